//! Creep: a joint that bears 0.9 Ts, under a small tremor; and the torque at which it gives way.
//!
//! The shaft turns until the law bears 0.9·Ts, with a fifth of the Stribeck velocity that every law is
//! fitted to, and then trembles by ±0.02·Ts/kr at 8 Hz for 10 s.
//!
//! Then it is turned from rest, as slowly, by two break angles (1.2 in a quick study), and its highest torque is the torque of
//! breaking away.
//!
//! Known: our joint is in a stick. Its torque follows the angle, and the angle returns: nothing of
//! the load is lost, and it breaks at Ts. A load that friction gives back as drift is lost for the person who leans on it.

use super::{break_angle_rad, tremor};
use crate::laws::runner::Runner;
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_ladder::laws::Contact;
use crepitus_model::{Parameters, SettingsError};

/// The task.
pub struct Creep;

/// Frequency of the tremor, Hz.
const TREMOR_HZ: f64 = 8.0;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "creep",
        title: "share of a load of 0.9 Ts that is lost in 10 s under a tremor of 2 % of the break angle",
        unit: "1",
        demands: "a stick bears its load: nothing is lost",
        of: Use::Rest,
    },
    Quantity {
        name: "break-away-slow",
        title: "deviation of the highest torque from Ts, loaded ever so slowly",
        unit: "1",
        demands: "dry friction breaks at Ts",
        of: Use::Rest,
    },
];

impl Task for Creep {
    fn name(&self) -> &'static str {
        "creep"
    }

    fn title(&self) -> &'static str {
        "creep under a load and a tremor"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        Ok(Box::new(Load {
            joint: setting.joint.parameters,
            cycles: setting.or_quick(80, 20),
            break_angles: setting.or_quick(2.0, 1.2),
        }))
    }
}

struct Load {
    joint: Parameters,
    cycles: u32,
    /// Travel of a slow load, in break angles.
    break_angles: f64,
}

impl Prepared for Load {
    fn demanded(&self) -> Vec<Demand> {
        vec![Demand::none_of(1.0); 2]
    }

    fn refinements(&self) -> &[u32] {
        &[2, 8]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        Ok(vec![self.lost(runner)?, self.broken(runner)?])
    }
}

impl Load {
    fn slow_rad_s(&self) -> f64 {
        0.2 * Contact::direct(&self.joint).stribeck_rad_s
    }

    /// Deviation of the torque of breaking away, in shares of Ts.
    fn broken(&self, runner: &Runner<'_>) -> Result<Reading, SettingsError> {
        let mut ride = runner.start(0.0)?;
        let mut highest_nm = 0.0_f64;
        let most_rad = self.break_angles * break_angle_rad(&self.joint);
        ride.turn(self.slow_rad_s(), most_rad, |nm| {
            highest_nm = highest_nm.max(nm);
            false
        });
        let share = highest_nm / self.joint.static_torque_nm;
        Ok(Reading::of((share - 1.0).abs()))
    }

    fn lost(&self, runner: &Runner<'_>) -> Result<Reading, SettingsError> {
        let load_nm = 0.9 * self.joint.static_torque_nm;
        let broken_rad = break_angle_rad(&self.joint);
        let mut ride = runner.start(0.0)?;
        let most_rad = 3.0 * broken_rad;
        let loaded = ride.turn(self.slow_rad_s(), most_rad, |nm| nm >= load_nm);
        if loaded.is_none() {
            return Ok(Reading::failed("never bears 0.9 Ts"));
        }
        let tremor = tremor(runner, 0.02 * broken_rad, TREMOR_HZ);
        let mut mean_nm = 0.0;
        for _ in 0..self.cycles {
            let (mut sum, mut count) = (0.0, 0.0);
            ride.steps(&tremor, |_, torque_nm| {
                sum += torque_nm;
                count += 1.0;
            });
            mean_nm = sum / count;
        }
        Ok(Reading::of(1.0 - mean_nm / load_nm))
    }
}
