//! Runs of whole scenes against closed forms, and laws that hold for all.

mod refused_samples;
mod warnings;

use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_scene::run::{Diverged, RunError, TorqueSummary};
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Observer, Overrides, Scene, Summary, run};
use std::convert::Infallible;
use std::path::Path;

/// Keeps everything.
#[derive(Default)]
struct Keep {
    rows: Vec<Vec<f64>>,
    events: Vec<EventRecord>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        assert!(self.rows.last().is_none_or(|row| row[0] <= event.time_s));
        self.events.push(*event);
        Ok(())
    }
}

/// A scene from its parts.
fn scene(duration_s: f64, motion: &str, solver: &str, effects: &str) -> Scene {
    let text = format!(
        "version = 1\ntitle = \"test\"\nduration_s = {duration_s:?}\n[motion]\n{motion}\n[solver]\n{solver}\n{effects}\n"
    );
    Scene::parse(Path::new("test.toml"), &text, &Overrides::default()).unwrap()
}

fn simulate(scene: &Scene) -> (Keep, Summary) {
    let mut keep = Keep::default();
    let summary = run(scene, &mut keep).unwrap();
    (keep, summary)
}

const EXACT_EVENTS: &str = "kind = \"exact-events\"\nstep_s = 5e-5";
const REFERENCE: &str = "kind = \"reference\"";
const ONE_RAD_S: &str = "kind = \"constant\"\nvelocity_rad_s = 1.0";
const KNEE_PASS: &str = "kind = \"sine\"\namplitude_deg = 45\nfrequency_hz = 0.25\nphase_deg = -90";

fn crepitus(convention: &str) -> String {
    format!("[effects.crepitus]\nconvention = \"{convention}\"")
}

#[test]
fn the_pass_has_124_cycles_frozen_and_a_few_with_a_velocity_match() {
    for (convention, breaks) in [("frozen", 124), ("physical", 3), ("paper", 5)] {
        for solver in [EXACT_EVENTS, REFERENCE] {
            let (keep, summary) = simulate(&scene(4.0, KNEE_PASS, solver, &crepitus(convention)));
            assert_eq!(
                summary.events.unwrap().breaks,
                breaks,
                "{convention} {solver}"
            );
            assert_eq!(keep.rows.len(), 80_001);
        }
    }
}

#[test]
fn mean_torque_over_whole_cycles_is_the_kinetic_torque() {
    for convention in ["frozen", "paper", "physical"] {
        for omega in [0.05_f64, 0.5, 2.0] {
            let lambda = 0.2 / (omega * 2.0);
            let cycle = (2.0 * std::f64::consts::PI + 2.0 * (lambda - lambda.atan())) / 200.0;
            let first_break = 0.4 / (400.0 * omega);
            let motion = format!("kind = \"constant\"\nvelocity_rad_s = {omega}");
            let impulse = |end_s: f64| {
                // One row, at the end: the run stops exactly there.
                let effects = format!(
                    "{}\n[output]\ntrace_step_s = {end_s:?}",
                    crepitus(convention)
                );
                let (_, summary) = simulate(&scene(end_s, &motion, REFERENCE, &effects));
                summary.torque.unwrap().mean_nm * summary.simulated_s
            };
            let mean =
                (impulse(first_break + 20.0 * cycle) - impulse(first_break)) / (20.0 * cycle);
            assert!(
                (mean - 0.2).abs() < 1e-13,
                "{convention} {omega} rad/s: {mean}"
            );
        }
    }
}

#[test]
fn cycle_frequency_is_the_closed_form() {
    for omega in [0.05_f64, 0.3, 1.0, 3.0] {
        let lambda = 0.2 / (omega * 2.0);
        let expected = 200.0 / (2.0 * std::f64::consts::PI + 2.0 * (lambda - lambda.atan()));
        let motion = format!("kind = \"constant\"\nvelocity_rad_s = {omega}");
        for convention in ["frozen", "paper", "physical"] {
            let (_, summary) = simulate(&scene(10.0, &motion, EXACT_EVENTS, &crepitus(convention)));
            let frequency = summary.cycles.unwrap().frequency_hz.unwrap();
            assert!(
                (frequency / expected - 1.0).abs() < 1e-13,
                "{convention} {omega}: {frequency}"
            );
        }
    }
}

#[test]
fn energy_balances_to_rounding() {
    let strokes =
        "kind = \"strokes\"\nfrom_deg = 0\nto_deg = 40\npeak_speed_deg_s = 60\npause_s = 0.2";
    let damped = "[effects.crepitus]\nconvention = \"physical\"\ndamping_nms_per_rad = 0.002";
    // Slips with equal torques go on without an event, each with the shaft's velocity of then.
    let equal = "[effects.crepitus]\nkinetic_torque_nm = 0.2\nstatic_torque_nm = 0.2";
    for solver in [EXACT_EVENTS, REFERENCE] {
        for motion in [ONE_RAD_S, KNEE_PASS, strokes] {
            for effects in [
                &crepitus("frozen"),
                &crepitus("paper"),
                &crepitus("physical"),
                damped,
                equal,
            ] {
                let (_, summary) = simulate(&scene(4.0, motion, solver, effects));
                let energy = summary.energy.unwrap();
                assert!(energy.work_in_j > 0.01);
                assert!(
                    energy.residual_relative.abs() < 1e-10,
                    "{solver} {motion} {effects}: {energy:?}"
                );
            }
        }
    }
}

#[test]
fn physical_conserves_energy_without_any_convention_term() {
    let (_, summary) = simulate(&scene(10.0, KNEE_PASS, EXACT_EVENTS, &crepitus("physical")));
    assert_eq!(summary.energy.unwrap().convention_j, 0.0);
}

/// Worst event error of `exact-events` against `reference`, s.
fn sampled_error(motion: &str, convention: &str, step_s: &str, precision: &str) -> f64 {
    let solver = format!("kind = \"exact-events\"\nstep_s = {step_s}\nprecision = \"{precision}\"");
    let effects = crepitus(convention);
    let (sampled, _) = simulate(&scene(4.0, motion, &solver, &effects));
    let (truth, _) = simulate(&scene(4.0, motion, REFERENCE, &effects));
    assert_eq!(
        sampled.events.len(),
        truth.events.len(),
        "{motion} {convention} {step_s} {precision}"
    );
    sampled
        .events
        .iter()
        .zip(&truth.events)
        .map(|(a, b)| {
            assert_eq!((a.kind, a.from, a.to), (b.kind, b.from, b.to));
            (a.time_s - b.time_s).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn frozen_on_a_sampled_sine_is_of_second_order() {
    let errors =
        ["4e-4", "2e-4", "1e-4", "5e-5"].map(|h| sampled_error(KNEE_PASS, "frozen", h, "f64"));
    println!("worst event errors at 400, 200, 100, 50 µs: {errors:?} s");
    assert!(errors[3] <= 1e-7);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.4, "order {order:.2}: {errors:?}");
    }
}

#[test]
fn single_precision_follows_the_same_events() {
    let reversal = "kind = \"sine\"\namplitude_rad = 0.003\nfrequency_hz = 1";
    for (motion, convention, allowed) in [
        (KNEE_PASS, "frozen", 5e-6),
        (reversal, "frozen", 5e-6),
        (reversal, "paper", 2e-5),
        (reversal, "physical", 2e-5),
    ] {
        let error = sampled_error(motion, convention, "5e-5", "f32");
        println!("{convention}: {error:.1e} s");
        assert!(error <= allowed, "{motion} {convention}: {error:e} s");
    }
}

#[test]
fn torque_never_exceeds_the_static_limit() {
    let violent = "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 0 }, \
        { t_s = 0.3, omega_left_rad_s = 9, omega_right_rad_s = -9 }, { t_s = 0.5, omega_rad_s = 4 }, \
        { t_s = 0.52, omega_rad_s = 0 }, { t_s = 0.7, omega_left_rad_s = 0, omega_right_rad_s = 0.4 }]";
    for convention in ["frozen", "paper", "physical"] {
        for solver in ["exact", "exact-events"] {
            for precision in ["f32", "f64"] {
                let solver =
                    format!("kind = \"{solver}\"\nstep_s = 5e-5\nprecision = \"{precision}\"");
                let (keep, summary) =
                    simulate(&scene(1.0, violent, &solver, &crepitus(convention)));
                let limit = f64::from(0.4_f32);
                assert!(keep.rows.iter().all(|row| row[6].abs() <= limit));
                let torque = summary.torque.unwrap();
                assert!(torque.max_nm <= limit && torque.min_nm >= -limit);
            }
        }
    }
}

/// The laws of what a summary says of the torque.
fn assert_within_what_was_shown(torque: &TorqueSummary, label: &str) {
    let label = format!("{label}: {torque:?}");
    let rounding = 1e-9 * (torque.max_nm - torque.min_nm);
    assert!(torque.mean_nm >= torque.min_nm - rounding, "{label}");
    assert!(torque.mean_nm <= torque.max_nm + rounding, "{label}");
    let most_nm = torque.max_nm.max(-torque.min_nm);
    assert!(torque.rms_nm <= most_nm + rounding, "{label}");
}

/// Includes steps that are far too long for the damping, and find the break at their end only.
#[test]
fn what_a_summary_says_of_the_torque_is_within_what_was_shown() {
    let motion =
        "kind = \"strokes\"\nfrom_deg = 5\nto_deg = 4\npeak_speed_deg_s = 421\npause_s = 0.003\n";
    let mut runs = 0;
    for solver in Solver::ALL {
        for convention in Convention::ALL {
            if solver.refusal(convention).is_some() {
                continue;
            }
            for (damping, step) in [
                ("0.0", "2e-3"),
                ("0.0", "4e-2"),
                ("0.03", "2e-3"),
                ("500000.0", "2e-3"),
            ] {
                let is_frozen = convention == Convention::Frozen;
                if is_frozen && damping != "0.0" {
                    continue;
                }
                let name = convention.name();
                let effects = format!("{}\ndamping_nms_per_rad = {damping}\n", crepitus(name));
                let ladder = format!("kind = \"{}\"\nstep_s = {step}\n", solver.name());
                let scene = scene(1.52, motion, &ladder, &effects);
                let Ok(summary) = run(&scene, &mut Keep::default()) else {
                    // An explicit rung beyond its limit of stability.
                    continue;
                };
                let torque = summary.torque.expect("a joint");
                let label = format!("{}, {name}, {damping}, {step}", solver.name());
                assert_within_what_was_shown(&torque, &label);
                runs += 1;
            }
        }
    }
    assert!(runs > 60, "{runs}");
}

#[test]
fn a_plant_that_diverges_is_not_the_solvers_fault() {
    let hand = "[effects.crepitus]\n[effects.spasticity]\nform = \"reflex\"\n\
        [effects.hand]\nstiffness_n_per_m = 0\n[effects.limb]\n";
    let motion = "kind = \"constant\"\nvelocity_rad_s = 10";
    let solver = "kind = \"exact-events\"\nstep_s = 0.5";
    let text = format!(
        "version = 1\ntitle = \"t\"\nduration_s = 6\ndevice = true\n[motion]\n{motion}\n[solver]\n{solver}\n{hand}"
    );
    let scene = Scene::parse(Path::new("t.toml"), &text, &Overrides::default()).unwrap();
    let mut kept = Keep::default();
    let error = run(&scene, &mut kept).expect_err("steps of half a second");
    assert!(matches!(error, RunError::Diverged(Diverged::Shaft { .. })));
    let text = error.to_string();
    assert!(
        text.contains("angle or speed is no number, or above 1e15, with steps of 0.5 s"),
        "{text}"
    );
    // Up to there its trace holds numbers.
    assert!(kept.rows.iter().flatten().all(|x| x.is_finite()));
}

#[test]
fn a_velocity_jump_between_steps_tears_a_physical_stick_loose() {
    let jump = "kind = \"velocity-knots\"\nknots = [{ t_s = 0, omega_rad_s = 0.1 }, \
        { t_s = 0.002, omega_left_rad_s = 0.1, omega_right_rad_s = 0.5 }]";
    for solver in [EXACT_EVENTS, REFERENCE] {
        let first = |convention| {
            simulate(&scene(0.05, jump, solver, &crepitus(convention)))
                .0
                .events[0]
        };
        assert!((first("physical").time_s - 0.002).abs() < 1e-15);
        assert!((first("physical").theta_rad - 2e-4).abs() < 1e-15);
        // A frozen stick does not notice: it breaks at its limit.
        assert!((first("frozen").theta_rad - 1e-3).abs() < 1e-15);
    }
}

#[test]
fn an_encoder_changes_the_cycle_rate_by_less_than_a_percent() {
    for omega in [0.3, 1.0, 2.0] {
        let motion = format!("kind = \"constant\"\nvelocity_rad_s = {omega}");
        let rate = |encoder: &str| {
            let effects = format!("{}\n{encoder}", crepitus("frozen"));
            let (_, summary) = simulate(&scene(5.0, &motion, EXACT_EVENTS, &effects));
            summary.cycles.unwrap().frequency_hz.unwrap()
        };
        let (ideal, seen) = (rate(""), rate("[effects.encoder]"));
        assert!(
            (seen / ideal - 1.0).abs() < 0.01,
            "{omega} rad/s: {seen} Hz for {ideal} Hz"
        );
    }
}

/// Friction never pushes the shaft along where a slip ends at a velocity match;
/// a frozen slip does when the hand slows, and both kinds of run report the same.
#[test]
fn a_slip_that_outlasts_its_match_is_reported() {
    for convention in ["paper", "physical"] {
        for solver in [EXACT_EVENTS, REFERENCE] {
            let (_, summary) = simulate(&scene(2.0, KNEE_PASS, solver, &crepitus(convention)));
            let lead = summary.lead.unwrap();
            assert_eq!((lead.behind_s, lead.behind_j), (0.0, 0.0), "{convention}");
            assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
        }
    }
    let frozen = |solver| {
        let scene = scene(2.0, KNEE_PASS, solver, &crepitus("frozen"));
        let summary = simulate(&scene).1;
        assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
        summary.lead.unwrap()
    };
    let (stepped, reference) = (frozen(EXACT_EVENTS), frozen(REFERENCE));
    println!("frozen knee pass: {reference:?}, stepped {stepped:?}");
    assert!(reference.behind_s > 1e-2 && reference.behind_j > 1e-6);
    // A few slips around the turn of the knee, each looked at now and then.
    assert!((stepped.behind_s / reference.behind_s - 1.0).abs() < 0.3);
    assert!((stepped.behind_j / reference.behind_j - 1.0).abs() < 0.3);
    // A solver that looks at the ends of its steps is late by less than one.
    let coarse = "kind = \"exact\"\nstep_s = 5e-3";
    let quick = "kind = \"sine\"\namplitude_deg = 45\nfrequency_hz = 2";
    let (_, summary) = simulate(&scene(2.0, quick, coarse, &crepitus("physical")));
    assert_eq!(summary.lead.unwrap().behind_s, 0.0, "seen at its ends");
}
