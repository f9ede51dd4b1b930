//! A line that was lost, and what of it comes back.

use crate::accounting::Accounting;
use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::Event;
use crate::handshake::Handshake;
use crate::request_kind::RequestKind;
use crate::transport::Transport;
use crepitus_protocol::host::{Answer, Ask, Status};
use std::time::Duration;

/// A line that does not open is tried again this often.
const TRY_EVERY: Duration = Duration::from_millis(50);

/// What was under way as the line was lost.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loss {
    pub(crate) was_armed: bool,
    pub(crate) unanswered: Option<RequestKind>,
}

/// The line is open again, and what was lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconnected {
    /// Who is there now.
    pub handshake: Handshake,
    /// How it is now.
    pub status: Status,
    /// This client had armed the device. Its lease ends, and with it all
    /// torque; it is not armed again by itself.
    pub was_armed: bool,
    /// What was asked as the line was lost; whether it was done is not known.
    pub unanswered: Option<RequestKind>,
    /// The subscription goes on.
    pub resubscribed: Option<Resubscribed>,
}

/// A subscription that goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resubscribed {
    /// The tick after the last sample that had arrived.
    pub until_tick: u64,
    /// The tick from which on samples come again.
    pub from_tick: u64,
}

impl Resubscribed {
    /// Samples in between, which are in no books; not known if the drive has
    /// started anew.
    pub fn unseen(&self) -> Option<u64> {
        self.from_tick.checked_sub(self.until_tick)
    }
}

impl<T: Transport> Client<T> {
    /// Opens the line again, which may take this long, finds out who is there,
    /// and subscribes again if there was a subscription. It never arms.
    ///
    /// # Errors
    /// Why the last try failed; [`Error::Mismatch`] if the device speaks
    /// another language now. It may be tried again.
    pub fn reconnect(&mut self, patience: Duration) -> Result<Reconnected, Error> {
        let until = self.now() + patience;
        let loss = self.loss.unwrap_or(Loss {
            was_armed: self.is_armed(),
            unanswered: None,
        });
        loop {
            self.lease = Lease::None;
            self.watch.asked = None;
            let result = self.try_again(loss);
            // Who asks for a new line knows that the old one was lost.
            self.events.retain(|event| !matches!(event, Event::Lost(_)));
            let error = match result {
                Ok(reconnected) => return Ok(reconnected),
                Err(error) => error,
            };
            self.loss = Some(loss);
            if matches!(error, Error::Mismatch(_)) || self.now() >= until {
                return Err(error);
            }
            self.wire
                .wait(TRY_EVERY.min(until.saturating_sub(self.now())));
        }
    }

    fn try_again(&mut self, loss: Loss) -> Result<Reconnected, Error> {
        self.wire.reopen()?;
        self.loss = None;
        let handshake = self.identify()?;
        self.accept(handshake)?;
        let resubscribed = if self.telemetry.is_subscribed {
            Some(self.resubscribe()?)
        } else {
            None
        };
        Ok(Reconnected {
            handshake,
            status: self.status()?,
            was_armed: loss.was_armed,
            unanswered: loss.unanswered,
            resubscribed,
        })
    }

    fn resubscribe(&mut self) -> Result<Resubscribed, Error> {
        let until_tick = self.accounting().map_or(0, Accounting::next_tick);
        let from_tick = self.begin_subscription(|books, first_tick| match books {
            Some(books) => books.resume(first_tick),
            None => *books = Some(Accounting::new(first_tick)),
        })?;
        Ok(Resubscribed {
            until_tick,
            from_tick,
        })
    }

    /// Subscribes; then the books begin as they are told to.
    pub(crate) fn begin_subscription(
        &mut self,
        begin: impl FnOnce(&mut Option<Accounting>, u64),
    ) -> Result<u64, Error> {
        self.telemetry.early = Some(Vec::new());
        let answer = self.ask(Ask::Subscribe);
        let early = self.telemetry.early.take().unwrap_or_default();
        let Answer::Subscribed { first_tick } = answer? else {
            return Err(Error::Unexpected {
                what: RequestKind::Subscribe,
            });
        };
        begin(&mut self.telemetry.books, first_tick);
        self.telemetry.is_subscribed = true;
        self.telemetry.heard_at = self.now();
        self.telemetry.is_silent = false;
        // What came before is of an earlier subscription.
        for block in early {
            if block.first_tick >= first_tick {
                self.take_block(Box::new(block));
            } else {
                self.counts.unasked_blocks += 1;
            }
        }
        Ok(first_tick)
    }
}
