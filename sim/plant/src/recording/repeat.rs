//! A recording of one cycle as a motion without end: the periodic smoothing spline.
//!
//! The spline has the least Σ w (y − f)² + λ ∫ f″² dt of all functions with the period of the
//! cycle, so it is what [`smooth`](super::smooth) makes of the cycle written many times one after
//! the other, far from both ends. The last sample is the first of the next cycle: the period is the
//! time from the first sample to the last, and φ, Ω and Ω̇ are continuous at the join as at every
//! other sample.
//!
//! First and last angle of a recorded cycle differ by a little. That difference d is taken out
//! as a line over the whole cycle, y − d (t/T − ½): it changes no angle by more than d/2 and every
//! velocity by d/T. Put into one place it would be a jump there.

use super::cyclic_bands::{Equation, LEAST, solve};
use super::smooth::{CubicSegment, Knot, average, bin_s, check, check_cutoff, cubics};
use super::{RecordingError, Samples};
use std::f64::consts::TAU;

/// The most that the last angle may differ from the first, in degrees: as much as strides of
/// one person do. More is no whole cycle.
pub const MAX_JOIN_DEG: f64 = 2.0;

/// One cycle of the motion below `cutoff_hz`: segments from 0 to the period, the last of which
/// goes on in the first with φ, Ω and Ω̇ continuous to rounding.
///
/// # Errors
/// Those of [`smooth`](super::smooth); ends that differ by more than [`MAX_JOIN_DEG`]; fewer
/// samples in a cycle than a periodic spline needs.
pub fn smooth_cycle(
    samples: &Samples,
    cutoff_hz: f64,
) -> Result<Vec<CubicSegment>, RecordingError> {
    check(samples)?;
    check_cutoff(samples, cutoff_hz)?;
    let Samples {
        time_s, angle_rad, ..
    } = samples;
    let (Some((last_s, time_s)), Some((last_rad, angle_rad)), Some(&first_rad)) = (
        time_s.split_last(),
        angle_rad.split_last(),
        angle_rad.first(),
    ) else {
        return Ok(Vec::new());
    };
    let (period_s, ends_rad) = (*last_s, last_rad - first_rad);
    if ends_rad.abs() > MAX_JOIN_DEG.to_radians() {
        return Err(RecordingError::NoCycle {
            first_deg: first_rad.to_degrees(),
            last_deg: last_rad.to_degrees(),
        });
    }
    let closed = |(t, y): (&f64, &f64)| y - ends_rad * (t / period_s - 0.5);
    let angle_rad: Vec<f64> = time_s.iter().zip(angle_rad).map(closed).collect();
    let knots = average(
        time_s,
        &angle_rad,
        &weights(time_s, period_s),
        bin_s(cutoff_hz),
    );
    if knots.len() < LEAST {
        return Err(RecordingError::ShortCycle {
            found: knots.len(),
            needed: LEAST,
            cutoff_hz,
        });
    }
    let mut time_s: Vec<f64> = knots.iter().map(|knot| knot.time_s).collect();
    let mut angle_rad = low_pass(&knots, period_s, TAU * cutoff_hz);
    let mut acceleration = accelerations(&time_s, &angle_rad, period_s);
    for values in [&mut angle_rad, &mut acceleration] {
        values.extend(values.first().copied());
    }
    time_s.extend(time_s.first().map(|first| first + period_s));
    let mut segments = cubics(&time_s, &angle_rad, &acceleration);
    begin_at_zero(&mut segments, period_s);
    if segments.iter().any(|s| s.c.iter().any(|c| !c.is_finite())) {
        let reason = "its values are not finite".to_owned();
        return Err(RecordingError::Spline { reason });
    }
    Ok(segments)
}

/// Half the time between the neighbours of each sample, round the cycle.
fn weights(time_s: &[f64], period_s: f64) -> Vec<f64> {
    round(time_s, period_s)
        .map(|[before, _, after]| 0.5 * (after - before))
        .collect()
}

/// The time before, at and after each sample; the first follows the last after a period.
fn round(time_s: &[f64], period_s: f64) -> impl Iterator<Item = [f64; 3]> {
    let before = time_s.last().map(|last| last - period_s).into_iter();
    let after = time_s.first().map(|first| first + period_s);
    before
        .chain(time_s.iter().copied())
        .zip(time_s.iter().copied())
        .zip(time_s.iter().copied().skip(1).chain(after))
        .map(|((before, at), after)| [before, at, after])
}

/// The values and their neighbours, round the cycle.
fn neighbours(values: &[f64]) -> impl Iterator<Item = [f64; 3]> {
    round(values, 0.0)
}

/// The periodic smoothing spline's values at the knots: Reinsch's equations, as in
/// `smoothing_spline`, with as many second differences as knots.
fn low_pass(knots: &[Knot], period_s: f64, omega_c: f64) -> Vec<f64> {
    let of = |pick: fn(&Knot) -> f64| -> Vec<f64> { knots.iter().map(pick).collect() };
    let (time_s, angle_rad) = (of(|knot| knot.time_s), of(|knot| knot.angle_rad));
    let per_weight: Vec<f64> = knots
        .iter()
        .map(|knot| 1.0 / (omega_c * knot.weight_s))
        .collect();
    // Spacing before each knot, and after it, in 1/ωc.
    let spacings: Vec<[f64; 2]> = round(&time_s, period_s)
        .map(|[before, at, after]| [omega_c * (at - before), omega_c * (after - at)])
        .collect();
    let differences: Vec<[f64; 3]> = spacings
        .iter()
        .map(|[h0, h1]| [1.0 / h0, -1.0 / h0 - 1.0 / h1, 1.0 / h1])
        .collect();
    let count = knots.len();
    let equations: Vec<Equation> = spacings
        .iter()
        .zip(&differences)
        .zip(neighbours(&angle_rad))
        .zip(neighbours(&per_weight))
        .enumerate()
        .map(|(j, ((([h0, h1], q), [y0, y1, y2]), [v0, v1, v2]))| {
            let of_next = |k: usize| differences.get((j + k) % count).copied();
            let (next, after) = (
                of_next(1).unwrap_or_default(),
                of_next(2).unwrap_or_default(),
            );
            Equation {
                diagonal: (h0 + h1) / 3.0 + q[0] * q[0] * v0 + q[1] * q[1] * v1 + q[2] * q[2] * v2,
                next: h1 / 6.0 + q[1] * v1 * next[0] + q[2] * v2 * next[1],
                after: q[2] * v2 * after[0],
                right: (y2 - y1) / h1 - (y1 - y0) / h0,
            }
        })
        .collect();
    let curvature = solve(&equations);
    // Each knot is in the differences about itself and about both neighbours.
    let shares = |k: usize| {
        let pairs = differences.iter().zip(&curvature);
        pairs
            .map(move |(q, gamma)| q[k] * gamma)
            .collect::<Vec<f64>>()
    };
    let (left, middle, right) = (shares(0), shares(1), shares(2));
    let sums = (neighbours(&left).zip(neighbours(&right)).zip(&middle))
        .map(|(([_, _, from_next], [from_before, _, _]), own)| from_before + own + from_next);
    angle_rad
        .iter()
        .zip(&per_weight)
        .zip(sums)
        .map(|((y, v), sum)| y - v * sum)
        .collect()
}

/// Ω̇ at the knots of the periodic cubic spline through the values:
/// h₋ M₋ + 2(h₋ + h₊) M + h₊ M₊ = 6 (slope₊ − slope₋), round the cycle.
fn accelerations(time_s: &[f64], angle_rad: &[f64], period_s: f64) -> Vec<f64> {
    let equations: Vec<Equation> = round(time_s, period_s)
        .zip(neighbours(angle_rad))
        .map(|([t0, t1, t2], [y0, y1, y2])| {
            let (h0, h1) = (t1 - t0, t2 - t1);
            Equation {
                diagonal: 2.0 * (h0 + h1),
                next: h1,
                after: 0.0,
                right: 6.0 * ((y2 - y1) / h1 - (y1 - y0) / h0),
            }
        })
        .collect();
    solve(&equations)
}

/// Moves the last segment's part beyond the period to before the first segment. Where samples were
/// averaged, the first knot is after 0.
fn begin_at_zero(segments: &mut Vec<CubicSegment>, period_s: f64) {
    let (Some(first), Some(last)) = (segments.first().copied(), segments.last_mut()) else {
        return;
    };
    last.end_s = period_s;
    if first.start_s > 0.0 {
        let c = [
            last.angle_rad(period_s),
            last.omega_rad_s(period_s),
            0.5 * last.acceleration_rad_s2(period_s),
            last.c[3],
        ];
        let before = CubicSegment {
            start_s: 0.0,
            end_s: first.start_s,
            c,
        };
        segments.insert(0, before);
    }
}
