//! Events: blocks, changes of the status, loss of the connection.

use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::{Arrival, Event, StateChange};
use crate::transport::{Transport, TransportError};
use crate::wire::Incoming;
use crepitus_protocol::State;
use crepitus_protocol::accounting::Taken;
use crepitus_protocol::host::{Answer, Operation, Refusal, Status};
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// Capacity of the event queue: ten seconds of blocks.
pub(crate) const WAITING_EVENTS: usize = 10_000;

/// Messages received at most before an event is returned.
const AT_ONCE: usize = 64;

/// Polling interval of the status while armed or subscribed, and its retry
/// timeout.
const WATCH_EVERY: Duration = Duration::from_millis(100);

/// Delay of another status request after a change: each controller receives the
/// other's cause a few milliseconds late.
const SETTLES_IN: Duration = Duration::from_millis(20);

/// Unanswered status requests after which the holder of the lease considers the connection lost:
/// a second. Torque has ended long before, and the device saves nothing while armed.
const MOST_UNANSWERED: u8 = 10;

/// Timeout without a block that is reported as silence.
const SILENCE: Duration = Duration::from_millis(500);

impl<T: Transport> Client<T> {
    /// Renews the lease if this client has armed the device, receives, and
    /// returns the next event within `patience`. With zero it returns only
    /// pending events.
    ///
    /// Call it in a loop, every 50 ms or more often while the device is armed:
    /// the lease expires after 250 ms.
    ///
    /// # Errors
    /// [`Error::NotConnected`], after [`Event::Lost`] was returned.
    pub fn pump(&mut self, patience: Duration) -> Result<Option<Event>, Error> {
        let event = self.next_event(patience);
        self.pace.pumped_at = self.now();
        event
    }

    fn next_event(&mut self, patience: Duration) -> Result<Option<Event>, Error> {
        let until = self.now() + patience;
        loop {
            let taken = self.receive_pending();
            if let Some(event) = self.events.pop_front() {
                return Ok(Some(event));
            }
            // A connection lost during this call is an event.
            taken?;
            if self.now() >= until {
                return Ok(None);
            }
            if let Ok(Some(_)) = self.receive(self.next_look(until)) {
                self.tally.stray_answers += 1;
            }
        }
    }

    /// Receives without waiting, at the [pace](crate::client::Pace) of the program.
    fn receive_pending(&mut self) -> Result<(), Error> {
        self.connected()?;
        self.renew()?;
        self.look()?;
        let began = self.now();
        let program_took = began.saturating_sub(self.pace.pumped_at);
        self.pace.ahead = self.pace.ahead.saturating_sub(program_took);
        if !self.events.is_empty() && !self.pace.ahead.is_zero() {
            return Ok(());
        }
        for _ in 0..AT_ONCE {
            match self.wire.next(Duration::ZERO) {
                Ok(None) => break,
                Ok(Some(incoming)) => {
                    if self.take_in(incoming).is_some() {
                        self.tally.stray_answers += 1;
                    }
                }
                Err(error) => return Err(self.failed(error)),
            }
            let took = self.now().saturating_sub(began);
            self.pace.ahead = took.saturating_sub(program_took);
            if !self.events.is_empty() && !self.pace.ahead.is_zero() {
                break;
            }
        }
        self.listen_for_silence();
        Ok(())
    }

    /// Next deadline if nothing arrives.
    fn next_look(&self, until: Duration) -> Duration {
        let mut next = until;
        if self.watch.asked.is_some() || self.is_watching() {
            next = next.min(self.watch.asked_at + WATCH_EVERY);
        }
        if let Some(due_at) = self.watch.due_at
            && self.watch.asked.is_none()
        {
            next = next.min(due_at);
        }
        if self.telemetry.is_subscribed && !self.telemetry.is_silent {
            next = next.min(self.telemetry.heard_at + SILENCE);
        }
        next
    }

    fn is_watching(&self) -> bool {
        self.lease == Lease::Held || self.telemetry.is_subscribed
    }

    /// Requests the status if due.
    fn look(&mut self) -> Result<(), Error> {
        let now = self.now();
        let is_old = now.saturating_sub(self.watch.asked_at) >= WATCH_EVERY;
        let is_wanted = if self.watch.asked.is_some() {
            // The request or its reply was lost.
            is_old
        } else {
            let is_due = self.watch.due_at.is_some_and(|due_at| due_at <= now);
            is_due || (is_old && self.is_watching())
        };
        if !is_wanted {
            return Ok(());
        }
        if self.watch.asked.is_some() {
            self.watch.unanswered = self.watch.unanswered.saturating_add(1);
        }
        if self.lease == Lease::Held && self.watch.unanswered >= MOST_UNANSWERED {
            let (port, detail) = (self.port(), "nothing answers any more".to_owned());
            return Err(self.failed(TransportError::Lost { port, detail }));
        }
        let number = self.next_number();
        (self.watch.asked, self.watch.asked_at) = (Some(number), now);
        self.watch.due_at = None;
        let request = self.numbered(number, Operation::Status);
        let sent = self.wire.request(&request);
        self.sent(sent)
    }

    fn listen_for_silence(&mut self) {
        let telemetry = &mut self.telemetry;
        if !telemetry.is_subscribed || telemetry.is_silent {
            return;
        }
        let silence = self.wire.now().saturating_sub(telemetry.heard_at);
        if silence >= SILENCE {
            telemetry.is_silent = true;
            self.events.push_back(Event::Silent(silence));
        }
    }

    /// Handles events and returns other messages.
    pub(crate) fn take_in(&mut self, incoming: Incoming) -> Option<Incoming> {
        match incoming {
            Incoming::Block(block) => {
                self.take_block(block);
                None
            }
            Incoming::Times(times) => {
                if self.telemetry.is_subscribed && self.events.len() < WAITING_EVENTS {
                    self.events.push_back(Event::Times(times));
                }
                None
            }
            Incoming::Reply(reply) if reply.session != self.session => {
                self.tally.stray_answers += 1;
                None
            }
            Incoming::Reply(reply) if self.watch.asked == Some(reply.number) => {
                (self.watch.asked, self.watch.unanswered) = (None, 0);
                match reply.answer {
                    Ok(Answer::Status(status)) => self.observe(&status),
                    Err(Refusal::NotOpen) => {
                        self.forgotten();
                    }
                    _ => {}
                }
                None
            }
            other => Some(other),
        }
    }

    pub(crate) fn take_block(&mut self, block: Box<Block>) {
        if let Some(early) = &mut self.telemetry.early {
            if early.len() < WAITING_EVENTS {
                early.push(*block);
            }
            return;
        }
        let Some(accounting) =
            (self.telemetry.accounting.as_mut()).filter(|_| self.telemetry.is_subscribed)
        else {
            self.tally.unasked_blocks += 1;
            return;
        };
        self.telemetry.heard_at = self.wire.now();
        self.telemetry.is_silent = false;
        if self.events.len() >= WAITING_EVENTS {
            self.tally.unread_blocks += 1;
            return;
        }
        let missing = match accounting.take(&block) {
            Taken::Old => return,
            Taken::Next(missing) => missing.samples,
            Taken::Restarted(missing) => {
                self.events.push_back(Event::DriveRestarted);
                missing.samples
            }
        };
        let state = Some(block.flags.state());
        if self.telemetry.state != state {
            self.telemetry.state = state;
            self.watch.due_at = Some(self.wire.now());
        }
        self.events
            .push_back(Event::Block(Arrival { block, missing }));
    }

    /// Updates the status.
    pub(crate) fn observe(&mut self, status: &Status) {
        let has_lease = status.lease == Some(self.session);
        let may_have_torque = matches!(status.state, State::Arming | State::Armed);
        if self.lease == Lease::Held && !(has_lease && may_have_torque) {
            self.lease = Lease::None;
        }
        let before = self.watch.known.replace(*status);
        if let Some(change) = before.and_then(|before| StateChange::between(&before, status)) {
            self.watch.due_at = Some(self.wire.now() + SETTLES_IN);
            self.events.push_back(Event::State(Box::new(change)));
        }
    }
}
