//! A law on its way through a task: stepped along a motion, watched for torques that are none.
//!
//! ```text
//! runner (law, joint, precision, parts of a tick) ── start ──> ride ── follow, turn, tick ──> torques
//! ```
//!
//! A step is a tick of the device, or an equal part of one. Along a motion that is a function of
//! time, every step gets the exact travel and velocities. Where the input is what a device has at its
//! ticks (encoder, lost samples, a coupled leg), the parts of a tick share its travel on the path that
//! [`ShaftStep::travel`] assumes: so the law converges, and the input stays.

use super::contestant::Contestant;
use crepitus_ladder::laws::stepped::Stepped;
use crepitus_model::{Parameters, Real, SettingsError, ShaftStep};
use crepitus_scene::scene::Precision;
use std::cell::Cell;

/// Ticks of the device in a second.
pub const TICKS_HZ: f64 = 20_000.0;

/// The device's tick, s.
pub const TICK_S: f64 = 1.0 / TICKS_HZ;

/// Torque in multiples of Ts beyond which a law has diverged.
const DIVERGED: f64 = 100.0;

/// Steps between two looks at the cancellation.
const STEPS_PER_POLL: u32 = 1 << 15;

/// Angle and velocity of the shaft, rad and rad/s.
pub type Pose = (f64, f64);

/// Starts one law in one precision at one step.
pub struct Runner<'a> {
    contestant: &'a dyn Contestant,
    /// The joint that it is fitted to.
    pub joint: &'a Parameters,
    precision: Precision,
    /// Steps in a tick of the device.
    pub parts: u32,
    is_stopped: &'a (dyn Fn() -> bool + Sync),
    trouble: Cell<Option<&'static str>>,
}

impl<'a> Runner<'a> {
    /// A runner; `is_stopped` returns whether the study was cancelled.
    pub fn new(
        contestant: &'a dyn Contestant,
        joint: &'a Parameters,
        precision: Precision,
        parts: u32,
        is_stopped: &'a (dyn Fn() -> bool + Sync),
    ) -> Self {
        Self {
            contestant,
            joint,
            precision,
            parts,
            is_stopped,
            trouble: Cell::new(None),
        }
    }

    /// Steps in a second.
    pub fn rate_hz(&self) -> f64 {
        TICKS_HZ * f64::from(self.parts)
    }

    /// The step, s.
    pub fn step_s(&self) -> f64 {
        1.0 / self.rate_hz()
    }

    /// Returns whether this is the converged run, not the controller's.
    pub fn is_converged(&self) -> bool {
        self.precision == Precision::F64
    }

    /// Trouble of any ride so far.
    pub fn trouble(&self) -> Option<&'static str> {
        self.trouble.get()
    }

    /// The law without torque, under a shaft that moves so; what it rubs on moves along.
    ///
    /// # Errors
    /// [`SettingsError`] if joint or step are invalid for the law.
    pub fn start(&self, omega_rad_s: f64) -> Result<Ride<'_>, SettingsError> {
        self.start_with(self.joint, omega_rad_s)
    }

    /// The same, fitted to another joint.
    ///
    /// # Errors
    /// [`SettingsError`] if joint or step are invalid for the law.
    pub fn start_with(
        &self,
        joint: &Parameters,
        omega_rad_s: f64,
    ) -> Result<Ride<'_>, SettingsError> {
        let step_s = self.step_s();
        Ok(Ride {
            law: self
                .contestant
                .start(joint, step_s, self.precision, omega_rad_s)?,
            runner: self,
            most_nm: DIVERGED * joint.static_torque_nm,
            since_poll: 0,
            is_over: false,
            torque_nm: 0.0,
        })
    }
}

/// A law that is stepped.
pub struct Ride<'a> {
    law: Box<dyn Stepped>,
    runner: &'a Runner<'a>,
    most_nm: f64,
    since_poll: u32,
    /// Diverged or cancelled: no further step has a meaning.
    is_over: bool,
    /// Torque at the end of the last step, N·m.
    pub torque_nm: f64,
}

impl Ride<'_> {
    /// Moves through one step, and returns the torque, N·m.
    pub fn step(&mut self, shaft: &ShaftStep<f64>) -> f64 {
        if self.is_over {
            return self.torque_nm;
        }
        let torque_nm = self.law.step(shaft);
        self.since_poll += 1;
        if self.since_poll == STEPS_PER_POLL {
            self.since_poll = 0;
            self.is_over = (self.runner.is_stopped)();
        }
        if torque_nm.abs() <= self.most_nm {
            self.torque_nm = torque_nm;
        } else {
            self.is_over = true;
            let trouble = if torque_nm.is_finite() {
                "diverges"
            } else {
                "its torque is not finite"
            };
            self.runner.trouble.set(Some(trouble));
        }
        self.torque_nm
    }

    /// Follows a path of its own time, from 0 to `duration_s`; `each` gets time and torque after
    /// every step.
    pub fn follow(
        &mut self,
        duration_s: f64,
        path: impl Fn(f64) -> Pose,
        mut each: impl FnMut(f64, f64),
    ) {
        let rate_hz = self.runner.rate_hz();
        let mut from = path(0.0);
        for n in 1..=(duration_s * rate_hz).round().whole() {
            if self.is_over {
                return;
            }
            let time_s = f64::from_whole(n) / rate_hz;
            let to = path(time_s);
            let torque_nm = self.step(&between(from, to));
            each(time_s, torque_nm);
            from = to;
        }
    }

    /// Turns with a constant velocity until `until` holds of the torque, at most by `most_rad`.
    /// Returns the travel, rad, or `None` if it never held.
    pub fn turn(
        &mut self,
        omega_rad_s: f64,
        most_rad: f64,
        mut until: impl FnMut(f64) -> bool,
    ) -> Option<f64> {
        let shaft = steady(omega_rad_s, self.runner.step_s());
        let most = (most_rad / shaft.delta_phi_rad).abs().whole();
        for n in 1..=most {
            if until(self.step(&shaft)) {
                return Some(shaft.delta_phi_rad * f64::from_whole(n));
            }
            if self.is_over {
                break;
            }
        }
        None
    }

    /// Goes through prepared steps; `each` gets each of them with the torque after it.
    pub fn steps(&mut self, steps: &[ShaftStep<f64>], mut each: impl FnMut(&ShaftStep<f64>, f64)) {
        for shaft in steps {
            if self.is_over {
                return;
            }
            let torque_nm = self.step(shaft);
            each(shaft, torque_nm);
        }
    }

    /// Moves through a tick of the device, in as many steps as the runner has; returns the torque at
    /// its end, N·m.
    pub fn tick(&mut self, tick: &ShaftStep<f64>) -> f64 {
        let parts = self.runner.parts;
        let mut from = (0.0, tick.omega_start_rad_s);
        for n in 1..=parts {
            let share = f64::from(n) / f64::from(parts);
            let bend = tick.omega_end_rad_s - tick.omega_start_rad_s;
            let to = (
                tick.travel(share, TICK_S),
                tick.omega_start_rad_s + bend * share,
            );
            self.step(&between(from, to));
            from = to;
        }
        self.torque_nm
    }

    /// Another joint from the next step on.
    ///
    /// # Errors
    /// [`SettingsError`] if joint or step are invalid for the law.
    pub fn change(&mut self, joint: &Parameters) -> Result<(), SettingsError> {
        self.law.change(joint, self.runner.step_s())
    }
}

/// The step from one pose to another.
pub fn between(from: Pose, to: Pose) -> ShaftStep<f64> {
    ShaftStep {
        delta_phi_rad: to.0 - from.0,
        omega_start_rad_s: from.1,
        omega_end_rad_s: to.1,
    }
}

/// The step of a constant velocity.
pub fn steady(omega_rad_s: f64, step_s: f64) -> ShaftStep<f64> {
    between((0.0, omega_rad_s), (omega_rad_s * step_s, omega_rad_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_ladder::laws::ENTRIES;

    #[test]
    fn the_parts_of_a_tick_are_the_tick() {
        let joint = Parameters::default();
        let tick = between((0.0, 0.1), (7e-6, 0.16));
        let torque = |parts| {
            let runner = Runner::new(&ENTRIES[0], &joint, Precision::F64, parts, &|| false);
            let mut ride = runner.start(0.1).unwrap();
            ride.tick(&tick)
        };
        assert!((torque(1) - 400.0 * 7e-6).abs() < 1e-15);
        assert!((torque(16) - torque(1)).abs() < 1e-15);
    }

    #[test]
    fn a_cancelled_ride_goes_no_further() {
        let joint = Parameters::default();
        let runner = Runner::new(&ENTRIES[0], &joint, Precision::F64, 1, &|| true);
        let mut ride = runner.start(0.0).unwrap();
        let mut seen = 0_u32;
        ride.follow(1e6, |t| (1e-9 * t, 1e-9), |_, _| seen += 1);
        assert_eq!(seen, STEPS_PER_POLL);
    }
}
