//! What the hub knows of a connected program, from the frames that it sends.

use crate::note::Program;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::{LEASE_TICKS, Lane, TICKS_PER_S};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, TrySendError};
use std::time::{Duration, Instant};

/// Bytes for a program, in whole frames.
pub(crate) type Chunk = Arc<[u8]>;

/// A connected program.
#[derive(Debug)]
pub(crate) struct Member {
    program: Program,
    outbox: SyncSender<Chunk>,
    /// Its last request.
    last: Option<Request>,
    /// When it asked to be armed, and renewed the lease last.
    asked: Option<Instant>,
    renewed: Option<Instant>,
    is_subscribed: bool,
}

impl Member {
    pub(crate) fn new(outbox: SyncSender<Chunk>) -> Self {
        Self {
            program: Program::default(),
            outbox,
            last: None,
            asked: None,
            renewed: None,
            is_subscribed: false,
        }
    }

    /// It says who it is.
    pub(crate) fn introduce(&mut self, program: Program) {
        self.program = program;
    }

    /// It sends a request.
    pub(crate) fn requests(&mut self, request: &Request) {
        self.program.session = Some(request.session);
        match request.operation {
            // Its number is compared with those of renewals only.
            Operation::Renew => return self.renewed = Some(Instant::now()),
            Operation::Arm => self.asked = Some(Instant::now()),
            Operation::Disarm => (self.asked, self.renewed) = (None, None),
            Operation::Subscribe => self.is_subscribed = true,
            Operation::Unsubscribe => self.is_subscribed = false,
            _ => {}
        }
        self.last = Some(*request);
    }

    /// Passes it bytes from the device. Those that it does not read in time are
    /// dropped, a chunk of whole frames at a time; its accounting shows them as
    /// lost on the connection.
    pub(crate) fn pass(&self, chunk: &Chunk) {
        match self.outbox.try_send(chunk.clone()) {
            // Its reader notices that it has gone.
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        }
    }

    /// The program, as of now.
    pub(crate) fn program(&self) -> Program {
        Program {
            is_armed: is_recent(self.renewed),
            ..self.program.clone()
        }
    }

    /// Requests on behalf of a program that has gone.
    pub(crate) fn last_will(&self) -> Vec<Frame> {
        let Some(last) = self.last else {
            return Vec::new();
        };
        let may_be_armed = is_recent(self.asked) || is_recent(self.renewed);
        let disarm = may_be_armed.then_some(Operation::Disarm);
        let unsubscribe = self.is_subscribed.then_some(Operation::Unsubscribe);
        let mut number = last.number;
        disarm
            .into_iter()
            .chain(unsubscribe)
            .filter_map(|operation| {
                number = number.saturating_add(1);
                let request = Request {
                    number,
                    operation,
                    ..last
                };
                frame::encode(Lane::Request, &request).ok()
            })
            .collect()
    }
}

/// Whether a lease of then may last.
fn is_recent(then: Option<Instant>) -> bool {
    let lease = Duration::from_secs(1) * u32::try_from(LEASE_TICKS).unwrap_or(0) / TICKS_PER_S;
    then.is_some_and(|then| then.elapsed() < lease)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::{Decoder, Nonce, Session};
    use std::sync::mpsc::sync_channel;

    fn request(number: u32, operation: Operation) -> Request {
        Request {
            session: Session(7),
            nonce: Nonce(8),
            number,
            operation,
        }
    }

    fn said(frames: &[Frame]) -> Vec<Request> {
        let mut decoder = Decoder::new();
        let mut requests = Vec::new();
        for byte in frames.iter().flatten() {
            if let Some(Ok(body)) = decoder.push(*byte) {
                requests.extend(body.message::<Request>());
            }
        }
        requests
    }

    #[test]
    fn the_last_will_is_what_the_program_has_left_open() {
        let (outbox, _inbox) = sync_channel(1);
        let mut member = Member::new(outbox);
        assert_eq!(said(&member.last_will()), []);
        member.requests(&request(0xfffe, Operation::Subscribe));
        member.requests(&request(0xffff, Operation::Arm));
        let will = [
            request(0x1_0000, Operation::Disarm),
            request(0x1_0001, Operation::Unsubscribe),
        ];
        // Killed before its first renewal, it may be armed all the same.
        assert_eq!(said(&member.last_will()), will);
        assert!(!member.program().is_armed);
        member.requests(&request(0x1_0005, Operation::Renew));
        assert!(member.program().is_armed);
        assert_eq!(said(&member.last_will()), will);
        member.requests(&request(0x1_0000, Operation::Disarm));
        member.requests(&request(0x1_0001, Operation::Unsubscribe));
        assert_eq!(said(&member.last_will()), []);
        assert!(!member.program().is_armed);
    }

    #[test]
    fn what_a_program_does_not_read_is_dropped() {
        let (outbox, inbox) = sync_channel(2);
        let member = Member::new(outbox);
        let chunk = Chunk::from([1, 0].as_slice());
        for _ in 0..5 {
            member.pass(&chunk);
        }
        assert_eq!(inbox.try_iter().count(), 2);
        drop(inbox);
        member.pass(&chunk);
    }
}
