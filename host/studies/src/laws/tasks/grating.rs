//! Steady grating: the shaft is dragged with a constant velocity, from a stick: at the start the object
//! moves with the shaft. (An object at rest that is dragged so fast has no cycles: its velocity never
//! meets the shaft's.)
//!
//! Known: frequency, highest torque and band Ts − (2Tk − Ts) by the closed form of
//! [`Grating`].

use super::{DRAG_RAD_S, NO_CYCLES};
use crate::laws::closed_forms::Grating;
use crate::laws::cycles::{Cycles, Frequency};
use crate::laws::runner::Runner;
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::SettingsError;
use crepitus_plant::Extremes;

/// The task.
pub struct Grate;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "grating-frequency",
        title: "cycles in a second while the shaft is dragged at 0.988 rad/s",
        unit: "Hz",
        demands: "stick 2Δ/(kr·Ω) and slip (2/ωn)·(π − atan(Δ·ωn/(kr·Ω))) together are a cycle",
        of: Use::Grating,
    },
    Quantity {
        name: "grating-peak",
        title: "highest torque of steady grating",
        unit: "N·m",
        demands: "every stick ends at Ts",
        of: Use::Grating,
    },
    Quantity {
        name: "grating-band",
        title: "highest less lowest torque of steady grating",
        unit: "N·m",
        demands: "the torque goes from 2Tk − Ts to Ts",
        of: Use::Grating,
    },
];

impl Task for Grate {
    fn name(&self) -> &'static str {
        "grating"
    }

    fn title(&self) -> &'static str {
        "steady grating"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        Ok(Box::new(Steady {
            form: Grating::new(&setting.joint.parameters, DRAG_RAD_S),
            settle_s: setting.or_quick(1.0, 0.4),
            measure_s: setting.or_quick(2.0, 0.6),
        }))
    }
}

struct Steady {
    form: Grating,
    settle_s: f64,
    measure_s: f64,
}

impl Prepared for Steady {
    fn demanded(&self) -> Vec<Demand> {
        let band_nm = self.form.high_nm - self.form.low_nm;
        vec![
            Demand::itself(self.form.hz()),
            Demand::itself(self.form.high_nm),
            Demand::itself(band_nm),
        ]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let mut ride = runner.start(DRAG_RAD_S)?;
        let mut cycles = Cycles::of(runner.joint);
        let (mut frequency, mut torques_nm) = (Frequency::default(), Extremes::default());
        ride.follow(
            self.settle_s + self.measure_s,
            |time_s| (DRAG_RAD_S * time_s, DRAG_RAD_S),
            |time_s, torque_nm| {
                let cycle_s = cycles.see(time_s, torque_nm);
                if time_s > self.settle_s {
                    torques_nm.add(torque_nm);
                    if let Some(at_s) = cycle_s {
                        frequency.add(at_s);
                    }
                }
            },
        );
        let Extremes { low, high } = torques_nm;
        Ok(vec![
            Reading::but(frequency.hz(), frequency.count() < 2, NO_CYCLES),
            Reading::of(high),
            Reading::of(high - low),
        ])
    }
}
