//! Oracle of a host: the replies and blocks that comms may send.

use crepitus_protocol::host::{Answer, Operation, Reply, Request};
use crepitus_protocol::management;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::{Decoder, Lane, Session, Values};
use std::collections::BTreeMap;

/// Accounting of a subscription.
#[derive(Clone, Copy)]
struct SampleAccounting {
    first_tick: u64,
    received: u64,
    start: Option<u8>,
    next_tick: u64,
}

/// A host that receives all replies.
#[derive(Default)]
pub(crate) struct HostOracle {
    decoder: Decoder,
    /// How many replies may still come to each request.
    expected: BTreeMap<(u32, u16), u32>,
    /// Which requests were subscriptions; the last one counts.
    subscription: Option<(Session, u16)>,
    accounting: Option<SampleAccounting>,
}

impl HostOracle {
    /// A request was sent.
    pub(crate) fn requested(&mut self, request: &Request) {
        let key = (request.session.0, request.number);
        match request.operation {
            Operation::Renew => return,
            Operation::Subscribe => {
                self.subscription = Some((request.session, request.number));
                self.accounting = None;
            }
            _ => {}
        }
        *self.expected.entry(key).or_default() += 1;
    }

    /// The connection was lost, with the bytes in flight.
    pub(crate) fn cut(&mut self) {
        self.decoder.reset();
        self.subscription = None;
        self.accounting = None;
    }

    /// A byte from comms; `values` are those that there may be.
    pub(crate) fn receive(&mut self, byte: u8, values: &[Values]) {
        let Some(body) = self.decoder.push(byte) else {
            return;
        };
        let body = body.expect("a frame in order");
        match body.lane() {
            Some(Lane::Reply) => {
                let reply = body.message().expect("a reply");
                self.reply(&reply, values);
            }
            Some(Lane::Telemetry) => {
                let block = body.message().expect("a block");
                self.block(&block);
            }
            Some(Lane::ManagementAnswer) => {
                assert!(management::Answer::of(body.payload).is_some());
            }
            other => panic!("{other:?} from comms"),
        }
    }

    fn reply(&mut self, reply: &Reply, values: &[Values]) {
        let expected = self.expected.get_mut(&(reply.session.0, reply.number));
        let expected = expected.expect("a reply to nobody");
        assert!(*expected > 0, "a reply too many: {reply:?}");
        *expected -= 1;
        match reply.answer {
            Ok(Answer::Subscribed { first_tick })
                if self.subscription == Some((reply.session, reply.number)) =>
            {
                self.subscription = None;
                self.accounting = Some(SampleAccounting {
                    first_tick,
                    received: 0,
                    start: None,
                    next_tick: 0,
                });
            }
            Ok(Answer::Parameters { values: told, .. }) => {
                assert!(values.contains(&told), "nobody's values");
            }
            _ => {}
        }
    }

    fn block(&mut self, block: &Block) {
        let Some(accounting) = &mut self.accounting else {
            return;
        };
        let start = block.flags.start();
        let is_another = match accounting.start {
            Some(known) => known != start || block.first_tick < accounting.next_tick,
            // It may have been reset before the first block came.
            None => {
                block.first_tick.wrapping_sub(accounting.first_tick) != u64::from(block.dropped)
            }
        };
        if is_another {
            accounting.first_tick = block.first_tick.wrapping_sub(block.dropped.into());
            accounting.received = 0;
        }
        (accounting.start, accounting.next_tick) = (Some(start), block.end_tick());
        accounting.received += BLOCK_SAMPLES as u64;
        let produced = block.end_tick() - accounting.first_tick;
        let lost = produced - accounting.received;
        assert_eq!(lost & u64::from(u32::MAX), u64::from(block.dropped));
    }
}
