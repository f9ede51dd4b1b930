//! Measures of whole arrays, by other algorithms than those that go sample by sample: strokes, a catch,
//! clonus, and the ends of a range, each from a closed form.

use super::*;
use std::f64::consts::PI;
use std::vec::Vec;

const TICK_S: f64 = 5e-5;

/// Time, angle, velocity, torque.
type Sample = [f64; 4];

/// A movement: angle at its end, °, its highest speed, °/s, and the rest after it, s.
type Movement = (f64, f64, f64);

/// Minimum-jerk movements one after another, from an angle, °, without a torque.
fn moved(from_deg: f64, movements: &[Movement]) -> Vec<Sample> {
    let (mut samples, mut from_rad, mut begin_s) = (Vec::new(), from_deg.to_radians(), 0.0);
    for (to_deg, peak_deg_s, rest_s) in movements {
        let travel = to_deg.to_radians() - from_rad;
        let length_s = 1.875 * travel.abs() / peak_deg_s.to_radians();
        let end_s = begin_s + length_s + rest_s;
        while f64::from(u32::try_from(samples.len()).unwrap()) * TICK_S < end_s {
            let time_s = f64::from(u32::try_from(samples.len()).unwrap()) * TICK_S;
            let s = ((time_s - begin_s) / length_s).min(1.0);
            let way = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
            let speed = 30.0 * s * s * (1.0 - s) * (1.0 - s) / length_s;
            samples.push([time_s, from_rad + travel * way, travel * speed, 0.0]);
        }
        (from_rad, begin_s) = (to_deg.to_radians(), end_s);
    }
    samples
}

fn examined(samples: &[Sample]) -> Examination {
    let mut examination = Examination::default();
    for [time_s, angle_rad, omega_rad_s, torque_nm] in samples {
        examination.take(*time_s, *angle_rad, *omega_rad_s, *torque_nm);
    }
    examination
}

#[track_caller]
fn is_near(examination: &Examination, measure: Measure, expected: f64, within: f64) {
    let found = examination.measure(measure);
    let is_near = found.is_some_and(|found| (found - expected).abs() <= within);
    assert!(is_near, "{measure:?}: {found:?} for {expected}");
}

/// Indices at which the leg has turned, of the whole array: the highest and the lowest of each time
/// between two crossings of the middle.
fn turns(samples: &[Sample]) -> Vec<usize> {
    let angles = || samples.iter().map(|sample| sample[1]);
    let middle = 0.5 * (angles().fold(f64::MAX, f64::min) + angles().fold(f64::MIN, f64::max));
    let mut found = Vec::new();
    let mut begin = 0;
    while begin < samples.len() {
        let is_above = samples[begin][1] > middle;
        let rest = &samples[begin..];
        let side = rest.iter().take_while(|s| (s[1] > middle) == is_above);
        let end = begin + side.count();
        let height = |i: &usize| (samples[*i][1] - middle).abs();
        found.extend((begin..end).max_by(|a, b| height(a).total_cmp(&height(b))));
        begin = end;
    }
    found
}

/// Speed, unsteadiness and smoothness of a stroke of the array, which is monotonous: by interpolation in
/// it, and by the derivatives of its velocity.
fn shape(stroke: &[Sample]) -> [f64; 3] {
    let [first, .., last] = stroke else {
        panic!("no stroke");
    };
    let travel = last[1] - first[1];
    let at = |share: f64| stroke.partition_point(|s| (s[1] - first[1]) / travel < share);
    let time = |share: f64| stroke[at(share)][0];
    let speed = 0.5 * travel.abs() / (time(0.75) - time(0.25));
    let middle = &stroke[at(0.25)..at(0.75)];
    let mean_of = |value: &dyn Fn(f64) -> f64| {
        let sum: f64 = middle.iter().map(|s| value(s[2].abs())).sum();
        sum / f64::from(u32::try_from(middle.len()).unwrap())
    };
    let mean = mean_of(&|v| v);
    let variance = mean_of(&|v| (v - mean) * (v - mean));
    let [from, to] = [at(0.05), at(0.95)];
    // Over 2 ms.
    let jerk = |i: usize| {
        let h = 40.0 * TICK_S;
        (stroke[i + 40][2] - 2.0 * stroke[i][2] + stroke[i - 40][2]) / (h * h)
    };
    let squares: f64 = (from..to).map(|i| jerk(i) * jerk(i) * TICK_S).sum();
    let length_s = stroke[to][0] - stroke[from][0];
    let fastest = stroke.iter().map(|s| s[2].abs()).fold(0.0, f64::max);
    let smoothness = -(length_s.powi(3) * squares / (fastest * fastest)).ln();
    [speed, variance.sqrt() / mean, smoothness]
}

/// Torque of each sample.
fn against(samples: &mut [Sample], mut torque_nm: impl FnMut(&Sample) -> f64) {
    for sample in samples {
        sample[3] = torque_nm(sample);
    }
}

#[test]
fn strokes_agree_with_those_of_the_whole_array() {
    let movements = [
        (80.0, 45.0, 0.4),
        (4.0, 60.0, 0.3),
        (110.0, 220.0, 0.2),
        (10.0, 90.0, 0.3),
        (40.0, 30.0, 0.5),
    ];
    let samples = moved(10.0, &movements);
    let turned = turns(&samples);
    let mut strokes = Strokes::default();
    let mut means = means::Means::default();
    let mut found = Vec::new();
    for [time_s, angle_rad, ..] in &samples {
        found.extend(strokes.take(*time_s, *angle_rad));
        if let Some((at_rad, squared)) = means.take(*time_s, *angle_rad).and_then(|m| m.jerk) {
            strokes.add_jerk(at_rad, squared);
        }
    }
    // The last one has not turned.
    assert_eq!(found.len(), movements.len() - 1);
    for (stroke, from) in found.iter().zip(&turned) {
        let end = samples.partition_point(|s| s[0] <= stroke.end_s);
        let [speed, unsteadiness, smoothness] = shape(&samples[*from..end]);
        assert!((stroke.speed_rad_s / speed - 1.0).abs() < 0.01, "{speed}");
        assert!((stroke.unsteadiness - unsteadiness).abs() < 0.01);
        let of_stroke = stroke.smoothness.unwrap();
        let off = of_stroke - smoothness;
        assert!(off.abs() < 0.15, "{of_stroke}, {smoothness}");
        // Of a minimum-jerk stroke in its middle.
        assert!((smoothness + 2.94).abs() < 0.1, "{smoothness}");
    }
    let examination = examined(&samples);
    let angles = samples.iter().map(|s| s[1].to_degrees());
    let highest = angles.clone().fold(f64::MIN, f64::max);
    let lowest = angles.fold(f64::MAX, f64::min);
    is_near(&examination, Measure::Range, highest - lowest, 1e-9);
    is_near(&examination, Measure::Flexion, highest, 1e-9);
    let fastest = samples.iter().map(|s| s[2].abs()).fold(0.0, f64::max);
    is_near(&examination, Measure::PeakSpeed, fastest.to_degrees(), 1.0);
    // Nothing was felt.
    for measure in [
        Measure::Catch,
        Measure::Dynamic,
        Measure::Beats,
        Measure::BeatRate,
    ] {
        assert_eq!(examination.measure(measure), None, "{measure:?}");
    }
    // It came to 4°.
    is_near(&examination, Measure::Deficit, 0.0, 1e-9);
}

/// Index of the first torque that is 0.25 N·m above all of the 300 to 50 ms before, beyond 6° of a
/// stroke.
fn first_rise(samples: &[Sample], from: usize) -> usize {
    let begin = samples[from][1] + 6.0_f64.to_radians();
    (from..samples.len())
        .filter(|i| samples[*i][1] > begin)
        .find(|i| {
            let before = samples[i.saturating_sub(6_000).max(from)..i - 1_000].iter();
            samples[*i][3] - before.map(|s| s[3]).fold(0.0, f64::max) >= 0.25
        })
        .unwrap()
}

/// As `spasticity`, form `catch`, of MAS 2: caught where φ − 75° + 0.25·Ω ≥ 0 from 40 °/s on.
#[test]
fn a_catch_is_where_the_whole_array_rises() {
    for peak_deg_s in [120.0, 200.0, 280.0] {
        let mut samples = moved(
            5.0,
            &[
                (100.0, 35.0, 0.3),
                (5.0, 60.0, 0.3),
                (110.0, peak_deg_s, 0.3),
                (5.0, 60.0, 0.2),
            ],
        );
        let mut caught: Option<(f64, f64, f64)> = None;
        against(&mut samples, |[time_s, angle_rad, omega_rad_s, _]| {
            let is_beyond = angle_rad - 75_f64.to_radians() + 0.25 * omega_rad_s >= 0.0;
            if caught.is_none() && *omega_rad_s >= 40_f64.to_radians() && is_beyond {
                caught = Some((*time_s, *angle_rad, 0.67 * omega_rad_s));
            }
            let Some((since_s, at_rad, peak_nm)) = caught else {
                return 0.0;
            };
            let limit_nm = peak_nm * (0.5 + 0.5 * (-(time_s - since_s) / 0.06).exp());
            (60.0 * (angle_rad - at_rad)).min(limit_nm).max(0.0)
        });
        let (_, at_rad, _) = caught.unwrap();
        let fast = samples.iter().position(|s| s[2] > 1.0 && s[0] > 5.0);
        let before = samples[..fast.unwrap()].iter();
        let turn = before.rev().position(|s| s[2] == 0.0).unwrap();
        let turn = fast.unwrap() - 1 - turn;
        let rise_deg = samples[first_rise(&samples, turn)][1].to_degrees();
        let examination = examined(&samples);
        // Smoothed over 10 ms: late by as much.
        is_near(&examination, Measure::Catch, rise_deg, 0.01 * peak_deg_s);
        is_near(&examination, Measure::Catch, at_rad.to_degrees(), 3.0);
        is_near(&examination, Measure::SlowEnd, 100.0, 0.1);
        let found_deg = examination.measure(Measure::Catch).unwrap();
        is_near(&examination, Measure::Dynamic, 100.0 - found_deg, 0.1);
    }
}

/// As `clonus`: 8 beats that begin 50 ms after the leg has passed 60°.
#[test]
fn beats_are_those_of_the_whole_array() {
    for (frequency_hz, beats) in [(5.0, 8_u32), (6.0, 8), (7.0, 20)] {
        let mut samples = moved(30.0, &[(75.0, 200.0, 4.0), (30.0, 60.0, 0.5)]);
        let passed = samples.iter().position(|s| s[1] >= 60_f64.to_radians());
        let begin_s = samples[passed.unwrap()][0] + 0.05;
        against(&mut samples, |sample| {
            let passed = (sample[0] - begin_s) * frequency_hz;
            let share = (passed - passed.floor()) / 0.45;
            let is_on = passed >= 0.0 && passed < f64::from(beats) && share < 1.0;
            f64::from(u8::from(is_on)) * 1.5 * (PI * share).sin()
        });
        // Every local maximum of the array.
        let is_peak = |three: &&[Sample]| {
            three[1][3] > 0.5 && three[1][3] > three[0][3] && three[1][3] >= three[2][3]
        };
        let peaks = samples.windows(3).filter(is_peak).count();
        assert_eq!(peaks, usize::try_from(beats).unwrap());
        let examination = examined(&samples);
        is_near(&examination, Measure::Beats, f64::from(beats), 0.0);
        is_near(&examination, Measure::BeatRate, frequency_hz, 0.05);
        assert!(examination.has_done(Step::Hold) && examination.has_done(Step::Fast));
    }
}

/// As `range-limit` of the capsular pattern: 10° of extension are missing, and flexion ends at 105°.
#[test]
fn ends_are_where_the_whole_array_has_their_torque() {
    let mut samples = moved(
        40.0,
        &[
            (5.0, 40.0, 0.3),
            (112.0, 40.0, 0.3),
            (5.0, 40.0, 0.3),
            (40.0, 40.0, 0.2),
        ],
    );
    let end_nm = |beyond_rad: f64, k1: f64, k2: f64| {
        (k1 * beyond_rad + k2 * beyond_rad * beyond_rad).min(4.0)
    };
    against(&mut samples, |[_, angle_rad, ..]| {
        let straight = (10_f64.to_radians() - angle_rad).max(0.0);
        let bent = (angle_rad - 105_f64.to_radians()).max(0.0);
        end_nm(bent, 15.0, 150.0) - end_nm(straight, 60.0, 400.0)
    });
    let torque_at = |nm: f64| {
        let found = samples.iter().find(|s| s[3] * nm.signum() >= nm.abs());
        found.unwrap()[1].to_degrees()
    };
    let examination = examined(&samples);
    is_near(&examination, Measure::Deficit, torque_at(-0.8), 0.5);
    is_near(&examination, Measure::SlowEnd, torque_at(0.8), 0.7);
    is_near(&examination, Measure::Range, 107.0, 1e-6);
    assert_eq!(examination.measure(Measure::Catch), None);
    assert!(examination.has_done(Step::Slow) && !examination.has_done(Step::Fast));
}

/// Behind counts, with the numbers of an encoder.
#[test]
fn counts_change_no_measure() {
    let movements = [(100.0, 35.0, 0.3), (3.0, 60.0, 0.3), (90.0, 60.0, 0.3)];
    let samples = moved(5.0, &movements);
    let counted: Vec<Sample> = (samples.iter())
        .map(|[time_s, angle_rad, omega_rad_s, nm]| {
            let counted_rad = (angle_rad / 3.567e-5).floor() * 3.567e-5;
            [*time_s, counted_rad, *omega_rad_s, *nm]
        })
        .collect();
    let (exact, counted) = (examined(&samples), examined(&counted));
    let within = |measure| match measure {
        Measure::Smoothness => 0.05,
        Measure::Unsteadiness => 0.5,
        _ => 0.01,
    };
    for measure in Measure::ALL {
        let [a, b] = [&exact, &counted].map(|of| of.measure(measure));
        assert_eq!(a.is_some(), b.is_some(), "{measure:?}");
        if let (Some(a), Some(b)) = (a, b) {
            assert!((a - b).abs() < within(measure), "{measure:?}: {a}, {b}");
        }
    }
}

#[test]
fn a_gap_ends_what_was_under_way() {
    let movements = [(80.0, 60.0, 0.3), (10.0, 60.0, 0.3), (80.0, 60.0, 0.0)];
    let samples = moved(10.0, &movements);
    let middle = samples.len() / 2;
    let mut examination = Examination::default();
    for (n, [time_s, angle_rad, omega_rad_s, _]) in samples.iter().enumerate() {
        // Half a second is missing in the middle of the way back; the zero is another one then.
        if n.abs_diff(middle) < 5_000 {
            continue;
        }
        let zero_rad = if n > middle { 1.0 } else { 0.0 };
        examination.take(*time_s, *angle_rad - zero_rad, *omega_rad_s, 0.0);
    }
    examination.take(f64::NAN, 0.0, 0.0, 0.0);
    assert!(!examination.has_done(Step::Slow), "no way back was whole");
    is_near(&examination, Measure::PeakSpeed, 60.0, 1.0);
    let seconds = examination.seconds();
    let samples = f64::from(u32::try_from(samples.len()).unwrap());
    assert!((seconds - (samples * TICK_S - 0.5)).abs() < 0.01);
}

/// A leg that falls and is caught, as V2: about 140 °/s in its middle.
#[test]
fn a_fall_that_is_caught_is_a_drop() {
    let falls = |from_deg, peak_deg_s| {
        let movements = [(100.0, peak_deg_s, 0.3), (from_deg, 60.0, 0.3)];
        examined(&moved(from_deg, &movements)).has_done(Step::Drop)
    };
    assert!(falls(10.0, 150.0));
    assert!(!falls(10.0, 60.0) && !falls(10.0, 250.0) && !falls(60.0, 150.0));
}

#[test]
fn a_leg_that_is_moved_on_is_not_held() {
    // Back at once, at a speed that alone ends no hold.
    let samples = moved(10.0, &[(100.0, 200.0, 0.0), (10.0, 60.0, 0.3)]);
    let examination = examined(&samples);
    assert!(examination.has_done(Step::Fast) && !examination.has_done(Step::Hold));
}

/// That of flexors, which are stretched in extension.
#[test]
fn a_catch_in_extension_is_compared_with_the_slow_end_there() {
    let mut samples = moved(
        110.0,
        &[
            (10.0, 35.0, 0.3),
            (110.0, 60.0, 0.3),
            (5.0, 200.0, 0.3),
            (110.0, 60.0, 0.2),
        ],
    );
    against(&mut samples, |[_, angle_rad, omega_rad_s, _]| {
        let is_caught = *omega_rad_s < -1.5 && *angle_rad < 60_f64.to_radians();
        -f64::from(u8::from(is_caught))
    });
    let examination = examined(&samples);
    is_near(&examination, Measure::Catch, 60.0, 2.5);
    is_near(&examination, Measure::SlowEnd, 10.0, 0.1);
    let found_deg = examination.measure(Measure::Catch).unwrap();
    is_near(&examination, Measure::Dynamic, found_deg - 10.0, 0.1);
}
