//! Effect on the energy of a hand of showing not the torque of the tick but
//! what the joint is expected to have next: is a prediction worth its risk?
//!
//! | shown | torque |
//! |---|---|
//! | joint | T(tₙ) |
//! | half tick | in a stick T(tₙ) + kr·Ω·h/2 within ±Ts, the ramp's middle; otherwise T(tₙ) |
//! | next tick | the mean over the next tick if Ω goes on, events and all |
//!
//! A joint held for a tick gives back at most Ts²/2kr + g·kr·h·∫Ω² dt, with
//! g = ½ + d for a delay of d ticks. A prediction of half a tick on the velocity
//! at the tick moves g by −½·Σ Ωₙ·Δφₙ₊₁/∫Ω² dt: down to d for a hand that goes
//! on, up to 1 + d for one that turns back at every tick (Cauchy–Schwarz: an
//! estimate that amplifies no frequency has no more of ∫Ω² dt than Ω). Behind an
//! estimator of bandwidth f_b, H = 1/(1 + jf/f_b)², a sine in a stick that never
//! ends has g = ½ + d − Re(H)/2, at most ½ + d + 1/16, at √3·f_b.
//!
//! What follows from the numbers stands in `docs/accuracy.md`.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers, and f32 is what is tested"
)]

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::Limit;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Parameters, Phase, Renderer, Sample, Settings, ShaftStep, StepCoefficients, StickSlip,
};

const TICK_S: f64 = 5e-5;
const DELAYS: [usize; 3] = [0, 1, 2];
/// Duration of a hand's motion, s.
const SECONDS: f64 = 0.4;

/// The shaft as the joint measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sensing {
    /// The true angle, and the true velocity at the tick.
    True,
    /// The counts of the device's encoder, and the velocity estimated from them.
    Counts,
}

/// A hand: angle and velocity at a time.
type Hand<'a> = &'a dyn Fn(f64) -> (f64, f64);

/// The output torque.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shown {
    Joint,
    HalfTick,
    NextTick,
}

const SIGHTS: [Sensing; 2] = [Sensing::True, Sensing::Counts];

const SHOWN: [Shown; 3] = [Shown::Joint, Shown::HalfTick, Shown::NextTick];

/// The mean torque of the next tick if the shaft continues at `omega`, N·m.
fn next_tick(renderer: &Renderer<f32, ExactEvents>, omega: f32) -> f64 {
    let mut ahead = renderer.clone();
    let (mut from, mut torque_nm, mut sum) = (0.0, ahead.joint().torque_nm(), 0.0);
    ahead.render(
        &Sample::Taken(ShaftStep {
            delta_phi_rad: omega * TICK_S as f32,
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        }),
        |event| {
            sum += (event.fraction - from) * (torque_nm + event.torque_before_nm) / 2.0;
            (from, torque_nm) = (event.fraction, event.torque_after_nm);
        },
    );
    sum += (1.0 - from) * (torque_nm + ahead.joint().torque_nm()) / 2.0;
    f64::from(sum)
}

/// The travel of every tick, and what was shown at its beginning in each way.
fn ticks(p: Parameters, sensing: Sensing, hand: Hand<'_>, seconds: f64) -> Vec<(f64, [f64; 3])> {
    let encoder = EncoderSettings::default();
    let settings = Settings {
        parameters: p,
        ..Settings::default()
    };
    let coefficients = StepCoefficients::<f32>::new(&settings.validate().unwrap(), TICK_S).unwrap();
    let count = |phi: f64| (phi / encoder.rad_per_count()).floor() as i32;
    let (mut phi, mut omega) = hand(0.0);
    let mut reader = EncoderReader::<f32>::new(&encoder, TICK_S, count(phi), 0.0).unwrap();
    let mut renderer = Renderer::<f32, ExactEvents>::of(
        coefficients,
        InputLimits::device(TICK_S),
        encoder.rad_per_count() as f32,
        omega as f32,
    );
    let mut shown = [0.0; 3];
    let mut ticks = Vec::new();
    for n in 1..=(seconds / TICK_S) as u32 {
        let (next, omega_next) = hand(f64::from(n) * TICK_S);
        ticks.push((next - phi, shown));
        let shaft = match sensing {
            Sensing::Counts => reader.read(count(next)),
            Sensing::True => ShaftStep {
                delta_phi_rad: (next - phi) as f32,
                omega_start_rad_s: omega as f32,
                omega_end_rad_s: omega_next as f32,
            },
        };
        (phi, omega) = (next, omega_next);
        let torque = renderer.render(&Sample::Taken(shaft), |_| {});
        let joint = f64::from(torque.torque_nm);
        shown = [joint; 3];
        if torque.limit == Limit::None {
            let known = shaft.omega_end_rad_s;
            if renderer.joint().phase() == Phase::Stick {
                let ahead = p.stiffness_nm_per_rad * f64::from(known) * TICK_S / 2.0;
                let limit = p.static_torque_nm;
                shown[1] = (joint + ahead).min(limit).max(-limit);
            }
            shown[2] = next_tick(&renderer, known);
        }
    }
    ticks
}

/// The smallest g with which the hand gets no more back than Ts²/2kr (behind
/// counts half a count at the limit more) and g·kr·h·∫Ω² dt; −1 if less will do.
fn constant(
    p: Parameters,
    sensing: Sensing,
    ticks: &[(f64, [f64; 3])],
    way: usize,
    delay: usize,
) -> f64 {
    let stored = p.static_torque_nm.powi(2) / (2.0 * p.stiffness_nm_per_rad);
    let counts = match sensing {
        Sensing::True => 0.0,
        Sensing::Counts => EncoderSettings::default().rad_per_count() * p.static_torque_nm / 2.0,
    };
    let holds = |g: f64| {
        let (mut level, mut highest, mut deepest) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (n, (travel, _)) in ticks.iter().enumerate() {
            let acting = n.checked_sub(delay).map_or(0.0, |n| ticks[n].1[way]);
            level += acting * travel + g * p.stiffness_nm_per_rad * travel * travel;
            highest = highest.max(level);
            deepest = deepest.max(highest - level);
        }
        deepest <= stored + counts
    };
    let (mut low, mut high) = (-1.0, 16.0);
    if holds(low) {
        return low;
    }
    while high - low > 1e-3 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// A hand with a name.
type Named = (String, Box<dyn Fn(f64) -> (f64, f64)>);

/// The largest constants over the given hands: by what is shown, by sensing and
/// by delay.
fn worst(name: &str, p: Parameters, hands: &[Named]) -> [[[f64; 3]; 2]; 3] {
    let mut worst = [[[-1.0; 3]; 2]; 3];
    let mut by = [[[""; 3]; 2]; 3];
    for (what, hand) in hands {
        for (s, sensing) in SIGHTS.into_iter().enumerate() {
            let ticks = ticks(p, sensing, hand, SECONDS);
            for (way, _) in SHOWN.into_iter().enumerate() {
                for delay in DELAYS {
                    let g = constant(p, sensing, &ticks, way, delay);
                    if g > worst[way][s][delay] {
                        worst[way][s][delay] = g;
                        by[way][s][delay] = what;
                    }
                }
            }
        }
    }
    for (way, shown) in SHOWN.into_iter().enumerate() {
        for (s, sensing) in SIGHTS.into_iter().enumerate() {
            println!(
                "{name}, {shown:?}, {sensing:?}: g is at least {:.3}, {:.3}, {:.3} for 0, 1, 2 ticks of delay ({}; {}; {})",
                worst[way][s][0],
                worst[way][s][1],
                worst[way][s][2],
                by[way][s][0],
                by[way][s][1],
                by[way][s][2]
            );
        }
    }
    worst
}

/// Shakes: sines from within a stick to far beyond it.
fn shakes(p: Parameters) -> Vec<Named> {
    let stroke = p.static_torque_nm / p.stiffness_nm_per_rad;
    let mut hands: Vec<Named> = Vec::new();
    for amplitude in [0.51, 0.9, 0.99, 1.01, 1.2, 2.0, 5.0, 30.0] {
        for frequency in [7.0, 20.0, 50.0, 87.0] {
            let (a, w) = (amplitude * stroke, std::f64::consts::TAU * frequency);
            hands.push((
                format!("{amplitude} strokes at {frequency} Hz"),
                Box::new(move |t| (a * (w * t).sin(), a * w * (w * t).cos())),
            ));
        }
    }
    hands
}

#[test]
fn half_a_tick_ahead_is_more_passive_on_the_true_velocity_and_less_behind_an_encoder() {
    let p = Parameters::default();
    let worst = worst("shakes", p, &shakes(p));
    for (delay, d) in DELAYS.into_iter().zip([0.0, 1.0, 2.0]) {
        for (s, _) in SIGHTS.into_iter().enumerate() {
            // The present output stays within its bound.
            assert!(worst[0][s][delay] <= 0.5 + d + 1e-3);
        }
        let [on_true, behind_counts] = [worst[1][0][delay], worst[1][1][delay]];
        assert!(on_true <= d + 0.01, "{on_true}");
        // The bound gets worse, and by no more than what was derived.
        assert!(behind_counts > 0.5 + d + 0.04, "{behind_counts}");
        assert!(
            behind_counts <= 0.5 + d + 1.0 / 16.0 + 2e-3,
            "{behind_counts}"
        );
    }
}
