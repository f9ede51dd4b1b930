//! The measured motion at even times, with velocity and acceleration.

use super::refusal::Refusal;
use crepitus_model::render::position::{Sensing, Travel};

/// Shortest time between two samples of a fit, s.
const STEP_S: f64 = 5e-3;

/// Half the window of the local parabola that gives velocity and acceleration, s.
const HALF_WINDOW_S: f64 = 0.03;

/// Fewest samples.
const LEAST: usize = 100;

/// Longest median interval between samples, s, and longest examination, s: memory and time grow with it.
const SLOWEST_S: f64 = 0.04;
const LONGEST_S: f64 = 600.0;

/// Longest interval without a sample, in median intervals.
const LONGEST_GAP: f64 = 20.0;

/// Angle and torque of a passive examination.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Examination {
    /// Times, s, increasing.
    pub time_s: Vec<f64>,
    /// Knee flexion, rad; 0 is straight.
    pub angle_rad: Vec<f64>,
    /// Torque with which knee and leg resist, N·m; positive against flexion. Of a released leg none.
    pub torque_nm: Vec<f64>,
    /// Inertia of a leg that swings freely (the pendulum test of Wartenberg, 1951), kg·m²; `None` if it is moved.
    pub released_kg_m2: Option<f64>,
}

/// An examination at even times.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    pub(crate) step_s: f64,
    pub(crate) time_s: Vec<f64>,
    pub(crate) angle_rad: Vec<f64>,
    pub(crate) omega_rad_s: Vec<f64>,
    pub(crate) alpha_rad_s2: Vec<f64>,
    pub(crate) torque_nm: Vec<f64>,
    /// Way from each sample to the next, as the laws take it.
    pub(crate) travels: Vec<Travel<f64>>,
    /// Whether the torque is that of the leg's own inertia.
    pub(crate) is_released: bool,
}

impl Motion {
    /// Resamples an examination: means over a step, and straight lines where steps are shorter than intervals.
    pub(crate) fn of(it: &Examination) -> Result<Self, Refusal> {
        let count = it.time_s.len();
        let is_released = it.released_kg_m2.is_some();
        if count < LEAST
            || it.angle_rad.len() != count
            || (it.torque_nm.len() != count && !is_released)
        {
            return Err(Refusal::Short { samples: count });
        }
        let mut intervals: Vec<f64> = it.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if intervals
            .iter()
            .any(|interval| interval.is_nan() || *interval <= 0.0)
        {
            return Err(Refusal::NotInOrder);
        }
        let longest = intervals.iter().copied().fold(0.0, f64::max);
        let median = *intervals
            .select_nth_unstable_by(count / 2 - 1, f64::total_cmp)
            .1;
        if longest > LONGEST_GAP * median.max(STEP_S) {
            return Err(Refusal::Gap { longest_s: longest });
        }
        let lasts_s = it.time_s[count - 1] - it.time_s[0];
        if median > SLOWEST_S {
            return Err(Refusal::Slow { hz: 1.0 / median });
        }
        if lasts_s > LONGEST_S {
            return Err(Refusal::Long {
                lasts_s,
                most_s: LONGEST_S,
            });
        }
        let all = it.angle_rad.iter().chain(&it.torque_nm);
        if all.into_iter().any(|value| !value.is_finite()) {
            return Err(Refusal::NotInOrder);
        }
        let step_s = STEP_S.max(median);
        let (first, last) = (it.time_s[0], it.time_s[count - 1]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let steps = ((last - first) / step_s) as usize;
        if steps < LEAST {
            return Err(Refusal::Short { samples: steps });
        }
        let time_s: Vec<f64> = (0..steps).map(|i| first + i as f64 * step_s).collect();
        let even = |values: &[f64]| resampled(&it.time_s, values, &time_s, step_s);
        let angle = even(&it.angle_rad);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let half = ((HALF_WINDOW_S / step_s).round() as usize).max(2);
        let [mut angle_rad, mut omega_rad_s, mut alpha_rad_s2] = parabolas(&angle, half, step_s);
        let (mut time_s, mut torque_nm) = (time_s.clone(), Vec::new());
        if let Some(inertia) = it.released_kg_m2 {
            let before = (let_go(&omega_rad_s, step_s) + half).min(time_s.len());
            for values in [
                &mut time_s,
                &mut angle_rad,
                &mut omega_rad_s,
                &mut alpha_rad_s2,
            ] {
                values.drain(..before);
            }
            // What limb and symptom resist with is what the inertia gives.
            torque_nm.extend(alpha_rad_s2.iter().map(|alpha| -inertia * alpha));
        } else {
            torque_nm = even(&it.torque_nm);
        }
        let travels = angle_rad.windows(2).zip(omega_rad_s.windows(2));
        let travels = travels.map(|(angles, omegas)| travel(angles, omegas, step_s));
        Ok(Self {
            travels: travels.collect(),
            step_s,
            time_s,
            angle_rad,
            omega_rad_s,
            alpha_rad_s2,
            torque_nm,
            is_released,
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Returns the least and the largest angle, deg.
    pub(crate) fn range_deg(&self) -> (f64, f64) {
        let angles = self.angle_rad.iter().map(|angle| angle.to_degrees());
        angles.fold((f64::MAX, f64::MIN), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    }
}

/// Returns the sample at which a leg was let go of for the last time: until the end of the last hold a hand moved it.
fn let_go(omega_rad_s: &[f64], step_s: f64) -> usize {
    /// Speed below which the leg is held, and shortest hold: a turning point is shorter.
    const STILL_RAD_S: f64 = 0.05;
    const HOLD_S: f64 = 0.3;
    let (mut released, mut still_since) = (0, 0);
    for (i, omega) in omega_rad_s.iter().enumerate() {
        if omega.abs() >= STILL_RAD_S {
            if (i - still_since) as f64 * step_s >= HOLD_S {
                released = i;
            }
            still_since = i + 1;
        }
    }
    released
}

/// Returns the way between two samples of angle, rad, and velocity, rad/s.
pub(crate) fn travel(angles: &[f64], omegas: &[f64], step_s: f64) -> Travel<f64> {
    let ([from, to], [before, after]) = ([angles[0], angles[1]], [omegas[0], omegas[1]]);
    Travel {
        to: Sensing::IDEAL.position(to),
        delta_rad: to - from,
        omega_start_rad_s: before,
        omega_end_rad_s: after,
        bend_rad: 0.5 * (after - before) * step_s,
        ticks: 1,
        length: 1.0,
        rad_per_count: Sensing::IDEAL.rad_per_count,
    }
}

/// Means of a broken line over a step about each time.
fn resampled(time_s: &[f64], values: &[f64], at_s: &[f64], step_s: f64) -> Vec<f64> {
    // The integral of the line up to each sample.
    let mut integral = Vec::with_capacity(values.len());
    let mut sum = 0.0;
    integral.push(0.0);
    for (times, pair) in time_s.windows(2).zip(values.windows(2)) {
        sum += 0.5 * (pair[0] + pair[1]) * (times[1] - times[0]);
        integral.push(sum);
    }
    let last = time_s.len() - 2;
    let up_to = |t: f64| {
        let t = t.clamp(time_s[0], time_s[last + 1]);
        let i = time_s
            .partition_point(|x| *x <= t)
            .saturating_sub(1)
            .min(last);
        let dt = t - time_s[i];
        let slope = (values[i + 1] - values[i]) / (time_s[i + 1] - time_s[i]);
        integral[i] + dt * (values[i] + 0.5 * slope * dt)
    };
    let (first, end) = (time_s[0], time_s[last + 1]);
    (at_s.iter())
        .map(|t| {
            let (from, to) = ((t - 0.5 * step_s).max(first), (t + 0.5 * step_s).min(end));
            (up_to(to) - up_to(from)) / (to - from)
        })
        .collect()
}

/// Value, slope and curvature of the parabola through `half` neighbours to either side (Savitzky & Golay 1964).
fn parabolas(values: &[f64], half: usize, step_s: f64) -> [Vec<f64>; 3] {
    let count = values.len();
    let mut out = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
    for i in 0..count {
        let reach = half.min(i).min(count - 1 - i);
        if reach < 2 {
            let j = i.clamp(1, count - 2);
            out[0][i] = values[i];
            out[1][i] = (values[j + 1] - values[j - 1]) / (2.0 * step_s);
            continue;
        }
        let (mut s0, mut s2, mut s4) = (0.0, 0.0, 0.0);
        let (mut y0, mut y1, mut y2) = (0.0, 0.0, 0.0);
        for (k, value) in values[i - reach..=i + reach].iter().enumerate() {
            let x = k as f64 - reach as f64;
            (s0, s2, s4) = (s0 + 1.0, s2 + x * x, s4 + x.powi(4));
            (y0, y1, y2) = (y0 + value, y1 + x * value, y2 + x * x * value);
        }
        let determinant = s0 * s4 - s2 * s2;
        out[0][i] = (s4 * y0 - s2 * y2) / determinant;
        out[1][i] = y1 / s2 / step_s;
        out[2][i] = 2.0 * (s0 * y2 - s2 * y0) / determinant / (step_s * step_s);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_own_derivatives() {
        let time_s: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let angle_rad: Vec<f64> = time_s.iter().map(|t| 0.3 + 0.5 * t - 0.2 * t * t).collect();
        let motion = Motion::of(&Examination {
            torque_nm: angle_rad.clone(),
            time_s,
            angle_rad,
            released_kg_m2: None,
        })
        .unwrap();
        for i in (10..motion.len() - 10).step_by(17) {
            let t = motion.time_s[i];
            assert!((motion.omega_rad_s[i] - 0.5 + 0.4 * t).abs() < 1e-6, "{t}");
            assert!((motion.alpha_rad_s2[i] + 0.4).abs() < 1e-3, "{t}");
        }
    }
}
