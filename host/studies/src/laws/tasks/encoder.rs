//! Steady grating of a shaft that the device sees through its encoder: counts at the motor, and a
//! velocity that is estimated.
//!
//! Known: frequency, and root mean square of the torque, √(Tk² + stick/cycle·Δ²/3), by the closed
//! form. The converged law gets the same counts at the same ticks, and takes every tick in parts.

use super::{DRAG_RAD_S, NO_CYCLES};
use crate::laws::closed_forms::Grating;
use crate::laws::cycles::{Cycles, Frequency};
use crate::laws::runner::{Runner, TICK_S, TICKS_HZ};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::{Real, SettingsError, ShaftStep};
use crepitus_plant::encoder::Encoder;

/// The task.
pub struct Encode;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "encoder-frequency",
        title: "cycles in a second at 0.988 rad/s, by counts of the encoder",
        unit: "Hz",
        demands: "the frequency of the closed form, as if the shaft were known exactly",
        of: Use::Grating,
    },
    Quantity {
        name: "encoder-rms",
        title: "root mean square of the torque, by counts of the encoder",
        unit: "N·m",
        demands: "√(Tk² + stick/cycle·Δ²/3)",
        of: Use::Grating,
    },
];

impl Task for Encode {
    fn name(&self) -> &'static str {
        "encoder"
    }

    fn title(&self) -> &'static str {
        "steady grating by counts of the encoder"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let settings = EncoderSettings::default();
        let encoder = Encoder::new(&settings);
        let mut reader =
            EncoderReader::<f32>::new(&settings, TICK_S, 0, f32::from_f64(DRAG_RAD_S))?;
        let ticks = setting.or_quick(60_000_u32, 20_000);
        let count = |n: u32| encoder.count(DRAG_RAD_S * f64::from(n) * TICK_S);
        let ticks = (1..=ticks)
            .map(|n| double(&reader.read(count(n))))
            .collect();
        Ok(Box::new(Counted {
            form: Grating::new(&setting.joint.parameters, DRAG_RAD_S),
            ticks,
        }))
    }
}

/// The same step in f64.
fn double(shaft: &ShaftStep<f32>) -> ShaftStep<f64> {
    ShaftStep {
        delta_phi_rad: shaft.delta_phi_rad.to_f64(),
        omega_start_rad_s: shaft.omega_start_rad_s.to_f64(),
        omega_end_rad_s: shaft.omega_end_rad_s.to_f64(),
    }
}

struct Counted {
    form: Grating,
    ticks: Vec<ShaftStep<f64>>,
}

impl Prepared for Counted {
    fn demanded(&self) -> Vec<Demand> {
        vec![
            Demand::itself(self.form.hz()),
            Demand::itself(self.form.rms_nm),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[4, 16]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let mut ride = runner.start(DRAG_RAD_S)?;
        let mut cycles = Cycles::of(runner.joint);
        let (mut frequency, mut squares, mut count) = (Frequency::default(), 0.0, 0.0);
        // A law may swing in for the first 0.4 s.
        let settled = usize::try_from((0.4 * TICKS_HZ).whole()).unwrap_or(0);
        for (n, tick) in self.ticks.iter().enumerate() {
            let torque_nm = ride.tick(tick);
            let cycle_s = cycles.see(n as f64 * TICK_S, torque_nm);
            if n > settled {
                squares += torque_nm * torque_nm;
                count += 1.0;
                if let Some(at_s) = cycle_s {
                    frequency.add(at_s);
                }
            }
        }
        let rms_nm = f64::sqrt(squares / count);
        Ok(vec![
            Reading::but(frequency.hz(), frequency.count() < 2, NO_CYCLES),
            Reading::of(rms_nm),
        ])
    }
}
