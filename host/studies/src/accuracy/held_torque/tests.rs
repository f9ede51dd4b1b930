use super::*;
use crate::accuracy::input::Input;
use crate::accuracy::measure::{Accuracy, ReferenceRun, measure};
use crate::accuracy::reference_torque::ReferenceTorque;
use crate::accuracy::scenes::standard;
use crate::true_events::TimedEvent;
use crepitus_model::solver::Solver;
use crepitus_model::{Parameters, Settings};
use crepitus_plant::motion::VelocityKnot;
use crepitus_scene::reference::Reference;
use crepitus_scene::scene::Precision;
use std::convert::Infallible;

const TICK_S: f64 = 5e-5;

fn scene(convention: Convention, motion: Motion, duration_s: f64) -> StudyScene {
    let settings = Settings {
        convention,
        ..Settings::default()
    };
    StudyScene {
        name: "test".to_owned(),
        title: String::new(),
        motion,
        duration_s,
        settings: settings.validate().unwrap(),
        input: Input::Exact,
    }
}

fn accuracy(scene: &StudyScene, solver: Solver, step_s: f64) -> Accuracy {
    let truth = scene.true_events();
    let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
    let events: Vec<TimedEvent> = truth.iter().map(|e| e.event).collect();
    let target = ReferenceRun {
        scene,
        sampling: &sampling,
        events: &events,
        torque: &ReferenceTorque::new(scene, &sampling, &truth, || Ok::<_, Infallible>(()))
            .unwrap(),
        held: &HeldTorque::new(scene, &sampling, &truth),
    };
    measure(&target, solver, Precision::F64).unwrap()
}

/// Root mean square of the held error of an exact joint at a constant speed,
/// and the floor, N·m: the module's closed forms.
fn closed_forms_nm(p: &Parameters, omega_rad_s: f64, step_s: f64) -> (f64, f64) {
    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
    let ramp = p.stiffness_nm_per_rad * omega_rad_s;
    let lambda = drop_nm / (omega_rad_s * p.impedance_nms_per_rad());
    let period_s = 2.0 * (std::f64::consts::PI + lambda - lambda.atan()) / p.natural_rad_s();
    let events = drop_nm * drop_nm * step_s;
    let ramps = ramp * ramp * step_s.powi(3);
    (
        ((events - ramps / 12.0) / period_s).sqrt(),
        ((events / 3.0 - ramps / 60.0) / period_s).sqrt(),
    )
}

#[test]
fn an_exact_joint_held_for_a_tick_is_off_by_the_closed_form() {
    for (omega_rad_s, step_s) in [
        // At 0.988 rad/s a cycle has nearly 628 12/31 ticks: phases repeat.
        (0.97, TICK_S),
        (0.1234, TICK_S),
        (1.973, TICK_S),
        (0.988, 4.1e-4),
        (3.1, 2e-4),
    ] {
        for convention in [Convention::Frozen, Convention::Physical] {
            let scene = scene(convention, Motion::constant(omega_rad_s), 60.0);
            let (held, floor) = closed_forms_nm(&scene.settings.parameters, omega_rad_s, step_s);
            let truth = scene.true_events();
            let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
            for (name, found, expected) in [
                (
                    "held",
                    accuracy(&scene, Solver::ExactEvents, step_s).rms_held_torque_error_nm,
                    held,
                ),
                (
                    "floor",
                    HeldTorque::new(&scene, &sampling, &truth).floor_nm(),
                    floor,
                ),
            ] {
                let off = found / expected - 1.0;
                println!(
                    "{omega_rad_s} rad/s, {step_s} s, {convention:?}: {name} {found:.6e} N·m ({off:+.1e})"
                );
                assert!(
                    off.abs() < 1e-3,
                    "{name} {omega_rad_s} {step_s}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn at_the_devices_tick_every_rung_that_locates_the_break_is_off_by_8_mnm() {
    // Without location events drift, so the error grows with the run.
    for (duration_s, expected_nm) in [(4.0, 11.9e-3), (10.0, 17.3e-3)] {
        let scene = scene(Convention::Physical, Motion::constant(0.988), duration_s);
        let a = accuracy(&scene, Solver::Exact, TICK_S);
        println!(
            "exact, {duration_s} s: held {:.2e} N·m, at the tick {:.2e} N·m",
            a.rms_held_torque_error_nm, a.rms_tick_torque_error_nm
        );
        assert!(
            (a.rms_held_torque_error_nm - expected_nm).abs() < 5e-5,
            "{a:?}"
        );
    }
    let scene = scene(Convention::Physical, Motion::constant(0.988), 10.0);
    let of = |solver| accuracy(&scene, solver, TICK_S);
    for solver in [
        Solver::ExactBreak,
        Solver::ExactInterpolated,
        Solver::ExactEvents,
        Solver::Rk4Events,
    ] {
        let a = of(solver);
        println!(
            "{}: held {:.2e} N·m, at the tick {:.2e} N·m",
            solver.name(),
            a.rms_held_torque_error_nm,
            a.rms_tick_torque_error_nm
        );
        assert!((a.rms_held_torque_error_nm - 8.0e-3).abs() < 3e-4, "{a:?}");
        // The whole jump, for the rest of its tick.
        assert!((a.max_held_torque_error_nm - 0.2).abs() < 0.02, "{a:?}");
        assert!(a.rms_tick_torque_error_nm < 3e-3, "{a:?}");
    }
}

/// Motions with all kinds of pieces, knots and jumps.
fn motions() -> Vec<Motion> {
    let knot = |time_s, left, right| VelocityKnot {
        time_s,
        omega_left_rad_s: left,
        omega_right_rad_s: right,
    };
    vec![
        Motion::constant(-1.1),
        Motion::sine(0.7, 0.9, 20.0),
        Motion::sine(0.01, 11.0, 0.0),
        Motion::velocity_knots(&[
            knot(0.0, 0.0, 1.0),
            knot(0.200_013, 1.5, -0.7),
            knot(0.411_117, -0.7, -0.7),
            knot(0.5, 0.0, 0.0),
            knot(0.55, 0.0, 0.0),
            knot(0.7, 2.0, 0.3),
        ]),
    ]
}

#[test]
fn between_its_events_the_torque_is_that_of_the_reference() {
    for convention in Convention::ALL {
        for motion in motions() {
            let scene = scene(convention, motion, 1.0);
            let events = scene.true_events();
            assert!(events.len() > 10, "{}", events.len());
            let mut reference = Reference::new(&scene.settings, &scene.motion);
            let mut path = Path::new(&scene);
            let mut next = events.iter().peekable();
            // Times that mean nothing, none of them within rounding of an event.
            for i in 1..7001 {
                let time_s = f64::from(i) / 7001.0;
                while let Some(event) = next.next_if(|e| e.event.time_s <= time_s) {
                    path.pass(event.event.time_s, event);
                }
                reference.advance(time_s, |_| {});
                let (found, expected) = (path.now_nm(time_s), reference.torque_nm());
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{convention:?} {:?} at {time_s}: {found} {expected}",
                    scene.motion
                );
            }
        }
    }
}

#[test]
fn moments_are_those_of_a_fine_sampling() {
    const FINE: u32 = 2000;
    for convention in Convention::ALL {
        for motion in motions() {
            let scene = scene(convention, motion, 0.75);
            let events = scene.true_events();
            let sampling = Sampling::new(&scene.motion, scene.duration_s, 2e-3);
            let held = HeldTorque::new(&scene, &sampling, &events);
            let mut reference = Reference::new(&scene.settings, &scene.motion);
            for (n, tick) in (0_u64..).zip(&held.ticks) {
                let mut samples = Vec::new();
                for i in 0..FINE {
                    let part = (f64::from(i) + 0.5) / f64::from(FINE);
                    reference.advance(sampling.time_s(n, part), |_| {});
                    samples.push(reference.torque_nm());
                }
                let mean = samples.iter().sum::<f64>() / f64::from(FINE);
                let variance =
                    samples.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / f64::from(FINE);
                // A jump of 0.4 N·m may fall anywhere in a part.
                assert!((tick.mean_nm - mean).abs() < 8e-4, "{n} {tick:?} {mean}");
                assert!(
                    (tick.variance - variance).abs() < 4e-4,
                    "{n} {tick:?} {variance}"
                );
                // Where the shaft turns back the extreme is between the nodes.
                let Extremes { low, high }: Extremes<f64> = samples.iter().copied().collect();
                assert!((tick.low_nm - low).abs() < 2e-3, "{n} {tick:?} {low}");
                assert!((tick.high_nm - high).abs() < 2e-3, "{n} {tick:?} {high}");
                let square = |held_nm: f64| {
                    samples.iter().map(|t| (held_nm - t).powi(2)).sum::<f64>() / f64::from(FINE)
                };
                assert!((tick.mean_square(0.3) - square(0.3)).abs() < 1e-3);
                assert!(tick.largest_nm(0.3) >= (0.3 - samples[7]).abs() - 2e-3);
            }
        }
    }
}

#[test]
fn nothing_that_is_held_is_below_the_floor() {
    for scene in standard().unwrap() {
        let scene = StudyScene {
            duration_s: 2.0,
            ..scene
        };
        let truth = scene.true_events();
        let sampling = Sampling::new(&scene.motion, scene.duration_s, TICK_S);
        let held = HeldTorque::new(&scene, &sampling, &truth);
        let floor_nm = held.floor_nm();
        for solver in [Solver::Exact, Solver::ExactBreak, Solver::ExactEvents] {
            let a = accuracy(&scene, solver, TICK_S);
            assert!(
                a.rms_held_torque_error_nm > 1.3 * floor_nm,
                "{a:?} {floor_nm}"
            );
        }
        let means: f64 = held.ticks.iter().map(|t| t.mean_square(t.mean_nm)).sum();
        let count = f64::from_whole(sampling.steps());
        assert!(((means / count).sqrt() - floor_nm).abs() < 1e-15);
    }
}

#[test]
fn a_shaft_at_rest_is_held_without_an_error() {
    let scene = scene(Convention::Physical, Motion::rest(0.3), 0.1);
    let a = accuracy(&scene, Solver::ExactEvents, TICK_S);
    assert_eq!(
        (a.rms_held_torque_error_nm, a.max_held_torque_error_nm),
        (0.0, 0.0)
    );
}
