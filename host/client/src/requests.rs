//! What can be asked of a device.

use crate::accounting::Accounting;
use crate::client::{Client, Lease};
use crate::errors::{Conflict, Error};
use crate::event::Event;
use crate::handshake::Handshake;
use crate::refusals::Refused;
use crate::request_kind::RequestKind;
use crate::transport::Transport;
use crepitus_protocol::host::{Answer, Ask, Counters, Refusal, Status};
use crepitus_protocol::management::{self, Role, What};
use crepitus_protocol::{Revision, Values};
use std::time::Duration;

/// A device that has just started hears of its drive within 200 ms.
const INTRODUCTION: Duration = Duration::from_millis(300);
const INTRODUCTION_PAUSE: Duration = Duration::from_millis(50);

/// A set begins anew this often if somebody else commits meanwhile.
const SET_TRIES: usize = 4;

/// Asks, and takes the one answer that there can be.
macro_rules! answer {
    ($client:expr, $ask:expr, $pattern:pat => $value:expr) => {{
        let what = RequestKind::of(&$ask);
        $client.ask($ask).and_then(|answer| match answer {
            $pattern => Ok($value),
            _ => Err(Error::Unexpected { what }),
        })
    }};
}

/// All of them may fail with [`Error::NoAnswer`], [`Error::Transport`],
/// [`Error::NotConnected`] and [`Error::Refused`]. What was not answered may
/// have been done all the same.
impl<T: Transport> Client<T> {
    /// Who is there, asked anew.
    ///
    /// # Errors
    /// See above.
    pub fn identify(&mut self) -> Result<Handshake, Error> {
        self.connected()?;
        let sent = self.wire.delimit();
        self.sent(sent)?;
        let end = self.now() + INTRODUCTION;
        loop {
            let answer = self.ask_management(What::Hello)?;
            let management::Answer::Hello { own, drive, .. } = answer else {
                return Err(Error::Unexpected {
                    what: RequestKind::Hello,
                });
            };
            let drive = (drive.role != Role::Unknown).then_some(drive);
            if drive.is_some() || self.now() >= end {
                return Ok(Handshake { comms: own, drive });
            }
            self.idle(INTRODUCTION_PAUSE)?;
        }
    }

    /// No more torque, at once and whoever has armed the device.
    ///
    /// # Errors
    /// See above. The lease ends all torque within 250 ms of its holder's
    /// silence.
    pub fn stop(&mut self) -> Result<(), Error> {
        self.lease = Lease::None;
        self.done(What::Stop)
    }

    /// Starts the device anew; the line may be lost.
    ///
    /// # Errors
    /// [`Error::NotDone`] while there is torque.
    pub fn reboot(&mut self) -> Result<(), Error> {
        self.done(What::Reboot)
    }

    fn done(&mut self, what: What) -> Result<(), Error> {
        match self.ask_management(what)? {
            management::Answer::Stop { done: true, .. }
            | management::Answer::Reboot { done: true, .. } => Ok(()),
            _ => Err(Error::NotDone {
                what: RequestKind::of_question(what),
            }),
        }
    }

    /// How it is.
    ///
    /// # Errors
    /// See above.
    pub fn status(&mut self) -> Result<Status, Error> {
        let status = answer!(self, Ask::Status, Answer::Status(status) => status)?;
        self.observe(&status);
        Ok(status)
    }

    /// What the device has counted since its start.
    ///
    /// # Errors
    /// See above.
    pub fn counters(&mut self) -> Result<Counters, Error> {
        answer!(self, Ask::Counters, Answer::Counters(counters) => counters)
    }

    /// The parameters that were committed last, and their revision.
    ///
    /// # Errors
    /// See above.
    pub fn parameters(&mut self) -> Result<(Revision, Values), Error> {
        answer!(self, Ask::Parameters, Answer::Parameters { revision, values } => (revision, values))
    }

    /// Puts all of these values in force, or none; they were made from those
    /// of revision `base`. Gives the new revision.
    ///
    /// # Errors
    /// [`Refusal::Stale`] if others are in force by now, [`Refusal::Values`] if
    /// they are not allowed.
    pub fn commit(&mut self, base: Revision, values: &Values) -> Result<Revision, Error> {
        let values = *values;
        let ask = Ask::Commit { base, values };
        answer!(self, ask, Answer::Committed { revision } => revision)
    }

    /// Sets some parameters, by their ids, all or none, and leaves the others
    /// as they are. Gives the new revision.
    ///
    /// If another host commits meanwhile, the values are read again and the
    /// change is made anew, up to three times; unless the other host has
    /// changed one of these very parameters: then nothing is set.
    ///
    /// # Errors
    /// [`Error::Conflict`] in that case; [`Error::UnknownParameter`];
    /// otherwise as [`Self::commit`].
    pub fn set(&mut self, changes: &[(u8, f64)]) -> Result<Revision, Error> {
        let (mut base, first) = self.parameters()?;
        let mut read = first;
        let mut tries = 1;
        loop {
            let mut values = read;
            for &(id, value) in changes {
                let before = first.get(id).ok_or(Error::UnknownParameter { id })?;
                let now = read.get(id).ok_or(Error::UnknownParameter { id })?;
                if now.to_bits() != before.to_bits() && now.to_bits() != value.to_bits() {
                    return Err(Error::Conflict(Box::new(Conflict {
                        id,
                        before,
                        now,
                        wanted: value,
                        revision: base,
                    })));
                }
                values.set(id, value);
            }
            match self.commit(base, &values) {
                Err(Error::Refused(refused)) if is_stale(&refused) && tries < SET_TRIES => {
                    (base, read) = self.parameters()?;
                    tries += 1;
                }
                result => return result,
            }
        }
    }

    /// Keeps the parameters in force for the next start.
    ///
    /// # Errors
    /// See above.
    pub fn save(&mut self) -> Result<(), Error> {
        answer!(self, Ask::Save, Answer::Done => ())
    }

    /// The angle is zero here.
    ///
    /// # Errors
    /// See above.
    pub fn zero(&mut self) -> Result<(), Error> {
        answer!(self, Ask::Zero, Answer::Done => ())
    }

    /// Arms: the device proves that it can let go, then renders. From now on
    /// [`Self::pump`] has to be called every 50 ms or more often.
    ///
    /// # Errors
    /// [`Refusal`] says what stands in the way.
    pub fn arm(&mut self) -> Result<(), Error> {
        let before = self.lease;
        // Arming may take longer than a lease lives.
        self.lease = Lease::Taking;
        self.renewed_at = self.now();
        match answer!(self, Ask::Arm, Answer::Done => ()) {
            Ok(()) => {
                self.lease = Lease::Held;
                self.watch.due_at = Some(self.now());
                Ok(())
            }
            Err(error) => {
                // Who is armed already, and asks again, stays so.
                if self.loss.is_none() {
                    self.lease = before;
                }
                Err(error)
            }
        }
    }

    /// No more torque; gives the lease back. Works for whoever asks.
    ///
    /// # Errors
    /// See above; the lease is not renewed any more in any case.
    pub fn disarm(&mut self) -> Result<(), Error> {
        self.lease = Lease::None;
        self.watch.due_at = Some(self.now());
        answer!(self, Ask::Disarm, Answer::Done => ())
    }

    /// Forgets the faults whose causes are gone.
    ///
    /// # Errors
    /// [`Refusal::Faulted`] with the one whose cause is still there.
    pub fn clear_fault(&mut self) -> Result<(), Error> {
        answer!(self, Ask::ClearFault, Answer::Done => ())
    }

    /// Asks for every sample from now on; gives the first tick. New books
    /// begin, and what of an earlier subscription has not been taken yet is
    /// thrown away.
    ///
    /// # Errors
    /// See above.
    pub fn subscribe(&mut self) -> Result<u64, Error> {
        self.events
            .retain(|event| !matches!(event, Event::Block(_) | Event::DriveRestarted));
        self.telemetry.is_subscribed = false;
        self.telemetry.state = None;
        self.begin_subscription(|books, first_tick| *books = Some(Accounting::new(first_tick)))
    }

    /// Asks for no more samples. What has come before can still be taken, and
    /// the books stay.
    ///
    /// # Errors
    /// See above.
    pub fn unsubscribe(&mut self) -> Result<(), Error> {
        answer!(self, Ask::Unsubscribe, Answer::Done => ())?;
        self.telemetry.is_subscribed = false;
        Ok(())
    }
}

fn is_stale(refused: &Refused) -> bool {
    matches!(refused.refusal, Refusal::Stale { .. })
}
