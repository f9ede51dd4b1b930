//! Steady grating while one sample in a hundred is lost.
//!
//! What a device does, with any law: while a sample is missing it holds the torque; with the next one
//! the law catches up, in equal steps for the missing ticks and the present one. (That is what
//! `crepitus_model::render::held` does with our joint.) So no travel is lost, and the law is never given a
//! step of another length.
//!
//! Known: frequency by the closed form, and that nothing beyond Ts is shown.

use super::{DRAG_RAD_S, NO_CYCLES};
use crate::laws::closed_forms::Grating;
use crate::laws::cycles::{Cycles, Frequency};
use crate::laws::runner::{Runner, TICK_S, between};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::SettingsError;
use fastrand::Rng;

/// The task.
pub struct Lose;

/// Probability that a sample is lost.
const LOST: f64 = 0.01;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "lost-frequency",
        title: "cycles in a second at 0.988 rad/s, one sample in 100 lost",
        unit: "Hz",
        demands: "the frequency of the closed form, as if no sample were lost",
        of: Use::Grating,
    },
    Quantity {
        name: "lost-beyond",
        title: "largest torque beyond ±Ts, one sample in 100 lost",
        unit: "N·m",
        demands: "nothing beyond Ts is shown, whatever is lost",
        of: Use::Grating,
    },
];

impl Task for Lose {
    fn name(&self) -> &'static str {
        "lost-samples"
    }

    fn title(&self) -> &'static str {
        "steady grating with lost samples"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let mut random = Rng::with_seed(56);
        let ticks = setting.or_quick(60_000, 20_000);
        Ok(Box::new(Gaps {
            form: Grating::new(&setting.joint.parameters, DRAG_RAD_S),
            is_lost: (0..ticks).map(|_| random.f64() < LOST).collect(),
        }))
    }
}

struct Gaps {
    form: Grating,
    is_lost: Vec<bool>,
}

impl Prepared for Gaps {
    fn demanded(&self) -> Vec<Demand> {
        vec![
            Demand::itself(self.form.hz()),
            Demand::none_of(self.form.high_nm),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[4, 16]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let mut ride = runner.start(DRAG_RAD_S)?;
        let mut cycles = Cycles::of(runner.joint);
        let (mut frequency, mut beyond_nm) = (Frequency::default(), 0.0_f64);
        let mut from = (0.0, DRAG_RAD_S);
        let mut missed = 0_u32;
        for (is_lost, n) in self.is_lost.iter().zip(1_u32..) {
            if *is_lost {
                missed += 1;
                continue;
            }
            let to = (DRAG_RAD_S * f64::from(n) * TICK_S, DRAG_RAD_S);
            let ticks = f64::from(missed + 1);
            let each = between((0.0, from.1), ((to.0 - from.0) / ticks, to.1));
            // The velocity is known where there was a sample: linear between them.
            let gain = (each.omega_end_rad_s - each.omega_start_rad_s) / ticks;
            for place in 0..=missed {
                let mut tick = each;
                tick.omega_start_rad_s = from.1 + gain * f64::from(place);
                tick.omega_end_rad_s = from.1 + gain * f64::from(place + 1);
                ride.tick(&tick);
            }
            (missed, from) = (0, to);
            let time_s = f64::from(n) * TICK_S;
            let cycle_s = cycles.see(time_s, ride.torque_nm);
            if time_s > 0.4 {
                beyond_nm = beyond_nm.max(ride.torque_nm.abs() - self.form.high_nm);
                if let Some(at_s) = cycle_s {
                    frequency.add(at_s);
                }
            }
        }
        Ok(vec![
            Reading::but(frequency.hz(), frequency.count() < 2, NO_CYCLES),
            Reading::of(beyond_nm),
        ])
    }
}
