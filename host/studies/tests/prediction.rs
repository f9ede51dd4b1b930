//! Benefit of showing not the torque of the tick but the torque that the joint is
//! expected to have next, on the scenes of the accuracy study: the held error
//! with and without, on the true velocity and behind the device's encoder.
//!
//! | shown | torque |
//! |---|---|
//! | joint | T(tₙ) |
//! | half tick | in a stick T(tₙ) + kr·Ω·h/2 within ±Ts, the ramp's middle; otherwise T(tₙ) |
//! | next tick | the mean over the next tick if Ω goes on, events and all |
//!
//! At a constant speed (Δ = Ts − Tk, r = kr·Ω, period P)
//!
//! ```text
//! joint      e² = (Δ²·h − r²·h³/12)/P
//! half tick  e² = (Δ²·h − 5/24·Δ·r·h² + 7/192·r²·h³)/P
//! next tick  e² = (Δ²·h/3 − r²·h³/60)/P, the floor
//! ```
//!
//! so half a tick wins 5/48·r·h/Δ of the error, 1 % at 0.988 rad/s and 50 µs.
//! What it risks is tested in the model's `prediction` test; what follows from
//! both stands in `docs/accuracy.md`.

#![allow(
    clippy::cast_possible_truncation,
    reason = "counts of an encoder on a scene's angle"
)]

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::solver::propagate::Exact;
use crepitus_model::solver::velocity_match::{Paper, Physical};
use crepitus_model::{
    Convention, Frozen, Phase, Real, ShaftStep, StepCoefficients, StickSlip, VelocityMatch,
};
use crepitus_plant::Motion;
use crepitus_studies::accuracy::StudyScene;
use crepitus_studies::accuracy::held_torque::HeldTorque;
use crepitus_studies::accuracy::scenes::standard;
use crepitus_studies::sampling::Sampling;

/// The joint's knowledge of the shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sensing {
    True,
    Counts,
}

/// Held errors of the three ways of showing, and the floor, N·m.
#[derive(Clone, Copy, Debug)]
struct Errors {
    joint: f64,
    half_tick: f64,
    next_tick: f64,
    floor: f64,
}

fn errors(scene: &StudyScene, sensing: Sensing, step_s: f64) -> Errors {
    // The device's precision behind its encoder, the study's best without.
    match sensing {
        Sensing::True => of::<f64>(scene, sensing, step_s),
        Sensing::Counts => of::<f32>(scene, sensing, step_s),
    }
}

fn of<F: Real>(scene: &StudyScene, sensing: Sensing, step_s: f64) -> Errors {
    let coefficients = StepCoefficients::<F>::new(&scene.settings, step_s).unwrap();
    let omega = F::from_f64(scene.motion.at(0.0).omega_rad_s);
    match scene.settings.convention {
        Convention::Frozen => along(
            Frozen::<F, ExactEvents>::new(coefficients, omega),
            scene,
            sensing,
            step_s,
        ),
        Convention::Paper => along(
            VelocityMatch::<F, Paper, Exact<F>, ExactEvents>::new(coefficients, omega),
            scene,
            sensing,
            step_s,
        ),
        Convention::Physical => along(
            VelocityMatch::<F, Physical, Exact<F>, ExactEvents>::new(coefficients, omega),
            scene,
            sensing,
            step_s,
        ),
    }
}

fn along<F: Real, J: StickSlip<F> + Clone>(
    mut joint: J,
    scene: &StudyScene,
    sensing: Sensing,
    step_s: f64,
) -> Errors {
    let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
    let held = HeldTorque::new(scene, &sampling, &scene.true_events());
    let encoder = EncoderSettings::default();
    let count = |n: u64| {
        let phi = scene.motion.at(sampling.time_s(n, 0.0)).phi_rad;
        (phi / encoder.rad_per_count()).floor() as i32
    };
    let start = F::from_f64(scene.motion.at(0.0).omega_rad_s);
    let mut reader = EncoderReader::<F>::new(&encoder, step_s, count(0), start).unwrap();
    let mut walk = sampling.walk_from(0);
    let mut chunk: Vec<ShaftStep<F>> = Vec::new();
    let mut squares = [0.0; 3];
    let mut omega = start;
    for n in 0..sampling.steps() {
        let tick = held.tick(usize::try_from(n).unwrap()).unwrap();
        let shown = [
            joint.torque_nm().to_f64(),
            half_tick(&joint, omega, step_s),
            next_tick(&joint, omega, step_s),
        ];
        for (sum, shown_nm) in squares.iter_mut().zip(shown) {
            *sum += tick.mean_square(shown_nm);
        }
        walk.fill(&mut chunk, 1);
        let shaft = match sensing {
            Sensing::True => chunk[0],
            Sensing::Counts => reader.read(count(n + 1)),
        };
        joint.step(&shaft, |_| {});
        omega = shaft.omega_end_rad_s;
    }
    let rms = |squares: f64| (squares / f64::from_whole(sampling.steps())).sqrt();
    Errors {
        joint: rms(squares[0]),
        half_tick: rms(squares[1]),
        next_tick: rms(squares[2]),
        floor: held.floor_nm(),
    }
}

fn half_tick<F: Real, J: StickSlip<F>>(joint: &J, omega: F, step_s: f64) -> f64 {
    let torque_nm = joint.torque_nm().to_f64();
    if joint.phase() != Phase::Stick {
        return torque_nm;
    }
    let coefficients = joint.coefficients();
    let limit_nm = coefficients.static_nm.to_f64();
    let ahead_nm = coefficients.stiffness.to_f64() * omega.to_f64() * step_s / 2.0;
    (torque_nm + ahead_nm).min(limit_nm).max(-limit_nm)
}

fn next_tick<F: Real, J: StickSlip<F> + Clone>(joint: &J, omega: F, step_s: f64) -> f64 {
    let mut ahead = joint.clone();
    let (mut from, mut torque_nm, mut sum) = (0.0, ahead.torque_nm().to_f64(), 0.0);
    ahead.step(
        &ShaftStep {
            delta_phi_rad: omega * F::from_f64(step_s),
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        },
        |event| {
            let fraction = event.fraction.to_f64();
            sum += (fraction - from) * (torque_nm + event.torque_before_nm.to_f64()) / 2.0;
            (from, torque_nm) = (fraction, event.torque_after_nm.to_f64());
        },
    );
    sum + (1.0 - from) * (torque_nm + ahead.torque_nm().to_f64()) / 2.0
}

/// Closed forms at a constant speed: joint, half tick, next tick.
fn closed_forms(scene: &StudyScene, omega_rad_s: f64, step_s: f64) -> [f64; 3] {
    let p = &scene.settings.parameters;
    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
    let lambda = drop_nm / (omega_rad_s * p.impedance_nms_per_rad());
    let period_s = 2.0 * (std::f64::consts::PI + lambda - lambda.atan()) / p.natural_rad_s();
    let rise_nm = p.stiffness_nm_per_rad * omega_rad_s * step_s;
    [
        drop_nm * drop_nm - rise_nm * rise_nm / 12.0,
        drop_nm * drop_nm - 5.0 / 24.0 * drop_nm * rise_nm + 7.0 / 192.0 * rise_nm * rise_nm,
        drop_nm * drop_nm / 3.0 - rise_nm * rise_nm / 60.0,
    ]
    .map(|square| (square * step_s / period_s).sqrt())
}

#[test]
fn at_a_constant_speed_all_three_are_the_closed_forms() {
    for scene in standard().unwrap() {
        if scene.name != "constant-0.988" {
            continue;
        }
        for (omega_rad_s, step_s) in [(0.97, 5e-5), (0.1234, 5e-5), (0.988, 4.1e-4), (3.1, 2e-4)] {
            let scene = StudyScene {
                motion: Motion::constant(omega_rad_s),
                duration_s: 60.0,
                ..scene.clone()
            };
            let found = errors(&scene, Sensing::True, step_s);
            let expected = closed_forms(&scene, omega_rad_s, step_s);
            for (found, expected) in [found.joint, found.half_tick, found.next_tick]
                .into_iter()
                .zip(expected)
            {
                let off = found / expected - 1.0;
                assert!(
                    off.abs() < 1e-3,
                    "{omega_rad_s} {step_s}: {found} {expected}"
                );
            }
            assert!(
                (found.next_tick / found.floor - 1.0).abs() < 1e-6,
                "{found:?}"
            );
        }
    }
}

#[test]
fn on_the_studied_motions_half_a_tick_wins_next_to_nothing() {
    println!(
        "held error at 50 µs, mN·m RMS: as it is, half a tick ahead, mean of the next tick; the floor"
    );
    for sensing in [Sensing::True, Sensing::Counts] {
        let (mut half, mut next, mut count) = (0.0, 0.0, 0.0);
        for scene in standard().unwrap() {
            let e = errors(&scene, sensing, 5e-5);
            println!(
                "{sensing:?}, {}, {}: {:.3}, {:.3} ({:+.1} %), {:.3} ({:+.1} %); {:.3}",
                scene.name,
                scene.convention(),
                1e3 * e.joint,
                1e3 * e.half_tick,
                100.0 * (e.half_tick / e.joint - 1.0),
                1e3 * e.next_tick,
                100.0 * (e.next_tick / e.joint - 1.0),
                1e3 * e.floor
            );
            half += e.half_tick / e.joint;
            next += e.next_tick / e.joint;
            count += 1.0;
            assert!(e.half_tick > 0.95 * e.joint, "{e:?}");
            // A steady speed that is known leaves nothing better.
            if sensing == Sensing::True && scene.name.starts_with("constant") {
                assert!(e.next_tick < 1.001 * e.floor, "{e:?}");
            }
        }
        println!(
            "{sensing:?}, in the mean: half a tick {:+.1} %, the next tick {:+.1} %",
            100.0 * (half / count - 1.0),
            100.0 * (next / count - 1.0)
        );
    }
}
