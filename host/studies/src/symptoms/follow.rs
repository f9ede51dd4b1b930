//! The law of a symptom alone, step by step: without check, tank and limit.

use super::event::SymptomEvent;
use super::given::Given;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crepitus_ladder::loops::tick;
use crepitus_model::render::effects::{DeviceEffect, LawVisitor, Timing};
use crepitus_model::render::position::{Scale, Sensing};
use crepitus_model::{Real, SettingsError, ShaftStep};

/// Timing and sensing of a law that knows the joint's true motion.
pub fn timing(step_s: f64) -> Timing {
    Timing {
        step_s,
        delay_ticks: 1,
        sensing: Sensing::IDEAL,
    }
}

/// Follows a motion: calls `on_tick` with the number of steps and the torque after
/// each, N·m, and returns all events.
///
/// # Errors
/// [`SettingsError`] if the settings or the step are out of range.
pub fn follow<F: Real>(
    given: &Given,
    sampling: &Sampling<'_>,
    on_tick: &mut dyn FnMut(u64, f64),
) -> Result<Vec<SymptomEvent>, SettingsError> {
    let timing = timing(sampling.step_s());
    let run = Run {
        sampling,
        scale: timing.scale()?,
        on_tick,
    };
    let events = given
        .settings()
        .with_law::<F, _>(given.place(), &timing, run)?;
    Ok(events.unwrap_or_default())
}

struct Run<'a, F> {
    sampling: &'a Sampling<'a>,
    scale: Scale<F>,
    on_tick: &'a mut dyn FnMut(u64, f64),
}

impl<F: Real> LawVisitor<F> for Run<'_, F> {
    type Output = Vec<SymptomEvent>;

    fn visit<E: DeviceEffect<F>>(self, mut law: E) -> Vec<SymptomEvent> {
        let mut events = Vec::new();
        let mut walk = self.sampling.walk_from(0);
        let mut angle_rad = walk.now().0;
        law.rest(&Sensing::IDEAL.position(angle_rad));
        let mut chunk: Vec<(f64, ShaftStep<F>)> = Vec::with_capacity(CHUNK_STEPS);
        let mut n = 0;
        loop {
            walk.fill_with_angles(&mut chunk, CHUNK_STEPS);
            if chunk.is_empty() {
                return events;
            }
            for (end_rad, shaft) in &chunk {
                angle_rad = *end_rad;
                let place = Sensing::IDEAL.position(angle_rad);
                let torque_nm = tick(&mut law, shaft, place, &self.scale, |change| {
                    let fraction = change.fraction.to_f64();
                    let (from, to) = (shaft.omega_start_rad_s, shaft.omega_end_rad_s);
                    events.push(SymptomEvent {
                        time_s: self.sampling.time_s(n, fraction),
                        word: change.word,
                        omega_rad_s: from.to_f64() + fraction * (to - from).to_f64(),
                        before_nm: change.before_nm.to_f64(),
                        after_nm: change.after_nm.to_f64(),
                    });
                });
                n += 1;
                (self.on_tick)(n, torque_nm.to_f64());
            }
        }
    }
}
