//! The `[solver]` table, and the step of the trace that goes with it.

use crate::document::{Range, Section};
use crate::error::SceneError;
use crepitus_model::solver::Solver;

/// The most steps of one run, and the most rows of one trace.
const MOST_STEPS: f64 = 1e12;

/// Solver that integrates the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolverChoice {
    /// Reference solver, from event to event on the true motion, in f64.
    Reference,
    /// A rung of the ladder.
    Ladder {
        /// The rung.
        solver: Solver,
        /// Step of the rung, s.
        step_s: f64,
        /// Precision of the rung.
        precision: Precision,
    },
}

crepitus_model::named! {
    /// The numbers that the model computes with.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Precision {
        /// Single, as on the device.
        F32 => "f32",
        /// Double.
        F64 => "f64",
    }
}

impl SolverChoice {
    /// Names of all solvers, cheapest first.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Solver::ALL.iter().map(|s| s.name()).chain([REFERENCE])
    }

    /// Name in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reference => REFERENCE,
            Self::Ladder { solver, .. } => solver.name(),
        }
    }
}

/// Name of the event-driven solver.
pub(super) const REFERENCE: &str = "reference";

pub(super) fn read_solver(section: &Section<'_>) -> Result<(SolverChoice, u32), SceneError> {
    let ladder = Solver::ALL.map(|s| (s.name(), Some(s)));
    let names: Vec<_> = ladder.into_iter().chain([(REFERENCE, None)]).collect();
    let kind = section.choice("kind", &names)?;
    let step_s = section.optional_number("step_s", Range::above(0.0, 1.0))?;
    let precisions = [Precision::F32, Precision::F64].map(|p| (p.name(), p));
    let precision = section.choice_or("precision", &precisions, Precision::F64)?;
    let substeps = read_substeps(section)?;
    section.finish()?;
    let choice = match kind {
        None => {
            if step_s.is_some() {
                return Err(section.key_error("step_s", "\"reference\" has no step: leave it out"));
            }
            if precision == Precision::F32 {
                return Err(section.key_error("precision", "\"reference\" computes in f64 only"));
            }
            SolverChoice::Reference
        }
        Some(solver) => SolverChoice::Ladder {
            solver,
            step_s: step_s.ok_or_else(|| {
                section.key_error(
                    "step_s",
                    format!(
                        "this key is missing: \"{}\" needs a step in seconds, for example 5e-5",
                        solver.name()
                    ),
                )
            })?,
            precision,
        },
    };
    Ok((choice, substeps))
}

/// Steps of the plant in one of the solver: the device's tick stays what it
/// is.
fn read_substeps(section: &Section<'_>) -> Result<u32, SceneError> {
    match section.number_or("substeps", Range::closed(1.0, 1000.0), 1.0)? {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and in range"
        )]
        x if x.fract() == 0.0 => Ok(x as u32),
        x => Err(section.key_error("substeps", format!("{x} is not a whole number"))),
    }
}

/// Time between trace rows: a whole number of solver steps, at least one.
pub(super) fn read_trace_step(
    output: Option<&Section<'_>>,
    solver_section: &Section<'_>,
    solver: SolverChoice,
    duration_s: f64,
) -> Result<f64, SceneError> {
    /// Step of `reference`, which has none of its own: the device's tick.
    const DEFAULT_STEP_S: f64 = 5e-5;
    let wanted = match output {
        None => None,
        Some(section) => section.optional_number("trace_step_s", Range::above(0.0, 1e7))?,
    };
    let refuse = |message: String| match (output, wanted) {
        (Some(section), Some(_)) => section.key_error("trace_step_s", message),
        _ => solver_section.key_error("step_s", message),
    };
    let step_s = match solver {
        SolverChoice::Reference => wanted.unwrap_or(DEFAULT_STEP_S),
        SolverChoice::Ladder { step_s, .. } => {
            if duration_s / step_s > MOST_STEPS {
                return Err(solver_section.key_error(
                    "step_s",
                    format!("steps of {step_s} s are more than {MOST_STEPS:e} in {duration_s} s"),
                ));
            }
            if duration_s < step_s * (1.0 - 1e-9) {
                return Err(solver_section.key_error(
                    "step_s",
                    format!("a step of {step_s} s is longer than the run of {duration_s} s"),
                ));
            }
            // A step that is set from outside may be longer than the scene's rows are apart.
            let wanted = wanted.map_or(step_s, |wanted| wanted.max(step_s));
            let steps = wanted / step_s;
            if (steps - steps.round()).abs() > 1e-6 * steps {
                return Err(refuse(format!(
                    "{wanted} s is not a whole number of steps of {step_s} s"
                )));
            }
            wanted
        }
    };
    if duration_s / step_s > MOST_STEPS {
        return Err(refuse(format!(
            "rows every {step_s} s are more than {MOST_STEPS:e} in {duration_s} s"
        )));
    }
    Ok(step_s)
}
