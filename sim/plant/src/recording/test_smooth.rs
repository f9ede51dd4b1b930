//! The spline against its transfer function, and its continuity.

use super::{CubicSegment, RecordingError, Samples, acceleration_ripple_rad_s2, smooth};
use fastrand::Rng;
use std::f64::consts::{PI, TAU};

fn samples(time_s: Vec<f64>, angle: impl Fn(f64) -> f64) -> Samples {
    let angle_rad = time_s.iter().map(|&t| angle(t)).collect();
    Samples {
        time_s,
        angle_rad,
        ..Samples::default()
    }
}

fn regular(rate_hz: f64, duration_s: f64) -> Vec<f64> {
    (0..1_000_000)
        .map(|i| f64::from(i) / rate_hz)
        .take_while(|t| *t <= duration_s)
        .collect()
}

/// Every interval changed by up to ±`share`.
fn jittered(rate_hz: f64, duration_s: f64, share: f64) -> Vec<f64> {
    let mut random = Rng::with_seed(1);
    let mut time_s = vec![0.0];
    while let Some(&t) = time_s.last()
        && t < duration_s
    {
        time_s.push(t + (1.0 + share * (2.0 * random.f64() - 1.0)) / rate_hz);
    }
    time_s
}

fn at(segments: &[CubicSegment], time_s: f64) -> &CubicSegment {
    let index = segments.partition_point(|s| s.end_s < time_s);
    &segments[index.min(segments.len() - 1)]
}

/// Amplitude and delay in s of the part at `frequency_hz` over whole periods in the interior.
fn response(segments: &[CubicSegment], frequency_hz: f64) -> (f64, f64) {
    let margin_s = 1.0;
    let duration_s = segments.last().unwrap().end_s - 2.0 * margin_s;
    let periods = (duration_s * frequency_hz).floor();
    let n = 20_000;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for i in 0..n {
        let t = margin_s + periods / frequency_hz * f64::from(i) / f64::from(n);
        let angle = at(segments, t).angle_rad(t);
        sine += angle * (TAU * frequency_hz * t).sin() * 2.0 / f64::from(n);
        cosine += angle * (TAU * frequency_hz * t).cos() * 2.0 / f64::from(n);
    }
    (
        sine.hypot(cosine),
        -cosine.atan2(sine) / (TAU * frequency_hz),
    )
}

fn assert_response(time_s: &[f64], cutoff_hz: f64, frequency_hz: f64, tolerance: f64) {
    let sine = samples(time_s.to_vec(), |t| (TAU * frequency_hz * t).sin());
    let segments = smooth(&sine, cutoff_hz).unwrap();
    let (amplitude, delay_s) = response(&segments, frequency_hz);
    let expected = 1.0 / (1.0 + (frequency_hz / cutoff_hz).powi(4));
    let what = format!("{frequency_hz} Hz at cutoff {cutoff_hz} Hz");
    assert!(
        (amplitude / expected - 1.0).abs() < tolerance,
        "{what}: {amplitude} {expected}"
    );
    assert!(delay_s.abs() < 1e-4, "{what}: delay {delay_s} s");
}

#[test]
fn the_amplitude_is_that_of_a_dual_pass_butterworth_and_the_phase_is_zero() {
    for frequency_hz in [0.5, 2.0, 4.0, 6.0, 8.0, 12.0] {
        assert_response(&regular(100.0, 8.0), 6.0, frequency_hz, 0.01);
        assert_response(&regular(148.3, 8.0), 6.0, frequency_hz, 0.01);
        // Dense enough to be averaged in bins first.
        assert_response(&regular(20_000.0, 8.0), 6.0, frequency_hz, 0.01);
        assert_response(&regular(1_000.0, 8.0), 10.0, frequency_hz, 0.01);
    }
}

#[test]
fn the_amplitude_does_not_depend_on_jitter_in_the_sampling() {
    for frequency_hz in [0.5, 2.0, 4.0, 6.0, 8.0] {
        assert_response(&jittered(100.0, 8.0, 0.3), 6.0, frequency_hz, 0.01);
        assert_response(&jittered(1_000.0, 8.0, 0.9), 6.0, frequency_hz, 0.01);
    }
}

#[test]
fn the_cutoff_does_not_depend_on_the_rate() {
    // One recording at 200 Hz and then at 50 Hz: the same sine keeps the same amplitude.
    let time_s: Vec<f64> = (0..1600)
        .map(|i| {
            if i < 1200 {
                f64::from(i) / 200.0
            } else {
                f64::from(i - 900) / 50.0
            }
        })
        .collect();
    assert_response(&time_s, 6.0, 5.0, 0.01);
}

#[test]
fn a_straight_line_passes_unchanged() {
    for time_s in [
        regular(100.0, 3.0),
        jittered(100.0, 3.0, 0.9),
        regular(20_000.0, 3.0),
    ] {
        let line = |t: f64| 0.3 - 1.7 * t;
        let segments = smooth(&samples(time_s.clone(), line), 6.0).unwrap();
        for &t in &time_s {
            let segment = at(&segments, t);
            assert!((segment.angle_rad(t) - line(t)).abs() < 1e-12);
            assert!((segment.omega_rad_s(t) + 1.7).abs() < 1e-10);
            assert!(segment.acceleration_rad_s2(t).abs() < 1e-8);
        }
    }
}

/// The largest jumps of φ, Ω and Ω̇ at the breaks, relative to the largest φ, Ω and Ω̇.
pub(super) fn jumps(segments: &[CubicSegment]) -> [f64; 3] {
    let state = |s: &CubicSegment, t| [s.angle_rad(t), s.omega_rad_s(t), s.acceleration_rad_s2(t)];
    let (mut jump, mut size) = ([0.0_f64; 3], [0.0_f64; 3]);
    for [left, right] in segments.array_windows() {
        assert_eq!(left.end_s, right.start_s);
        let (before, after) = (state(left, left.end_s), state(right, right.start_s));
        for i in 0..3 {
            jump[i] = jump[i].max((before[i] - after[i]).abs());
            size[i] = size[i].max(after[i].abs());
        }
    }
    [0, 1, 2].map(|i| jump[i] / size[i])
}

#[test]
fn angle_velocity_and_acceleration_are_continuous() {
    let mut random = Rng::with_seed(1);
    let mut noisy = |time_s: Vec<f64>| {
        let angle_rad = time_s
            .iter()
            .map(|t| (1.0 - (TAU * t).cos()) / 2.0 + 0.01 * random.f64())
            .collect();
        Samples {
            time_s,
            angle_rad,
            ..Samples::default()
        }
    };
    for time_s in [
        regular(50.0, 10.0),
        regular(100.0, 600.0),
        jittered(100.0, 10.0, 0.99),
        regular(1_000.0, 10.0),
        regular(20_000.0, 10.0),
    ] {
        let recording = noisy(time_s);
        for cutoff_hz in [1.0, 6.0, 20.0] {
            let segments = smooth(&recording, cutoff_hz).unwrap();
            let [angle, omega, acceleration] = jumps(&segments);
            let worst = angle.max(omega).max(acceleration);
            assert!(worst < 2e-15, "{angle:e} {omega:e} {acceleration:e}");
            assert_eq!(segments[0].start_s, 0.0);
            assert_eq!(
                segments.last().unwrap().end_s,
                *recording.time_s.last().unwrap()
            );
        }
    }
}

#[test]
fn the_smoothed_motion_follows_the_samples() {
    let knee = samples(regular(100.0, 5.0), |t| 0.5 * (1.0 - (TAU * t).cos()));
    let segments = smooth(&knee, 6.0).unwrap();
    for (&t, &y) in knee.time_s.iter().zip(&knee.angle_rad) {
        assert!((at(&segments, t).angle_rad(t) - y).abs() < 0.02);
    }
}

#[test]
fn the_ripple_is_the_largest_change_of_acceleration_between_breaks() {
    let segment = |start_s, c3| CubicSegment {
        start_s,
        end_s: start_s + 0.5,
        c: [0., 1., 2., c3],
    };
    assert_eq!(acceleration_ripple_rad_s2(&[]), 0.0);
    assert_eq!(
        acceleration_ripple_rad_s2(&[segment(0.0, 1.0), segment(0.5, -2.0)]),
        6.0
    );
    // A sine of 1 Hz at 100 Hz: the largest Ω̈ over 10 ms.
    let sine = samples(regular(100.0, 5.0), |t| (TAU * t).sin());
    let ripple = acceleration_ripple_rad_s2(&smooth(&sine, 20.0).unwrap());
    assert!(
        (ripple / (TAU.powi(3) * 0.01) - 1.0).abs() < 0.15,
        "{ripple}"
    );
}

#[test]
fn the_cutoff_is_limited_by_the_sampling() {
    let recording = samples(regular(100.0, 2.0), f64::sin);
    assert!((recording.nyquist_hz() - 50.0).abs() < 1e-9);
    for cutoff_hz in [0.0, -6.0, 50.1, f64::NAN, f64::INFINITY] {
        let error = smooth(&recording, cutoff_hz).unwrap_err();
        assert!(matches!(error, RecordingError::Cutoff { .. }), "{error}");
    }
    let error = smooth(&recording, 60.0).unwrap_err().to_string();
    let start = "a cutoff of 60 Hz is not possible: it must be above 0 and below 50.0000 Hz";
    assert!(error.starts_with(start), "{error}");
    smooth(&recording, 49.0).unwrap();
}

#[test]
fn a_recording_of_few_bins_is_too_short() {
    let short = samples(regular(100_000.0, 0.005), f64::sin);
    assert!(matches!(
        smooth(&short, 6.0),
        Err(RecordingError::TooShort { .. })
    ));
    smooth(&short, 100.0).unwrap();
}

#[test]
fn four_samples_are_enough() {
    let segments = smooth(&samples(vec![0.0, 0.02, 0.04, 0.06], |t| PI * t), 6.0).unwrap();
    assert_eq!(segments.len(), 3);
}

#[test]
fn samples_that_break_their_promises_are_refused() {
    let good = samples(regular(100.0, 0.1), f64::sin);
    let broken = |change: fn(&mut Samples)| {
        let mut samples = good.clone();
        change(&mut samples);
        let error = smooth(&samples, 6.0).unwrap_err();
        assert!(
            matches!(error, RecordingError::BadSamples { .. }),
            "{error}"
        );
    };
    broken(|s| s.time_s.push(1.0));
    broken(|s| s.angle_rad[3] = f64::NAN);
    broken(|s| s.time_s[3] = s.time_s[2]);
    broken(|s| {
        s.time_s.truncate(3);
        s.angle_rad.truncate(3);
    });
}

#[test]
fn odd_spacing_does_not_break_the_solver() {
    let mut random = Rng::with_seed(1);
    for round in 0..200 {
        let mut time_s = vec![0.0];
        for _ in 0..(4 + round) {
            let step_s = 10_f64.powf(6.0 * random.f64() - 6.0);
            time_s.push(time_s.last().unwrap() + step_s);
        }
        let angle_rad = time_s.iter().map(|_| random.f64()).collect();
        let recording = Samples {
            time_s,
            angle_rad,
            ..Samples::default()
        };
        match smooth(&recording, 0.2 * recording.nyquist_hz().min(50.0)) {
            Ok(segments) => {
                assert!(segments.iter().all(|s| s.c.iter().all(|c| c.is_finite())));
                assert!(jumps(&segments)[1] < 1e-9);
            }
            Err(error) => assert!(matches!(error, RecordingError::TooShort { .. }), "{error}"),
        }
    }
}
