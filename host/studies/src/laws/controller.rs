//! The laws on the controller: a plan and its inputs for each of them.
//!
//! ```text
//! law, joint, steps ──> subject of the ladder, plan, inputs ──> on_target ──> calls ──> costs
//! ```

use super::costs::{on_controller, place_of};
use super::runner::TICK_S;
use super::study::LawStudy;
use crate::accuracy::target::TargetError;
use crate::watcher::Watcher;
use crepitus_ladder::exchange::Input;
use crepitus_ladder::{Call, Plan, Subject};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, ShaftStep};

/// Runs the laws of a study on the controller, fitted to this joint, and adds what a step costs.
/// `on_target` gets a plan and its inputs, and returns what each step cost.
///
/// # Errors
/// Error of the controller or of the watcher.
pub fn add<T>(
    study: &mut LawStudy,
    joint: &Parameters,
    mut on_target: impl FnMut(&Plan, &[Input]) -> Result<Vec<Call>, T>,
    watcher: &mut dyn Watcher,
) -> Result<(), TargetError<T>> {
    let run = |law: &'static str, joint: &Parameters, steps: &[ShaftStep<f32>]| {
        let Some(subject) = subject(law) else {
            return Ok(Vec::new());
        };
        let plan = Plan {
            parameters: [*joint; 2],
            step_s: TICK_S,
            omega_rad_s: steps.first().map_or(0.0, |step| step.omega_start_rad_s),
            ..Plan::of(subject)
        };
        let inputs: Vec<Input> = steps.iter().map(input).collect();
        on_target(&plan, &inputs)
    };
    on_controller(&mut study.costs, joint, run, watcher)
}

fn input(step: &ShaftStep<f32>) -> Input {
    let numbers = [
        step.delta_phi_rad,
        step.omega_start_rad_s,
        step.omega_end_rad_s,
    ];
    Input {
        words: numbers.map(f32::to_bits),
        ..Input::default()
    }
}

/// The subject of the ladder that is this law; our joint is a rung of it.
pub fn subject(law: &str) -> Option<Subject> {
    let ours = Convention::ALL
        .into_iter()
        .find(|convention| convention.name() == law);
    match ours {
        Some(convention) => Some(Subject::Rung(convention, Solver::ExactEvents)),
        None => Some(Subject::Law(u8::try_from(place_of(law)?).ok()?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_ladder::laws::ENTRIES;

    #[test]
    fn every_law_has_a_subject_of_its_name() {
        for entry in ENTRIES {
            let subject = subject(entry.name).expect("a subject");
            let name = if entry.is_ours() {
                subject.convention().map_or("", Convention::name)
            } else {
                subject.name()
            };
            assert_eq!(name, entry.name);
        }
        assert_eq!(subject("glue"), None);
    }
}
