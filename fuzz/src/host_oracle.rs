//! Oracle of a host: the replies and blocks that comms may send.

use crate::known_values::KnownValues;
use crepitus_protocol::host::{Answer, Operation, Reply, Request};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::{Nonce, Session};
use std::collections::{BTreeMap, BTreeSet};

/// Accounting of a subscription.
#[derive(Clone, Copy)]
struct SampleAccounting {
    first_tick: u64,
    dropped_before: u32,
    received: u64,
    start: u8,
    next_tick: u64,
}

/// A host that receives all replies.
#[derive(Default)]
pub(crate) struct HostOracle {
    /// Number of replies that may still come to each request.
    expected: BTreeMap<(u32, u32), u32>,
    /// Nonces of the sessions.
    nonces: BTreeMap<u32, Nonce>,
    /// Sessions whose nonce is of this start of comms.
    open: BTreeSet<u32>,
    /// Number of each session's request that was a subscription; the last one counts.
    subscriptions: BTreeMap<u32, u32>,
    /// Start and ticks of the blocks that have come since, first and next: a reply may come after
    /// them, if it is the second one.
    waiting: BTreeMap<u32, Vec<(u8, u64, u64)>>,
    /// Accounting of each session, also of one that has unsubscribed: the count is one for
    /// all.
    accountings: BTreeMap<u32, SampleAccounting>,
}

impl HostOracle {
    /// A request was sent.
    pub(crate) fn requested(&mut self, request: &Request) {
        let key = (request.session.0, request.number);
        match request.operation {
            Operation::Renew => return,
            Operation::Subscribe => {
                self.subscriptions.insert(key.0, request.number);
                self.waiting.insert(key.0, Vec::new());
                self.accountings.remove(&key.0);
            }
            _ => {}
        }
        *self.expected.entry(key).or_default() += 1;
    }

    /// A request was sent again, and will not be executed.
    pub(crate) fn repeated(&mut self, request: &Request) {
        if request.operation != Operation::Renew {
            let key = (request.session.0, request.number);
            *self.expected.entry(key).or_default() += 1;
        }
    }

    /// Comms has restarted: no session is open.
    pub(crate) fn closed(&mut self) {
        self.open.clear();
    }

    /// A host has heard that its session is not open.
    pub(crate) fn forget(&mut self, session: Session) {
        self.nonces.remove(&session.0);
        self.open.remove(&session.0);
    }

    /// Returns whether comms has given this session its nonce since its restart.
    pub(crate) fn is_open(&self, session: Session) -> bool {
        self.open.contains(&session.0)
    }

    /// The connection was lost, with the bytes in flight.
    pub(crate) fn cut(&mut self) {
        self.subscriptions.clear();
        self.waiting.clear();
        self.accountings.clear();
    }

    /// Returns whether no reply and no telemetry is to come.
    pub(crate) fn is_idle(&self) -> bool {
        self.accountings.is_empty() && self.expected.values().all(|count| *count == 0)
    }

    /// The nonce of a session.
    pub(crate) fn nonce(&self, session: Session) -> Nonce {
        self.nonces.get(&session.0).copied().unwrap_or_default()
    }

    /// A reply has come; `values` are those that there may be. Returns
    /// whether a subscription begins with it.
    pub(crate) fn reply(&mut self, reply: &Reply, values: &KnownValues) -> bool {
        let expected = self.expected.get_mut(&(reply.session.0, reply.number));
        let expected = expected.expect("a reply to nobody");
        assert!(*expected > 0, "a reply too many: {reply:?}");
        *expected -= 1;
        match reply.answer {
            Ok(Answer::Subscribed {
                first_tick,
                dropped,
                start,
            }) if self.subscriptions.get(&reply.session.0) == Some(&reply.number) => {
                self.subscriptions.remove(&reply.session.0);
                let waiting = self.waiting.remove(&reply.session.0).unwrap_or_default();
                let came = waiting
                    .iter()
                    .filter(|(of, first, _)| *of == start && *first >= first_tick);
                let accounting = SampleAccounting {
                    first_tick,
                    dropped_before: dropped,
                    received: came.clone().count() as u64 * BLOCK_SAMPLES as u64,
                    start,
                    next_tick: came.map(|(_, _, next)| *next).max().unwrap_or(0),
                };
                self.accountings.insert(reply.session.0, accounting);
                return true;
            }
            Ok(Answer::Opened { nonce }) => {
                assert_ne!(nonce, Nonce::NONE);
                self.nonces.insert(reply.session.0, nonce);
                self.open.insert(reply.session.0);
            }
            Ok(Answer::Parameters { values: told, .. }) => {
                assert!(values.has(&told), "nobody's values");
            }
            _ => {}
        }
        false
    }

    /// A block has come.
    pub(crate) fn block(&mut self, block: &Block) {
        for accounting in self.accountings.values_mut() {
            accounting.block(block);
        }
        let came = (block.flags.start(), block.first_tick, block.end_tick());
        for waiting in self.waiting.values_mut() {
            waiting.push(came);
        }
    }
}

impl SampleAccounting {
    fn block(&mut self, block: &Block) {
        let start = block.flags.start();
        if self.start != start || block.first_tick < self.next_tick {
            self.first_tick = block.first_tick.wrapping_sub(block.dropped.into());
            (self.dropped_before, self.received) = (0, 0);
        }
        (self.start, self.next_tick) = (start, block.end_tick());
        self.received += BLOCK_SAMPLES as u64;
        let produced = block.end_tick() - self.first_tick;
        let lost = produced - self.received;
        let dropped = block.dropped.wrapping_sub(self.dropped_before);
        assert_eq!(lost & u64::from(u32::MAX), u64::from(dropped));
    }
}
