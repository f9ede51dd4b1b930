//! The loop on a sampled winding, against closed forms, and its limits.

use super::*;
use std::vec::Vec;

const TICK_S: f64 = 5e-5;

/// A winding under a voltage that is held for a tick, exactly; the voltage
/// may come some ticks late.
struct Winding {
    left: f64,
    per_ohm: f64,
    current_a: f64,
    on_the_way_v: Vec<f64>,
}

impl Winding {
    fn new(ohm: f64, henry: f64, late: usize) -> Self {
        let left = libm::exp(-ohm * TICK_S / henry);
        Self {
            left,
            per_ohm: (1.0 - left) / ohm,
            current_a: 0.0,
            on_the_way_v: std::vec![0.0; late],
        }
    }

    fn believed(late: usize) -> Self {
        Self::new(1.23, 0.34e-3, late)
    }

    fn tick(&mut self, volts: f64, emf_v: f64) {
        self.on_the_way_v.push(volts);
        let volts = self.on_the_way_v.remove(0);
        self.current_a = self.left * self.current_a + self.per_ohm * (volts - emf_v);
    }
}

fn default_loop<F: Real>() -> CurrentLoop<F> {
    CurrentLoop::new(&CurrentLoopSettings::default(), TICK_S).unwrap()
}

/// The currents at the beginning of each tick.
fn run<F: Real>(
    winding: &mut Winding,
    regulator: &mut CurrentLoop<F>,
    ticks: u32,
    setpoint_a: f64,
    emf_v: impl Fn(u32) -> f64,
) -> Vec<f64> {
    (0..ticks)
        .map(|n| {
            let measured = winding.current_a;
            let volts = regulator.tick(F::from_f64(setpoint_a), F::from_f64(measured));
            winding.tick(volts.to_f64(), emf_v(n));
            measured
        })
        .collect()
}

#[test]
fn a_ramp_is_followed_at_the_lag_that_is_stated() {
    for bandwidth_hz in [100.0, 1000.0, 2000.0] {
        let settings = CurrentLoopSettings {
            bandwidth_hz,
            ..CurrentLoopSettings::default()
        };
        for late in [0, 1] {
            let mut winding = Winding::believed(late);
            let mut regulator = CurrentLoop::<f64>::new(&settings, TICK_S).unwrap();
            let mut behind = 0.0;
            for n in 0..1000_u32 {
                let setpoint_a = 1e-3 * f64::from(n);
                behind = (setpoint_a - winding.current_a) / 1e-3;
                let volts = regulator.tick(setpoint_a, winding.current_a);
                winding.tick(volts, 0.0);
            }
            let stated = settings.lag_ticks(TICK_S);
            assert!((behind - stated).abs() < 1e-6, "{behind} {stated}");
        }
    }
    let default = CurrentLoopSettings::default().lag_ticks(TICK_S);
    assert!((default - 3.7092).abs() < 1e-4, "{default}");
}

fn step<F: Real>(mut winding: Winding) -> Vec<f64> {
    run(&mut winding, &mut default_loop::<F>(), 200, 1.0, |_| 0.0)
}

fn overshoot(currents: &[f64]) -> f64 {
    currents.iter().fold(0.0, |most, i| i.max(most)) - 1.0
}

#[test]
fn settings_are_their_table_and_are_held_to_it() {
    crate::parameters::tests::is_its_table_and_is_held_to_it::<7, CurrentLoopSettings>();
    let s = CurrentLoopSettings::default();
    assert_eq!((s.bandwidth_hz, s.resistance_ohm), (1000.0, 1.23));
    assert_eq!((s.inductance_h, s.supply_v), (0.34e-3, 24.0));
    for step_s in [0.0, -1e-5, f64::NAN, 1.1] {
        assert!(CurrentLoop::<f32>::new(&s, step_s).is_err());
    }
}

#[test]
fn the_gains_are_those_of_the_sampled_winding() {
    let c = default_loop::<f64>();
    assert!((c.gain - 2.0041).abs() < 1e-4);
    assert!((c.gain * c.share_per_tick / TICK_S - 6632.1).abs() < 0.1);
    // In short ticks they are those of continuous time.
    let c = CurrentLoop::<f64>::new(&CurrentLoopSettings::default(), 1e-9).unwrap();
    assert!((c.gain - 2.136_28).abs() < 1e-4);
    assert!((c.gain * c.share_per_tick / 1e-9 - 7728.3).abs() < 0.1);
}

#[test]
fn a_step_is_first_order() {
    let g = 1.0 - libm::exp(-core::f64::consts::TAU * 1000.0 * TICK_S);
    let mut left = 1.0;
    let single = step::<f32>(Winding::believed(0));
    for (double, single) in step::<f64>(Winding::believed(0)).iter().zip(single) {
        assert!((1.0 - double - left).abs() < 1e-14, "{double} {left}");
        assert!((1.0 - single - left).abs() < 2e-6, "{single} {left}");
        left *= 1.0 - g;
    }
}

#[test]
fn a_tick_late_it_is_second_order_and_just_beyond_critical() {
    let g = 1.0 - libm::exp(-core::f64::consts::TAU * 1000.0 * TICK_S);
    let currents = step::<f64>(Winding::believed(1));
    // i(n+2) − i(n+1) + g·i(n) = g
    for i in currents.windows(3) {
        assert!((i[2] - i[1] + g * i[0] - g).abs() < 1e-14);
    }
    let over = overshoot(&currents);
    assert!(over > 5e-4 && over < 6e-4, "{over}");
}

#[test]
fn a_winding_with_other_constants_is_still_controlled() {
    // Hot copper, and an inductance that is off by 30 %.
    for ohm in [1.23, 1.71] {
        for henry in [0.24e-3, 0.34e-3, 0.44e-3] {
            for late in [0, 1] {
                let currents = step::<f64>(Winding::new(ohm, henry, late));
                let over = overshoot(&currents);
                assert!(over < 0.052, "{ohm} Ω, {henry} H, {late} late: {over}");
                assert!(currents[40..].iter().all(|i| (i - 1.0).abs() < 0.01));
            }
        }
    }
}

#[test]
fn the_bandwidth_is_what_was_asked_for() {
    // |g/(e^(jω) − (1 − g))| of a sine, from its settled samples.
    let g = 1.0 - libm::exp(-core::f64::consts::TAU * 1000.0 * TICK_S);
    for hertz in [100.0, 1000.0, 1008.5, 4000.0] {
        let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
        let angle = core::f64::consts::TAU * hertz * TICK_S;
        let (mut in_phase, mut behind) = (0.0, 0.0);
        for n in 0..8000_u32 {
            let volts = regulator.tick(libm::sin(angle * f64::from(n)), winding.current_a);
            winding.tick(volts, 0.0);
            // Of a whole number of periods.
            if n >= 4000 {
                let (sin, cos) = libm::sincos(angle * f64::from(n + 1));
                in_phase += winding.current_a * sin / 2000.0;
                behind += winding.current_a * cos / 2000.0;
            }
        }
        let gain = libm::hypot(in_phase, behind);
        let left = 1.0 - g;
        let theory = g / libm::sqrt(1.0 + left * left - 2.0 * left * libm::cos(angle));
        assert!((gain - theory).abs() < 1e-3, "{hertz}: {gain} {theory}");
        if hertz == 1008.5 {
            assert!((gain - 0.5_f64.sqrt()).abs() < 1e-3, "{gain}");
        }
    }
}

#[test]
fn a_steady_back_emf_is_cancelled_and_a_jump_of_it_is_known() {
    let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
    let currents = run(&mut winding, &mut regulator, 200, 0.0, |_| 1.0);
    let lowest = currents.iter().fold(0.0, |low, i| i.min(low));
    assert!((lowest + 0.259).abs() < 1e-3, "{lowest}");
    assert!(currents[199].abs() < 1e-12);
    // Growing by 66 V/s, as at 20 rad/s² of the joint.
    let growing = |n: u32| 66.0 * TICK_S * f64::from(n);
    let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
    let currents = run(&mut winding, &mut regulator, 200, 0.0, growing);
    assert!((currents[199] + 66.0 / 6632.0).abs() < 1e-5);
}

#[test]
fn voltage_saturation_is_reported_without_windup() {
    for sign in [1.0, -1.0] {
        let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
        // A second in which 24 V cannot push 1 A against 30 V.
        let stuck = run(&mut winding, &mut regulator, 20_000, sign, |_| sign * 30.0);
        assert_eq!(regulator.limited_by(), Some(Limit::Voltage));
        assert!((stuck[19_999] + sign * 6.0 / 1.23).abs() < 1e-9);
        // As the shaft gets slower, within 20 ms, the current comes back
        // and overshoots by what a falling back-EMF alone is worth.
        let falling = |n: u32| sign * (30.0 - 0.025 * f64::from(n.min(400)));
        let back = run(&mut winding, &mut regulator, 600, sign, falling);
        let beyond = back.iter().map(|i| i * sign - 1.0).fold(0.0, f64::max);
        assert!((beyond - 500.0 / 6632.1).abs() < 1e-3, "{beyond}");
        assert_eq!(regulator.limited_by(), None);
        assert!((back[599] - sign).abs() < 1e-9);
    }
}

#[test]
fn an_approach_that_the_supply_cuts_short_does_not_overshoot() {
    let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
    run(&mut winding, &mut regulator, 400, 0.0, |_| 23.0);
    let currents = run(&mut winding, &mut regulator, 400, 0.8, |_| 23.0);
    assert!(currents.windows(2).all(|i| i[1] >= i[0] - 1e-12));
    // All of the 24 V at first, the first-order law at last.
    assert!((currents[1] - winding.per_ohm).abs() < 1e-9);
    let left = |n: usize| 0.8 - currents[n];
    assert!((left(30) / left(29) - 0.7304).abs() < 1e-4);
}

#[test]
fn the_setpoint_is_clamped_to_the_current_limit() {
    for wanted in [5.0, -5.0, 1e30] {
        let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f32>());
        let currents = run(&mut winding, &mut regulator, 200, wanted, |_| 0.0);
        assert_eq!(regulator.limited_by(), Some(Limit::Current));
        let largest = currents.iter().map(|i| i.abs()).fold(0.0, f64::max);
        assert!((largest - 1.37).abs() < 1e-6, "{largest}");
    }
}

#[test]
fn an_invalid_measurement_is_counted_and_ignored() {
    let mut regulator = default_loop::<f32>();
    regulator.tick(1.0, 0.2);
    let before = regulator;
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(regulator.tick(1.0, bad), 0.0);
        assert_eq!(regulator.tick(bad, 1.0), 0.0);
    }
    assert_eq!(regulator.missed(), 6);
    let (mut after, mut expected) = (regulator, before);
    assert_eq!(after.tick(1.0, 0.4), expected.tick(1.0, 0.4));
    regulator.reset();
    assert_eq!((regulator.missed(), regulator.limited_by()), (6, None));
    assert_eq!(
        regulator.tick(1.0, 0.2),
        default_loop::<f32>().tick(1.0, 0.2)
    );
}

#[test]
fn at_rest_it_comes_to_rest() {
    let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f32>());
    run(&mut winding, &mut regulator, 200, 1.0, |_| 0.0);
    run(&mut winding, &mut regulator, 20_000, 0.0, |_| 0.0);
    assert_eq!(regulator.explained_v, 0.0);
}

#[test]
fn a_shaft_that_already_turns_is_not_jolted() {
    for emf_v in [5.0, -5.0] {
        let (mut winding, mut regulator) = (Winding::believed(0), default_loop::<f64>());
        regulator.start(emf_v);
        let currents = run(&mut winding, &mut regulator, 50, 0.0, |_| emf_v);
        assert!(currents.iter().all(|i| i.abs() < 1e-12));
    }
    // There is no more than the supply to take over.
    for beyond in [1e3, -1e3] {
        let mut regulator = default_loop::<f64>();
        regulator.start(beyond);
        assert_eq!(regulator.tick(0.0, 0.0), beyond.signum() * 24.0);
    }
}
