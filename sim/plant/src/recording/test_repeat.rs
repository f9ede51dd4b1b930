//! The periodic spline against the other one on a long file, its continuity, its errors.

use super::test_smooth::jumps;
use super::{CubicSegment, MAX_JOIN_DEG, RecordingError, Samples, smooth, smooth_cycle};
use crate::motion::Motion;
use fastrand::Rng;
use proptest::prelude::*;
use std::f64::consts::TAU;

fn samples(time_s: Vec<f64>, angle_rad: Vec<f64>) -> Samples {
    Samples {
        time_s,
        angle_rad,
        ..Samples::default()
    }
}

/// A cycle of uneven samples with noise, whose ends differ by `ends_rad`.
fn cycle(seed: u64, count: usize, period_s: f64, ends_rad: f64) -> Samples {
    let mut rng = Rng::with_seed(seed);
    let mut at = 0.0;
    let raw: Vec<f64> = (0..=count)
        .map(|i| {
            if i > 0 {
                at += 0.4 + 1.2 * rng.f64();
            }
            at
        })
        .collect();
    let time_s: Vec<f64> = raw.iter().map(|t| t / at * period_s).collect();
    let mut angle_rad: Vec<f64> = time_s
        .iter()
        .map(|t| {
            let turn = TAU * t / period_s;
            0.5 - 0.4 * turn.cos() + 0.2 * (2.0 * turn + 1.0).sin() + 0.02 * rng.f64()
        })
        .collect();
    let first = angle_rad[0];
    *angle_rad.last_mut().unwrap() = first + ends_rad;
    samples(time_s, angle_rad)
}

fn at(segments: &[CubicSegment], time_s: f64) -> &CubicSegment {
    let index = segments.partition_point(|s| s.end_s <= time_s);
    &segments[index.min(segments.len() - 1)]
}

fn state(segment: &CubicSegment, time_s: f64) -> [f64; 3] {
    [
        segment.angle_rad(time_s),
        segment.omega_rad_s(time_s),
        segment.acceleration_rad_s2(time_s),
    ]
}

/// φ, Ω, Ω̇ just before the join less those just after it, relative to their largest.
fn join(segments: &[CubicSegment]) -> [f64; 3] {
    let (first, last) = (&segments[0], segments.last().unwrap());
    let (before, after) = (state(last, last.end_s), state(first, 0.0));
    let mut size = [f64::MIN_POSITIVE; 3];
    for segment in segments {
        for (size, value) in size.iter_mut().zip(state(segment, segment.start_s)) {
            *size = size.max(value.abs());
        }
    }
    [0, 1, 2].map(|i| (before[i] - after[i]).abs() / size[i])
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_join_is_as_smooth_as_every_other_sample(
        seed: u64,
        count in 8_usize..400,
        period_s in 0.3_f64..8.0,
        ends_deg in -MAX_JOIN_DEG..MAX_JOIN_DEG,
        share in 0.02_f64..0.9,
    ) {
        let recording = cycle(seed, count, period_s, ends_deg.to_radians());
        let cutoff_hz = share * recording.nyquist_hz();
        let smoothed = smooth_cycle(&recording, cutoff_hz);
        // Of eight samples that are drawn two may be at one time.
        prop_assume!(!matches!(smoothed, Err(RecordingError::ShortCycle { .. })));
        let segments = smoothed.unwrap();
        let [within, at_join] = [jumps(&segments), join(&segments)];
        for (what, jump) in [("within", within), ("join", at_join)] {
            // Ω is continuous to the rounding of φ over the shortest interval.
            prop_assert!(jump[0] < 4e-15 && jump[1] < 1e-12 && jump[2] < 1e-12, "{what}: {jump:?}");
        }
        prop_assert_eq!(segments[0].start_s, 0.0);
        prop_assert_eq!(segments.last().unwrap().end_s, *recording.time_s.last().unwrap());
    }
}

/// `cycle` written many times, the last sample of each the first of the next.
fn written_out(cycle: &Samples, times: u32) -> Samples {
    let period_s = cycle.duration_s();
    let (mut time_s, mut angle_rad) = (Vec::new(), Vec::new());
    for k in 0..times {
        let within = cycle.time_s.len() - usize::from(k + 1 < times);
        for i in 0..within {
            time_s.push(f64::from(k) * period_s + cycle.time_s[i]);
            angle_rad.push(cycle.angle_rad[i]);
        }
    }
    samples(time_s, angle_rad)
}

#[test]
fn it_is_the_interior_of_a_long_file() {
    // Uneven at 60 Hz, and so dense that samples are averaged. Cutoff, repetitions.
    for (seed, count, cutoff_hz) in [(1, 60, 6.0), (2, 60, 2.0), (3, 9, 3.0), (4, 200, 12.0)] {
        let one = cycle(seed, count, 1.0, 0.0);
        let segments = smooth_cycle(&one, cutoff_hz).unwrap();
        let motion = Motion::repeated(&segments);
        let long = smooth(&written_out(&one, 41), cutoff_hz).unwrap();
        let mut worst = [0.0_f64; 3];
        for i in 0..2_000 {
            // Both sides of a join in the middle.
            let t = 19.5 + f64::from(i) * 1e-3;
            let expected = state(at(&long, t), t);
            let found = motion.at(t);
            let found = [found.phi_rad, found.omega_rad_s, found.omega_dot];
            for (worst, (x, y)) in worst.iter_mut().zip(found.iter().zip(expected)) {
                *worst = worst.max((x - y).abs());
            }
        }
        println!("{count} samples, {cutoff_hz} Hz: off by {worst:?}");
        // Rounding of times near 20 s, seen by intervals of a hundredth.
        assert!(
            worst[0] < 2e-13 && worst[1] < 2e-11 && worst[2] < 5e-9,
            "{worst:?}"
        );
    }
}

#[test]
fn a_sine_keeps_its_phase_and_the_amplitude_of_the_filter_also_at_the_join() {
    for (rate_hz, periods) in [(100.0, 1.0), (100.0, 3.0), (5_000.0, 2.0)] {
        let frequency_hz = 2.0;
        let duration_s = periods / frequency_hz;
        let mut count = 0;
        let time_s: Vec<f64> = std::iter::repeat_with(|| {
            count += 1;
            f64::from(count - 1) / rate_hz
        })
        .take_while(|t| *t < duration_s + 0.5 / rate_hz)
        .collect();
        let value = |t: f64| (TAU * frequency_hz * t + 0.7).sin();
        let angle_rad = time_s.iter().map(|t| value(*t)).collect();
        for cutoff_hz in [2.0, 4.0, 6.0] {
            let recording = samples(time_s.clone(), Vec::clone(&angle_rad));
            let segments = smooth_cycle(&recording, cutoff_hz).unwrap();
            let gain = 1.0 / (1.0 + (frequency_hz / cutoff_hz).powi(4));
            let off = (0..1000)
                .map(|i| f64::from(i) * 1e-3 * duration_s)
                .map(|t| (at(&segments, t).angle_rad(t) / gain - value(t)).abs())
                .fold(0.0, f64::max);
            assert!(off < 2e-3, "{rate_hz} Hz, cutoff {cutoff_hz} Hz: {off}");
        }
    }
}

#[test]
fn ends_that_differ_are_closed_evenly_up_to_a_bound() {
    let ends_rad = 1.5_f64.to_radians();
    let (closed, open) = (cycle(5, 100, 1.0, 0.0), cycle(5, 100, 1.0, ends_rad));
    // By hand: a line over the cycle.
    let mut expected = closed.clone();
    for (t, y) in expected.time_s.iter().zip(&mut expected.angle_rad) {
        *y -= ends_rad * (t - 0.5);
    }
    *expected.angle_rad.last_mut().unwrap() = expected.angle_rad[0];
    let found = smooth_cycle(&open, 6.0).unwrap();
    for (a, b) in found.iter().zip(smooth_cycle(&expected, 6.0).unwrap()) {
        assert!((a.angle_rad(a.start_s) - b.angle_rad(b.start_s)).abs() < 1e-13);
    }
    for ends_deg in [2.01_f64, -2.01, 90.0] {
        let error = smooth_cycle(&cycle(5, 100, 1.0, ends_deg.to_radians()), 6.0).unwrap_err();
        assert!(matches!(error, RecordingError::NoCycle { .. }), "{error}");
        let text = error.to_string();
        assert!(
            text.contains("within 2 deg") && text.contains("whole cycles"),
            "{text}"
        );
    }
}

#[test]
fn a_cycle_of_few_samples_is_refused() {
    let few = |count| smooth_cycle(&cycle(6, count, 1.0, 0.0), 0.5);
    few(6).unwrap();
    let error = few(5).unwrap_err();
    assert!(
        matches!(error, RecordingError::ShortCycle { found: 5, .. }),
        "{error}"
    );
    // Many, but within less than six bins.
    let error = smooth_cycle(&cycle(6, 500, 0.01, 0.0), 6.0).unwrap_err();
    assert!(
        matches!(error, RecordingError::ShortCycle { .. }),
        "{error}"
    );
    let error = smooth_cycle(&cycle(6, 100, 1.0, 0.0), 60.0).unwrap_err();
    assert!(matches!(error, RecordingError::Cutoff { .. }), "{error}");
}
