//! Supervision of the drive; controls the enable line of comms, in series with
//! the drive's.

use crate::comms::drive_view::DriveView;
use crate::comms::enable_line::EnableLine;
use crate::self_test::SelfTest;
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, State, schema};

/// Supervises the drive and controls the enable line.
#[derive(Clone, Copy, Debug)]
pub struct Supervision {
    line: EnableLine,
    /// A host has requested torque.
    enable_requested: bool,
    /// The drive was armed after the request.
    was_armed: bool,
    fault: Option<Fault>,
    /// The drive's schema hash differs.
    schema_mismatch: bool,
}

impl Supervision {
    /// The state after boot: an unexpected reset is a fault, and so is a self-test that
    /// has failed.
    pub fn new(reset: ResetCause, self_test: SelfTest) -> Self {
        Self {
            line: EnableLine::default(),
            enable_requested: false,
            was_armed: false,
            fault: match (self_test, reset) {
                (SelfTest::ImageBroken, _) => Some(Fault::CommsImageBroken),
                (SelfTest::CrystalWrong, _) => Some(Fault::CommsCrystal),
                (SelfTest::OptionBytesWrong, _) => Some(Fault::CommsOptionBytes),
                (_, ResetCause::Power | ResetCause::Requested) => None,
                (_, ResetCause::Watchdog) => Some(Fault::CommsWatchdog),
                (_, ResetCause::BrownOut) => Some(Fault::CommsBrownOut),
                (_, ResetCause::Panic) => Some(Fault::CommsPanic),
            },
            schema_mismatch: false,
        }
    }

    /// Returns whether a host has requested torque and no fault has ended the request.
    pub fn is_enable_requested(&self) -> bool {
        self.enable_requested
    }

    /// The latched fault of comms.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// The level of the enable line: true for on.
    pub fn line_level(&self) -> bool {
        self.line.level()
    }

    /// Returns whether the enable line has passed its test.
    pub fn line_is_tested(&self) -> bool {
        self.line.is_tested()
    }

    /// Requests torque: starts the test of the enable line.
    pub fn request_enable(&mut self) {
        self.enable_requested = true;
        self.was_armed = false;
        self.line.prove();
    }

    /// Records that the drive has confirmed arming; it may have disarmed since.
    pub fn confirm_armed(&mut self) {
        self.was_armed = true;
    }

    /// Ends the request for torque and switches the enable line off.
    pub fn release(&mut self) {
        self.enable_requested = false;
        self.line.off();
    }

    /// Handles a restart of the drive: a fault while torque is requested.
    pub fn drive_restarted(&mut self) {
        if self.enable_requested {
            self.fail(Fault::DriveRestarted);
        }
    }

    /// Raises a fault that comms has seen in the drive's samples; returns whether
    /// there was none before.
    pub fn observed(&mut self, fault: Fault) -> bool {
        let is_first = self.fault.is_none();
        self.fail(fault);
        is_first
    }

    /// Compares the drive's schema hash with that of comms.
    pub fn check_schema(&mut self, hash: u64) {
        self.schema_mismatch = hash != schema::HASH;
        if self.schema_mismatch {
            self.fail(Fault::VersionMismatch);
        }
    }

    /// Clears the fault of comms; returns it if its cause persists.
    pub fn clear(&mut self, line_is_on: bool) -> Option<Fault> {
        let persists = match self.fault {
            Some(Fault::CommsImageBroken | Fault::CommsCrystal | Fault::CommsOptionBytes) => true,
            Some(Fault::CommsEnableStuckOn) => line_is_on,
            _ => false,
        };
        if !persists {
            // A version mismatch may stand behind the fault that was first.
            self.fault = self.schema_mismatch.then_some(Fault::VersionMismatch);
        }
        self.fault
    }

    /// Runs once a millisecond; returns the level of the enable line.
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
        if self.enable_requested {
            if drive_is_silent {
                self.fail(Fault::DriveSilent);
            }
            match drive.state() {
                State::Armed => self.was_armed = true,
                // The drive has proven before that nothing moves current.
                State::Arming if drive.awaits_comms() => self.line.raise(),
                // The drive has disarmed by itself; its status has the cause.
                State::Faulted | State::Disarmed if self.was_armed => self.release(),
                _ => {}
            }
            if !is_leased {
                // Heartbeats continue: they tell the drive that the lease has
                // expired, and it reports the fault.
                self.line.off();
            }
        }
        self.line.level()
    }

    /// State of the device.
    pub fn state(&self, drive: &DriveView) -> State {
        if self.fault.is_some() || drive.state() == State::Faulted {
            return State::Faulted;
        }
        match (self.enable_requested, drive.state()) {
            (true, State::Armed) | (false, State::Armed | State::Arming) => drive.state(),
            (true, _) => State::Arming,
            (false, _) => State::Disarmed,
        }
    }

    fn fail(&mut self, fault: Fault) {
        self.release();
        self.fault.get_or_insert(fault);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supervision() -> Supervision {
        Supervision::new(ResetCause::Power, SelfTest::Passed)
    }

    #[test]
    fn a_fault_ends_the_request_and_stays_the_first_one() {
        let mut supervision = supervision();
        supervision.request_enable();
        assert!(supervision.is_enable_requested());
        assert!(supervision.observed(Fault::CommsOvercurrent));
        assert!(!supervision.is_enable_requested());
        assert!(!supervision.observed(Fault::CommsOverspeed));
        assert_eq!(supervision.fault(), Some(Fault::CommsOvercurrent));
        assert_eq!(supervision.state(&DriveView::default()), State::Faulted);
        assert_eq!(supervision.clear(false), None);
        assert_eq!(supervision.state(&DriveView::default()), State::Disarmed);
    }

    #[test]
    fn a_drive_that_restarts_is_a_fault_only_while_torque_is_requested() {
        let mut supervision = supervision();
        supervision.drive_restarted();
        assert_eq!(supervision.fault(), None);
        supervision.request_enable();
        supervision.drive_restarted();
        assert_eq!(supervision.fault(), Some(Fault::DriveRestarted));
    }

    #[test]
    fn a_fault_is_cleared_when_its_cause_is_gone() {
        for self_test in [
            SelfTest::ImageBroken,
            SelfTest::CrystalWrong,
            SelfTest::OptionBytesWrong,
        ] {
            let mut supervision = Supervision::new(ResetCause::Power, self_test);
            let fault = supervision.fault();
            assert!(fault.is_some());
            assert_eq!(supervision.clear(false), fault);
        }
        let mut other_schema = supervision();
        other_schema.check_schema(!schema::HASH);
        assert_eq!(other_schema.clear(false), Some(Fault::VersionMismatch));
        other_schema.check_schema(schema::HASH);
        assert_eq!(other_schema.clear(false), None);
        let mut second = Supervision::new(ResetCause::BrownOut, SelfTest::Passed);
        second.check_schema(!schema::HASH);
        assert_eq!(second.fault(), Some(Fault::CommsBrownOut));
        assert_eq!(second.clear(false), Some(Fault::VersionMismatch));
        let mut stuck = supervision();
        stuck.observed(Fault::CommsEnableStuckOn);
        assert_eq!(stuck.clear(true), Some(Fault::CommsEnableStuckOn));
        assert_eq!(stuck.clear(false), None);
    }

    #[test]
    fn a_drive_that_is_silent_is_a_fault_only_while_torque_is_requested() {
        let mut supervision = supervision();
        let view = DriveView::default();
        assert!(!supervision.tick(false, true, true, &view));
        assert_eq!(supervision.fault(), None);
        supervision.request_enable();
        assert!(!supervision.tick(false, true, true, &view));
        assert_eq!(supervision.fault(), Some(Fault::DriveSilent));
    }
}
