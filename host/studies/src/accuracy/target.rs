//! The second axis: cost of a step on the device's core.
//!
//! The caller runs the ladder there and returns the cycles and instructions of
//! each step; this module says what to run, and joins the numbers with errors.
//!
//! ```text
//! scenes at the device's tick ──┐
//! hard inputs for the worst ────┴─> on_target(plan, inputs) ─> calls ─┬─> points
//!                                                                     └─> rows
//! ```
//!
//! The mean of a rung is over the study's scenes, a part of each, that of a
//! symptom over the motions of symptoms; the worst
//! is the worst *observed*, over those and hard [`inputs`] with breaks,
//! matches and reversals. It is not a bound.

pub mod inputs;
pub mod recorded;
pub mod table;

use crate::accuracy::point::Point;
use crate::accuracy::scenes::StudyScene;
use crate::watcher::{StudyError, Watcher};
use crepitus_ladder::exchange::Input;
use crepitus_ladder::{Call, Cost, Plan, Subject};
use crepitus_model::{Convention, Real, SettingsError};
use crepitus_scene::scene::Precision;
use inputs::{Lengths, Task};
use serde::Serialize;

/// Core cycles of a tick of the device: 50 µs at 168 MHz.
pub const TICK_CYCLES: f64 = 8_400.0;

/// The share of a tick that the worst observed step of a rung may take on the
/// target: a fifth, 1,680 cycles. Sampling, guard, compensation, limits,
/// current loop and link share the rest.
pub const STEP_SHARE: f64 = 0.2;

/// Label of the numbers.
pub const LABEL: &str = "modelled cycles, 0 wait states; not measured on hardware";

/// Costs of the ladder on the target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnTarget {
    /// Label of the numbers.
    pub label: &'static str,
    /// Core cycles of a tick of the device.
    pub tick_cycles: f64,
    /// Steps that were run, each the same to the bit as on the host.
    pub steps: u64,
    /// The rungs by convention, then the device's other code.
    pub rows: Vec<Row>,
}

/// The cost of a subject.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the rung in scene files, or of the effect in `crepitus
    /// effects`.
    pub subject: &'static str,
    /// The form of the effect's law, if it has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<&'static str>,
    /// The convention of its joint.
    pub convention: Option<&'static str>,
    /// Whether it is a rung of the ladder.
    pub is_rung: bool,
    /// Relative error of the cycle frequency in f32 at the device's tick, the
    /// worst of the study's scenes; NaN without, or if events are wrong.
    pub frequency_error_rel: f64,
    /// Mean cycles of a step on the study's scenes; of a symptom on the
    /// [motions](crate::accuracy::symptoms::motions) of symptoms.
    pub mean_cycles: f64,
    /// Most cycles observed in a step.
    pub worst_cycles: u32,
    /// The input of that step.
    pub worst_on: String,
    /// Mean instructions of a step on the study's scenes.
    pub mean_instructions: f64,
    /// Most instructions observed in a step.
    pub worst_instructions: u32,
    /// The mean as a share of a tick.
    pub mean_share: f64,
    /// The worst as a share of a tick.
    pub worst_share: f64,
    /// Steps that were run.
    pub steps: u64,
}

/// Reason why there is no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError<T> {
    /// The target failed.
    #[error("the target: {0}")]
    Target(T),
    /// The study ended early.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl<T> From<SettingsError> for TargetError<T> {
    fn from(error: SettingsError) -> Self {
        Self::Study(error.into())
    }
}

/// Runs every subject on the target. Adds the costs to the study's points in f32 at the
/// device's tick, and returns all of them as a separate table.
///
/// # Errors
/// Errors of the target or the watcher, or contradictory settings.
pub fn costs<T>(
    points: &mut [Point],
    scenes: &[StudyScene],
    lengths: Lengths,
    mut on_target: impl FnMut(&Plan, &[Input]) -> Result<Vec<Call>, T>,
    watcher: &mut dyn Watcher,
) -> Result<OnTarget, TargetError<T>> {
    let mut on = OnTarget {
        label: LABEL,
        tick_cycles: TICK_CYCLES,
        steps: 0,
        rows: Vec::new(),
    };
    let subjects: Vec<Subject> = Subject::all()
        .filter(|subject| is_studied(*subject, scenes))
        .collect();
    let mut done = 0.0;
    for subject in &subjects {
        let tasks = inputs::tasks(*subject, scenes, lengths)?;
        let each = 1.0 / whole(tasks.len() * subjects.len());
        let mut cost_of_subject = SubjectCost::default();
        for task in &tasks {
            let calls = on_target(&task.plan, &task.inputs).map_err(TargetError::Target)?;
            let cost = Cost::of(&calls);
            cost_of_subject.add(task, &cost);
            if let (Some(scene), Subject::Rung(_, solver)) = (task.scene, subject) {
                note(points, scene, solver.name(), &cost);
            }
            done += each;
            watcher
                .progress(f64::min(done, 1.0))
                .map_err(StudyError::from)?;
        }
        on.steps += cost_of_subject.all.calls;
        let frequency = frequency_error(points, *subject, scenes);
        on.rows.push(cost_of_subject.row(*subject, frequency));
    }
    Ok(on)
}

fn whole(n: usize) -> f64 {
    f64::from_whole(u64::try_from(n).unwrap_or(u64::MAX))
}

/// A subject with a joint is studied under the conventions of the scenes; friction laws are not
/// here.
fn is_studied(subject: Subject, scenes: &[StudyScene]) -> bool {
    subject.law().is_none()
        && subject.convention().is_none_or(|convention| {
            let mut conventions = scenes.iter().map(|scene| scene.settings.convention);
            conventions.any(|here| here == convention)
        })
}

impl Row {
    /// Name of the subject, with the form in brackets: `cogwheel (space)`.
    pub fn name(&self) -> String {
        match self.form {
            Some(form) => format!("{} ({form})", self.subject),
            None => self.subject.to_owned(),
        }
    }
}

/// Returns whether a point has the device's precision and tick, and the shaft's true motion.
fn is_on_the_device(point: &Point) -> bool {
    point.is_exact()
        && point.precision == Precision::F32.name()
        && (point.step_s - inputs::TICK_S).abs() < 1e-6 * inputs::TICK_S
}

/// The worst frequency error of a rung under its convention.
fn frequency_error(points: &[Point], subject: Subject, scenes: &[StudyScene]) -> f64 {
    let Subject::Rung(convention, solver) = subject else {
        return f64::NAN;
    };
    let points = points.iter().filter(|point| {
        is_on_the_device(point)
            && point.convention == convention.name()
            && point.solver == solver.name()
            && scenes.iter().any(|scene| scene.name == point.scene)
    });
    let errors = points.map(|point| {
        if point.unmatched == 0 {
            point.frequency_error_rel
        } else {
            f64::NAN
        }
    });
    // NaN, for not known, is the worst.
    errors
        .reduce(|a, b| if a.is_nan() || a > b { a } else { b })
        .unwrap_or(f64::NAN)
}

/// Adds the cost of a rung to its point.
fn note(points: &mut [Point], scene: &StudyScene, solver: &str, cost: &Cost) {
    let point = points.iter_mut().find(|point| {
        is_on_the_device(point)
            && point.scene == scene.name
            && point.convention == scene.convention()
            && point.solver == solver
    });
    if let Some(point) = point {
        point.cycles_per_step = cost.mean_cycles();
        point.worst_cycles = cost.worst_cycles.into();
        point.instructions_per_step = cost.mean_instructions();
    }
}

/// Cost of a subject.
#[derive(Default)]
struct SubjectCost {
    /// Cost on the scenes of the study.
    usual: Cost,
    all: Cost,
    worst_on: String,
}

impl SubjectCost {
    fn add(&mut self, task: &Task<'_>, cost: &Cost) {
        if task.is_usual {
            self.usual.add(cost);
        }
        if cost.worst_cycles > self.all.worst_cycles {
            self.worst_on.clone_from(&task.name);
        }
        self.all.add(cost);
    }

    fn row(self, subject: Subject, frequency_error_rel: f64) -> Row {
        let mean_cycles = self.usual.mean_cycles();
        Row {
            subject: subject.name(),
            form: subject.form(),
            convention: subject.convention().map(Convention::name),
            is_rung: matches!(subject, Subject::Rung(..)),
            frequency_error_rel,
            mean_cycles,
            worst_cycles: self.all.worst_cycles,
            worst_on: self.worst_on,
            mean_instructions: self.usual.mean_instructions(),
            worst_instructions: self.all.worst_instructions,
            mean_share: mean_cycles / TICK_CYCLES,
            worst_share: f64::from(self.all.worst_cycles) / TICK_CYCLES,
            steps: self.all.calls,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;
    use crate::accuracy::study;
    use crate::watcher::Cancelled;
    use crepitus_ladder::exchange::Kind;
    use crepitus_model::render::effects::SPECS;

    struct Nobody;

    impl Watcher for Nobody {
        fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
            assert!(fraction <= 1.0);
            Ok(())
        }
    }

    #[test]
    fn costs_are_in_the_points_of_the_same_rung() {
        let mut scenes = standard().unwrap();
        scenes.truncate(1);
        scenes[0].duration_s = 0.1;
        let plan = study::Plan {
            scenes: scenes.clone(),
            steps_s: vec![1e-4, 5e-5],
            precisions: vec![Precision::F32, Precision::F64],
            repeats: 1,
        };
        let mut study = study::run(&plan, &mut Nobody).unwrap();
        let lengths = Lengths {
            scene: 10,
            hard: 30,
        };
        // A tick without a sample costs more than any other.
        let on_target = |_: &Plan, inputs: &[Input]| -> Result<Vec<Call>, ()> {
            let call = |input: &Input| Call {
                cycles: if input.kind == Kind::Lost { 900 } else { 100 },
                instructions: 50,
                path: 0,
            };
            Ok(inputs.iter().map(call).collect())
        };
        let on = costs(&mut study.points, &scenes, lengths, on_target, &mut Nobody).unwrap();
        let names: Vec<_> = on.rows.iter().map(|row| row.subject).collect();
        let rungs = ["exact", "exact-break", "exact-interpolated", "exact-events"];
        assert_eq!(names[..4], rungs);
        let effects = Subject::all().filter(|s| matches!(s, Subject::Effect(..)));
        let effects = effects.count();
        assert!(effects > SPECS.len());
        assert_eq!((names[4], names.len()), ("input check", 8 + effects));
        assert_eq!(
            (on.rows[3].worst_cycles, on.rows[4].worst_cycles),
            (100, 900)
        );
        assert_eq!(on.rows[4].worst_on, "gaps");
        assert_eq!(
            (on.rows[4].mean_cycles, on.rows[4].mean_instructions),
            (100.0, 50.0)
        );
        for point in &study.points {
            let is_known = point.precision == "f32" && point.step_s == 5e-5;
            assert_eq!(point.cycles_per_step == 100.0, is_known, "{point:?}");
        }
    }
}
