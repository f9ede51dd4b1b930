//! Whether comms lets there be torque: its own line, in series with the
//! drive's.

use crate::comms::drive_view::DriveView;
use crate::comms::line::Line;
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, State};

/// Watches the drive and holds the line.
#[derive(Clone, Copy, Debug)]
pub struct Supervision {
    line: Line,
    /// A host wants torque.
    wanted: bool,
    /// The drive has been armed since.
    was_armed: bool,
    fault: Option<Fault>,
    /// The drive speaks another language.
    foreign: bool,
}

impl Supervision {
    /// As comms starts: a reset that should not have been is a fault.
    pub fn new(reset: ResetCause) -> Self {
        Self {
            line: Line::default(),
            wanted: false,
            was_armed: false,
            fault: match reset {
                ResetCause::Power | ResetCause::Asked => None,
                ResetCause::Watchdog => Some(Fault::CommsWatchdog),
                ResetCause::BrownOut => Some(Fault::CommsBrownOut),
                ResetCause::Panic => Some(Fault::CommsPanic),
            },
            foreign: false,
        }
    }

    /// Whether a host wants torque, and nothing here speaks against it.
    pub fn is_wanted(&self) -> bool {
        self.wanted
    }

    /// The fault of comms.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Whether the line was proven and is on.
    pub fn line_is_proven(&self) -> bool {
        self.line.is_proven()
    }

    /// A host wants torque: the line is proven first.
    pub fn want(&mut self) {
        self.wanted = true;
        self.was_armed = false;
        self.line.prove();
    }

    /// The drive has said that it was armed; it may have let go since.
    pub fn armed(&mut self) {
        self.was_armed = true;
    }

    /// No more torque.
    pub fn let_go(&mut self) {
        self.wanted = false;
        self.line.off();
    }

    /// The drive has started anew.
    pub fn drive_restarted(&mut self) {
        if self.wanted {
            self.fail(Fault::DriveRestarted);
        }
    }

    /// The drive has said which language it speaks.
    pub fn drive_speaks(&mut self, ours: bool) {
        self.foreign = !ours;
        if self.foreign {
            self.fail(Fault::VersionMismatch);
        }
    }

    /// Forgets the fault of comms; gives it back if its cause is still there.
    pub fn clear(&mut self, line_is_on: bool) -> Option<Fault> {
        let persists = match self.fault {
            Some(Fault::VersionMismatch) => self.foreign,
            Some(Fault::CommsEnableStuckOn) => line_is_on,
            _ => false,
        };
        if !persists {
            self.fault = None;
        }
        self.fault
    }

    /// Once a millisecond: whether the line is to be on.
    pub fn tick(
        &mut self,
        line_is_on: bool,
        drive_is_silent: bool,
        is_leased: bool,
        drive: &DriveView,
    ) -> bool {
        if let Some(fault) = self.line.tick(line_is_on)
            && self.fault != Some(fault)
        {
            self.fail(fault);
        }
        if self.wanted {
            if drive_is_silent {
                self.fail(Fault::DriveSilent);
            }
            match drive.state() {
                State::Armed => self.was_armed = true,
                // It has let go by itself, and says why.
                State::Faulted | State::Disarmed if self.was_armed => self.let_go(),
                _ => {}
            }
            if !is_leased {
                // The heartbeats go on: they tell the drive that the lease has
                // ended, and it says so.
                self.line.off();
            }
        }
        self.line.level()
    }

    /// The state of the whole.
    pub fn state(&self, drive: &DriveView) -> State {
        if self.fault.is_some() || drive.state() == State::Faulted {
            return State::Faulted;
        }
        match (self.wanted, drive.state()) {
            (true, State::Armed) | (false, State::Armed | State::Arming) => drive.state(),
            (true, _) => State::Arming,
            (false, _) => State::Disarmed,
        }
    }

    fn fail(&mut self, fault: Fault) {
        self.let_go();
        self.fault.get_or_insert(fault);
    }
}
