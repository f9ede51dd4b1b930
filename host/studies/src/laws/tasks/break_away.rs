//! Break-away torque against the rate of load.
//!
//! The shaft is dragged with 0.01 to 10 rad/s, from a stick, for three cycles of the closed form. Of a
//! law that does not grate, the first loading counts.
//!
//! Known: our joint breaks at Ts at every rate. The worst deviation is given in shares of Ts. At
//! 10 rad/s the torque may rise by half of Ts within a tick, and no tick sees the break.

use crate::laws::closed_forms::Grating;
use crate::laws::runner::Runner;
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, SettingsError};

/// The task.
pub struct BreakAway;

/// Velocities of a hand that examines, rad/s.
const SLOW_RAD_S: [f64; 3] = [0.01, 0.1, 1.0];
/// Velocity of a blow, rad/s.
const FAST_RAD_S: f64 = 10.0;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "break-away",
        title: "worst deviation of the highest torque from Ts, dragged at 0.01, 0.1 and 1 rad/s",
        unit: "1",
        demands: "dry friction breaks at Ts, however fast it is loaded",
        of: Use::Moving,
    },
    Quantity {
        name: "break-away-fast",
        title: "deviation of the highest torque from Ts, dragged at 10 rad/s",
        unit: "1",
        demands: "dry friction breaks at Ts, however fast it is loaded",
        of: Use::Moving,
    },
];

impl Task for BreakAway {
    fn name(&self) -> &'static str {
        "break-away"
    }

    fn title(&self) -> &'static str {
        "break-away torque against the rate of load"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        Ok(Box::new(Loads(setting.joint.parameters)))
    }
}

struct Loads(Parameters);

impl Prepared for Loads {
    fn demanded(&self) -> Vec<Demand> {
        vec![Demand::none_of(1.0); 2]
    }

    fn refinements(&self) -> &[u32] {
        &[8, 32]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let mut worst = 0.0_f64;
        for omega_rad_s in SLOW_RAD_S {
            worst = worst.max(self.deviation(runner, omega_rad_s)?);
        }
        let fast = self.deviation(runner, FAST_RAD_S)?;
        Ok(vec![Reading::of(worst), Reading::of(fast)])
    }
}

impl Loads {
    fn deviation(&self, runner: &Runner<'_>, omega_rad_s: f64) -> Result<f64, SettingsError> {
        let Self(joint) = self;
        let cycles_s = 3.0 * Grating::new(joint, omega_rad_s).period_s();
        let mut ride = runner.start(omega_rad_s)?;
        let mut highest_nm = 0.0_f64;
        ride.follow(
            cycles_s,
            |time_s| (omega_rad_s * time_s, omega_rad_s),
            |_, torque_nm| highest_nm = highest_nm.max(torque_nm),
        );
        Ok((highest_nm / joint.static_torque_nm - 1.0).abs())
    }
}
