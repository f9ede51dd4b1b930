//! Runs of whole scenes against closed forms, and laws that hold for all.

use crepitus_model::Convention;
use crepitus_model::render::Limit;
use crepitus_model::solver::Solver;
use crepitus_scene::run::{Diverged, RunError, TorqueSummary, columns};
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

/// A gap of some ticks in a scene of a drive on a shaft at 0.5 rad/s: the integral of its torque,
/// N·m·s, and for how many ticks it was held.
fn torque_over_a_gap(start_ticks: u32, gap_ticks: u32, ticks: u32) -> (f64, f64) {
    let time_s = |ticks: u32| f64::from(ticks) * 5e-5;
    let text = format!(
        "version = 1\ntitle = \"t\"\nduration_s = {}\ndevice = true\n[effects.crepitus]\n\
        [solver]\nkind = \"exact-events\"\nprecision = \"f32\"\nstep_s = 5e-5\n\
        [motion]\nkind = \"velocity-knots\"\nknots = [{{ t_s = 0, omega_rad_s = 0.5 }}, \
        {{ t_s = {}, omega_left_rad_s = 0.5, omega_right_rad_s = 5000.0 }}, \
        {{ t_s = {}, omega_left_rad_s = 5000.0, omega_right_rad_s = 0.5 }}, {{ t_s = 1.0, omega_rad_s = 0.5 }}]",
        time_s(ticks),
        time_s(start_ticks),
        time_s(start_ticks + gap_ticks),
    );
    let scene = Scene::parse(Path::new("t.toml"), &text, &Overrides::default()).unwrap();
    let column = columns(&scene).iter().position(|c| c.name == "limit");
    let holding = f64::from(Limit::Holding as u8);
    let (kept, summary) = simulate(&scene);
    let held = kept
        .rows
        .iter()
        .filter(|row| row[column.unwrap()] == holding);
    let mean_nm = summary.torque.unwrap().mean_nm;
    (
        mean_nm * time_s(ticks),
        time_s(u32::try_from(held.count()).unwrap()),
    )
}

/// Compares with closed forms: 400 N·m/rad at 0.5 rad/s, up to 0.4 N·m after 2 ms, then 0.2 N·m.
#[test]
fn the_torque_of_a_gap_is_what_was_held() {
    let rise = |from_nm: f64, time_s: f64| from_nm * time_s + 100.0 * time_s * time_s;
    let close = |(integral, _): (f64, f64), expected: f64, label: &str| {
        let off = (integral - expected).abs();
        assert!(
            off < 2e-9,
            "{label}: {integral:e} N·m·s, expected {expected:e}"
        );
    };
    for gap_ticks in [1, 2, 3, 5, 9] {
        // In stick at 0.2 N·m, from 1 ms on; what is caught up goes on, after more it begins
        // again at the end of a tick.
        let found = torque_over_a_gap(20, gap_ticks, 35);
        let held_s = if found.1 > 3.5 * 5e-5 {
            found.1 + 5e-5
        } else {
            found.1
        };
        assert!(found.1 > 0.0, "no sample was refused");
        let expected = 0.2 * held_s + rise(0.0, 35.0 * 5e-5 - held_s);
        close(found, expected, &format!("stick, {gap_ticks} ticks"));
        // In slip.
        let found = torque_over_a_gap(100, gap_ticks, 115);
        let rest_s = if found.1 > 3.5 * 5e-5 {
            14.0 * 5e-5 - found.1
        } else {
            0.0
        };
        let slip_s = 115.0 * 5e-5 - 2e-3 - rest_s;
        let expected = rise(0.0, 2e-3) + 0.2 * slip_s + rise(0.2, rest_s);
        close(found, expected, &format!("slip, {gap_ticks} ticks"));
    }
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

/// A shaft too fast to be believed: a drive holds its torque, lets go, and catches up or begins
/// again. What a summary says is what it showed, and the energy balances.
#[test]
fn samples_that_a_device_refuses_are_in_the_accounting() {
    const DEVICE: &str =
        "device = true\n[solver]\nkind = \"exact-events\"\nprecision = \"f32\"\nstep_s = 5e-5\n";
    for start_ms in 40..70 {
        for gap_ticks in [1, 2, 3, 20, 4000] {
            let start_s = f64::from(start_ms) * 1e-3;
            let end_s = start_s + f64::from(gap_ticks) * 5e-5;
            let text = format!(
                "version = 1\ntitle = \"t\"\nduration_s = 0.2\n{DEVICE}\n[effects.crepitus]\n[effects.encoder]\n\
                [motion]\nkind = \"velocity-knots\"\nknots = [{{ t_s = 0, omega_rad_s = 0.5 }}, \
                {{ t_s = {start_s:?}, omega_left_rad_s = 0.5, omega_right_rad_s = 5000.0 }}, \
                {{ t_s = {end_s:?}, omega_left_rad_s = 5000.0, omega_right_rad_s = 0.5 }}, {{ t_s = 1.0, omega_rad_s = 0.5 }}]"
            );
            let scene = Scene::parse(Path::new("t.toml"), &text, &Overrides::default()).unwrap();
            let columns = columns(&scene);
            let shown = columns
                .iter()
                .position(|c| c.name == "shown_nm")
                .expect("a device");
            let (kept, summary) = simulate(&scene);
            let torque = summary.torque.expect("a joint");
            let label = format!("{start_ms} ms, {gap_ticks} ticks");
            assert_within_what_was_shown(&torque, &label);
            let sum: f64 = kept.rows.iter().map(|row| row[shown]).sum();
            let mean_nm = sum / f64::from(u32::try_from(kept.rows.len()).unwrap());
            assert!(
                (torque.mean_nm - mean_nm).abs() < 2e-3,
                "{label}: {torque:?}, {mean_nm} N·m shown"
            );
            let energy = summary.energy.expect("a joint");
            // Of steps in f32, and of some that were caught up at once.
            assert!(energy.residual_relative.abs() < 1e-5, "{label}: {energy:?}");
        }
    }
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
fn an_absent_effect_leaves_no_trace() {
    let bare = scene(0.1, ONE_RAD_S, EXACT_EVENTS, "");
    let (keep, summary) = simulate(&bare);
    assert_eq!(keep.rows[0].len(), 3);
    assert!(keep.events.is_empty() && summary.torque.is_none() && summary.effects.is_empty());

    // With and without the encoder, what both have of the motion is the same.
    let with = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, "[effects.encoder]")).0;
    assert_eq!(with.rows[0].len(), 6);
    for (a, b) in keep.rows.iter().zip(&with.rows) {
        assert_eq!(a[..], b[..3]);
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

#[test]
fn steps_too_long_to_see_are_warned_of() {
    let slow = "kind = \"exact\"\nstep_s = 1e-3";
    let fast = "kind = \"constant\"\nvelocity_rad_s = 3.0";
    let (_, summary) = simulate(&scene(1.0, fast, slow, &crepitus("frozen")));
    assert!(
        summary
            .warnings
            .iter()
            .any(|w| w.contains("step longer than a stick phase"))
    );
    // That rung locates every event, however many fall into a step.
    let located = "kind = \"exact-events\"\nstep_s = 1e-3";
    let (_, summary) = simulate(&scene(1.0, fast, located, &crepitus("frozen")));
    let all = summary.warnings.join("\n");
    assert!(!all.contains("stick phase"), "{all}");
    let (_, summary) = simulate(&scene(1.0, fast, EXACT_EVENTS, &crepitus("frozen")));
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
}

#[test]
fn steps_longer_than_a_pitch_are_warned_of() {
    let texture = "[effects.texture]\npitch_deg = 0.5";
    let teeth = "[effects.cogwheel]\nmode = \"space\"\npitch_deg = 2.0";
    let warned = |omega_rad_s: f64, step_s: &str, effect: &str| {
        let motion = format!("kind = \"constant\"\nvelocity_rad_s = {omega_rad_s:?}");
        let solver = format!("kind = \"exact-events\"\nstep_s = {step_s}");
        let (_, summary) = simulate(&scene(0.05, &motion, &solver, effect));
        summary
            .warnings
            .iter()
            .any(|w| w.contains("longer than its pitch"))
    };
    assert!(warned(9.0, "1e-3", texture) && !warned(8.0, "1e-3", texture));
    assert!(!warned(9.0, "5e-4", texture));
    assert!(warned(36.0, "1e-3", teeth) && !warned(34.0, "1e-3", teeth));
}

#[test]
fn a_joint_that_the_device_refuses_is_warned_of() {
    // Two counts of 512 lines are 71.35 µrad; (Ts − Tk)/kr is 72 and 70.
    for (stiffness, lines, refused) in [
        ("2777.7", "512", false),
        ("2857.2", "512", true),
        ("2857.2", "1024", false),
        ("4000.0", "512", true),
    ] {
        let joint = format!(
            "{}\nstiffness_nm_per_rad = {stiffness}\ninertia_kg_m2 = 0.07",
            crepitus("frozen")
        );
        let encoder = format!("[effects.encoder]\nlines = {lines}");
        let effects = format!("{joint}\n{encoder}");
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &effects));
        let is_warned = |summary: &Summary| {
            let warnings = &summary.warnings;
            warnings.iter().any(|w| w.contains("the device refuses"))
        };
        assert_eq!(is_warned(&summary), refused, "{:?}", summary.warnings);
        // Without an encoder there is no count, and under another convention
        // no such slip.
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &joint));
        assert!(!is_warned(&summary));
        let physical = effects.replace("frozen", "physical");
        let (_, summary) = simulate(&scene(0.1, ONE_RAD_S, EXACT_EVENTS, &physical));
        assert!(!is_warned(&summary));
    }
}

#[test]
fn a_duration_of_no_whole_number_of_steps_is_a_warning() {
    let (keep, summary) = simulate(&scene(
        0.00012,
        ONE_RAD_S,
        EXACT_EVENTS,
        &crepitus("frozen"),
    ));
    assert_eq!(keep.rows.len(), 3);
    assert!(
        summary.warnings[0].contains("the run ends at 0.0001 s"),
        "{:?}",
        summary.warnings
    );
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
