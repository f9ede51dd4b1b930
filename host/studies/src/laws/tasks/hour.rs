//! An hour of steady grating in f32, a day in a long study.
//!
//! Known: the frequency of the closed form, in the first minute as in the last. What adds up, an angle
//! or an energy, is rounded ever more coarsely in f32: a law that keeps one drifts, or stops.
//!
//! The converged law is the same in f64 at the same step for a tenth of the time: its roundings are 10⁹
//! times smaller.

use super::{DRAG_RAD_S, NO_CYCLES};
use crate::laws::closed_forms::Grating;
use crate::laws::cycles::{Cycles, Frequency};
use crate::laws::runner::{Runner, TICK_S, steady};
use crate::laws::task::{Demand, Extent, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Real, SettingsError};

/// The task.
pub struct Hour;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "hour-drift",
        title: "frequency in the last minute of an hour (a day in a long study) less that in the first",
        unit: "Hz",
        demands: "the same cycle for ever",
        of: Use::Running,
    },
    Quantity {
        name: "hour-frequency",
        title: "frequency in the last minute of an hour (a day in a long study)",
        unit: "Hz",
        demands: "the frequency of the closed form",
        of: Use::Running,
    },
];

impl Task for Hour {
    fn name(&self) -> &'static str {
        "hour"
    }

    fn title(&self) -> &'static str {
        "an hour in f32"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn is_for_one_joint(&self) -> bool {
        true
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let (total_s, window_s) = match setting.extent {
            Extent::Quick => (20.0, 4.0),
            Extent::Full => (3600.0, 60.0),
            Extent::Long => (86_400.0, 60.0),
        };
        Ok(Box::new(Hours {
            form: Grating::new(&setting.joint.parameters, DRAG_RAD_S),
            total_s,
            window_s,
        }))
    }
}

struct Hours {
    form: Grating,
    total_s: f64,
    window_s: f64,
}

impl Prepared for Hours {
    fn demanded(&self) -> Vec<Demand> {
        let hz = self.form.hz();
        vec![Demand::none_of(hz), Demand::itself(hz)]
    }

    fn refinements(&self) -> &[u32] {
        &[1]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        const SETTLE_S: f64 = 1.0;
        let share = if runner.is_converged() { 0.1 } else { 1.0 };
        let total_s = (self.total_s * share).max(2.0 * self.window_s);
        let mut ride = runner.start(DRAG_RAD_S)?;
        // The same step again and again: a block of it, a second long.
        let block = vec![steady(DRAG_RAD_S, TICK_S); 20_000];
        let mut cycles = Cycles::of(runner.joint);
        let (mut first, mut last) = (Frequency::default(), Frequency::default());
        let blocks = total_s.round().whole();
        for second in 0..blocks {
            let start_s = f64::from_whole(second);
            let mut time_s = start_s;
            ride.steps(&block, |_, torque_nm| {
                time_s += TICK_S;
                if let Some(at_s) = cycles.see(time_s, torque_nm) {
                    if at_s > SETTLE_S && at_s < SETTLE_S + self.window_s {
                        first.add(at_s);
                    } else if at_s > total_s - self.window_s {
                        last.add(at_s);
                    }
                }
            });
        }
        let stopped = last.count() < 2;
        Ok(vec![
            Reading::but((last.hz() - first.hz()).abs(), stopped, NO_CYCLES),
            Reading::but(last.hz(), stopped, NO_CYCLES),
        ])
    }
}
