//! Subscription and lease of a program, which have to end when it does.

use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::{Decoder, LEASE_TICKS, Lane, Nonce, Session, TICKS_PER_S};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Kept by the hub for every program, and by each program itself: with the hub it would be
/// forgotten. What the hub's own program has left open, the others keep.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct LeftOpen {
    /// Session, nonce and number of its last request.
    last: Option<(Session, Nonce, u32)>,
    is_subscribed: bool,
    /// Times at which it asked to be armed, and renewed the lease last: not known to another hub.
    #[serde(skip)]
    asked: Option<Instant>,
    #[serde(skip)]
    renewed: Option<Instant>,
}

impl LeftOpen {
    /// Takes note of a request.
    pub(crate) fn requests(&mut self, request: &Request) {
        match request.operation {
            // The number of a renewal is compared with those of renewals only.
            Operation::Renew => return self.renewed = Some(Instant::now()),
            Operation::Arm => self.asked = Some(Instant::now()),
            Operation::Disarm => (self.asked, self.renewed) = (None, None),
            Operation::Subscribe => self.is_subscribed = true,
            Operation::Unsubscribe => self.is_subscribed = false,
            Operation::Status
            | Operation::Counters
            | Operation::Times
            | Operation::Parameters
            | Operation::Commit { .. }
            | Operation::Save
            | Operation::Zero
            | Operation::ClearFault
            | Operation::Open
            | Operation::ReadCrash { .. }
            // The drive ends it by itself.
            | Operation::PlayChirp(_) => {}
        }
        self.last = Some((request.session, request.nonce, request.number));
    }

    /// Session of the program.
    pub(crate) fn session(&self) -> Option<Session> {
        self.last.map(|(session, ..)| session)
    }

    /// Returns whether it renews the lease: the device is armed for it.
    pub(crate) fn renews(&self) -> bool {
        is_recent(self.renewed)
    }

    /// Returns whether it has asked to be armed, and not to be disarmed since.
    pub(crate) fn is_armed(&self) -> bool {
        self.asked.is_some() || self.renewed.is_some()
    }

    /// Requests on behalf of a program that has gone.
    pub(crate) fn last_will(&self) -> Vec<Frame> {
        self.will(is_recent(self.asked) || self.renews())
    }

    /// Requests on behalf of a program of which only `may_be_armed` is known.
    pub(crate) fn will(&self, may_be_armed: bool) -> Vec<Frame> {
        let Some((session, nonce, last)) = self.last else {
            return Vec::new();
        };
        let disarm = may_be_armed.then_some(Operation::Disarm);
        let unsubscribe = self.is_subscribed.then_some(Operation::Unsubscribe);
        let mut number = last;
        disarm
            .into_iter()
            .chain(unsubscribe)
            .filter_map(|operation| {
                number = number.saturating_add(1);
                let request = Request {
                    session,
                    nonce,
                    number,
                    operation,
                };
                frame::encode(Lane::Request, &request).ok()
            })
            .collect()
    }
}

/// The requests in whole frames.
pub(crate) fn requests_in(frames: &[u8]) -> Vec<Request> {
    let mut decoder = Decoder::new();
    let mut requests = Vec::new();
    for byte in frames {
        if let Some(Ok(body)) = decoder.push(*byte)
            && body.lane() == Some(Lane::Request)
        {
            requests.extend(body.message::<Request>());
        }
    }
    requests
}

/// Returns whether a lease that was renewed then may still be valid.
fn is_recent(then: Option<Instant>) -> bool {
    let lease = Duration::from_secs(1) * u32::try_from(LEASE_TICKS).unwrap_or(0) / TICKS_PER_S;
    then.is_some_and(|then| then.elapsed() < lease)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(number: u32, operation: Operation) -> Request {
        Request {
            session: Session(7),
            nonce: Nonce(8),
            number,
            operation,
        }
    }

    fn said(frames: &[Frame]) -> Vec<Request> {
        requests_in(&frames.concat())
    }

    #[test]
    fn the_last_will_is_what_the_program_has_left_open() {
        let mut open = LeftOpen::default();
        assert_eq!(said(&open.last_will()), []);
        open.requests(&request(0xfffe, Operation::Subscribe));
        open.requests(&request(0xffff, Operation::Arm));
        let will = [
            request(0x1_0000, Operation::Disarm),
            request(0x1_0001, Operation::Unsubscribe),
        ];
        // Killed before its first renewal, it may be armed all the same.
        assert_eq!(said(&open.last_will()), will);
        assert!(!open.renews());
        // More than a lease ago: from now on only a renewal tells that it may be armed.
        open.asked = Instant::now().checked_sub(Duration::from_secs(1));
        let only_unsubscribe = [request(0x1_0000, Operation::Unsubscribe)];
        assert_eq!(said(&open.last_will()), only_unsubscribe);
        open.requests(&request(0x1_0005, Operation::Renew));
        assert!(open.renews());
        assert_eq!(said(&open.last_will()), will);
        open.requests(&request(0x1_0000, Operation::Disarm));
        open.requests(&request(0x1_0001, Operation::Unsubscribe));
        assert_eq!(said(&open.last_will()), []);
        assert!(!open.renews());
    }

    #[test]
    fn another_hub_knows_the_subscription() {
        let mut open = LeftOpen::default();
        open.requests(&request(4, Operation::Subscribe));
        open.requests(&request(5, Operation::Status));
        let text = serde_json::to_string(&open).unwrap();
        let told: LeftOpen = serde_json::from_str(&text).unwrap();
        assert_eq!(
            said(&told.last_will()),
            [request(6, Operation::Unsubscribe)]
        );
    }
}
