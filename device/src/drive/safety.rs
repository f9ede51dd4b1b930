//! Whether there may be torque.
//!
//! ```text
//!                 Arm                    proven
//!   Disarmed ──────────────> Arming ──────────────> Armed
//!      ↑  ↑                    │  │                  │  │
//!      │  └────────────────────┘  └───────┐   ┌──────┘  │
//!      │      no longer wanted            ↓   ↓         │ no longer wanted
//!      │                     ClearFault  Faulted        │
//!      └──────────────────────────────────┘─────────────┘
//! ```
//!
//! It lives in the highest priority, which runs in every tick whatever else is
//! late, so nothing that hangs below can keep the torque on.

use crate::counters::Counters;
use crate::drive::arming::{Arming, Wish};
use crate::drive::vigil::{Heard, Vigil};
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::link::{DriveRefusal, Heartbeat};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, State};

/// Ticks within which the enable line falls once it is let go of.
const LINE_TICKS: u32 = 9;

/// What a tick may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Permit {
    /// Nothing: the line off, the bridge floating.
    Nothing,
    /// The line on, the bridge floating.
    Line,
    /// The line on, this current, A.
    Push(f32),
    /// The line on, the torque that was rendered.
    Torque,
}

/// The state of a drive.
#[derive(Clone, Copy, Debug)]
pub struct Safety {
    state: State,
    fault: Option<Fault>,
    vigil: Vigil,
    arming: Arming,
    /// What became of the last order to arm.
    outcome: Option<Result<(), DriveRefusal>>,
    polarity_proven: bool,
    /// Ticks in a row in which the line was on, and let go of.
    astray_ticks: u32,
}

impl Safety {
    /// As a controller starts: a reset that should not have been is a fault.
    pub fn new(reset: ResetCause) -> Self {
        let fault = match reset {
            ResetCause::Power | ResetCause::Asked => None,
            ResetCause::Watchdog => Some(Fault::DriveWatchdog),
            ResetCause::BrownOut => Some(Fault::DriveBrownOut),
            ResetCause::Panic => Some(Fault::DrivePanic),
        };
        Self {
            state: if fault.is_some() {
                State::Faulted
            } else {
                State::Disarmed
            },
            fault,
            vigil: Vigil::default(),
            arming: Arming::default(),
            outcome: None,
            polarity_proven: false,
            astray_ticks: 0,
        }
    }

    /// The state.
    pub fn state(&self) -> State {
        self.state
    }

    /// The fault that it is in.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Whether the line is, or may be, on.
    pub fn is_live(&self) -> bool {
        matches!(self.state, State::Arming | State::Armed)
    }

    /// Whether encoder and motor have been seen to turn the same way.
    pub fn polarity_proven(&self) -> bool {
        self.polarity_proven
    }

    /// The current sensor's offset, once arming has measured it, A.
    pub fn offset_a(&self) -> Option<f32> {
        self.arming.offset_a()
    }

    /// What became of the last order to arm; once.
    pub fn take_outcome(&mut self) -> Option<Result<(), DriveRefusal>> {
        self.outcome.take()
    }

    /// A heartbeat was decoded in the tick `now`.
    pub fn hear(&mut self, now: u64, heartbeat: &Heartbeat, counters: &Counters) -> Heard {
        let heard = self.vigil.hear(now, heartbeat);
        if heard == Heard::Stale {
            counters.count(DriveCounter::StaleHeartbeats);
            return heard;
        }
        counters.count(DriveCounter::Heartbeats);
        if heard == Heard::Restarted && self.is_live() {
            self.fail(Fault::CommsRestarted, counters);
        }
        if !heartbeat.enable {
            self.disarm();
        }
        heard
    }

    /// Which start of comms was heard last.
    pub fn heard_start(&self) -> Option<u16> {
        self.vigil.start()
    }

    /// Begins to arm; [`Self::take_outcome`] says how it ended.
    ///
    /// # Errors
    /// [`DriveRefusal`] if it cannot even begin.
    pub fn arm(&mut self, now: u64, lost_ticks: u32) -> Result<(), DriveRefusal> {
        match (self.state, self.fault) {
            (State::Faulted, Some(fault)) => {
                return Err(DriveRefusal::Faulted { code: fault.code() });
            }
            (State::Arming | State::Armed, _) => return Err(DriveRefusal::Armed),
            _ => {}
        }
        if self.vigil.missing(now).is_some() {
            return Err(DriveRefusal::NoLease);
        }
        if lost_ticks > 0 {
            return Err(DriveRefusal::NoEncoder);
        }
        self.arming = Arming::default();
        self.outcome = None;
        self.state = State::Arming;
        Ok(())
    }

    /// No more torque; not a fault.
    pub fn disarm(&mut self) {
        if self.is_live() {
            if self.state == State::Arming {
                self.outcome = Some(Err(DriveRefusal::Aborted));
            }
            self.state = State::Disarmed;
        }
    }

    /// Forgets the fault.
    ///
    /// # Errors
    /// [`DriveRefusal::Faulted`] if what caused it is still there.
    pub fn clear(&mut self, line_is_on: bool) -> Result<(), DriveRefusal> {
        if self.is_live() {
            return Err(DriveRefusal::Armed);
        }
        match self.fault {
            Some(fault @ Fault::EnableStuckOn) if line_is_on => {
                Err(DriveRefusal::Faulted { code: fault.code() })
            }
            _ => {
                self.fault = None;
                self.state = State::Disarmed;
                Ok(())
            }
        }
    }

    /// A fault: no more torque until it is cleared. The first one stays.
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

    /// One tick, before anything is done in it.
    pub fn tick(
        &mut self,
        now: u64,
        raw_a: Option<f32>,
        line_is_on: bool,
        count: i32,
        counters: &Counters,
    ) -> Permit {
        if self.is_live()
            && let Some(fault) = self.vigil.missing(now)
        {
            self.fail(fault, counters);
        }
        let permit = match self.state {
            State::Armed => Permit::Torque,
            State::Arming => match self.arming.tick(raw_a, line_is_on, count) {
                Wish::Off => Permit::Nothing,
                Wish::Line => Permit::Line,
                Wish::Push(amperes) => Permit::Push(amperes),
                Wish::Armed => {
                    self.state = State::Armed;
                    self.outcome = Some(Ok(()));
                    self.polarity_proven = self.arming.is_proven();
                    counters.count(DriveCounter::Armings);
                    Permit::Torque
                }
                Wish::Failed(fault) => {
                    self.fail(fault, counters);
                    Permit::Nothing
                }
            },
            State::Disarmed | State::Faulted => Permit::Nothing,
        };
        self.watch_line(permit, line_is_on, counters);
        permit
    }

    /// A line that was let go of has to fall.
    fn watch_line(&mut self, permit: Permit, line_is_on: bool, counters: &Counters) {
        let is_astray = permit == Permit::Nothing && self.state != State::Arming && line_is_on;
        self.astray_ticks = if is_astray {
            self.astray_ticks.saturating_add(1)
        } else {
            0
        };
        if self.astray_ticks > LINE_TICKS && self.fault != Some(Fault::EnableStuckOn) {
            // Worse than any other fault: it takes their place.
            self.fault = None;
            self.fail(Fault::EnableStuckOn, counters);
        }
    }
}
