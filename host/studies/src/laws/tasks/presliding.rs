//! Small cycles below the break.
//!
//! Our joint is a spring there, in a stick. So the work of a cycle is zero, and after 10⁴ cycles the torque
//! is where it was:
//!
//! ```text
//! loop    φ = φ_s/2·sin(2π·f·t), f a fifth of the natural frequency     ∮ T dφ = 0
//! drift   φ = 0.3·φ_s + 0.01·φ_s·sin(2π·f·t), f = 100 Hz                mean torque stays
//! ```
//!
//! φ_s = Ts/kr. The loop is slow, so that the object's inertia adds a twenty-fifth; the drift's
//! amplitude is so small that it adds less than Ts/4. The energy is seen beside that of the spring at
//! φ_s/2, the drift beside Ts.

use super::{break_angle_rad, tremor};
use crate::laws::runner::Runner;
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, SettingsError, ShaftStep};
use std::f64::consts::TAU;

/// The task.
pub struct Preslide;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "presliding-loss",
        title: "energy lost in a cycle of half the break angle",
        unit: "J",
        demands: "a stick is a spring: nothing is lost",
        of: Use::Rest,
    },
    Quantity {
        name: "presliding-drift",
        title: "drift of the mean torque over 10⁴ small cycles",
        unit: "N·m",
        demands: "a stick is a spring: the torque returns with the angle",
        of: Use::Rest,
    },
];

/// Frequency of the small cycles, Hz.
const SMALL_HZ: f64 = 100.0;

impl Task for Preslide {
    fn name(&self) -> &'static str {
        "presliding"
    }

    fn title(&self) -> &'static str {
        "small cycles below the break"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        Ok(Box::new(Loops {
            joint: setting.joint.parameters,
            small_cycles: setting.or_quick(10_000, 1_000),
        }))
    }
}

struct Loops {
    joint: Parameters,
    small_cycles: u32,
}

impl Prepared for Loops {
    fn demanded(&self) -> Vec<Demand> {
        let half = 0.5 * break_angle_rad(&self.joint);
        vec![
            Demand::none_of(0.5 * self.joint.stiffness_nm_per_rad * half * half),
            Demand::none_of(self.joint.static_torque_nm),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[1, 4]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        Ok(vec![
            Reading::of(self.loss_j(runner)?),
            Reading::of(self.drift_nm(runner)?),
        ])
    }
}

impl Loops {
    /// Work of the third of three cycles, J, by the trapezoidal rule.
    fn loss_j(&self, runner: &Runner<'_>) -> Result<f64, SettingsError> {
        let natural_hz = self.joint.natural_rad_s() / TAU;
        let steps = tremor(runner, 0.5 * break_angle_rad(&self.joint), 0.2 * natural_hz);
        let mut ride = runner.start(steps.first().map_or(0.0, |s| s.omega_start_rad_s))?;
        let mut work_j = 0.0;
        for _ in 0..3 {
            let mut before_nm = ride.torque_nm;
            work_j = 0.0;
            ride.steps(&steps, |shaft, torque_nm| {
                work_j += 0.5 * (before_nm + torque_nm) * shaft.delta_phi_rad;
                before_nm = torque_nm;
            });
        }
        Ok(work_j)
    }

    /// Change of the mean torque from the tenth small cycle to the last, N·m.
    fn drift_nm(&self, runner: &Runner<'_>) -> Result<f64, SettingsError> {
        let broken_rad = break_angle_rad(&self.joint);
        let small = tremor(runner, 0.01 * broken_rad, SMALL_HZ);
        let mut ride = runner.start(0.0)?;
        ride.turn(0.01, 0.3 * broken_rad, |_| false);
        let mean_nm = |ride: &mut super::super::runner::Ride<'_>, steps: &[ShaftStep<f64>]| {
            let (mut sum, mut count) = (0.0, 0.0);
            ride.steps(steps, |_, torque_nm| {
                sum += torque_nm;
                count += 1.0;
            });
            sum / count
        };
        let (mut first_nm, mut last_nm) = (0.0, 0.0);
        for cycle in 1..=self.small_cycles {
            last_nm = mean_nm(&mut ride, &small);
            if cycle == 10 {
                first_nm = last_nm;
            }
        }
        Ok((last_nm - first_nm).abs())
    }
}
