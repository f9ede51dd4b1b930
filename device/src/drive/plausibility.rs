//! What cannot be, while there is torque.
//!
//! Each check waits for as many ticks as its fault says in
//! [`FAULTS`](crepitus_protocol::fault::FAULTS): a disturbance of one sample
//! is no fault.

use crate::drive::motor::Motor;
use crepitus_model::Real;
use crepitus_model::control::current_loop::Limit;
use crepitus_protocol::Fault;

/// Largest current, A: beyond it the hardware trips, too.
pub const TRIP_A: f32 = 1.95;

/// How far a current may stay from what was asked for, A.
const CURRENT_SLACK_A: f32 = 0.2;

/// How far speed from back-EMF and speed from the encoder may differ, rad/s,
/// and as a share of the larger: copper that is 80 K warmer than believed.
const SPEED_SLACK_RAD_S: f32 = 0.5;
const SPEED_SLACK_SHARE: f32 = 0.25;

/// Counts the ticks in a row in which something is so.
#[derive(Clone, Copy, Debug, Default)]
struct Patience(u32);

impl Patience {
    /// Whether it is so for the `ticks`-th time in a row.
    fn is_over(&mut self, is_so: bool, ticks: u32) -> bool {
        if !is_so {
            self.0 = 0;
            return false;
        }
        self.0 = self.0.saturating_add(1);
        self.0 >= ticks
    }
}

/// What a tick shows.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a line or a fact by itself"
)]
pub struct Seen {
    /// Ticks in a row without a count to believe.
    pub lost_ticks: u32,
    /// Speed of the joint by the encoder, rad/s.
    pub omega_rad_s: f32,
    /// The torque is that of the tick before.
    pub is_late: bool,
    /// The torque to show is a number.
    pub is_number: bool,
    /// The current without the sensor's offset, A.
    pub current_a: Option<f32>,
    /// The enable line, as read back.
    pub enable_is_on: bool,
    /// The hardware has let go.
    pub is_broken: bool,
}

/// The checks and how long each has waited.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plausibility {
    overspeed: Patience,
    late: Patience,
    missing: Patience,
    overcurrent: Patience,
    mismatch: Patience,
    speeds: Patience,
    enable: Patience,
}

impl Plausibility {
    /// The first fault of a tick with torque, if there is one. `motor` is as
    /// the tick before has left it.
    pub fn check(&mut self, seen: &Seen, motor: &Motor, speed_limit_rad_s: f32) -> Option<Fault> {
        let current_a = seen.current_a;
        let over = current_a.is_some_and(|a| a.abs() > TRIP_A);
        let astray = current_a.is_some_and(|a| {
            (a - motor.wanted_a()).abs() > CURRENT_SLACK_A
                && motor.limited_by() != Some(Limit::Voltage)
        });
        let (emf, encoder) = (motor.emf_rad_s(), seen.omega_rad_s);
        let slack = SPEED_SLACK_RAD_S + SPEED_SLACK_SHARE * emf.abs().at_least(encoder.abs());
        let differ = (emf - encoder).abs() > slack;
        // Each is asked in every tick: none may lose count for another.
        let overcurrent = self.overcurrent.is_over(over, 2);
        let missing = self.missing.is_over(current_a.is_none(), 3);
        let enable = self.enable.is_over(!seen.enable_is_on, 9);
        let is_fast = encoder.abs() > speed_limit_rad_s;
        let overspeed = self.overspeed.is_over(is_fast, 20);
        let late = self.late.is_over(seen.is_late, 20);
        let mismatch = self.mismatch.is_over(astray, 100);
        let speeds = self.speeds.is_over(differ, 400);
        // By urgency.
        if seen.is_broken {
            Some(Fault::Overcurrent)
        } else if !seen.is_number {
            Some(Fault::NotANumber)
        } else if overcurrent {
            Some(Fault::Overcurrent)
        } else if missing {
            Some(Fault::CurrentMissing)
        } else if enable {
            Some(Fault::EnableStuckOff)
        } else if seen.lost_ticks >= crate::drive::sampler::LOST_TICKS {
            Some(Fault::EncoderLost)
        } else if overspeed {
            Some(Fault::Overspeed)
        } else if late {
            Some(Fault::RenderingLate)
        } else if mismatch {
            Some(Fault::CurrentMismatch)
        } else if speeds {
            Some(Fault::SpeedMismatch)
        } else {
            None
        }
    }
}
