//! Contribution of the drive to the joint's torque, and response of its current:
//! laws that hold for any motion and any input.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small numbers, and f32 is what runs on the device"
)]

mod support;

use crepitus_model::control::current_loop::CurrentLoopSettings;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::bone_shaping::BoneShapingSettings;
use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_model::render::effects::{DeviceEffect, Timing};
use crepitus_model::render::position::Sensing;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    BoneShaping, CurrentLoop, FrictionCompensation, Frozen, Real, Settings, ShaftStep,
    StepCoefficients, StickSlip, Tabled,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

const TICK_S: f64 = 5e-5;

const TIMING: Timing = Timing {
    step_s: TICK_S,
    delay_ticks: 1,
    sensing: Sensing::IDEAL,
};

/// Any number, NaN and infinities.
fn anything() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -2.0..2.0_f32,
        2 => any::<f32>(),
        1 => prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 0.0]),
    ]
}

/// Any settings that are allowed.
fn within_the_table<const N: usize, T: Tabled<N> + std::fmt::Debug>() -> impl Strategy<Value = T> {
    prop::array::uniform(0.0..=1.0_f64).prop_map(|at: [f64; N]| {
        let mut values = T::defaults().values();
        for ((value, spec), at) in values.iter_mut().zip(T::TABLE).zip(at) {
            *value = spec.min + (spec.max - spec.min) * at;
        }
        T::of(values)
    })
}

fn bone<F: Real>(settings: &BoneShapingSettings, delay_ticks: usize) -> BoneShaping<F> {
    let timing = Timing {
        delay_ticks,
        ..TIMING
    };
    BoneShaping::coefficients(settings, &timing).unwrap()
}

/// A hand and the torque that is added: what it gets back over the worst
/// stretch beyond what the tank refills, J.
struct Accounting {
    on_the_way_nm: Vec<f64>,
    refill_j: f64,
    level_j: f64,
    highest_j: f64,
    worst_j: f64,
}

impl Accounting {
    /// Returns an empty account of a torque that acts this many ticks late.
    fn new(late: usize, refill_w: f64) -> Self {
        Self {
            on_the_way_nm: vec![0.0; late + 1],
            refill_j: refill_w * TICK_S,
            level_j: 0.0,
            highest_j: 0.0,
            worst_j: 0.0,
        }
    }

    /// The torque that acts in the tick to come.
    fn acting_nm(&self) -> f64 {
        self.on_the_way_nm[0]
    }

    fn tick(&mut self, delta_phi: f64, torque_nm: f64) {
        let acting = self.on_the_way_nm.remove(0);
        self.on_the_way_nm.push(torque_nm);
        self.level_j += acting * delta_phi + self.refill_j;
        self.highest_j = self.highest_j.max(self.level_j);
        self.worst_j = self.worst_j.max(self.highest_j - self.level_j);
    }
}

/// Runs a hand against a bone that is struck: each tick a jump and a travel,
/// made of the torque that will act in it.
fn returned<F: Real>(
    settings: &BoneShapingSettings,
    (delay, late): (usize, usize),
    ticks: u32,
    mut hand: impl FnMut(u32, f64) -> (f64, f64),
) -> f64 {
    let mut bone = bone::<F>(settings, delay);
    let mut accounting = Accounting::new(late, settings.refill_w);
    for n in 0..ticks {
        let (jump, delta_phi) = hand(n, accounting.acting_nm());
        let delta_phi = F::from_f64(delta_phi);
        bone.ring(F::from_f64(jump));
        let torque = bone.tick(delta_phi).to_f64();
        assert!(torque.abs() <= settings.limit_nm + 1e-7);
        accounting.tick(delta_phi.to_f64(), torque);
    }
    accounting.worst_j
}

/// Every delay that is asked for, with every real one up to it.
fn delays() -> impl Iterator<Item = (usize, usize)> {
    (0..=MOST_DELAY_TICKS).flat_map(|delay| (0..=delay).map(move |late| (delay, late)))
}

/// Rounding of the energy account in f32.
fn slack(settings: &BoneShapingSettings) -> f64 {
    1e-3 * settings.budget_j
}

#[test]
fn a_hand_that_goes_with_the_ringing_gets_no_more_than_the_tank() {
    let s = BoneShapingSettings::default();
    for delays in delays() {
        // The hand sees which way it is pushed, is struck with all there is, and is
        // as fast as the account is exact for; or slow.
        for speed in [0.5, 5.0, 20.0] {
            let greedy = |n: u32, acting: f64| {
                let jump = (TAU * 115.0 * TICK_S * f64::from(n)).cos() * 0.6;
                (jump, -acting.signum() * speed * TICK_S)
            };
            let single = returned::<f32>(&s, delays, 40_000, greedy);
            let double = returned::<f64>(&s, delays, 40_000, greedy);
            println!(
                "{delays:?}, {speed} rad/s: {:.3} mJ, {:.3} mJ",
                single * 1e3,
                double * 1e3
            );
            assert!(single <= s.budget_j + slack(&s) && double <= s.budget_j + 1e-12);
            // The bound is not vacuous: the hand gets energy.
            assert!(double > 0.8 * s.budget_j);
        }
        // ±0.9 mrad at 115 Hz in every phase, struck every 31 ms.
        for phase in 0..12 {
            let shaking = |n: u32, _: f64| {
                let angle =
                    |n: f64| 0.9e-3 * (TAU * (115.0 * TICK_S * n + f64::from(phase) / 12.0)).sin();
                let jump = if n.is_multiple_of(696) { 0.6 } else { 0.0 };
                (jump, angle(f64::from(n) + 1.0) - angle(f64::from(n)))
            };
            let got = returned::<f32>(&s, delays, 40_000, shaking);
            assert!(got <= s.budget_j + slack(&s), "{got}");
        }
    }
}

#[test]
fn without_a_refill_the_tank_is_all_there_is() {
    let s = BoneShapingSettings {
        refill_w: 0.0,
        ..BoneShapingSettings::default()
    };
    let greedy = |n: u32, acting: f64| {
        let jump = if n.is_multiple_of(87) { 0.6 } else { 0.0 };
        (jump, -acting.signum() * 1e-4)
    };
    let got = returned::<f64>(&s, (1, 1), 200_000, greedy);
    assert!(got <= s.budget_j && got > 0.97 * s.budget_j, "{got}");
}

/// Cause of a strike on the bone.
#[derive(Clone, Copy, PartialEq)]
enum Struck {
    ByEvents,
    ByEveryChange,
}

/// The paper's joint at a constant speed with a bone, tick by tick.
struct Crepitus {
    torque_nm: Vec<f64>,
    ringing_nm: Vec<f64>,
    /// The lowest level of the tank.
    level_j: f64,
}

impl Crepitus {
    /// Amplitudes of the torque without and with the ringing.
    fn amplitudes(&self, hertz: f64) -> (f64, f64) {
        let shaped: Vec<f64> = self
            .torque_nm
            .iter()
            .zip(&self.ringing_nm)
            .map(|(t, z)| t + z)
            .collect();
        (amplitude(&self.torque_nm, hertz), amplitude(&shaped, hertz))
    }

    fn largest(&self) -> f64 {
        self.ringing_nm
            .iter()
            .fold(0.0, |most, z| z.abs().max(most))
    }
}

/// Runs the joint with a bone at a speed; records it after a second to settle.
fn crepitus(omega: f64, seconds: f64, struck: Struck) -> Crepitus {
    let coefficients =
        StepCoefficients::<f64>::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
    let mut joint = Frozen::<f64, ExactEvents>::new(coefficients, omega);
    let mut bone = bone::<f64>(&BoneShapingSettings::default(), 1);
    let step = ShaftStep {
        delta_phi_rad: omega * TICK_S,
        omega_start_rad_s: omega,
        omega_end_rad_s: omega,
    };
    let mut run = Crepitus {
        torque_nm: Vec::new(),
        ringing_nm: Vec::new(),
        level_j: f64::INFINITY,
    };
    for n in 0..((seconds + 1.0) / TICK_S) as u32 {
        let before = joint.torque_nm();
        let mut jumps = 0.0;
        joint.step(&step, |e| jumps += e.torque_after_nm - e.torque_before_nm);
        bone.ring(match struck {
            Struck::ByEvents => jumps,
            Struck::ByEveryChange => joint.torque_nm() - before,
        });
        let ringing = bone.tick(step.delta_phi_rad);
        if f64::from(n) * TICK_S >= 1.0 {
            run.torque_nm.push(joint.torque_nm());
            run.ringing_nm.push(ringing);
            run.level_j = run.level_j.min(bone.level_j());
        }
    }
    run
}

/// Amplitude at a frequency.
fn amplitude(signal: &[f64], hertz: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (n, x) in (0_u32..).zip(signal) {
        // (A Hann window: neighbours more than a few lines away do not leak.)
        let window = 1.0 - (TAU * f64::from(n) / signal.len() as f64).cos();
        let (sin, cos) = (TAU * hertz * TICK_S * f64::from(n)).sin_cos();
        re += window * x * cos;
        im += window * x * sin;
    }
    2.0 * re.hypot(im) / signal.len() as f64
}

fn mean(signal: &[f64]) -> f64 {
    signal.iter().sum::<f64>() / signal.len() as f64
}

#[test]
fn the_spectrum_gains_where_a_bone_rings() {
    // (speed, a harmonic near 115 Hz, the gain there)
    for (omega, harmonic, least) in [(0.05, 4.0, 3.0), (0.2, 4.0, 2.5), (1.0, 4.0, 50.0)] {
        let run = crepitus(omega, 4.0, Struck::ByEvents);
        let lambda: f64 = 0.1 / omega;
        let cycle_hz = 200.0 / (TAU + 2.0 * (lambda - lambda.atan()));
        let (bare, shaped) = run.amplitudes(cycle_hz * harmonic);
        println!(
            "{omega} rad/s, {:.1} Hz: {bare:.4} to {shaped:.4} N·m",
            cycle_hz * harmonic
        );
        assert!(shaped > least * bare && shaped > 0.06);
        // Far above the bone, hardly anything.
        let (bare, shaped) = run.amplitudes(cycle_hz * 12.0);
        assert!((shaped - bare).abs() < 2e-3, "{bare} {shaped}");
    }
}

#[test]
fn jumps_that_all_fall_shift_the_mean_by_their_sum_over_omega() {
    for omega in [0.2, 1.0, 2.0, 4.0] {
        let run = crepitus(omega, 4.0, Struck::ByEvents);
        let lambda: f64 = 0.1 / omega;
        let cycle_hz = 200.0 / (TAU + 2.0 * (lambda - lambda.atan()));
        let expected = -0.4 * cycle_hz / (TAU * 115.0);
        let shift = mean(&run.ringing_nm);
        assert!(
            (shift - expected).abs() < 4e-4,
            "{omega}: {shift} {expected}"
        );
        // That, and the exchange of every ring, leave the upper half of the
        // tank alone: nothing fades.
        println!("{omega} rad/s: tank down to {:.2} mJ", run.level_j * 1e3);
        assert!(run.level_j > 5e-3, "{omega}: {}", run.level_j);
        let peak = run.largest();
        assert!(peak > 0.15 && peak < 0.4, "{omega}: {peak}");
    }
}

#[test]
fn the_whole_torque_would_hardly_strike_it_at_speed() {
    let events = crepitus(1.0, 4.0, Struck::ByEvents).largest();
    let whole = crepitus(1.0, 4.0, Struck::ByEveryChange);
    println!(
        "{events:.3} of the events, {:.3} of the whole torque",
        whole.largest()
    );
    assert!(whole.largest() < 0.04 && events > 0.29);
    assert!(mean(&whole.ringing_nm).abs() < 2e-4);
}

proptest! {
    #![proptest_config(support::cases(200))]

    #[test]
    fn no_hand_gets_more_than_the_tank(
        s in within_the_table::<6, BoneShapingSettings>(),
        which in 0..6_usize,
        greed in 0.0..1.0_f64,
        moves in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 1..200_u32), 1..40),
    ) {
        let furthest = (s.budget_j / (16.0 * s.limit_nm)).min(1.0);
        let ticks: Vec<_> = moves
            .iter()
            .flat_map(|&(jump, travel, n)| {
                (0..n).map(move |i| (if i == 0 { jump } else { 0.0 }, travel))
            })
            .collect();
        // A part of the motion is its own, the rest goes with the torque.
        let hand = |n: u32, acting: f64| {
            let (jump, travel) = ticks[n as usize];
            (jump, furthest * (travel * (1.0 - greed) - acting.signum() * greed))
        };
        let delays = delays().nth(which).unwrap();
        let n = u32::try_from(ticks.len()).unwrap();
        let double = returned::<f64>(&s, delays, n, hand);
        prop_assert!(double <= s.budget_j * (1.0 + 1e-9), "{double}");
        let single = returned::<f32>(&s, delays, n, hand);
        prop_assert!(single <= s.budget_j + slack(&s), "{single}");
    }

    #[test]
    fn a_bone_stays_within_its_limit_and_mirrors(
        s in within_the_table::<6, BoneShapingSettings>(),
        inputs in prop::collection::vec((anything(), anything()), 1..300),
    ) {
        let (mut bone, mut mirror) = (bone::<f32>(&s, 1), bone::<f32>(&s, 1));
        for (jump, travel) in inputs {
            bone.ring(jump);
            mirror.ring(-jump);
            let torque = bone.tick(travel);
            prop_assert!(torque.abs() <= s.limit_nm as f32);
            prop_assert_eq!(mirror.tick(-travel), -torque);
            prop_assert_eq!(bone.level_j(), mirror.level_j());
            prop_assert!(bone.level_j().abs() <= s.budget_j as f32);
        }
        // Whatever it was, it dies away.
        for _ in 0..400_000 {
            bone.tick(0.0);
        }
        prop_assert!(bone.tick(0.0).abs() < 1e-9);
    }

    #[test]
    fn a_gear_takes_what_its_compensation_gives(
        s in within_the_table::<3, FrictionCompensationSettings>(),
        more in 0.0..1.0_f64,
        late in 0..4_usize,
        speeds in prop::collection::vec(-8.0..8.0_f64, 10..300),
        noise in prop::collection::vec(-0.05..0.05_f64, 300),
    ) {
        let compensation = FrictionCompensation::<f64>::coefficients(&s, &TIMING).unwrap();
        let cancelled = s.share * s.friction_nm;
        let friction = cancelled + more;
        let (mut taken, mut given, mut travel) = (0.0, 0.0, 0.0);
        for (n, omega) in speeds.iter().enumerate().skip(late) {
            // The measured speed is late and noisy.
            let torque = compensation.torque_nm(speeds[n - late] + noise[n]);
            let delta_phi = omega * TICK_S;
            taken += friction * delta_phi.abs() + torque * delta_phi;
            given -= torque * delta_phi;
            travel += delta_phi.abs();
            prop_assert!(given <= cancelled * travel + 1e-12);
            prop_assert!(taken >= more * travel - 1e-12);
        }
    }

    #[test]
    fn a_compensation_is_bounded_odd_and_pushes_along(
        s in within_the_table::<3, FrictionCompensationSettings>(),
        omega in anything(),
    ) {
        let compensation = FrictionCompensation::<f32>::coefficients(&s, &TIMING).unwrap();
        let torque = compensation.torque_nm(omega);
        prop_assert!(torque.abs() <= (s.share * s.friction_nm) as f32);
        prop_assert_eq!(compensation.torque_nm(-omega), -torque);
        // (A speed of NaN gives zero.)
        prop_assert!(torque * omega <= 0.0 || torque == 0.0);
    }

    #[test]
    fn a_current_loop_is_bounded_and_mirrors(
        s in within_the_table::<7, CurrentLoopSettings>(),
        inputs in prop::collection::vec((anything(), anything()), 1..300),
    ) {
        let mut regulator = CurrentLoop::<f32>::new(&s, TICK_S).unwrap();
        let mut mirror = regulator;
        for (wanted, measured) in inputs {
            let volts = regulator.tick(wanted, measured);
            prop_assert!(volts.abs() <= s.supply_v as f32);
            prop_assert_eq!(mirror.tick(-wanted, -measured), -volts);
            prop_assert_eq!(mirror.limited_by(), regulator.limited_by());
            if !(wanted.is_finite() && measured.is_finite()) {
                prop_assert_eq!(volts, 0.0);
            }
        }
    }

    #[test]
    fn whatever_came_before_a_current_settles_where_it_is_wanted(
        inputs in prop::collection::vec((anything(), anything()), 0..100),
        wanted in -1.3..1.3_f32,
        emf in -20.0..20.0_f64,
        current in -5.0..5.0_f64,
        late in 0..2_usize,
    ) {
        let s = CurrentLoopSettings::default();
        let mut regulator = CurrentLoop::<f32>::new(&s, TICK_S).unwrap();
        for (wanted, measured) in inputs {
            regulator.tick(wanted, measured);
        }
        let left = (-s.resistance_ohm * TICK_S / s.inductance_h).exp();
        let mut current = current;
        let mut on_the_way = vec![0.0; late];
        // 10 ms: 36 times the winding's time.
        for _ in 0..200 {
            on_the_way.push(f64::from(regulator.tick(wanted, current as f32)));
            let volts = on_the_way.remove(0);
            current = left * current + (1.0 - left) / s.resistance_ohm * (volts - emf);
        }
        prop_assert!((current - f64::from(wanted)).abs() < 1e-4, "{current} {wanted}");
    }
}
