//! The safety state machine: permits or denies torque.
//!
//! ```text
//!                 Arm                    proven
//!   Disarmed ──────────────> Arming ──────────────> Armed
//!      ↑  ↑                    │  │                  │  │
//!      │  └────────────────────┘  └───────┐   ┌──────┘  │
//!      │      disarm                      ↓   ↓         │ disarm
//!      │                     ClearFault  Faulted        │
//!      └──────────────────────────────────┘─────────────┘
//! ```
//!
//! The state machine runs at the highest priority, in every tick, so no task that hangs or is
//! late can keep the torque on.

use crate::counters::Counters;
use crate::drive::arming::{Arming, ArmingInputs, ArmingOutput};
use crate::drive::heartbeat_monitor::{Freshness, HeartbeatMonitor};
use crate::self_test::SelfTest;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::link::{DriveRefusal, Heartbeat};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, State};

/// Ticks within which the enable line falls after it is switched off.
const LINE_TICKS: u32 = 9;

/// Permitted output of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Permit {
    /// No output: the line off, the bridge floating.
    Nothing,
    /// The line on, the bridge floating.
    Line,
    /// A voltage that must not move current, V, beside the back-EMF; the line on or
    /// off.
    Proof(f32, bool),
    /// The line on, this current, A.
    Push(f32),
    /// The line on, the torque that was rendered.
    Torque,
}

/// The safety state of the drive.
#[derive(Clone, Copy, Debug)]
pub struct Safety {
    state: State,
    fault: Option<Fault>,
    /// Fault of the self-test, latched until the next start.
    defect: Option<Fault>,
    heartbeat_monitor: HeartbeatMonitor,
    arming: Arming,
    /// Result of the last order to arm.
    outcome: Option<Result<(), DriveRefusal>>,
    polarity_proven: bool,
    /// Consecutive ticks in which the line read back on while switched off.
    stuck_on_ticks: u32,
}

impl Safety {
    /// The state after boot: an unexpected reset is a fault, and so is a self-test that
    /// has failed.
    pub fn new(reset: ResetCause, self_test: SelfTest) -> Self {
        let defect = match self_test {
            SelfTest::ImageBroken => Some(Fault::DriveImageBroken),
            SelfTest::CrystalWrong => Some(Fault::DriveCrystal),
            SelfTest::OptionBytesWrong => Some(Fault::DriveOptionBytes),
            SelfTest::Passed => None,
        };
        let fault = defect.or(match reset {
            ResetCause::Power | ResetCause::Requested => None,
            ResetCause::Watchdog => Some(Fault::DriveWatchdog),
            ResetCause::BrownOut => Some(Fault::DriveBrownOut),
            ResetCause::Panic => Some(Fault::DrivePanic),
        });
        Self {
            state: if fault.is_some() {
                State::Faulted
            } else {
                State::Disarmed
            },
            fault,
            defect,
            heartbeat_monitor: HeartbeatMonitor::default(),
            arming: Arming::default(),
            outcome: None,
            polarity_proven: false,
            stuck_on_ticks: 0,
        }
    }

    /// The state.
    pub fn state(&self) -> State {
        self.state
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Returns whether the line may be on.
    pub fn is_live(&self) -> bool {
        matches!(self.state, State::Arming | State::Armed)
    }

    /// Returns whether arming has shown that encoder and motor turn the same way.
    pub fn polarity_proven(&self) -> bool {
        self.polarity_proven
    }

    /// Returns whether arming waits for the enable line of comms, or has it.
    pub fn awaits_comms(&self) -> bool {
        self.state == State::Arming && self.arming.awaits_comms()
    }

    /// Offsets of the current sensor and of the monitor, A, once arming has
    /// measured them.
    pub fn offsets_a(&self) -> Option<(f32, f32)> {
        self.arming.offsets_a()
    }

    /// Takes the result of the last order to arm.
    pub fn take_outcome(&mut self) -> Option<Result<(), DriveRefusal>> {
        self.outcome.take()
    }

    /// Handles a heartbeat that was decoded in the tick `now`.
    pub fn receive_heartbeat(
        &mut self,
        now: u64,
        heartbeat: &Heartbeat,
        counters: &Counters,
    ) -> Freshness {
        let freshness = self.heartbeat_monitor.receive(now, heartbeat);
        if freshness == Freshness::Stale {
            counters.count(DriveCounter::StaleHeartbeats);
            return freshness;
        }
        counters.count(DriveCounter::Heartbeats);
        if freshness == Freshness::Started && self.is_live() {
            self.fail(Fault::CommsRestarted, counters);
        }
        if !heartbeat.enable {
            self.disarm();
        }
        freshness
    }

    /// Boot counter of comms, from its last heartbeat.
    pub fn comms_start(&self) -> Option<u16> {
        self.heartbeat_monitor.comms_start()
    }

    /// Starts arming; [`Self::take_outcome`] returns its result.
    ///
    /// # Errors
    /// [`DriveRefusal`] if arming cannot start, or that of the leg's `place`.
    pub fn arm(
        &mut self,
        now: u64,
        lost_ticks: u32,
        place: Result<(), DriveRefusal>,
    ) -> Result<(), DriveRefusal> {
        match (self.state, self.fault) {
            (State::Faulted, Some(fault)) => {
                return Err(DriveRefusal::Faulted { code: fault.code() });
            }
            (State::Arming | State::Armed, _) => return Err(DriveRefusal::Armed),
            _ => {}
        }
        if self.heartbeat_monitor.timeout(now).is_some() {
            return Err(DriveRefusal::NoLease);
        }
        if lost_ticks > 0 {
            return Err(DriveRefusal::NoEncoder);
        }
        place?;
        self.arming = Arming::default();
        self.outcome = None;
        self.state = State::Arming;
        Ok(())
    }

    /// Disarms; not a fault.
    pub fn disarm(&mut self) {
        if self.is_live() {
            if self.state == State::Arming {
                self.outcome = Some(Err(DriveRefusal::Aborted));
            }
            self.state = State::Disarmed;
        }
    }

    /// Clears the fault.
    ///
    /// # Errors
    /// [`DriveRefusal::Faulted`] if its cause persists.
    pub fn clear(&mut self, line_is_on: bool) -> Result<(), DriveRefusal> {
        if self.is_live() {
            return Err(DriveRefusal::Armed);
        }
        match self.fault {
            Some(fault @ Fault::EnableStuckOn) if line_is_on => {
                Err(DriveRefusal::Faulted { code: fault.code() })
            }
            _ => {
                self.fault = self.defect;
                if let Some(defect) = self.defect {
                    return Err(DriveRefusal::Faulted {
                        code: defect.code(),
                    });
                }
                self.state = State::Disarmed;
                Ok(())
            }
        }
    }

    /// Latches a fault: no torque until it is cleared. The first fault is kept.
    pub fn fail(&mut self, fault: Fault, counters: &Counters) {
        if self.state == State::Arming {
            self.outcome = Some(Err(DriveRefusal::Faulted { code: fault.code() }));
        }
        if self.fault.is_none() {
            self.fault = Some(fault);
            counters.count(DriveCounter::Faults);
        }
        self.state = State::Faulted;
    }

    /// Runs first in every tick; returns the permitted output.
    pub fn tick(&mut self, now: u64, seen: &ArmingInputs, counters: &Counters) -> Permit {
        if self.is_live()
            && let Some(fault) = self.heartbeat_monitor.timeout(now)
        {
            self.fail(fault, counters);
        }
        let permit = match self.state {
            State::Armed => Permit::Torque,
            State::Arming => match self.arming.tick(seen) {
                ArmingOutput::Off => Permit::Nothing,
                ArmingOutput::Line => Permit::Line,
                ArmingOutput::Proof(volts, line) => Permit::Proof(volts, line),
                ArmingOutput::Push(amperes) => Permit::Push(amperes),
                ArmingOutput::Armed => {
                    self.state = State::Armed;
                    self.outcome = Some(Ok(()));
                    self.polarity_proven = self.arming.is_proven();
                    counters.count(DriveCounter::Armings);
                    Permit::Torque
                }
                ArmingOutput::Failed(fault) => {
                    self.fail(fault, counters);
                    Permit::Nothing
                }
            },
            State::Disarmed | State::Faulted => Permit::Nothing,
        };
        self.check_line(permit, seen.line_is_on, counters);
        permit
    }

    /// Checks that the line falls after it is switched off.
    fn check_line(&mut self, permit: Permit, line_is_on: bool, counters: &Counters) {
        let is_stuck_on = permit == Permit::Nothing && self.state != State::Arming && line_is_on;
        self.stuck_on_ticks = if is_stuck_on {
            self.stuck_on_ticks.saturating_add(1)
        } else {
            0
        };
        if self.stuck_on_ticks > LINE_TICKS && self.fault != Some(Fault::EnableStuckOn) {
            // More serious than any other fault: replaces them.
            self.fault = None;
            self.fail(Fault::EnableStuckOn, counters);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fault of the self-test stays latched behind a more urgent fault.
    #[test]
    fn a_defect_stays_until_the_next_start() {
        for self_test in [
            SelfTest::ImageBroken,
            SelfTest::CrystalWrong,
            SelfTest::OptionBytesWrong,
        ] {
            let counters = Counters::default();
            let mut safety = Safety::new(ResetCause::Power, self_test);
            let defect = safety.fault();
            let seen = ArmingInputs {
                raw_a: None,
                line_is_on: true,
                comms_line_is_on: false,
                count: 0,
            };
            for now in 0..20 {
                assert_eq!(safety.tick(now, &seen, &counters), Permit::Nothing);
            }
            assert_eq!(safety.fault(), Some(Fault::EnableStuckOn));
            assert!(safety.clear(true).is_err());
            let code = defect.expect("a fault").code();
            for _ in 0..2 {
                assert_eq!(safety.clear(false), Err(DriveRefusal::Faulted { code }));
                assert_eq!((safety.state(), safety.fault()), (State::Faulted, defect));
            }
        }
    }
}
