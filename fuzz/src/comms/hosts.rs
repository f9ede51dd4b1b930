//! Requests and noise of hosts, and the notes of the oracle on them.

use super::{Bench, session_at};
use crate::sent::Sent;
use crepitus_device::Comms;
use crepitus_device::usb_port::HostBytes;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::host::{Operation, Refusal, Reply, Request};
use crepitus_protocol::management::Action;
use crepitus_protocol::{LEASE_TICKS, Lane, Nonce, Session, frame};

/// Sessions that comms knows at once.
const MOST_SESSIONS: u32 = 32;

impl Bench {
    pub(super) fn request(&mut self, session: Session, number: u32, operation: Operation) {
        self.request_with(self.host.nonce(session), session, number, operation);
    }

    /// Opens as many new sessions as comms has room for, so that it evicts the others, except the
    /// holder of the lease and the one that a request is for.
    pub(super) fn evict_sessions(&mut self) {
        for number in 0..MOST_SESSIONS {
            self.request(Session(0x10_0000 + number), 1, Operation::Open);
            self.read(usize::MAX);
        }
        // They open theirs again, with numbers of their own.
        for (place, number) in (0..).zip(&mut self.numbers) {
            self.host.forget(session_at(place));
            *number += 1;
        }
    }

    /// A request with another nonce than that of the session is not executed.
    pub(super) fn stale_request(&mut self, session: Session, number: u32, operation: Operation) {
        if operation == Operation::Open {
            return;
        }
        let executed = |comms: &Comms| {
            let counters = comms.counters();
            [CommsCounter::Requests, CommsCounter::Renewals].map(|counter| counters.get(counter))
        };
        let before = executed(&self.comms);
        let Nonce(nonce) = self.host.nonce(session);
        self.request_with(Nonce(nonce ^ 1), session, number, operation);
        assert_eq!(executed(&self.comms), before, "{session:?} {operation:?}");
    }

    fn request_with(&mut self, nonce: Nonce, session: Session, number: u32, operation: Operation) {
        let request = Request {
            session,
            nonce,
            number,
            operation,
        };
        let frame = frame::encode(Lane::Request, &request).expect("every message fits");
        self.send(&frame, &Sent::Request(request));
    }

    /// A frame of a host, for comms and for the oracle. After a delimiter it is
    /// received as it was sent.
    pub(super) fn send(&mut self, frame: &[u8], sent: &Sent) {
        if self.is_in_frame {
            return self.send_raw(frame);
        }
        let requests = self.requests();
        self.comms.received(frame);
        self.note(sent, requests);
    }

    /// Any bytes of a host; what was received is known only from decoding them.
    pub(super) fn send_raw(&mut self, bytes: &[u8]) {
        for run in bytes.split_inclusive(|byte| *byte == frame::DELIMITER) {
            let sent = run.iter().fold(None, |sent, byte| {
                let body = self.ear.push(*byte).and_then(Result::ok);
                body.as_ref().and_then(Sent::of).or(sent)
            });
            let requests = self.requests();
            self.comms.received(run);
            if let Some(sent) = sent {
                self.note(&sent, requests);
            }
            self.is_in_frame = run.last() != Some(&frame::DELIMITER);
        }
    }

    /// Requests that were executed.
    fn requests(&self) -> u32 {
        self.comms.counters().get(CommsCounter::Requests)
    }

    fn note(&mut self, sent: &Sent, requests_before: u32) {
        match sent {
            Sent::Request(request) => self.requested(request, self.requests() != requests_before),
            Sent::Question(question) => match question.action {
                Action::Stop => self.lease.stop(),
                Action::Reboot => self.may_reboot = true,
                Action::Hello => {}
            },
        }
    }

    fn requested(&mut self, request: &Request, is_new: bool) {
        let Request {
            session,
            nonce,
            number,
            operation,
        } = *request;
        if is_new {
            self.host.requested(request);
        } else {
            self.host.repeated(request);
        }
        let end_tick = self.drive.tick() + LEASE_TICKS;
        if operation == Operation::Renew {
            let last = self.renewed.get(&session.0);
            let is_newer = last.is_none_or(|last| last.0 != nonce || last.1 < number);
            if nonce == self.host.nonce(session) && is_newer {
                self.renewed.insert(session.0, (nonce, number));
                if self.lease.renew(session, self.now_ms) {
                    self.lease_end_tick = self.lease_end_tick.map(|end| end.max(end_tick));
                }
            }
            return;
        }
        if !is_new {
            return;
        }
        if operation != Operation::Open {
            let before = self.executed.insert(session.0, (nonce, number));
            let is_newer = before.is_none_or(|last| last.0 != nonce || last.1 < number);
            assert!(is_newer, "{number} after {before:?}");
        }
        match operation {
            // Whether or not it is refused.
            Operation::Arm => {
                let is_first = !self.lease.is_alive(self.now_ms);
                self.lease.arm(session, number, self.now_ms);
                self.lease_end_tick = match self.lease_end_tick {
                    _ if is_first => Some(end_tick),
                    before => before.map(|end| end.max(end_tick)),
                };
            }
            Operation::Disarm => self.lease.disarm(session),
            Operation::Commit { values, .. } => {
                self.numbered += 1;
                self.values.add(&values);
                self.commits.insert((session.0, number), values);
            }
            Operation::Save => self.may_save = true,
            _ => {}
        }
    }

    pub(super) fn replied(&mut self, reply: &Reply) {
        // After a timeout a commit may come into effect; and a request that was
        // not executed may have the number of one that was.
        if matches!(reply.answer, Err(Refusal::Unconfirmed | Refusal::NotOpen)) {
            return;
        }
        if let Err(Refusal::Leased { .. }) = reply.answer {
            self.lease.refused(reply.session, reply.number);
        }
        let commit = self.commits.remove(&(reply.session.0, reply.number));
        if let (Some(values), Err(_)) = (commit, reply.answer) {
            self.values.withdraw(&values);
            let committed = self.comms.values();
            assert!(self.values.has(committed), "refused, and committed");
        }
    }
}
