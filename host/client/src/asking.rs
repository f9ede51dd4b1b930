//! Asking until there is an answer, and the lease meanwhile.

use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::Event;
use crate::reconnect::Loss;
use crate::refusals::Refused;
use crate::request_kind::RequestKind;
use crate::transport::{Transport, TransportError};
use crate::wire::{Heard, Wire};
use crepitus_protocol::host::{Answer, Ask, Refusal, Reply, Request};
use crepitus_protocol::management::{self, Question, What};
use std::time::Duration;

/// The lease of 250 ms is renewed this often: four renewals may be lost.
const RENEW_EVERY: Duration = Duration::from_millis(50);

/// A device that is busy is asked again for so long, this often.
const BUSY_PATIENCE: Duration = Duration::from_millis(500);
const BUSY_PAUSE: Duration = Duration::from_millis(20);

impl<T: Transport> Client<T> {
    /// Asks, and waits for the answer. What is refused because the device is
    /// still busy with something else is asked anew for half a second.
    pub(crate) fn ask(&mut self, ask: Ask) -> Result<Answer, Error> {
        let what = RequestKind::of(&ask);
        let end = self.now() + BUSY_PATIENCE;
        loop {
            let (session, number) = (self.session, self.next_number());
            let request = Request {
                session,
                number,
                ask,
            };
            let reply = self.exchange(
                what,
                |wire| wire.request(&request),
                |heard| match heard {
                    Heard::Reply(reply) if reply.number == number => Some(**reply),
                    _ => None,
                },
            )?;
            let Reply { answer, .. } = reply;
            match answer {
                Ok(answer) => return Ok(answer),
                Err(Refusal::Busy) if what.is_job() && self.now() < end => self.idle(BUSY_PAUSE)?,
                Err(refusal) => {
                    let values = match ask {
                        Ask::Commit { values, .. } => Some(values),
                        _ => None,
                    };
                    return Err(Error::from(Refused {
                        what,
                        refusal,
                        values,
                    }));
                }
            }
        }
    }

    /// Asks on the lane that never changes.
    pub(crate) fn ask_management(&mut self, what: What) -> Result<management::Answer, Error> {
        self.token = self.token.wrapping_add(1);
        let question = Question {
            what,
            token: self.token,
        };
        self.exchange(
            RequestKind::of_question(what),
            |wire| wire.question(question),
            |heard| match heard {
                Heard::Answer(answer)
                    if answer.token() == question.token && kind_of(answer) == what =>
                {
                    Some(*answer)
                }
                _ => None,
            },
        )
    }

    /// Sends until there is an answer that is meant.
    fn exchange<R>(
        &mut self,
        what: RequestKind,
        send: impl Fn(&mut Wire<T>) -> Result<(), TransportError>,
        find: impl Fn(&Heard) -> Option<R>,
    ) -> Result<R, Error> {
        self.asking = Some(what);
        let result = self.repeat(what, send, find);
        self.asking = None;
        result
    }

    fn repeat<R>(
        &mut self,
        what: RequestKind,
        send: impl Fn(&mut Wire<T>) -> Result<(), TransportError>,
        find: impl Fn(&Heard) -> Option<R>,
    ) -> Result<R, Error> {
        let patience = what.patience();
        let began = self.now();
        let end = began + patience.limit;
        let mut tries = 0;
        while self.now() < end {
            self.connected()?;
            let sent = send(&mut self.wire);
            self.sent(sent)?;
            self.counts.repeats += u64::from(tries > 0);
            tries += 1;
            let again = end.min(self.now() + patience.again);
            while self.now() < again {
                let Some(heard) = self.turn(again)? else {
                    continue;
                };
                if let Some(answer) = find(&heard) {
                    self.round_trips
                        .took(what, self.now().saturating_sub(began));
                    return Ok(answer);
                }
                self.counts.strays += 1;
            }
        }
        Err(Error::NoAnswer {
            what,
            tries,
            waited: self.now().saturating_sub(began),
            port: self.port(),
        })
    }

    /// Lets time go by, in which the lease is renewed and nothing is missed.
    pub(crate) fn idle(&mut self, time: Duration) -> Result<(), Error> {
        let until = self.now() + time;
        while self.now() < until {
            if self.turn(until)?.is_some() {
                self.counts.strays += 1;
            }
        }
        Ok(())
    }

    /// Renews the lease if that is due, then takes the next message, waited
    /// for until then at most. Gives it if it is an answer that may be meant;
    /// nothing is not yet the end of the time.
    pub(crate) fn turn(&mut self, until: Duration) -> Result<Option<Heard>, Error> {
        self.connected()?;
        self.renew()?;
        let until = match self.lease {
            Lease::None => until,
            Lease::Taking | Lease::Held => until.min(self.renewed_at + RENEW_EVERY),
        };
        match self.wire.next(until) {
            Ok(heard) => Ok(heard.and_then(|heard| self.take_in(heard))),
            Err(error) => Err(self.failed(error)),
        }
    }

    /// Renews the lease, if that is due.
    pub(crate) fn renew(&mut self) -> Result<(), Error> {
        let now = self.now();
        if self.lease == Lease::None || now.saturating_sub(self.renewed_at) < RENEW_EVERY {
            return Ok(());
        }
        self.renewed_at = now;
        let sent = self.wire.request(&Request {
            session: self.session,
            number: self.number,
            ask: Ask::Renew,
        });
        self.counts.renewals += 1;
        self.sent(sent)
    }

    pub(crate) fn next_number(&mut self) -> u16 {
        self.number = self.number.wrapping_add(1);
        self.number
    }

    /// What was not taken is as good as lost on the way: it will be repeated.
    pub(crate) fn sent(&mut self, result: Result<(), TransportError>) -> Result<(), Error> {
        match result {
            Ok(()) => Ok(()),
            Err(TransportError::Stalled { .. }) => {
                self.counts.stalls += 1;
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

    /// The line has failed: whatever it is, it has to be opened again.
    pub(crate) fn failed(&mut self, error: TransportError) -> Error {
        self.loss = Some(Loss {
            was_armed: self.lease == Lease::Held,
            unanswered: self.asking,
        });
        self.lease = Lease::None;
        self.watch.asked = None;
        self.events.push_back(Event::Lost(error.clone()));
        error.into()
    }
}

fn kind_of(answer: &management::Answer) -> What {
    match answer {
        management::Answer::Hello { .. } => What::Hello,
        management::Answer::Stop { .. } => What::Stop,
        management::Answer::Reboot { .. } => What::Reboot,
    }
}
