//! The filters against closed forms, both precisions, fades, and exchange.

use super::*;
use crate::render::effects::tests::{TIMING, missing, seen};
use crate::render::effects::{Adds, Switched};
use std::vec::Vec;

const TICK_S: f64 = 5e-5;
const TAU: f64 = core::f64::consts::TAU;

fn actuator<F: Real>(settings: &VibrationActuatorSettings) -> VibrationActuator<F> {
    crate::render::effects::tests::law(settings)
}

/// Returns an actuator at full gain from the first tick on, at rest before.
fn faded_in<F: Real>(settings: &VibrationActuatorSettings) -> VibrationActuator<F> {
    let mut law = actuator(settings);
    law.tick(F::ZERO, true);
    law.gain = law.goal;
    law
}

#[test]
fn settings_are_their_table_and_are_held_to_it() {
    crate::parameters::tests::is_its_table_and_is_held_to_it::<11, VibrationActuatorSettings>();
    let s = VibrationActuatorSettings::default();
    assert!((s.stiffness_n_per_m() - 2901.6).abs() < 0.1);
    // 0.3 of 1.6 mm are for a shell that moves, 0.2 for its weight.
    assert!((s.usable_stroke_m() - 1.077e-3).abs() < 1e-6);
    assert!((s.volts_per_nm() + 5.4545).abs() < 1e-4);
    let soft = VibrationActuatorSettings {
        resonance_hz: 10.0,
        ..s
    };
    assert!(matches!(
        soft.check(),
        Err(SettingsError::Contradiction { .. })
    ));
    // The weight of the mass takes 2.48 mm: 0.6 of this stroke.
    for (stroke_mm, is_one) in [(4.13, false), (4.15, true)] {
        let soft = VibrationActuatorSettings { stroke_mm, ..soft };
        assert_eq!(soft.check().is_ok(), is_one, "{stroke_mm}");
        assert!(!is_one || soft.usable_stroke_m() > 0.199 * stroke_mm * 1e-3);
    }
    assert!((s.electric_damping_ratio() - 0.02547).abs() < 1e-5);
    let light = VibrationActuatorSettings {
        moving_mass_g: 11.0,
        ..s
    };
    assert!(matches!(
        light.check(),
        Err(SettingsError::Contradiction { .. })
    ));
    // Nothing but the back-EMF may damp it.
    let electric = VibrationActuatorSettings {
        damping_ratio: s.electric_damping_ratio(),
        ..s
    };
    assert_eq!(electric.check(), Ok(()));
    for step_s in [0.0, f64::NAN, 1.1] {
        let timing = Timing { step_s, ..TIMING };
        assert!(VibrationActuator::<f32>::coefficients(&s, &timing).is_err());
    }
}

/// Step response of s², s·ω and ω² over s² + 2ζω·s + ω², for ζ < 1.
fn step_response(omega: f64, two_zeta: f64, t: f64) -> [f64; 3] {
    let zeta = two_zeta / 2.0;
    let damped = libm::sqrt(1.0 - zeta * zeta);
    let (decay, turn) = (libm::exp(-zeta * omega * t), damped * omega * t);
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let high = decay * (cos - zeta / damped * sin);
    let band = decay * sin / damped;
    [high, band, 1.0 - high - two_zeta * band]
}

#[test]
fn each_filter_answers_a_step_as_its_closed_form() {
    fn errors<F: Real>(corner_hz: f64, two_zeta: f64) -> f64 {
        let omega = TAU * corner_hz;
        let follower = Follower::<F>::new(omega, two_zeta, TICK_S);
        let mut state = Following::at(F::ZERO);
        let height = 0.4;
        (0..20_000)
            .map(|n| {
                let parts = follower.tick(&mut state, F::from_f64(height));
                let [high, band, low] = step_response(omega, two_zeta, f64::from(n) * TICK_S);
                let off = [
                    parts.high.to_f64() - height * high,
                    parts.rate.to_f64() / omega - height * band,
                    parts.low.to_f64() - height * low,
                ];
                off.iter().fold(0.0_f64, |most, off| most.max(off.abs()))
            })
            .fold(0.0, f64::max)
    }
    for corner_hz in [8.0, 10.0, 30.0] {
        for two_zeta in BUTTERWORTH {
            let (double, single) = (
                errors::<f64>(corner_hz, two_zeta),
                errors::<f32>(corner_hz, two_zeta),
            );
            assert!(double < 1e-12, "{corner_hz} {two_zeta}: {double:e}");
            assert!(single < 1e-6, "{corner_hz} {two_zeta}: {single:e}");
        }
    }
}

/// Up to a limit, and up to where reductions begin, a command is what was wanted.
#[test]
fn a_command_is_reduced_beyond_a_limit_and_not_at_it() {
    let law = faded_in::<f64>(&VibrationActuatorSettings::default());
    let limited = |change: fn(&mut VibrationActuator<f64>), wanted_v: f64| {
        let mut law = law;
        change(&mut law);
        let volts = law.limited(wanted_v);
        (volts / wanted_v, law.phase)
    };
    // The supply: 5 V.
    for volts in [5.0, -5.0] {
        assert_eq!(limited(|_| (), volts), (1.0, ACTING));
        let (share, phase) = limited(|_| (), 1.25 * volts);
        assert_eq!((share, phase), (0.8, VOLTAGE));
    }
    // Heat: all up to 0.8 of what may last, half at 0.9, nothing at it.
    assert_eq!(limited(|law| law.heat = BEGINS_AT, 1.0), (1.0, ACTING));
    let (share, phase) = limited(|law| law.heat = 0.9, 1.0);
    assert!((share - 0.5).abs() < 1e-12 && phase == HEAT, "{share}");
    assert_eq!(limited(|law| law.heat = 1.0, 1.0), (0.0, HEAT));
    // A mass that turns is driven no further out, and one that returns is not held.
    let out = |law: &mut VibrationActuator<f64>| law.excursion = 0.9;
    assert_eq!(limited(out, 1.0), (1.0, ACTING));
    let moves = |law: &mut VibrationActuator<f64>| {
        (law.excursion, law.excursion_rate) = (0.9, 1e-9);
    };
    assert_eq!(limited(moves, -1.0), (1.0, ACTING));
    let (share, phase) = limited(moves, 1.0);
    assert!((share - 0.19 / 0.36).abs() < 1e-12, "{share}");
    assert_eq!(phase, EXCURSION);
}

/// Complex numbers, as far as needed.
#[derive(Clone, Copy)]
struct C(f64, f64);

impl C {
    fn times(self, b: C) -> C {
        C(self.0 * b.0 - self.1 * b.1, self.0 * b.1 + self.1 * b.0)
    }
    fn over(self, b: C) -> C {
        let size = b.0 * b.0 + b.1 * b.1;
        let top = self.times(C(b.0, -b.1));
        C(top.0 / size, top.1 / size)
    }
    fn plus(self, b: C) -> C {
        C(self.0 + b.0, self.1 + b.1)
    }
    fn abs(self) -> f64 {
        libm::hypot(self.0, self.1)
    }
}

/// a·s² + b·s + c at s = iω.
fn polynomial(omega: f64, a: f64, b: f64, c: f64) -> C {
    C(c - a * omega * omega, b * omega)
}

/// Amplitude and phase of the output for a sine of this frequency: by correlation
/// over whole periods, once it is steady.
fn response(settings: &VibrationActuatorSettings, ticks_per_period: u32) -> C {
    let mut law = faded_in::<f64>(settings);
    let omega = TAU / f64::from(ticks_per_period);
    let periods = (60_000 / ticks_per_period).max(4);
    let mut sum = C(0.0, 0.0);
    for n in 0..2 * periods * ticks_per_period {
        let turn = omega * f64::from(n % ticks_per_period);
        let volts = law.tick(1e-3 * libm::sin(turn), true) / 1e-3;
        if n >= periods * ticks_per_period {
            sum = sum.plus(C(volts * libm::sin(turn), volts * libm::cos(turn)));
        }
    }
    let ticks = f64::from(periods * ticks_per_period);
    C(2.0 * sum.0 / ticks, 2.0 * sum.1 / ticks)
}

#[test]
fn filter_and_actuator_together_are_a_butterworth_of_fourth_order() {
    let s = VibrationActuatorSettings {
        stroke_mm: 8.0,
        ..VibrationActuatorSettings::default()
    };
    let (corner, resonance) = (TAU * s.corner_hz, s.resonance_rad_s());
    // 5, 10, 20, 40, 100, 200 and 500 Hz.
    for ticks_per_period in [4000, 2000, 1000, 500, 200, 100, 40] {
        let omega = TAU / (f64::from(ticks_per_period) * TICK_S);
        let mass = polynomial(resonance, 0.0, 2.0 * s.damping_ratio * resonance, 0.0);
        let mass = polynomial(omega, 1.0, 0.0, 0.0).over(C(
            resonance * resonance - omega * omega,
            mass.1 / resonance * omega,
        ));
        let [first, second] = BUTTERWORTH.map(|two_zeta| {
            polynomial(omega, 1.0, 0.0, 0.0).over(polynomial(
                omega,
                1.0,
                two_zeta * corner,
                corner * corner,
            ))
        });
        let wanted = first.times(second);
        let got = response(&s, ticks_per_period)
            .times(mass)
            .times(C(1.0 / s.volts_per_nm(), 0.0));
        let error = got.plus(C(-wanted.0, -wanted.1)).abs();
        // Inputs are held over a tick, in both filters: as if a tick late at most.
        assert!(
            error < omega * TICK_S * wanted.abs() + 1e-3,
            "{omega}: {error}"
        );
    }
}

/// The paper's crepitus at 1 rad/s, roughly: ramps of 1 ms and drops, on a mean.
fn grating(n: u32) -> f64 {
    let place = f64::from(n % 640);
    0.2 + if place < 20.0 {
        0.01 * (place - 10.0)
    } else {
        0.0
    }
}

#[test]
fn in_single_precision_it_is_the_same() {
    let s = VibrationActuatorSettings::default();
    let (mut single, mut double) = (actuator::<f32>(&s), actuator::<f64>(&s));
    let (mut most, mut peak) = (0.0_f64, 0.0_f64);
    for n in 0..400_000 {
        #[expect(clippy::cast_possible_truncation, reason = "the input of both")]
        let torque = grating(n) as f32;
        let volts = double.tick(f64::from(torque), true);
        let off = f64::from(single.tick(torque, true)) - volts;
        (most, peak) = (most.max(off.abs()), peak.max(volts.abs()));
    }
    assert!(peak > 0.5, "{peak}");
    assert!(most < 1e-5 * peak, "{most:e} of {peak}");
}

#[test]
fn a_mean_torque_moves_nothing_and_driving_fades_in() {
    let s = VibrationActuatorSettings::default();
    let mut law = actuator::<f32>(&s);
    for _ in 0..100 {
        assert_eq!(law.tick(4.0, false), 0.0);
    }
    assert_eq!(law.phase, 0);
    for _ in 0..2_000 {
        assert_eq!(law.tick(4.0, true), 0.0);
    }
    assert_eq!((law.gain, law.phase), (1.0, ACTING));
    // Driving that ends silences at once, and fades in again.
    law.tick(4.2, true);
    assert!(law.tick(4.2, true).abs() > 0.5);
    assert_eq!(law.tick(4.2, false), 0.0);
    assert_eq!((law.gain, law.excursion, law.phase), (0.0, 0.0, 0));
    law.tick(4.2, true);
    assert!((1..=1_000).all(|n| {
        let volts = law.tick(4.2 + 0.1 * f32::from(n % 2 == 0), true);
        volts.abs() < 0.6
    }));
}

#[test]
fn what_is_no_number_silences() {
    let s = VibrationActuatorSettings::default();
    let mut law = faded_in::<f32>(&s);
    law.tick(0.3, true);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(law.tick(bad, true), 0.0);
        assert!(law.tick(0.1, true).is_finite() && law.amplitude().is_finite());
    }
    let mut silent = faded_in::<f32>(&s);
    silent.tick(0.2, true);
    for _ in 0..200_000 {
        silent.tick(0.2, true);
    }
    assert_eq!((silent.excursion, silent.high_pass.behind), (0.0, 0.0));
}

/// Command of the actuator in a tick that shows this torque.
fn after(stage: &mut Exchanged<f32>, torque_nm: f32, is_driven: bool) -> Shown<f32> {
    let mut shown = Shown {
        torque_nm,
        ..Shown::nothing()
    };
    let tick = Tick {
        is_driven,
        ..missing(&seen(0.0))
    };
    let volts = stage.tick(&tick, &mut shown, &mut ());
    assert_eq!(volts, shown.coil_v);
    assert_eq!(shown.torque_nm, torque_nm);
    shown
}

fn change(stage: &mut Exchanged<f32>, s: &VibrationActuatorSettings) {
    let made = VibrationActuator::<f32>::coefficients(s, &TIMING).unwrap();
    stage.change(&Some(Some(made)), 0.0);
}

#[test]
fn a_gain_is_followed_and_a_design_is_exchanged_in_silence() {
    let s = VibrationActuatorSettings::default();
    let mut stage = Exchanged::<f32>::new(0.0);
    assert_eq!(after(&mut stage, 0.3, true).coil_v, 0.0);
    change(&mut stage, &s);
    let settles = |stage: &mut Exchanged<f32>| {
        (0..5_000)
            .take_while(|_| after(stage, 0.3, true).settling)
            .count()
    };
    after(&mut stage, 0.3, true);
    // One more than the 1000 ticks of 50 ms: rounded.
    assert!((999..=1001).contains(&settles(&mut stage)));
    let louder = VibrationActuatorSettings { gain: 2.0, ..s };
    change(&mut stage, &louder);
    let before = stage.law().unwrap().high_pass;
    assert!((998..=1001).contains(&settles(&mut stage)));
    assert_eq!(stage.law().unwrap().high_pass.input, before.input);
    assert_eq!(stage.law().unwrap().gain, 2.0);
    // Another resonance: it fades out first, and in again.
    let other = VibrationActuatorSettings {
        resonance_hz: 40.0,
        ..s
    };
    stage.law.as_mut().unwrap().heat = 0.25;
    change(&mut stage, &other);
    let old = stage.law().unwrap().design;
    let mut largest_step = 0.0_f32;
    let mut last = after(&mut stage, 0.3, true).coil_v;
    for _ in 0..6_000 {
        let now = after(&mut stage, 0.3, true).coil_v;
        (largest_step, last) = (largest_step.max((now - last).abs()), now);
    }
    assert!(largest_step < 1e-3);
    let law = stage.law().unwrap();
    assert!(law.design != old && law.gain == 1.0);
    assert!((0.2..0.25).contains(&law.heat));
    stage.change(&Some(None), 0.0);
    assert!(after(&mut stage, 0.3, true).settling);
    // Where nothing is driven it goes at once.
    after(&mut stage, 0.3, false);
    assert!(stage.law().is_none());
}

#[test]
fn the_joint_and_the_ringing_are_heard_and_the_compensation_is_not() {
    let s = VibrationActuatorSettings::default();
    let (mut whole, mut alone) = (faded_in::<f32>(&s), faded_in::<f32>(&s));
    let sequence: Vec<f32> = (0..50_u8).map(|n| f32::from(n) * 0.01).collect();
    for nm in sequence {
        let mut shown = Shown {
            torque_nm: nm - 0.25,
            shell_nm: 0.125,
            ..Shown::nothing()
        };
        shown.added.friction_compensation = -0.25;
        let volts = whole.added(&missing(&seen(0.0)), &mut shown, &mut ());
        assert_eq!(volts, alone.tick(nm - 0.25 + 0.25 + 0.125, true));
    }
}
