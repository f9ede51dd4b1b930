//! The symptoms besides crepitus: their error against the event-driven
//! reference, at every step and in both precisions, and their cost over that of
//! a step of crepitus.
//!
//! ```text
//! symptom in a form ─┬─> reference: true events, true torque ───┐
//!                    └─> law × precision × step × motion ───────┴─> errors ─┐
//!                        law and crepitus × precision × step, in turn ─> time ┴─> points ──> symptoms.csv
//! ```
//!
//! A symptom is at its defaults. It is followed by its law alone, on the true
//! motion: without check, tank and limit, which the reference has not either. The
//! errors are those of all [`motions`](motions::motions) together.
//!
//! What the play under a symptom does is no event here: `lead-pipe` has none. A symptom
//! whose law refuses a step has no point there.

pub mod motions;
pub mod table;
mod timing;

use crate::accuracy::steps::falling;
use crate::sampling::Sampling;
use crate::symptoms::Given;
use crate::symptoms::errors::{Errors, Truth};
use crate::symptoms::follow::timing as timing_of;
use crate::watcher::{StudyError, Watcher};
use crepitus_model::Real;
use crepitus_scene::scene::Precision;
use motions::motions;
use serde::Serialize;

/// The torques of shorter steps are compared about that often, s.
const COMPARED_EVERY_S: f64 = 5e-5;

/// A symptom in a precision at a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SymptomPoint {
    /// Name of the effect in scene files.
    pub symptom: &'static str,
    /// The form of its law, if it has several.
    pub form: Option<&'static str>,
    /// The precision.
    pub precision: &'static str,
    /// The step, s.
    pub step_s: f64,
    /// Events found.
    pub events: u64,
    /// Events of the reference.
    pub events_true: u64,
    /// Events of either without a partner.
    pub unmatched: u64,
    /// Worst error of an event's time, s; NaN without events.
    pub max_event_error_s: f64,
    /// Root mean square of it, s; NaN likewise.
    pub rms_event_error_s: f64,
    /// Largest torque error at the end of a step, N·m.
    pub max_tick_torque_error_nm: f64,
    /// Root mean square of it, N·m.
    pub rms_tick_torque_error_nm: f64,
    /// CPU time of the host per step, ns: median of interleaved repeats.
    pub ns_per_step: f64,
    /// That over the time of a step of crepitus, `exact-events` under `frozen`, in
    /// the same precision and of the same repeats.
    pub time_ratio: f64,
    /// Spread of the repeats: (third quartile − first quartile)/median.
    pub time_spread: f64,
}

impl SymptomPoint {
    /// The symptom, with its form in brackets: `cogwheel (space)`.
    pub fn name(&self) -> String {
        match self.form {
            Some(form) => format!("{} ({form})", self.symptom),
            None => self.symptom.to_owned(),
        }
    }
}

/// Plan of the study of symptoms.
#[derive(Clone, Copy, Debug)]
pub struct SymptomPlan<'a> {
    /// The steps, s.
    pub steps_s: &'a [f64],
    /// The precisions.
    pub precisions: &'a [Precision],
    /// Repeats of each timing.
    pub repeats: usize,
}

/// Studies every symptom in every form, by symptom, form, precision and falling step.
///
/// # Errors
/// Error of the watcher, or a step that no device has.
pub fn points(
    plan: &SymptomPlan<'_>,
    watcher: &mut dyn Watcher,
) -> Result<Vec<SymptomPoint>, StudyError> {
    let all = Given::all();
    let steps_s = falling(plan.steps_s);
    // A shorter step is more work.
    let work = |step_s: f64| 1e-6 + 1.0 / step_s;
    let total = steps_s.iter().map(|h| work(*h)).sum::<f64>();
    let mut done = 0.0;
    let mut points = Vec::new();
    for &step_s in &steps_s {
        // The memory of a reflex is too short for its delay in steps below 25 µs.
        let has_a_law = |given: &&Given| given.settings().laws::<f64>(&timing_of(step_s)).is_ok();
        let symptoms: Vec<Given> = all.iter().filter(has_a_law).cloned().collect();
        let costs = timing::time(&symptoms, plan, step_s, || watcher.progress(done / total))?;
        for (n, given) in (0_u32..).zip(&symptoms) {
            let errors = errors(given, plan.precisions, step_s)?;
            let here = errors.iter().zip(plan.precisions);
            points.extend(here.map(|(errors, precision)| {
                point(
                    given,
                    *precision,
                    step_s,
                    errors,
                    &costs.of(given, *precision),
                )
            }));
            let share = f64::from(n + 1) / 10.0_f64.max(f64::from(n + 1));
            let now = (done + work(step_s) * share) / total;
            watcher.progress(now.min(1.0))?;
        }
        done += work(step_s);
    }
    // By symptom and precision, so that a curve's points are together.
    let place = |p: &SymptomPoint| {
        let own = |g: &Given| g.effect == p.symptom && g.form() == p.form;
        let precision = plan.precisions.iter().position(|q| q.name() == p.precision);
        (all.iter().position(own), precision)
    };
    points.sort_by_key(place);
    Ok(points)
}

/// The errors on all motions together, in each precision.
fn errors(given: &Given, precisions: &[Precision], step_s: f64) -> Result<Vec<Errors>, StudyError> {
    let mut all = vec![Errors::default(); precisions.len()];
    for (_, hand, duration_s) in motions() {
        let motion = hand.motion();
        let sampling = Sampling::new(&motion, duration_s, step_s);
        let stride = (COMPARED_EVERY_S / step_s).round().whole().max(1);
        let truth = Truth::new(given, &motion, &sampling, stride)?;
        for (errors, precision) in all.iter_mut().zip(precisions) {
            match precision {
                Precision::F32 => errors.add::<f32>(given, &sampling, &truth)?,
                Precision::F64 => errors.add::<f64>(given, &sampling, &truth)?,
            }
        }
    }
    Ok(all)
}

fn point(
    given: &Given,
    precision: Precision,
    step_s: f64,
    errors: &Errors,
    cost: &timing::SymptomCost,
) -> SymptomPoint {
    SymptomPoint {
        symptom: given.effect,
        form: given.form(),
        precision: precision.name(),
        step_s,
        events: errors.events,
        events_true: errors.events_true,
        unmatched: errors.unmatched,
        max_event_error_s: errors.event_s.most(),
        rms_event_error_s: errors.event_s.rms(),
        max_tick_torque_error_nm: errors.torque_nm.most(),
        rms_tick_torque_error_nm: errors.torque_nm.rms(),
        ns_per_step: cost.ns_per_step,
        time_ratio: cost.ratio,
        time_spread: cost.spread,
    }
}

#[cfg(test)]
mod tests;
