//! Plausibility checks while armed.
//!
//! Each check is debounced by the number of ticks that
//! [`FAULTS`](crepitus_protocol::fault::FAULTS) gives for its fault: a single
//! disturbed sample is no fault.

use crate::drive::motor::Motor;
use crepitus_model::Real;
use crepitus_model::control::current_loop::Limit;
use crepitus_protocol::Fault;

/// Overcurrent threshold, A: the hardware trips there, too.
pub const TRIP_A: f32 = 1.95;

/// Largest deviation of the current from its setpoint, A.
const CURRENT_SLACK_A: f32 = 0.2;

/// Largest difference of back-EMF speed and encoder speed, rad/s, and as a
/// share of the larger: copper 80 K warmer than assumed.
const SPEED_SLACK_RAD_S: f32 = 0.5;
const SPEED_SLACK_SHARE: f32 = 0.25;

/// Debounce: counts consecutive ticks in which a condition holds.
#[derive(Clone, Copy, Debug, Default)]
struct Debounce(u32);

impl Debounce {
    /// Whether the condition has held for `ticks` consecutive ticks.
    fn trips(&mut self, condition: bool, ticks: u32) -> bool {
        if !condition {
            self.0 = 0;
            return false;
        }
        self.0 = self.0.saturating_add(1);
        self.0 >= ticks
    }
}

/// Inputs of the checks in a tick.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a line or a fact by itself"
)]
pub struct Observation {
    /// Consecutive ticks without a plausible count.
    pub lost_ticks: u32,
    /// Speed of the joint by the encoder, rad/s.
    pub omega_rad_s: f32,
    /// The torque is that of the previous tick.
    pub is_late: bool,
    /// The rendered torque is finite.
    pub torque_is_finite: bool,
    /// The current without the sensor's offset, A.
    pub current_a: Option<f32>,
    /// The enable line, as read back.
    pub enable_is_on: bool,
    /// The hardware's break input has tripped.
    pub has_tripped: bool,
}

/// The checks and their debounce counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plausibility {
    overspeed: Debounce,
    late: Debounce,
    missing: Debounce,
    overcurrent: Debounce,
    mismatch: Debounce,
    speeds: Debounce,
    enable: Debounce,
}

impl Plausibility {
    /// Returns the most urgent fault of a tick with torque. `motor` is in the
    /// state after the previous tick.
    pub fn check(
        &mut self,
        observed: &Observation,
        motor: &Motor,
        speed_limit_rad_s: f32,
    ) -> Option<Fault> {
        let current_a = observed.current_a;
        let over = current_a.is_some_and(|a| a.abs() > TRIP_A);
        let deviates = current_a.is_some_and(|a| {
            (a - motor.setpoint_a()).abs() > CURRENT_SLACK_A
                && motor.limited_by() != Some(Limit::Voltage)
        });
        let (emf, encoder) = (motor.emf_rad_s(), observed.omega_rad_s);
        let slack = SPEED_SLACK_RAD_S + SPEED_SLACK_SHARE * emf.abs().at_least(encoder.abs());
        let speeds_differ = (emf - encoder).abs() > slack;
        // Every check runs in every tick, so that no counter misses one.
        let overcurrent = self.overcurrent.trips(over, 2);
        let missing = self.missing.trips(current_a.is_none(), 3);
        let enable = self.enable.trips(!observed.enable_is_on, 9);
        let is_fast = encoder.abs() > speed_limit_rad_s;
        let overspeed = self.overspeed.trips(is_fast, 20);
        let late = self.late.trips(observed.is_late, 20);
        let mismatch = self.mismatch.trips(deviates, 100);
        let speeds = self.speeds.trips(speeds_differ, 400);
        // By urgency.
        if observed.has_tripped {
            Some(Fault::Overcurrent)
        } else if !observed.torque_is_finite {
            Some(Fault::NotANumber)
        } else if overcurrent {
            Some(Fault::Overcurrent)
        } else if missing {
            Some(Fault::CurrentMissing)
        } else if enable {
            Some(Fault::EnableStuckOff)
        } else if observed.lost_ticks >= crate::drive::sampler::LOST_TICKS {
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
