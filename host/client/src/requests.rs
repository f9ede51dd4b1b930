//! The requests.

use crate::accounting::Accounting;
use crate::client::{Client, Lease};
use crate::errors::{Conflict, Error};
use crate::event::Event;
use crate::handshake::Handshake;
use crate::refusals::Refused;
use crate::request_kind::RequestKind;
use crate::transport::Transport;
use crepitus_protocol::accounting::Begin;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::crash::{self, Controller, Head, Tick};
use crepitus_protocol::host::{Answer, Counters, Operation, Refusal, Status};
use crepitus_protocol::management::{self, Action, Role};
use crepitus_protocol::task_times::DeviceTimes;
use crepitus_protocol::{Revision, Values};
use std::time::Duration;

/// Time that comms needs after boot to identify the drive.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_millis(300);
const HANDSHAKE_RETRY: Duration = Duration::from_millis(50);

/// A post-mortem record.
#[derive(Clone, Debug, PartialEq)]
pub struct Crash {
    /// Head of the record: how the program ended.
    pub head: Head,
    /// Last ticks of the program, the oldest first; of the drive only.
    pub ticks: Vec<Tick>,
}

/// Tries of a set if another host commits at the same time.
const SET_TRIES: usize = 4;

/// Sends a request and matches the one valid answer.
macro_rules! answer {
    ($client:expr, $operation:expr, $pattern:pat => $value:expr) => {{
        let kind = RequestKind::of(&$operation);
        $client.request($operation).and_then(|answer| match answer {
            $pattern => Ok($value),
            _ => Err(Error::Unexpected { request: kind }),
        })
    }};
}

/// All requests may fail with [`Error::NoAnswer`], [`Error::Transport`],
/// [`Error::NotConnected`] and [`Error::Refused`]. After a timeout the request
/// may have been executed.
impl<T: Transport> Client<T> {
    /// Repeats the handshake.
    ///
    /// # Errors
    /// See above.
    pub fn identify(&mut self) -> Result<Handshake, Error> {
        self.connected()?;
        let sent = self.wire.delimit();
        self.sent(sent)?;
        let end = self.now() + HANDSHAKE_TIMEOUT;
        loop {
            let answer = self.request_management(Action::Hello)?;
            let management::Answer::Hello { own, drive, .. } = answer else {
                return Err(Error::Unexpected {
                    request: RequestKind::Hello,
                });
            };
            let drive = (drive.role != Role::Unknown).then_some(drive);
            if drive.is_some() || self.now() >= end {
                return Ok(Handshake { comms: own, drive });
            }
            self.idle(HANDSHAKE_RETRY)?;
        }
    }

    /// Turns torque off at once, whichever host has armed the device.
    ///
    /// # Errors
    /// See above. Torque ends anyway 250 ms after the holder of the lease is
    /// silent.
    pub fn stop(&mut self) -> Result<(), Error> {
        self.lease = Lease::None;
        self.done(Action::Stop)
    }

    /// Reboots the device; the connection may be lost.
    ///
    /// # Errors
    /// [`Error::NotDone`] while armed.
    pub fn reboot(&mut self) -> Result<(), Error> {
        self.done(Action::Reboot)
    }

    fn done(&mut self, action: Action) -> Result<(), Error> {
        match self.request_management(action)? {
            management::Answer::Stop { done: true, .. }
            | management::Answer::Reboot { done: true, .. } => Ok(()),
            _ => Err(Error::NotDone {
                request: RequestKind::of_management(action),
            }),
        }
    }

    /// Reads the status.
    ///
    /// # Errors
    /// See above.
    pub fn status(&mut self) -> Result<Status, Error> {
        let status = answer!(self, Operation::Status, Answer::Status(status) => status)?;
        self.observe(&status);
        Ok(status)
    }

    /// Reads the counters since boot.
    ///
    /// # Errors
    /// See above.
    pub fn counters(&mut self) -> Result<Counters, Error> {
        answer!(self, Operation::Counters, Answer::Counters(counters) => counters)
    }

    /// Reads the times of the hardware tasks.
    ///
    /// # Errors
    /// See above.
    pub fn times(&mut self) -> Result<DeviceTimes, Error> {
        answer!(self, Operation::Times, Answer::Times(times) => times)
    }

    /// Reads a controller's post-mortem record; `None` if it has none.
    ///
    /// # Errors
    /// See above; [`Refusal::Armed`] for the drive's while it is armed, and
    /// [`Error::Unexpected`] if the record is damaged.
    pub fn crash(&mut self, controller: Controller) -> Result<Option<Crash>, Error> {
        let mut words = Vec::with_capacity(crash::WORDS);
        for part in 0.. {
            let operation = Operation::ReadCrash { controller, part };
            let part = answer!(self, operation, Answer::CrashPart(part) => part)?;
            // A device that goes on for ever is no device of ours.
            match part.words {
                Some(part) if words.len() < crash::WORDS => words.extend(part),
                _ => break,
            }
        }
        if words.is_empty() {
            return Ok(None);
        }
        let head = Head::of(&words).ok_or(Error::Unexpected {
            request: RequestKind::ReadCrash,
        })?;
        let ticks = crash::ticks(&words).collect();
        Ok(Some(Crash { head, ticks }))
    }

    /// Reads the parameters committed last, and their revision.
    ///
    /// # Errors
    /// See above.
    pub fn parameters(&mut self) -> Result<(Revision, Values), Error> {
        answer!(self, Operation::Parameters, Answer::Parameters { revision, values } => (revision, values))
    }

    /// Commits all values, atomically; they are based on revision `base`.
    /// Returns the new revision.
    ///
    /// # Errors
    /// [`Refusal::Stale`] if `base` is stale, [`Refusal::Values`] if the values
    /// are invalid.
    pub fn commit(&mut self, base: Revision, values: &Values) -> Result<Revision, Error> {
        let values = *values;
        let operation = Operation::Commit { base, values };
        answer!(self, operation, Answer::Committed { revision } => revision)
    }

    /// Sets some parameters by id, atomically, and keeps the others. Returns the
    /// new revision.
    ///
    /// Retries up to three times if another host commits at the same time,
    /// unless that host has changed one of the same parameters: then nothing is
    /// set.
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
                        requested: value,
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

    /// Saves the parameters for the next boot.
    ///
    /// # Errors
    /// See above.
    pub fn save(&mut self) -> Result<(), Error> {
        answer!(self, Operation::Save, Answer::Done => ())
    }

    /// Sets the angle's zero here.
    ///
    /// # Errors
    /// See above.
    pub fn zero(&mut self) -> Result<(), Error> {
        answer!(self, Operation::Zero, Answer::Done => ())
    }

    /// Arms: the device tests its enable lines, then turns torque on. From now
    /// on call [`Self::pump`] every 50 ms or more often.
    ///
    /// # Errors
    /// [`Refusal`] gives the reason.
    pub fn arm(&mut self) -> Result<(), Error> {
        let before = self.lease;
        // Arming may take longer than the lease lasts.
        self.lease = Lease::Taking;
        self.renewed_at = self.now();
        match answer!(self, Operation::Arm, Answer::Done => ()) {
            Ok(()) => {
                self.lease = Lease::Held;
                self.watch.due_at = Some(self.now());
                Ok(())
            }
            Err(error) => {
                // Arming again keeps the device armed.
                if self.loss.is_none() {
                    self.lease = before;
                }
                if before != Lease::Held && matches!(error, Error::NoAnswer { .. }) {
                    self.withdraw();
                }
                Err(error)
            }
        }
    }

    /// Sends what ends arming, behind a request to arm that may yet be on its way; nobody waits for
    /// the answer.
    fn withdraw(&mut self) {
        let number = self.next_number();
        let request = self.numbered(number, Operation::Disarm);
        // Without a connection there is no way for either.
        let _ = self.wire.request(&request);
    }

    /// Turns torque off and releases the lease.
    ///
    /// # Errors
    /// [`Refusal::Leased`] while another host holds the lease: only [`Self::stop`]
    /// ends another's torque. In any case the lease is no longer renewed.
    pub fn disarm(&mut self) -> Result<(), Error> {
        self.lease = Lease::None;
        self.watch.due_at = Some(self.now());
        answer!(self, Operation::Disarm, Answer::Done => ())
    }

    /// Plays a chirp on the coil of the vibration actuator of the device that this host
    /// has armed. Its ticks have [`SampleFlags::CHIRP`](crepitus_protocol::telemetry::SampleFlags::CHIRP).
    ///
    /// # Errors
    /// [`Refusal`] gives the reason.
    pub fn play_chirp(&mut self, chirp: PlayedChirp) -> Result<(), Error> {
        answer!(self, Operation::PlayChirp(chirp), Answer::Done => ())
    }

    /// Clears the faults.
    ///
    /// # Errors
    /// [`Refusal::Faulted`] with a fault whose cause persists.
    pub fn clear_fault(&mut self) -> Result<(), Error> {
        answer!(self, Operation::ClearFault, Answer::Done => ())
    }

    /// Starts telemetry; returns where it begins. Restarts the accounting and
    /// drops pending blocks of an earlier subscription.
    ///
    /// # Errors
    /// See above.
    pub fn subscribe(&mut self) -> Result<Begin, Error> {
        self.events
            .retain(|event| !matches!(event, Event::Block(_) | Event::DriveRestarted));
        self.telemetry.is_subscribed = false;
        self.telemetry.state = None;
        self.begin_subscription(|accounting, begin| {
            *accounting = Some(Accounting::new(begin));
        })
    }

    /// Stops telemetry. Pending blocks and the accounting are kept.
    ///
    /// # Errors
    /// See above.
    pub fn unsubscribe(&mut self) -> Result<(), Error> {
        answer!(self, Operation::Unsubscribe, Answer::Done => ())?;
        self.telemetry.is_subscribed = false;
        Ok(())
    }
}

fn is_stale(refused: &Refused) -> bool {
    matches!(refused.refusal, Refusal::Stale { .. })
}
