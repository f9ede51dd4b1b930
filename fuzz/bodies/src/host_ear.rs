//! What a host hears of comms, and may expect to hear.

use crepitus_protocol::host::{Answer, Operation, Reply, Request};
use crepitus_protocol::management;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::{Decoder, Lane, Session, Values};
use std::collections::BTreeMap;

/// The books of a subscription.
#[derive(Clone, Copy)]
struct Books {
    first_tick: u64,
    received: u64,
    start: Option<u8>,
    next_tick: u64,
}

/// A host that hears all replies.
#[derive(Default)]
pub(crate) struct HostEar {
    decoder: Decoder,
    /// How many replies may still come to each request.
    expected: BTreeMap<(u32, u16), u32>,
    /// Which requests were subscriptions; the last one counts.
    subscription: Option<(Session, u16)>,
    books: Option<Books>,
}

impl HostEar {
    /// A request was sent.
    pub(crate) fn asked(&mut self, request: &Request) {
        let key = (request.session.0, request.number);
        match request.operation {
            Operation::Renew => return,
            Operation::Subscribe => {
                self.subscription = Some((request.session, request.number));
                self.books = None;
            }
            _ => {}
        }
        *self.expected.entry(key).or_default() += 1;
    }

    /// The connection was lost, and what was on its way.
    pub(crate) fn cut(&mut self) {
        self.decoder.reset();
        self.subscription = None;
        self.books = None;
    }

    /// A byte from comms; `values` are those that there may be.
    pub(crate) fn hear(&mut self, byte: u8, values: &[Values]) {
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
                self.books = Some(Books {
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
        let Some(books) = &mut self.books else {
            return;
        };
        let start = block.flags.start();
        let is_another = match books.start {
            Some(known) => known != start || block.first_tick < books.next_tick,
            // It may have been reset before the first block came.
            None => block.first_tick.wrapping_sub(books.first_tick) != u64::from(block.dropped),
        };
        if is_another {
            books.first_tick = block.first_tick.wrapping_sub(block.dropped.into());
            books.received = 0;
        }
        (books.start, books.next_tick) = (Some(start), block.end_tick());
        books.received += BLOCK_SAMPLES as u64;
        let produced = block.end_tick() - books.first_tick;
        let lost = produced - books.received;
        assert_eq!(lost & u64::from(u32::MAX), u64::from(block.dropped));
    }
}
