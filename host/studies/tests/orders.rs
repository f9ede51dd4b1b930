//! Orders of convergence by kind of motion and convention, of a synthetic
//! recording and, where they stand beside the repository, of recorded knees.
//! `--nocapture` prints the tables of `docs/accuracy.md`.

use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings};
use crepitus_plant::Motion;
use crepitus_plant::recording::{AngleUnit, Angles, Quantity, Source, read, smooth};
use crepitus_studies::accuracy::convergence::{motions, orders_on, run_at};
use crepitus_studies::accuracy::orders::{Order, Orders};
use crepitus_studies::accuracy::{Input, StudyScene};
use std::fmt::Write as _;
use std::path::Path;

const TICK_S: f64 = 5e-5;

fn order(of: &Orders) -> Option<f64> {
    match of.event_time_rms {
        Order::Slope { order, .. } => Some(order),
        _ => None,
    }
}

fn text(order: Order) -> String {
    match order {
        Order::Slope { order, .. } => format!("{order:.1}"),
        Order::RoundOff { .. } => "rounding".to_owned(),
        Order::TooFewPoints { .. } => "–".to_owned(),
    }
}

/// Root mean square event error at the device's tick, s; `None` with other
/// events.
fn at_the_tick(scene: &StudyScene, solver: Solver) -> Option<f64> {
    at_a_step(scene, solver, TICK_S)
}

fn at_a_step(scene: &StudyScene, solver: Solver, step_s: f64) -> Option<f64> {
    let truth: Vec<_> = scene.true_events().iter().map(|e| e.event).collect();
    let run = run_at(scene, &truth, solver, step_s).unwrap();
    (run.unmatched == 0).then_some(run.errors.rms_s)
}

/// Rungs down, motions across: order, and error at 50 µs.
fn tables(scenes: &[StudyScene], orders: &[Orders]) -> String {
    let mut tables = String::new();
    for convention in Convention::ALL {
        let of: Vec<&StudyScene> = scenes
            .iter()
            .filter(|s| s.settings.convention == convention)
            .collect();
        let head: Vec<_> = of.iter().map(|s| s.name.as_str()).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(
            tables,
            "\n| `{}` | {} |",
            convention.name(),
            head.join(" | ")
        );
        let _ = writeln!(tables, "|---|{}", "---|".repeat(head.len()));
        for solver in Solver::ALL {
            if solver.refusal(convention).is_some() {
                continue;
            }
            let cells = of.iter().map(|scene| {
                let found = orders.iter().find(|o| {
                    o.scene == scene.name
                        && o.convention == convention.name()
                        && o.solver == solver.name()
                });
                let error = at_the_tick(scene, solver)
                    .map_or_else(|| "other events".to_owned(), |e| format!("{e:.0e} s"));
                format!("{} ({error})", text(found.unwrap().event_time_rms))
            });
            let _ = writeln!(
                tables,
                "| `{}` | {} |",
                solver.name(),
                cells.collect::<Vec<_>>().join(" | ")
            );
        }
    }
    tables
}

/// The tables, which a page of the book has.
fn print(scenes: &[StudyScene], orders: &[Orders], page: &str) {
    let tables = tables(scenes, orders);
    println!("{tables}");
    for table in tables.trim().split("\n\n") {
        assert!(page.contains(table), "the book has another one");
    }
}

/// The orders that a path within the step allows: of the event times' root mean
/// square error, on every motion.
fn expected(convention: Convention, solver: Solver, motion: &str) -> Option<(f64, f64)> {
    if motion == "constant-speed" {
        return None;
    }
    match (convention, solver) {
        // Ω is of second order, and so is the duration or the match.
        (Convention::Frozen, Solver::ExactBreak | Solver::ExactEvents)
        | (Convention::Paper, Solver::ExactEvents) => Some((1.7, 2.3)),
        // J·Ω̇ is of first order in the torque of a stick.
        (Convention::Physical, Solver::ExactEvents) => Some((0.7, 1.4)),
        // And of second on the cubic path.
        (Convention::Physical, Solver::ExactHermite) => Some((1.4, 3.5)),
        // Ω is of third order, at least.
        (Convention::Paper, Solver::ExactHermite) => Some((2.4, 5.0)),
        _ => None,
    }
}

#[test]
fn orders_are_those_of_the_path_within_the_step() {
    let scenes = motions().unwrap();
    let orders = orders_on(&scenes).unwrap();
    print(&scenes, &orders, include_str!("../../../docs/accuracy.md"));
    let mut held = 0;
    for scene in &scenes {
        let convention = scene.settings.convention;
        for solver in Solver::ALL {
            let Some((low, high)) = expected(convention, solver, &scene.name) else {
                continue;
            };
            let found = orders
                .iter()
                .find(|o| {
                    o.scene == scene.name
                        && o.convention == convention.name()
                        && o.solver == solver.name()
                })
                .and_then(order)
                .unwrap();
            assert!(
                (low..high).contains(&found),
                "{} {} {}: {found:.2}, not {low} to {high}",
                scene.name,
                convention.name(),
                solver.name()
            );
            held += 1;
        }
    }
    assert_eq!(held, 18);
}

#[test]
fn at_a_constant_speed_located_events_are_exact_and_the_cubic_path_rounds() {
    for scene in motions().unwrap() {
        if scene.name == "constant-speed" {
            assert!(at_the_tick(&scene, Solver::ExactEvents).unwrap() < 1e-13);
        }
        if scene.name == "constant-speed" && scene.settings.convention == Convention::Physical {
            assert!(at_the_tick(&scene, Solver::ExactHermite).unwrap() < 1e-10);
        }
    }
}

#[test]
fn the_cubic_path_is_a_digit_better_at_the_tick_on_every_motion_of_a_hand() {
    for scene in motions().unwrap() {
        if scene.settings.convention == Convention::Physical && scene.name != "constant-speed" {
            assert!(better_by(10.0, &scene) == 2, "{}", scene.name);
        }
    }
}

/// Asserts that the cubic path is better by a factor where both rungs find the
/// true events; at how many of two steps they do.
fn better_by(factor: f64, scene: &StudyScene) -> usize {
    let events = scene.true_events().len();
    let mut compared = 0;
    for step_s in [1e-3, TICK_S] {
        let at = |solver| at_a_step(scene, solver, step_s);
        let (Some(linear), Some(cubic)) = (at(Solver::ExactEvents), at(Solver::ExactHermite))
        else {
            println!(
                "{}, {events} events, {step_s:e} s: other events",
                scene.name
            );
            continue;
        };
        compared += 1;
        println!(
            "{}, {events} events, {step_s:e} s: exact-events {linear:.1e} s, exact-hermite {cubic:.1e} s",
            scene.name,
        );
        assert!(cubic < linear / factor, "{} {step_s}", scene.name);
    }
    compared
}

#[test]
fn recorded_knees_have_the_same_orders() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !folder.is_dir() {
        eprintln!("skipped: no recordings in {}", folder.display());
        return;
    }
    let mut scenes = Vec::new();
    for name in [
        "opencap_squat_100hz",
        "opensim_walk_100hz",
        "bmc_walk_150hz",
    ] {
        let path = folder.join(name).with_extension("csv");
        let angles = Quantity::Angles(Angles::of(Some(AngleUnit::Deg)));
        let samples = read(&Source::new(&path, "time_s", "knee_flexion_deg", angles)).unwrap();
        let motion = Motion::recording(&smooth(&samples, 6.0).unwrap());
        for convention in Convention::ALL {
            let settings = Settings {
                convention,
                ..Settings::default()
            };
            scenes.push(StudyScene {
                name: name.to_owned(),
                title: name.to_owned(),
                motion: motion.clone(),
                // A recording has no end of its own: what follows is undefined.
                duration_s: samples.duration_s() - 0.05,
                settings: settings.validate().unwrap(),
                input: Input::Exact,
            });
        }
    }
    let orders = orders_on(&scenes).unwrap();
    print(
        &scenes,
        &orders,
        include_str!("../../../docs/generated/recorded-orders.md"),
    );
    let physical = scenes
        .iter()
        .filter(|scene| scene.settings.convention == Convention::Physical);
    let compared: usize = physical.map(|scene| better_by(1.0, scene)).sum();
    // Elsewhere a rung finds other events.
    assert!(compared >= 3, "{compared}");
}
