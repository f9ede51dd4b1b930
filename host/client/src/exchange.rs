//! Request and reply with retries and timeout; renews the lease meanwhile.

use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::Event;
use crate::loss::Loss;
use crate::refusals::Refused;
use crate::request_kind::RequestKind;
use crate::transport::{Transport, TransportError};
use crate::wire::{Incoming, Wire};
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply, Request};
use crepitus_protocol::management::{self, Action, ManagementRequest};
use std::time::Duration;

/// Interval of lease renewals: the lease of 250 ms survives four lost ones.
pub(crate) const RENEW_EVERY: Duration = Duration::from_millis(50);

/// Timeout and interval of retries while the device is busy.
const BUSY_TIMEOUT: Duration = Duration::from_millis(500);
const BUSY_RETRY: Duration = Duration::from_millis(20);

impl<T: Transport> Client<T> {
    /// Sends a request and waits for the reply. Retries for half a second while
    /// the device is busy.
    pub(crate) fn request(&mut self, operation: Operation) -> Result<Answer, Error> {
        let kind = RequestKind::of(&operation);
        let end = self.now() + BUSY_TIMEOUT;
        loop {
            let number = self.next_number();
            let request = self.numbered(number, operation);
            let reply = self.exchange(
                kind,
                |wire| wire.request(&request),
                |incoming| match incoming {
                    Incoming::Reply(reply) if reply.number == number => Some(**reply),
                    _ => None,
                },
            )?;
            let Reply { answer, .. } = reply;
            match answer {
                Ok(answer) => return Ok(answer),
                Err(Refusal::NotOpen) => return Err(self.forgotten()),
                Err(Refusal::Busy) if kind.is_job() && self.now() < end => self.idle(BUSY_RETRY)?,
                Err(refusal) => {
                    let values = match operation {
                        Operation::Commit { values, .. } => Some(values),
                        _ => None,
                    };
                    return Err(Error::from(Refused {
                        request: kind,
                        refusal,
                        values,
                    }));
                }
            }
        }
    }

    /// A request of this session.
    pub(crate) fn numbered(&self, number: u32, operation: Operation) -> Request {
        Request {
            session: self.session,
            nonce: self.nonce,
            number,
            operation,
        }
    }

    /// Opens the session.
    pub(crate) fn open(&mut self) -> Result<(), Error> {
        match self.request(Operation::Open)? {
            Answer::Opened { nonce } => {
                self.nonce = nonce;
                Ok(())
            }
            _ => Err(Error::Unexpected {
                request: RequestKind::Open,
            }),
        }
    }

    /// Handles a session that is open no longer: the device has restarted, or
    /// has evicted it. Reconnecting opens it again.
    pub(crate) fn forgotten(&mut self) -> Error {
        let port = self.port();
        self.failed(TransportError::Forgotten { port })
    }

    /// Sends a management request and waits for the answer.
    pub(crate) fn request_management(
        &mut self,
        action: Action,
    ) -> Result<management::Answer, Error> {
        self.token = self.token.wrapping_add(1);
        let request = ManagementRequest {
            action,
            token: self.token,
        };
        self.exchange(
            RequestKind::of_management(action),
            |wire| wire.management(request),
            |incoming| match incoming {
                Incoming::Answer(answer)
                    if answer.token() == request.token && action_of(answer) == action =>
                {
                    Some(*answer)
                }
                _ => None,
            },
        )
    }

    /// Sends with retries until the matching reply arrives.
    fn exchange<R>(
        &mut self,
        kind: RequestKind,
        send: impl Fn(&mut Wire<T>) -> Result<(), TransportError>,
        find: impl Fn(&Incoming) -> Option<R>,
    ) -> Result<R, Error> {
        self.pending_request = Some(kind);
        let result = self.repeat(kind, send, find);
        self.pending_request = None;
        result
    }

    fn repeat<R>(
        &mut self,
        kind: RequestKind,
        send: impl Fn(&mut Wire<T>) -> Result<(), TransportError>,
        find: impl Fn(&Incoming) -> Option<R>,
    ) -> Result<R, Error> {
        let timing = kind.timing();
        let started = self.now();
        let end = started + timing.limit;
        let mut tries = 0;
        while self.now() < end {
            self.connected()?;
            let sent = send(&mut self.wire);
            self.sent(sent)?;
            self.tally.repeats += u64::from(tries > 0);
            tries += 1;
            let retry_at = end.min(self.now() + timing.retry);
            while self.now() < retry_at {
                let Some(incoming) = self.receive(retry_at)? else {
                    continue;
                };
                if let Some(answer) = find(&incoming) {
                    self.round_trips
                        .took(kind, self.now().saturating_sub(started));
                    return Ok(answer);
                }
                self.tally.stray_answers += 1;
            }
        }
        Err(Error::NoAnswer {
            request: kind,
            tries,
            waited: self.now().saturating_sub(started),
            port: self.port(),
        })
    }

    /// Waits, renewing the lease and receiving messages.
    pub(crate) fn idle(&mut self, time: Duration) -> Result<(), Error> {
        let until = self.now() + time;
        while self.now() < until {
            if self.receive(until)?.is_some() {
                self.tally.stray_answers += 1;
            }
        }
        Ok(())
    }

    /// Renews the lease if due, then receives a message until the deadline.
    /// Returns it if it is a reply; `None` may come before the deadline.
    pub(crate) fn receive(&mut self, until: Duration) -> Result<Option<Incoming>, Error> {
        self.connected()?;
        self.renew()?;
        let until = match self.lease {
            Lease::None => until,
            Lease::Taking | Lease::Held => until.min(self.renewed_at + RENEW_EVERY),
        };
        match self.wire.next(until) {
            Ok(incoming) => Ok(incoming.and_then(|incoming| self.take_in(incoming))),
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Renews the lease if due.
    pub(crate) fn renew(&mut self) -> Result<(), Error> {
        let now = self.now();
        if self.lease == Lease::None || now.saturating_sub(self.renewed_at) < RENEW_EVERY {
            return Ok(());
        }
        self.renewed_at = now;
        let number = self.next_number();
        let renewal = self.numbered(number, Operation::Renew);
        let sent = self.wire.request(&renewal);
        self.tally.renewals += 1;
        self.sent(sent)
    }

    pub(crate) fn next_number(&mut self) -> u32 {
        self.number = self.number.wrapping_add(1);
        self.number
    }

    /// Handles a send error: a stalled frame counts as lost and is retried.
    pub(crate) fn sent(&mut self, result: Result<(), TransportError>) -> Result<(), Error> {
        match result {
            Ok(()) => Ok(()),
            Err(TransportError::Stalled { .. }) => {
                self.tally.stalls += 1;
                Ok(())
            }
            Err(error) => Err(self.failed(error)),
        }
    }

    pub(crate) fn connected(&self) -> Result<(), Error> {
        if self.loss.is_none() {
            return Ok(());
        }
        Err(Error::NotConnected { port: self.port() })
    }

    /// Handles a failed connection: it has to be reopened.
    pub(crate) fn failed(&mut self, error: TransportError) -> Error {
        self.loss = Some(Loss {
            was_armed: self.lease == Lease::Held,
            unanswered: self.pending_request,
        });
        self.lease = Lease::None;
        (self.watch.asked, self.watch.unanswered) = (None, 0);
        self.events.push_back(Event::Lost(error.clone()));
        error.into()
    }
}

fn action_of(answer: &management::Answer) -> Action {
    match answer {
        management::Answer::Hello { .. } => Action::Hello,
        management::Answer::Stop { .. } => Action::Stop,
        management::Answer::Reboot { .. } => Action::Reboot,
    }
}
