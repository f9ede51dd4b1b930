//! Motions that break within a step, and limits that are met exactly: a step is split where the motion breaks, and
//! what the joint and the symptoms make of it is what the event-driven reference makes of it.

use crepitus_model::Convention;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::solver::Solver;
use crepitus_scene::trace::{EventRecord, SymptomEvent};
use crepitus_scene::{Observer, Overrides, Scene, run};
use std::convert::Infallible;
use std::path::Path;

#[derive(Default)]
struct Keep {
    rows: Vec<Vec<f64>>,
    joint: Vec<EventRecord>,
    symptoms: Vec<SymptomEvent>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        self.joint.push(*event);
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.symptoms.push(*event);
        Ok(())
    }
}

/// Events of a scene with this solver.
fn events(body: &str, solver: &str) -> Keep {
    let text = format!("version = 1\ntitle = \"off the grid\"\n{body}\n[solver]\n{solver}\n");
    let scene = Scene::parse(Path::new("test.toml"), &text, &Overrides::default())
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut keep = Keep::default();
    assert!(run(&scene, &mut keep).is_ok(), "{text}");
    keep
}

const STEPPED: &str = "kind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f64\"";
const REFERENCE: &str = "kind = \"reference\"";

/// A slow hand that is torn along at `jump_s`, and let go 0.1 s later.
fn torn(jump_s: f64, effects: &str) -> String {
    let (bend_s, end_s) = (jump_s + 0.000_87, jump_s + 0.1);
    format!(
        "duration_s = 0.5\n[motion]\nkind = \"velocity-knots\"\nfrom_deg = 40.0\nknots = [\n\
         {{ t_s = 0.0, omega_rad_s = 0.001 }},\n\
         {{ t_s = {jump_s}, omega_left_rad_s = 0.001, omega_right_rad_s = 0.35 }},\n\
         {{ t_s = {bend_s}, omega_rad_s = 0.35 }},\n\
         {{ t_s = {end_s}, omega_left_rad_s = 0.35, omega_right_rad_s = 0.001 }},\n]\n{effects}"
    )
}

#[test]
fn a_jump_anywhere_in_a_step_gives_the_same_slips_in_every_rung() {
    for nth in 0..40 {
        let jump_s = 0.1 + 1.3e-6 * f64::from(nth);
        for convention in [Convention::Frozen, Convention::Paper] {
            let convention_name = convention.name();
            let effects = format!("[effects.crepitus]\nconvention = \"{convention_name}\"");
            let body = torn(jump_s, &effects);
            let exact = events(&body, REFERENCE).joint;
            for solver in Solver::ALL {
                if solver.refusal(convention).is_some() {
                    continue;
                }
                let kind = format!(
                    "kind = \"{}\"\nstep_s = 5e-5\nprecision = \"f64\"",
                    solver.name()
                );
                let found = events(&body, &kind).joint;
                let label = format!("{convention_name}, {kind}, jump at {jump_s} s");
                assert_eq!(found.len(), exact.len(), "{label}");
                // The others integrate, or find an event at the end of its step: their own orders are tests elsewhere.
                let is_exact = matches!(solver, Solver::ExactEvents | Solver::ExactHermite);
                let tolerance_s = if is_exact { 1e-8 } else { 1e-3 };
                for (found, exact) in found.iter().zip(&exact) {
                    let late_s = (found.time_s - exact.time_s).abs();
                    assert!(late_s < tolerance_s, "{label}: {late_s:e} s");
                }
            }
        }
    }
}

#[test]
fn a_reflex_answers_every_jump_within_a_step() {
    // Two in one step, and one where a step begins.
    let body = "duration_s = 0.3\n[motion]\nkind = \"velocity-knots\"\nfrom_deg = 60.0\nknots = [\
                { t_s = 0.0, omega_rad_s = 0.5 }, \
                { t_s = 0.10001, omega_left_rad_s = 0.5, omega_right_rad_s = 1.5 }, \
                { t_s = 0.10003, omega_left_rad_s = 1.5, omega_right_rad_s = 0.8 }, \
                { t_s = 0.15, omega_left_rad_s = 0.8, omega_right_rad_s = 0.2 }]\n\
                [effects.spasticity]\nform = \"reflex\"\nthreshold_deg = 50.0\ngain_nm_per_rad = 0.5\ndelay_s = 0.012345";
    let (found, exact) = (events(body, STEPPED).rows, events(body, REFERENCE).rows);
    assert_eq!(found.len(), exact.len());
    // Time, angle, velocity, and the reflex.
    let torque_nm = |row: &[f64]| row[3];
    let most_nm = exact.iter().map(|row| torque_nm(row)).fold(0.0, f64::max);
    assert!(most_nm > 0.1, "{most_nm} N*m");
    for (found, exact) in found.iter().zip(&exact) {
        let off_nm = (torque_nm(found) - torque_nm(exact)).abs();
        assert!(off_nm < 1e-7, "{found:?} for {exact:?}");
    }
}

#[test]
fn teeth_that_begin_or_turn_exactly_on_an_edge_are_felt_alike() {
    let body = |from_deg: f64, to_deg: f64, pitch_deg: f64| {
        format!(
            "duration_s = 3.0\n[motion]\nkind = \"strokes\"\nfrom_deg = {from_deg:?}\nto_deg = {to_deg:?}\n\
             peak_speed_deg_s = 120.0\npause_s = 0.1\n[effects.cogwheel]\nmode = \"space\"\npitch_deg = {pitch_deg:?}"
        )
    };
    for (from_deg, to_deg, pitch_deg) in [(20.0, 100.0, 10.0), (30.0, 90.0, 15.0), (0.0, 60.0, 6.0)]
    {
        let body = body(from_deg, to_deg, pitch_deg);
        let teeth = |solver| -> Vec<(Word, f64)> {
            let own = events(&body, solver).symptoms.into_iter();
            own.filter(|e| !e.word.is_of_play())
                .map(|e| (e.word, e.time_s))
                .collect()
        };
        let (found, exact) = (teeth(STEPPED), teeth(REFERENCE));
        assert!(exact.len() > 20, "{exact:?}");
        let words = |list: &[(Word, f64)]| list.iter().map(|e| e.0).collect::<Vec<_>>();
        assert_eq!(words(&found), words(&exact), "{body}");
        for (found, exact) in found.iter().zip(&exact) {
            assert!((found.1 - exact.1).abs() < 1e-6, "{found:?} for {exact:?}");
        }
    }
}

#[test]
fn a_joint_at_rest_feels_no_tooth_that_passes_in_time() {
    let body = "duration_s = 1.0\n[motion]\nkind = \"velocity-knots\"\nknots = [{ t_s = 0.0, omega_rad_s = 1.0 }, \
                { t_s = 0.31234, omega_rad_s = 0.0 }]\n[effects.cogwheel]\nmode = \"time\"\nfrequency_hz = 7.0";
    for solver in [STEPPED, REFERENCE] {
        let teeth = events(body, solver).symptoms;
        let catches = teeth
            .iter()
            .filter(|e| e.word == Word::Catch && e.time_s > 0.32);
        assert_eq!(catches.count(), 0, "{solver}: {teeth:?}");
    }
}

/// Time at which the line of the limit comes to the torque of the release, s: from the closed form.
const RELEASE_S: f64 = 0.173_959_245_15;

#[test]
fn a_release_by_torque_is_where_spring_and_limit_are_both_there() {
    let body = "duration_s = 0.3\n[motion]\nkind = \"velocity-knots\"\nfrom_deg = 59.027348\nknots = [\
                { t_s = 0.0, omega_rad_s = 0.0 }, { t_s = 0.25, omega_rad_s = 0.966673 }]\n\
                [effects.clasp-knife]\nrelease_deg = 54.482214\nslope_nm_per_rad = 4.796518\nresidual_share = 0.151571\n\
                release_torque_nm = 3.510394\nmuscles = \"extensors\"\ntrigger = \"torque\"";
    for solver in [STEPPED, REFERENCE] {
        let found = events(body, solver).symptoms;
        let release = found.iter().find(|e| e.word == Word::Release);
        let release = release.unwrap_or_else(|| panic!("{solver}: {found:?}"));
        assert!(
            (release.time_s - RELEASE_S).abs() < 5e-9,
            "{solver}: {release:?}"
        );
        let off_nm = (release.torque_before_nm.abs() - 3.510_394).abs();
        assert!(off_nm < 1e-6, "{solver}: {release:?}");
    }
}

#[test]
fn a_limit_that_is_only_touched_holds() {
    // The top of the sine is 2^-10 rad: the spring reaches exactly Ts = 0.5 N*m and turns back.
    let body = |static_nm: f64| {
        format!(
            "duration_s = 1.0\n[motion]\nkind = \"sine\"\namplitude_rad = 0.0009765625\nfrequency_hz = 1.0\n\
             [effects.crepitus]\nconvention = \"frozen\"\nrestart = \"elastic\"\ninertia_kg_m2 = 0.01\n\
             stiffness_nm_per_rad = 512.0\ndamping_nms_per_rad = 0.0\nkinetic_torque_nm = 0.25\nstatic_torque_nm = {static_nm:?}"
        )
    };
    let stepped = "kind = \"exact-events\"\nstep_s = 6.103515625e-5\nprecision = \"f64\"";
    for solver in [stepped, REFERENCE] {
        assert_eq!(events(&body(0.5), solver).joint, [], "{solver}");
        assert!(
            !events(&body(0.499_99), solver).joint.is_empty(),
            "{solver}"
        );
    }
}
