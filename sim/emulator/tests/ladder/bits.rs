//! Equal bits on the target and on the host.

use crate::{ladder, taken};
use crepitus_ladder::{Plan, Subject};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters};
use crepitus_plant::effects;
use crepitus_scene::scene::Precision;
use crepitus_studies::accuracy::scenes::standard;
use crepitus_studies::accuracy::target::inputs::{Lengths, tasks};
use crepitus_studies::stability::{catalogue, replay, subject};

#[test]
fn every_rung_and_every_effect_gives_the_bits_of_the_host() {
    let Some(mut ladder) = ladder() else { return };
    let scenes = standard().unwrap();
    let mut steps = 0;
    for subject in Subject::all() {
        for task in tasks(subject, &scenes, Lengths::QUICK).unwrap() {
            let run = ladder.run_and_compare(&task.plan, &task.inputs);
            steps += run
                .unwrap_or_else(|e| panic!("{}: {e}", task.name))
                .calls
                .len();
        }
    }
    println!("{steps} steps, each the same to the bit");
    assert!(steps > 300_000, "{steps}");
}

/// H36: the six golden runs, on the target.
#[test]
fn the_target_reproduces_the_golden_bits() {
    let Some(mut ladder) = ladder() else { return };
    let cases = catalogue::all();
    let golden = cases.iter().find(|case| case.id == "H36").unwrap();
    let (mut runs, mut steps) = (0, 0);
    for solver in [Solver::ExactEvents, Solver::ExactBreak] {
        let of = subject::Subject {
            solver: subject::Rung::Ladder(solver),
            convention: Convention::Frozen,
            precision: Precision::F32,
        };
        for trial in (golden.trials)(of) {
            let hash = trial.criteria[0].torque_bits();
            #[expect(
                clippy::cast_possible_truncation,
                reason = "rounded once, as on the host"
            )]
            let plan = Plan {
                parameters: [trial.settings.parameters; 2],
                omega_rad_s: replay::omega_rad_s(&trial.input) as f32,
                ..Plan::of(Subject::Rung(Convention::Frozen, solver))
            };
            let inputs: Vec<_> = replay::steps(&trial.input)
                .unwrap()
                .iter()
                .map(taken)
                .collect();
            let run = ladder.run(&plan, &inputs).unwrap();
            let torques = run.outputs.iter().map(|output| f32::from_bits(output[0]));
            let found = replay::torque_hash(torques);
            println!(
                "{}, {}: {found:#018x}, {} steps on the target",
                solver.name(),
                trial.input,
                run.outputs.len()
            );
            assert_eq!(Some(found), hash, "{}, {}", solver.name(), trial.input);
            (runs, steps) = (runs + 1, steps + run.outputs.len());
        }
    }
    assert_eq!((runs, steps), (12, 282_000));
}

#[test]
fn effects_have_the_names_that_the_tool_lists() {
    let is_effect = |s: &Subject| matches!(s, Subject::Encoder | Subject::Effect(..));
    for subject in Subject::all().filter(is_effect) {
        assert!(
            effects::find(subject.name()).is_some(),
            "{}",
            subject.name()
        );
    }
}

#[test]
fn what_is_not_allowed_is_refused_and_the_next_plan_is_not() {
    let Some(mut ladder) = ladder() else { return };
    let good = Plan::of(Subject::Rung(Convention::Frozen, Solver::Exact));
    let bad = Plan {
        parameters: [Parameters {
            kinetic_torque_nm: 1.0,
            static_torque_nm: 0.5,
            ..Parameters::default()
        }; 2],
        ..good
    };
    assert!(ladder.run(&bad, &[]).is_err());
    let refused = Plan::of(Subject::Rung(Convention::Frozen, Solver::Rk4));
    assert!(ladder.run(&refused, &[]).is_err());
    assert_eq!(ladder.run(&good, &[]).unwrap().outputs.len(), 0);
}
