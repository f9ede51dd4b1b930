//! The laws of the corrections, and that nothing is done where nothing is asked for.

use super::*;

const STEP_S: f64 = 5e-5;
const REACH: f64 = 0.27;

const NUMBERS: PathNumbers = PathNumbers {
    inductance_h: 0.34e-3,
    supply_v: 24.0,
    dead_time_s: 0.4e-6,
    lag_s: 0.43e-6,
};

fn correction(numbers: &PathNumbers) -> PathCorrection<f64> {
    PathCorrection::new(numbers, STEP_S, REACH).unwrap()
}

/// Corrections whose loop has carried this current for long.
fn carrying(current_a: f64, volts: f64) -> (PathCorrection<f64>, f64) {
    let mut correction = correction(&NUMBERS);
    let fed = (0..200).map(|_| correction.feed_v(current_a, volts)).last();
    (correction, fed.unwrap())
}

#[test]
fn without_dead_time_and_lag_there_is_no_correction() {
    let nothing = PathNumbers {
        dead_time_s: 0.0,
        lag_s: 0.0,
        ..NUMBERS
    };
    assert_eq!(PathCorrection::<f32>::new(&nothing, STEP_S, REACH), None);
}

#[test]
fn the_amplifier_is_that_of_the_half_that_switched_earlier() {
    for duty in [-0.84, -0.5, -0.125] {
        assert_eq!(earlier_half_a(1.0, 2.0, duty), 1.0);
        assert_eq!(earlier_half_a(1.0, 2.0, -duty), 2.0);
    }
    assert_eq!(earlier_half_a(1.0, 2.0, 0.0), 1.5);
    // Sensors that agree are not changed by a bit.
    for duty in [-0.84_f32, -0.1, 0.03, 0.7] {
        assert_eq!(earlier_half_a(0.123_4_f32, 0.123_4, duty), 0.123_4);
    }
}

/// A slope of −(R·i + E)/L, measured late.
#[test]
fn lag_is_taken_out_of_the_slope_between_the_pulses() {
    let only_lag = PathNumbers {
        dead_time_s: 0.0,
        ..NUMBERS
    };
    let (current_a, explained_v) = (0.3, 10.0);
    let late_a = current_a + only_lag.lag_s * explained_v / only_lag.inductance_h;
    let corrected_a = correction(&only_lag).corrected_a(late_a, explained_v);
    assert!((corrected_a - current_a).abs() < 1e-12);
    // 10 V are 29 kA/s: 12.6 mA, 42 mN·m at the joint.
    assert!((late_a - current_a - 0.012_647).abs() < 1e-6);
}

#[test]
fn a_current_beyond_the_ripple_costs_both_pulses_and_one_within_it_none() {
    let full_v = (2.0 * 24.0 + 4.0 * DIODE_V) * 0.4 / 50.0;
    // At a duty of one half the ripple is ±0.22 A.
    for (current_a, share) in [(0.26, 1.0), (0.18, 0.0), (-0.18, 0.0), (-0.26, -1.0)] {
        for volts in [-12.0, 12.0] {
            let (_, fed_v) = carrying(current_a, volts);
            assert!((fed_v - share * full_v).abs() < 1e-9, "{current_a} A");
        }
    }
    // 0.8 V from one sign to the other.
    assert!((2.0 * full_v - 0.819_2).abs() < 1e-9);
}

/// The pulses are late by half of the dead time where all are cut, or none.
#[test]
fn the_delay_of_the_pulses_goes_with_the_dead_time_that_is_fed_forward() {
    let late_a = |current_a: f64| -carrying(current_a, 12.0).0.corrected_a(0.0, 12.0);
    let per_second = 12.0 / NUMBERS.inductance_h;
    assert!((late_a(0.3) - 0.63e-6 * per_second).abs() < 1e-9);
    assert!((late_a(-0.3) - 0.63e-6 * per_second).abs() < 1e-9);
    assert!((late_a(0.1) - 0.43e-6 * per_second).abs() < 1e-9);
}

#[test]
fn what_is_fed_forward_follows_the_loop_and_not_the_setpoint_at_once() {
    let mut correction = correction(&NUMBERS);
    let fed: [f64; 4] = core::array::from_fn(|_| correction.feed_v(0.1, 0.0));
    // The setpoint acts with the next voltage.
    assert_eq!(fed[0], 0.0);
    assert!(fed[1] > 0.0 && fed[1] <= fed[2] && fed[2] <= fed[3]);
    correction.reset();
    assert_eq!(correction.feed_v(0.0, 0.0), 0.0);
}

#[test]
fn it_mirrors() {
    let (mut one, mut other) = (correction(&NUMBERS), correction(&NUMBERS));
    for n in 0..300 {
        let phase = 0.07 * f64::from(n);
        let (current_a, volts) = (0.4 * libm::sin(phase), 14.0 * libm::cos(0.3 * phase));
        assert_eq!(
            one.feed_v(current_a, volts),
            -other.feed_v(-current_a, -volts)
        );
        assert_eq!(
            one.corrected_a(0.2, volts),
            -other.corrected_a(-0.2, -volts)
        );
    }
}
