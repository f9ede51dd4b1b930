//! The energy that rendered crepitus can return to the hand: with the
//! turn-back guard it is at most
//!
//! ```text
//! E ≤ Ts²/2kr + (½ + d)·kr·h·∫Ω² dt
//! ```
//!
//! over any stretch of time, whatever the hand does. An encoder adds half a
//! count at the limit, Ts·Δ/2: a staircase holds that much more than a slope.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small numbers, and f32 is what is tested"
)]

mod support;

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    EnergyObserver, Parameters, Renderer, Sample, Settings, ShaftStep, StepCoefficients,
};
use proptest::prelude::*;

const TICK_S: f64 = 5e-5;

/// Joints of different pitch and torque; the first is the paper's.
const JOINTS: [(&str, Parameters); 3] = [
    ("paper", joint(0.01, 400.0, 0.2, 0.4)),
    ("fine", joint(0.001, 300.0, 0.08, 0.15)),
    ("heavy", joint(0.03, 500.0, 0.6, 1.1)),
];

const fn joint(inertia: f64, stiffness: f64, kinetic: f64, static_: f64) -> Parameters {
    Parameters {
        inertia_kg_m2: inertia,
        stiffness_nm_per_rad: stiffness,
        damping_nms_per_rad: 0.0,
        kinetic_torque_nm: kinetic,
        static_torque_nm: static_,
    }
}

/// The shaft as the joint measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sensing {
    /// The true angle.
    True,
    /// The counts of the device's encoder, and the speed estimated from them.
    Counts,
}

/// The largest energy returned over any stretch, as a part of the bound's
/// first term, for a hand at these angles tick by tick.
fn returned(parameters: Parameters, delay: usize, sensing: Sensing, angles_rad: &[f64]) -> f64 {
    let (guarded, _) = accounting(parameters, delay, sensing, angles_rad);
    guarded
}

/// The energy returned with the torque that is shown, and with the joint's own.
fn accounting(
    parameters: Parameters,
    delay: usize,
    sensing: Sensing,
    angles_rad: &[f64],
) -> (f64, f64) {
    let encoder = EncoderSettings::default();
    let settings = Settings {
        parameters,
        ..Settings::default()
    };
    let coefficients = StepCoefficients::<f32>::new(&settings.validate().unwrap(), TICK_S).unwrap();
    let count = |phi: f64| (phi / encoder.rad_per_count()).floor() as i32;
    let mut reader =
        EncoderReader::<f32>::new(&encoder, TICK_S, count(angles_rad[0]), 0.0).unwrap();
    let mut renderer = Renderer::<f32, ExactEvents>::of(
        coefficients,
        InputLimits::device(TICK_S),
        encoder.rad_per_count() as f32,
        0.0,
    );
    let exact = StepCoefficients::<f64>::new(&settings.validate().unwrap(), TICK_S).unwrap();
    let mut hand = EnergyObserver::new(&exact, delay);
    let mut unguarded = hand;
    let mut omega = 0.0;
    for pair in angles_rad.windows(2) {
        let delta_phi = pair[1] - pair[0];
        let shaft = match sensing {
            Sensing::Counts => reader.read(count(pair[1])),
            Sensing::True => {
                // The velocity at the end of a tick whose mean is known.
                let end = 2.0 * delta_phi / TICK_S - omega;
                ShaftStep {
                    delta_phi_rad: delta_phi as f32,
                    omega_start_rad_s: std::mem::replace(&mut omega, end) as f32,
                    omega_end_rad_s: end as f32,
                }
            }
        };
        let shown = renderer.render(&Sample::Taken(shaft), |_| {});
        hand.tick(delta_phi, f64::from(shown.torque_nm));
        unguarded.tick(delta_phi, f64::from(shown.model_torque_nm));
    }
    let counts = match sensing {
        Sensing::True => 0.0,
        Sensing::Counts => {
            encoder.rad_per_count() * parameters.stiffness_nm_per_rad / parameters.static_torque_nm
        }
    };
    (
        hand.share() / (1.0 + counts),
        unguarded.share() / (1.0 + counts),
    )
}

/// Minimum-jerk moves through these points, each of this many ticks.
fn moves(points: &[(f64, u32)]) -> Vec<f64> {
    let mut angles = vec![0.0];
    let mut from = 0.0;
    for &(to, ticks) in points {
        for i in 1..=ticks {
            let u = f64::from(i) / f64::from(ticks);
            let s = u * u * u * (10.0 + u * (6.0 * u - 15.0));
            angles.push(from + (to - from) * s);
        }
        from = to;
    }
    angles
}

fn sine(amplitude_rad: f64, frequency_hz: f64, seconds: f64) -> Vec<f64> {
    let ticks = (seconds / TICK_S) as u32;
    (0..=ticks)
        .map(|i| {
            let t = f64::from(i) * TICK_S;
            amplitude_rad * (std::f64::consts::TAU * frequency_hz * t).sin()
        })
        .collect()
}

/// Every delay of the torque, in ticks, with both sights.
const SIGHTS: [(usize, Sensing); 6] = [
    (0, Sensing::True),
    (1, Sensing::True),
    (2, Sensing::True),
    (0, Sensing::Counts),
    (1, Sensing::Counts),
    (2, Sensing::Counts),
];

#[test]
fn a_hand_that_shakes_gets_no_more_back_than_the_bound() {
    let mut worst = 0.0_f64;
    for (joint, p) in JOINTS {
        let stroke = p.static_torque_nm / p.stiffness_nm_per_rad;
        for (delay, sensing) in SIGHTS {
            for amplitude in [0.3, 0.51, 0.9, 0.99, 1.01, 1.2, 2.0, 5.0, 30.0] {
                for frequency in [2.0, 7.0, 20.0, 50.0, 90.0] {
                    let angles = sine(amplitude * stroke, frequency, 2.0);
                    let part = returned(p, delay, sensing, &angles);
                    println!("{joint} {delay} {sensing:?} {amplitude} {frequency}: {part:.3}");
                    worst = worst.max(part);
                }
            }
        }
    }
    println!("worst: {worst:.3} of what the spring holds");
    assert!(worst <= 1.0);
}

#[test]
fn without_the_guard_a_hand_that_turns_back_in_slips_gets_many_times_the_bound() {
    let p = Parameters::default();
    let angles = sine(5.0 * p.static_torque_nm / p.stiffness_nm_per_rad, 20.0, 2.0);
    let (guarded, unguarded) = accounting(p, 0, Sensing::True, &angles);
    println!("with the guard {guarded:.2}, without {unguarded:.1} times what the spring holds");
    assert!(guarded <= 1.0 && unguarded > 5.0);
}

proptest! {
    #![proptest_config(support::cases(400))]

    #[test]
    fn nor_does_any_other_hand(
        joint in 0..JOINTS.len(),
        sensing in 0..SIGHTS.len(),
        points in prop::collection::vec((-4.0..4.0_f64, 20..3000_u32), 2..40),
    ) {
        let (_, p) = JOINTS[joint];
        let stroke = p.static_torque_nm / p.stiffness_nm_per_rad;
        let points: Vec<_> = points.iter().map(|&(to, ticks)| (to * stroke, ticks)).collect();
        let (delay, sensing) = SIGHTS[sensing];
        let part = returned(p, delay, sensing, &moves(&points));
        prop_assert!(part <= 1.0, "{part}");
    }
}
