//! Intervals, and errors of left-out strokes.
//!
//! With the columns X of limb, amplitudes and shape at the optimum and the residual r, a fit without the rows of
//! stroke g is, to first order,
//!
//! ```text
//! Δ_g = −(XᵀX − X_gᵀX_g + P)⁻¹·X_gᵀr_g
//! cov = (G − 1)/G·Σ Δ_g·Δ_gᵀ
//! ```
//!
//! the jackknife over groups (Efron & Stein, Ann. Stat. 9 (1981), 586–596), which holds whatever the noise
//! within a stroke is like. P says that a shape lies within its range. The t of the interval has as many degrees
//! of freedom as there are strokes that count.
//!
//! What a model has wrong is the same in every stroke, at the same angle and in the same sense, which strokes do not
//! show. So the covariance of a second grouping is added, by ten degrees and sense (two-way clusters: Cameron,
//! Gelbach & Miller, J. Bus. Econ. Stat. 29 (2011), 238–249): H⁻¹·Σ g_s·g_sᵀ·H⁻¹ with H = XᵀX + P, g_s = X_sᵀr_s.

use super::motion::Motion;
use super::search::{Point, Problem};
use crate::estimate::DEVIATIONS;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::ops::Range;

/// Step of a difference quotient, share of a parameter's range.
const STEP: f64 = 4e-3;

/// Speed below which a joint is held, rad/s.
const STILL_RAD_S: f64 = 0.05;

/// A linearised fit.
pub(crate) struct Jackknife {
    /// Standard deviations of shape, then amplitudes; of a parameter that is not smooth none.
    pub(crate) covariance: DMatrix<f64>,
    /// Their covariance by what repeats at the same angle.
    by_angle: DMatrix<f64>,
    /// Change of shape and amplitudes, without each stroke.
    pub(crate) moves: Vec<DVector<f64>>,
    /// Sum of squares in each stroke by the fit without it, (N·m)².
    pub(crate) left_out: Vec<f64>,
    /// Residual, N·m.
    pub(crate) residual: Vec<f64>,
    /// Torque of the symptom, N·m.
    pub(crate) symptom: Vec<f64>,
}

impl Jackknife {
    pub(crate) fn of(problem: &Problem<'_>, point: &Point) -> Option<Self> {
        let motion = problem.motion;
        let count = motion.len();
        let signals = problem.signals(&point.shape, &point.phases)?;
        let mixed = |signals: &[Vec<f64>]| {
            let mut sum = vec![0.0; count];
            for (signal, a) in signals.iter().zip(&point.fitted.amplitudes) {
                sum.iter_mut()
                    .zip(signal)
                    .for_each(|(sum, s)| *sum += a * s);
            }
            sum
        };
        let symptom = mixed(&signals);
        let ranges = problem.symptom.shape();
        // Of the limb those between their bounds.
        let mut columns = problem.limb.free_columns(&point.fitted);
        let limb = columns.len();
        let mut prior = vec![0.0; limb];
        for (k, range) in ranges.iter().enumerate() {
            let step = STEP * (range.high - range.low);
            let moved = |by: f64| {
                let mut shape = point.shape.clone();
                shape[k] = (shape[k] + by).clamp(range.low, range.high);
                let at = shape[k];
                Some((at, mixed(&problem.signals(&shape, &point.phases)?)))
            };
            let is_smooth = range.is_smooth && point.fitted.amplitudes.iter().any(|a| *a > 0.0);
            let column = if is_smooth {
                // One-sided where a law has no such shape.
                let here = || moved(0.0);
                let ((low, less), (high, more)) =
                    (moved(-step).or_else(here)?, moved(step).or_else(here)?);
                let way = (high - low).max(1e-12);
                less.iter().zip(&more).map(|(a, b)| (b - a) / way).collect()
            } else {
                vec![0.0; count]
            };
            columns.push(column);
            prior.push(12.0 / (range.high - range.low).powi(2));
        }
        for (signal, a) in signals.into_iter().zip(&point.fitted.amplitudes) {
            // An amplitude at zero stays there.
            columns.push(if *a > 0.0 { signal } else { vec![0.0; count] });
            prior.push(0.0);
        }
        let x = DMatrix::from_fn(count, columns.len(), |i, j| columns[j][i]);
        let scale: Vec<f64> = (0..x.ncols())
            .map(|j| x.column(j).norm().max(1e-12))
            .collect();
        let scaled = DMatrix::from_fn(count, x.ncols(), |i, j| x[(i, j)] / scale[j]);
        let rest = problem.limb.rest(&point.fitted);
        let residual = DVector::from_fn(count, |i, _| rest[i] - symptom[i]);
        let variance = residual.norm_squared() / count as f64;
        let groups: Vec<(i32, i8)> = (0..count).map(|i| group(motion, i)).collect();
        let information = |j: usize| 1e-8 + variance * prior[j] / (scale[j] * scale[j]);
        let prior = DMatrix::from_diagonal(&DVector::from_fn(x.ncols(), |j, _| information(j)));
        let linear = Linear {
            columns: &scaled,
            residual: &residual,
            prior: &prior,
            blocks: problem.blocks,
        };
        let unscaled = |by: &DVector<f64>| {
            DVector::from_fn(by.len() - limb, |j, _| by[limb + j] / scale[limb + j])
        };
        let moves: Vec<_> = linear.without_each()?.iter().map(unscaled).collect();
        let pulls = linear.by_group(&groups)?;
        let mut by_angle = DMatrix::zeros(x.ncols() - limb, x.ncols() - limb);
        for by in pulls.iter().map(unscaled) {
            by_angle += &by * by.transpose();
        }
        Some(Self {
            covariance: of_moves(&moves),
            by_angle,
            left_out: left_out(problem, point, &moves),
            moves,
            residual: residual.iter().copied().collect(),
            symptom,
        })
    }

    /// Returns the half width of the 95 % interval of a combination of shape and amplitudes.
    pub(crate) fn half_width(&self, slopes: &DVector<f64>) -> f64 {
        let deviation = |covariance: &DMatrix<f64>| {
            (slopes.transpose() * covariance * slopes)[(0, 0)]
                .max(0.0)
                .sqrt()
        };
        let moves: Vec<f64> = self.moves.iter().map(|by| by.dot(slopes)).collect();
        (student(counting(&moves) - 1.0) * deviation(&self.covariance))
            .hypot(DEVIATIONS * deviation(&self.by_angle))
    }
}

/// A linear model at its least squares.
struct Linear<'a> {
    columns: &'a DMatrix<f64>,
    residual: &'a DVector<f64>,
    /// Information on each coefficient.
    prior: &'a DMatrix<f64>,
    blocks: &'a [Range<usize>],
}

/// Returns the sum of squares in each stroke by a fit without it, (N·m)²: limb and amplitudes are those of the other
/// strokes, and so is the length of the step of the shape, which is nonlinear.
fn left_out(problem: &Problem<'_>, point: &Point, moves: &[DVector<f64>]) -> Vec<f64> {
    const STEPS: [f64; 4] = [0.0, 0.25, 0.5, 1.0];
    let ranges = problem.symptom.shape();
    let pairs = problem.blocks.iter().zip(moves);
    let error = |(block, by): (&Range<usize>, &DVector<f64>)| {
        let tried = STEPS.iter().filter_map(|step| {
            let moved = point.shape.iter().zip(ranges).enumerate();
            let shape: Vec<f64> = moved
                .map(|(k, (x, range))| (x + step * by[k]).clamp(range.low, range.high))
                .collect();
            let signals = problem.signals(&shape, &point.phases)?;
            let fitted = problem.limb.fit_without(&signals, block)?;
            Some((fitted.cost, problem.unseen(&shape, &fitted, block)?))
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(f64::INFINITY, |(_, error)| error)
    };
    pairs.map(error).collect()
}

impl Linear<'_> {
    fn normal(&self) -> DMatrix<f64> {
        self.columns.tr_mul(self.columns) + self.prior
    }

    /// Changes of the coefficients by a fit without each block.
    fn without_each(&self) -> Option<Vec<DVector<f64>>> {
        let normal = self.normal();
        let without = |block: &Range<usize>| {
            let rows = self.columns.rows(block.start, block.len());
            let residual = self.residual.rows(block.start, block.len());
            let rest = &normal - rows.tr_mul(&rows);
            Some(rest.cholesky()?.solve(&(-rows.tr_mul(&residual))))
        };
        self.blocks.iter().map(without).collect()
    }

    /// Pulls of the rows of each group on the coefficients, H⁻¹·g.
    fn by_group<G: Ord + Copy>(&self, groups: &[G]) -> Option<Vec<DVector<f64>>> {
        let normal = self.normal().cholesky()?;
        let mut sums: BTreeMap<G, DVector<f64>> = BTreeMap::new();
        for (i, group) in groups.iter().enumerate() {
            let sum = sums
                .entry(*group)
                .or_insert_with(|| DVector::zeros(self.columns.ncols()));
            sum.axpy(self.residual[i], &self.columns.row(i).transpose(), 1.0);
        }
        Some(sums.values().map(|sum| normal.solve(sum)).collect())
    }
}

/// Covariance of the jackknife over groups.
fn of_moves(moves: &[DVector<f64>]) -> DMatrix<f64> {
    let groups = moves.len() as f64;
    let mean = moves.iter().sum::<DVector<f64>>() / groups;
    let mut covariance = DMatrix::zeros(mean.len(), mean.len());
    for by in moves {
        let off = by - &mean;
        covariance += &off * off.transpose() * ((groups - 1.0) / groups);
    }
    covariance
}

/// As many groups as count: three times this ratio is all of them where the moves are normal.
fn counting(moves: &[f64]) -> f64 {
    let (sum, fourth) =
        (moves.iter()).fold((0.0, 0.0), |(s, f), by| (s + by.powi(2), f + by.powi(4)));
    let groups = moves.len() as f64;
    if fourth > 0.0 {
        (3.0 * sum * sum / fourth).min(groups)
    } else {
        groups
    }
}

/// Returns by how much the sum of these squared errors is below that of another model, as a share, and the paired
/// difference in its standard deviations (Student's paired t).
pub(crate) fn gain(by_stroke: &[f64], of_other: &[f64]) -> (f64, f64) {
    let pairs = of_other.iter().zip(by_stroke);
    let differences: Vec<f64> = pairs.map(|(other, this)| other - this).collect();
    let (n, sum) = (differences.len() as f64, differences.iter().sum::<f64>());
    let squares: f64 = differences.iter().map(|d| (d - sum / n).powi(2)).sum();
    let variance = squares / (n - 1.0).max(1.0);
    let whole: f64 = of_other.iter().sum();
    (
        sum / whole.max(1e-300),
        sum / (n * variance).sqrt().max(1e-300),
    )
}

/// Ten degrees and the sense of the motion.
fn group(motion: &Motion, i: usize) -> (i32, i8) {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast from float saturates"
    )]
    let ten = (motion.angle_rad[i].to_degrees() / 10.0).floor() as i32;
    let omega = motion.omega_rad_s[i];
    (
        ten,
        i8::from(omega > STILL_RAD_S) - i8::from(omega < -STILL_RAD_S),
    )
}

/// Half width of the 95 % interval of Student's t with this many degrees of freedom, 2 at least.
///
/// With t = √ν·tan θ the density is that of cos^(ν−1) θ, and the whole of it √π·Γ(ν/2)/Γ((ν + 1)/2) (Johnson, Kotz &
/// Balakrishnan, Continuous Univariate Distributions 2, 1995, ch. 28).
pub(crate) fn student(freedom: f64) -> f64 {
    const COVERED: f64 = 0.95;
    /// Steps of Newton, and panels of Simpson's rule.
    const STEPS: u32 = 12;
    const PANELS: u32 = 400;
    let n = freedom.max(2.0);
    let density = |theta: f64| theta.cos().powf(n - 1.0);
    let area = |theta: f64| {
        let h = theta / f64::from(2 * PANELS);
        let inner = (1..2 * PANELS).map(|i| {
            let weight = if i % 2 == 0 { 2.0 } else { 4.0 };
            weight * density(h * f64::from(i))
        });
        h / 3.0 * (1.0 + inner.sum::<f64>() + density(theta))
    };
    let whole = 0.5
        * std::f64::consts::PI.sqrt()
        * (libm::lgamma(0.5 * n) - libm::lgamma(0.5 * (n + 1.0))).exp();
    // From the normal distribution's, which is below: Newton's steps do not pass the root of a concave area.
    let mut theta = (DEVIATIONS / n.sqrt()).atan();
    for _ in 0..STEPS {
        theta += (COVERED * whole - area(theta)) / density(theta);
    }
    n.sqrt() * theta.tan()
}

#[cfg(test)]
mod tests;
