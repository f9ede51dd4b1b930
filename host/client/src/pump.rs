//! What comes unasked: blocks, changes of the state, the end of the line.

use crate::accounting::Taken;
use crate::client::{Client, Lease};
use crate::errors::Error;
use crate::event::{Arrival, Event, StateChange};
use crate::transport::Transport;
use crate::wire::Heard;
use crepitus_protocol::State;
use crepitus_protocol::host::{Answer, Ask, Reply, Request, Status};
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// Events that may wait to be taken: ten seconds of blocks.
pub(crate) const WAITING_EVENTS: usize = 10_000;

/// Messages that are taken in at once before an event is handed out.
const AT_ONCE: usize = 64;

/// While armed or subscribed, the state is asked for this often. It is asked
/// again, too, if there was no answer for so long.
const WATCH_EVERY: Duration = Duration::from_millis(100);

/// After a change of the state it is asked again: each controller learns of
/// the other's reasons a few milliseconds late.
const SETTLES_IN: Duration = Duration::from_millis(20);

/// So long without a block is a silence.
const SILENCE: Duration = Duration::from_millis(500);

impl<T: Transport> Client<T> {
    /// Renews the lease of a device that this client has armed, receives, and
    /// gives the next of what has happened, waited for at most this long. With
    /// no patience it gives what has happened already.
    ///
    /// It is to be called again and again, every 50 ms or more often while the
    /// device is armed: the lease ends after 250 ms.
    ///
    /// # Errors
    /// [`Error::NotConnected`], after [`Event::Lost`] was given.
    pub fn pump(&mut self, patience: Duration) -> Result<Option<Event>, Error> {
        let until = self.now() + patience;
        loop {
            let taken = self.take_what_is_there();
            if let Some(event) = self.events.pop_front() {
                return Ok(Some(event));
            }
            // A line that has failed in this call was an event.
            taken?;
            if self.now() >= until {
                return Ok(None);
            }
            if let Ok(Some(_)) = self.turn(self.next_look(until)) {
                self.counts.strays += 1;
            }
        }
    }

    /// Without waiting.
    fn take_what_is_there(&mut self) -> Result<(), Error> {
        self.connected()?;
        self.renew()?;
        self.look()?;
        for _ in 0..AT_ONCE {
            match self.wire.next(Duration::ZERO) {
                Ok(None) => break,
                Ok(Some(heard)) => {
                    if self.take_in(heard).is_some() {
                        self.counts.strays += 1;
                    }
                }
                Err(error) => return Err(self.failed(error)),
            }
        }
        self.listen_for_silence();
        Ok(())
    }

    /// When there is something to do, if nothing comes.
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

    /// Asks for the state, if that is due.
    fn look(&mut self) -> Result<(), Error> {
        let now = self.now();
        let is_old = now.saturating_sub(self.watch.asked_at) >= WATCH_EVERY;
        let is_wanted = if self.watch.asked.is_some() {
            // It was lost on its way, or its answer was.
            is_old
        } else {
            let is_due = self.watch.due_at.is_some_and(|due_at| due_at <= now);
            is_due || (is_old && self.is_watching())
        };
        if !is_wanted {
            return Ok(());
        }
        let number = self.next_number();
        (self.watch.asked, self.watch.asked_at) = (Some(number), now);
        self.watch.due_at = None;
        let sent = self.wire.request(&Request {
            session: self.session,
            number,
            ask: Ask::Status,
        });
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

    /// Takes what comes unasked, and gives the rest.
    pub(crate) fn take_in(&mut self, heard: Heard) -> Option<Heard> {
        match heard {
            Heard::Block(block) => {
                self.take_block(block);
                None
            }
            Heard::Reply(reply) if reply.session != self.session => {
                self.counts.strays += 1;
                None
            }
            Heard::Reply(reply) if self.watch.asked == Some(reply.number) => {
                self.watch.asked = None;
                if let Reply {
                    answer: Ok(Answer::Status(status)),
                    ..
                } = *reply
                {
                    self.observe(&status);
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
        let Some(books) = (self.telemetry.books.as_mut()).filter(|_| self.telemetry.is_subscribed)
        else {
            self.counts.unasked_blocks += 1;
            return;
        };
        self.telemetry.heard_at = self.wire.now();
        self.telemetry.is_silent = false;
        if self.events.len() >= WAITING_EVENTS {
            self.counts.unread_blocks += 1;
            return;
        }
        let missing = match books.take(&block) {
            Taken::Old => return,
            Taken::Next { missing } => missing,
            Taken::Restarted { missing } => {
                self.events.push_back(Event::DriveRestarted);
                missing
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

    /// Learns how it is.
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
