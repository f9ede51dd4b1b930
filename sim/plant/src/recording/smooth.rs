//! A zero-phase low-pass and a C² interpolation in one: the cubic smoothing spline.
//!
//! Of all functions f it is the one with the least
//! ```text
//! Σ wᵢ (yᵢ − f(tᵢ))² + λ ∫ f″² dt,     wᵢ = half the time between the neighbours of sample i
//! ```
//! and it is a natural cubic spline: a cubic between the samples, φ, Ω and Ω̇ continuous, straight
//! beyond the ends. With these weights the sum is the trapezoidal rule of an integral, so what the
//! spline does to a motion depends on λ alone and not on the sampling, even where that is
//! irregular. The Euler equation of the integral is f + λ f⁗ = y. A sine of angular frequency ω
//! then keeps the amplitude
//! ```text
//! 1 / (1 + λ ω⁴) = 1 / (1 + (ω/ωc)⁴),     λ = 1/ωc⁴,  ωc = 2π · cutoff
//! ```
//! and its phase: the magnitude of a second-order Butterworth filter run forwards and backwards,
//! with the same cutoff. Half the amplitude is left there; where a text means 71 % (Winter's
//! correction for the dual pass), its cutoff is to be divided by 0.802. For samples at a spacing Δ
//! the exact ratio has ((2 − 2 cos ωΔ)/Δ²)² · 3/(2 + cos ωΔ) = ω⁴ (1 − (ωΔ)⁴/720 + …) in place
//! of ω⁴.
//!
//! Within about 5/ωc of either end (0.13 s at 6 Hz) there is less to average and the straight
//! continuation shows: Ω̇ is 0 at the first and the last sample.
//!
//! Time is measured in 1/ωc for the solver; sum and integral then have equal weight, whatever the
//! cutoff.
//!
//! Recordings far denser than the cutoff needs (20 kHz of a device) are first averaged over bins
//! of 1/64 of the cutoff's period: it costs 0.04 % of the amplitude at the cutoff, keeps the
//! spline well conditioned (its condition number grows with (ωc Δ)⁻⁴) and the pieces few.
//!
//! Source: Woltring, "A Fortran package for generalized, cross-validatory spline smoothing and
//! differentiation", Adv. Eng. Software 8 (1986), for splines and their Butterworth equivalence;
//! Winter, "Biomechanics and Motor Control of Human Movement", for the dual pass and the
//! customary 6 Hz in gait.

use super::smoothing_spline::smoothed;
use super::{MIN_SAMPLES, RecordingError, Samples};
use std::f64::consts::TAU;

/// Bins per period of the cutoff in which a dense recording is averaged.
const BINS_PER_PERIOD: f64 = 64.0;

/// One interval of the motion: φ(t) = c₀ + c₁ τ + c₂ τ² + c₃ τ³ with τ = t − `start_s`, in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubicSegment {
    /// The time at which the segment begins, in s.
    pub start_s: f64,
    /// The time at which the segment ends and the next begins, in s.
    pub end_s: f64,
    /// The coefficients in rad, rad/s, rad/s², rad/s³.
    pub c: [f64; 4],
}

impl CubicSegment {
    /// The angle φ at a time of the recording, in rad.
    pub fn angle_rad(&self, time_s: f64) -> f64 {
        let [c0, c1, c2, c3] = self.c;
        let tau = time_s - self.start_s;
        ((c3 * tau + c2) * tau + c1) * tau + c0
    }

    /// The velocity Ω at a time of the recording, in rad/s.
    pub fn omega_rad_s(&self, time_s: f64) -> f64 {
        let [_, c1, c2, c3] = self.c;
        let tau = time_s - self.start_s;
        (3.0 * c3 * tau + 2.0 * c2) * tau + c1
    }

    /// The segment with every angle multiplied.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        Self {
            c: self.c.map(|c| by * c),
            ..self
        }
    }

    /// The acceleration Ω̇ at a time of the recording, in rad/s².
    pub fn acceleration_rad_s2(&self, time_s: f64) -> f64 {
        let [_, _, c2, c3] = self.c;
        6.0 * c3 * (time_s - self.start_s) + 2.0 * c2
    }
}

/// The motion of `samples` below `cutoff_hz`: segments that follow each other without gaps from
/// the first sample to the last, with φ, Ω and Ω̇ continuous to rounding.
///
/// # Errors
/// A cutoff that is not between 0 and [`Samples::nyquist_hz`], a recording shorter than a few bins
/// of the cutoff, and samples that break the promises of [`Samples`].
pub fn smooth(samples: &Samples, cutoff_hz: f64) -> Result<Vec<CubicSegment>, RecordingError> {
    check(samples)?;
    check_cutoff(samples, cutoff_hz)?;
    let bin_s = bin_s(cutoff_hz);
    let Samples {
        time_s, angle_rad, ..
    } = samples;
    let knots = average(time_s, angle_rad, &weights(time_s), bin_s);
    if knots.len() < MIN_SAMPLES {
        return Err(RecordingError::TooShort {
            duration_s: samples.duration_s(),
            cutoff_hz,
            // A bin and the samples up to the next are at most two bins of regular sampling.
            enough_s: 6.0 * bin_s,
        });
    }
    let time_s: Vec<f64> = knots.iter().map(|knot| knot.time_s).collect();
    let angle_rad = low_pass(&knots, TAU * cutoff_hz)?;
    let mut segments = natural_spline(&time_s, &angle_rad);
    extend(&mut segments, samples);
    Ok(segments)
}

/// The largest change of Ω̇ from one break to the next, in rad/s².
///
/// Within a segment Ω̇ is straight and at a break its slope changes, so this is also the most that
/// the sampling of the recording can show in Ω̇.
pub fn acceleration_ripple_rad_s2(segments: &[CubicSegment]) -> f64 {
    let change = |segment: &CubicSegment| {
        let [_, _, _, c3] = segment.c;
        (6.0 * c3 * (segment.end_s - segment.start_s)).abs()
    };
    segments.iter().map(change).fold(0.0, f64::max)
}

/// The time over which dense samples are averaged, in s.
pub(super) fn bin_s(cutoff_hz: f64) -> f64 {
    1.0 / (BINS_PER_PERIOD * cutoff_hz)
}

/// A cutoff that the samples hold.
pub(super) fn check_cutoff(samples: &Samples, cutoff_hz: f64) -> Result<(), RecordingError> {
    let nyquist_hz = samples.nyquist_hz();
    if cutoff_hz > 0.0 && cutoff_hz < nyquist_hz {
        return Ok(());
    }
    Err(RecordingError::Cutoff {
        cutoff_hz,
        nyquist_hz,
    })
}

/// `Samples` can be built by hand, and the solver panics where these fail.
pub(super) fn check(samples: &Samples) -> Result<(), RecordingError> {
    let bad = |index, problem| Err(RecordingError::BadSamples { index, problem });
    let Samples {
        time_s, angle_rad, ..
    } = samples;
    if time_s.len() != angle_rad.len() {
        return bad(
            time_s.len().min(angle_rad.len()),
            "there is a time or an angle, but not both",
        );
    }
    if time_s.len() < MIN_SAMPLES {
        return bad(time_s.len(), "is missing, at least 4 samples are needed");
    }
    if let Some(index) = time_s
        .iter()
        .zip(angle_rad)
        .position(|(t, y)| !(t + y).is_finite())
    {
        return bad(index, "is not finite");
    }
    if let Some(index) = time_s
        .array_windows()
        .position(|[before, after]| after <= before)
    {
        return bad(index + 1, "is not later than the one before");
    }
    Ok(())
}

/// A time and angle that stand for `weight_s` of the recording.
pub(super) struct Knot {
    pub(super) time_s: f64,
    pub(super) angle_rad: f64,
    pub(super) weight_s: f64,
}

/// Half the time between the neighbours of each sample; at the ends there is one only.
fn weights(time_s: &[f64]) -> Vec<f64> {
    let before = time_s.first().into_iter().chain(time_s);
    let after = time_s.iter().skip(1).chain(time_s.last());
    before
        .zip(after)
        .map(|(before, after)| 0.5 * (after - before))
        .collect()
}

/// The means over bins; a bin begins at the first sample that the bin before does not hold.
/// Where the samples are further apart than a bin, each is its own.
pub(super) fn average(
    time_s: &[f64],
    angle_rad: &[f64],
    weight_s: &[f64],
    bin_s: f64,
) -> Vec<Knot> {
    let mut knots: Vec<Knot> = Vec::new();
    let mut bin_start_s = f64::NEG_INFINITY;
    for ((&time_s, &angle_rad), &weight_s) in time_s.iter().zip(angle_rad).zip(weight_s) {
        match knots.last_mut() {
            Some(knot) if time_s < bin_start_s + bin_s => {
                knot.weight_s += weight_s;
                let share = weight_s / knot.weight_s;
                knot.time_s += share * (time_s - knot.time_s);
                knot.angle_rad += share * (angle_rad - knot.angle_rad);
            }
            _ => {
                bin_start_s = time_s;
                knots.push(Knot {
                    time_s,
                    angle_rad,
                    weight_s,
                });
            }
        }
    }
    knots
}

/// The smoothing spline's values at the knots.
fn low_pass(knots: &[Knot], omega_c: f64) -> Result<Vec<f64>, RecordingError> {
    let time: Vec<f64> = knots.iter().map(|knot| omega_c * knot.time_s).collect();
    let angle: Vec<f64> = knots.iter().map(|knot| knot.angle_rad).collect();
    let weight: Vec<f64> = knots.iter().map(|knot| omega_c * knot.weight_s).collect();
    let values = smoothed(&time, &angle, &weight);
    if values.iter().any(|value| !value.is_finite()) {
        let reason = "its values are not finite".to_owned();
        return Err(RecordingError::Spline { reason });
    }
    Ok(values)
}

/// The natural cubic spline through the values.
///
/// The smoothing spline is the natural spline through its own values, but its solver works on the
/// stiff smoothing equations and leaves Ω continuous to 1e-12 only. The equations of the natural
/// spline are diagonally dominant and leave it continuous to rounding, φ and Ω̇ exactly:
/// h₋ M₋ + 2(h₋ + h₊) M + h₊ M₊ = 6 (slope₊ − slope₋), M = Ω̇ at a knot, 0 at both ends.
fn natural_spline(time_s: &[f64], angle_rad: &[f64]) -> Vec<CubicSegment> {
    let mut sweep = Vec::with_capacity(time_s.len());
    let (mut ratio, mut part) = (0.0, 0.0);
    for ([t0, t1, t2], [y0, y1, y2]) in time_s.array_windows().zip(angle_rad.array_windows()) {
        let (h0, h1) = (t1 - t0, t2 - t1);
        let pivot = 2.0 * (h0 + h1) - h0 * ratio;
        part = (6.0 * ((y2 - y1) / h1 - (y1 - y0) / h0) - h0 * part) / pivot;
        ratio = h1 / pivot;
        sweep.push((ratio, part));
    }
    let mut acceleration = vec![0.0];
    let mut next = 0.0;
    for (ratio, part) in sweep.into_iter().rev() {
        next = part - ratio * next;
        acceleration.push(next);
    }
    acceleration.push(0.0);
    acceleration.reverse();

    cubics(time_s, angle_rad, &acceleration)
}

/// The cubics between knots with these angles and Ω̇.
pub(super) fn cubics(time_s: &[f64], angle_rad: &[f64], acceleration: &[f64]) -> Vec<CubicSegment> {
    let knots = time_s.array_windows().zip(angle_rad.array_windows());
    knots
        .zip(acceleration.array_windows())
        .map(|(([t0, t1], [y0, y1]), [m0, m1])| {
            let h = t1 - t0;
            let c1 = (y1 - y0) / h - h * (2.0 * m0 + m1) / 6.0;
            CubicSegment {
                start_s: *t0,
                end_s: *t1,
                c: [*y0, c1, 0.5 * m0, (m1 - m0) / (6.0 * h)],
            }
        })
        .collect()
}

/// Straight pieces from the first sample to the first knot and from the last knot to the last
/// sample, which are apart by less than a bin where samples were averaged.
fn extend(segments: &mut Vec<CubicSegment>, samples: &Samples) {
    if let (Some(last), Some(&end_s)) = (segments.last(), samples.time_s.last())
        && last.end_s < end_s
    {
        let at = last.end_s;
        let c = [last.angle_rad(at), last.omega_rad_s(at), 0.0, 0.0];
        segments.push(CubicSegment {
            start_s: at,
            end_s,
            c,
        });
    }
    if let (Some(first), Some(&start_s)) = (segments.first(), samples.time_s.first())
        && start_s < first.start_s
    {
        let [c0, c1, ..] = first.c;
        let c = [c0 - c1 * (first.start_s - start_s), c1, 0.0, 0.0];
        segments.insert(
            0,
            CubicSegment {
                start_s,
                end_s: first.start_s,
                c,
            },
        );
    }
}
