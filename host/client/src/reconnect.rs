//! Reconnecting after a lost connection.

use crate::accounting::Accounting;
use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::Event;
use crate::handshake::Handshake;
use crate::loss::Loss;
use crate::request_kind::RequestKind;
use crate::transport::Transport;
use crepitus_protocol::accounting::Begin;
use crepitus_protocol::host::{Answer, Operation, Status};
use std::time::Duration;

/// Retry interval of opening the port.
const TRY_EVERY: Duration = Duration::from_millis(50);

/// Result of a reconnect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconnected {
    /// The new handshake.
    pub handshake: Handshake,
    /// Current status.
    pub status: Status,
    /// This client had armed the device. Its lease expires, and torque ends; the
    /// client does not rearm.
    pub was_armed: bool,
    /// The request that was pending at the loss; its result is unknown.
    pub unanswered: Option<RequestKind>,
    /// The resumed subscription.
    pub resubscribed: Option<Resubscribed>,
}

/// A resumed subscription.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resubscribed {
    /// The tick after the last sample received before.
    pub until_tick: u64,
    /// Start of the resumed stream.
    pub begin: Begin,
}

impl Resubscribed {
    /// Samples in between, which are not accounted for; unknown if the drive
    /// has restarted.
    pub fn unseen(&self) -> Option<u64> {
        self.begin.first_tick.checked_sub(self.until_tick)
    }
}

impl<T: Transport> Client<T> {
    /// Reopens the connection within `patience`, repeats the handshake, and
    /// resumes a subscription. It never arms.
    ///
    /// # Errors
    /// The error of the last try; [`Error::Mismatch`] if the device now has
    /// another schema hash. It may be called again.
    pub fn reconnect(&mut self, patience: Duration) -> Result<Reconnected, Error> {
        let until = self.now() + patience;
        let loss = self.loss.unwrap_or(Loss {
            was_armed: self.is_armed(),
            unanswered: None,
        });
        loop {
            self.lease = Lease::None;
            (self.watch.asked, self.watch.unanswered) = (None, 0);
            let result = self.try_again(loss);
            // The caller knows already that the connection was lost.
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
        self.open()?;
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
        let begin = self.begin_subscription(|accounting, begin| match accounting {
            Some(accounting) => accounting.resume(begin),
            None => *accounting = Some(Accounting::new(begin)),
        })?;
        Ok(Resubscribed { until_tick, begin })
    }

    /// Subscribes and starts the accounting.
    pub(crate) fn begin_subscription(
        &mut self,
        begin: impl FnOnce(&mut Option<Accounting>, Begin),
    ) -> Result<Begin, Error> {
        self.telemetry.early = Some(Vec::new());
        let answer = self.request(Operation::Subscribe);
        let early = self.telemetry.early.take().unwrap_or_default();
        let Answer::Subscribed {
            first_tick,
            dropped,
            start,
        } = answer?
        else {
            return Err(Error::Unexpected {
                request: RequestKind::Subscribe,
            });
        };
        let first = Begin {
            first_tick,
            dropped,
            start,
        };
        begin(&mut self.telemetry.accounting, first);
        self.telemetry.is_subscribed = true;
        self.telemetry.heard_at = self.now();
        self.telemetry.is_silent = false;
        // Earlier blocks are of a previous subscription.
        for block in early {
            if block.first_tick >= first_tick {
                self.take_block(Box::new(block));
            } else {
                self.tally.unasked_blocks += 1;
            }
        }
        Ok(first)
    }
}
