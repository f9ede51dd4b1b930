//! Intervals and errors of left-out strokes, both from one linearisation.
//!
//! With the columns X of limb, amplitudes and shape at the optimum and the residual r, a fit without the rows of
//! stroke g is, to first order,
//!
//! ```text
//! Δ_g = −(XᵀX − X_gᵀX_g + P)⁻¹·X_gᵀr_g        r_g without g = r_g − X_g·Δ_g
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
            for (signal, a) in signals.iter().zip(&point.amplitudes) {
                sum.iter_mut()
                    .zip(signal)
                    .for_each(|(sum, s)| *sum += a * s);
            }
            sum
        };
        let symptom = mixed(&signals);
        let ranges = problem.symptom.shape();
        let mut columns = problem.limb.clone();
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
            let is_smooth = range.is_smooth && point.amplitudes.iter().any(|a| *a > 0.0);
            let column = if is_smooth {
                let ((low, less), (high, more)) = (moved(-step)?, moved(step)?);
                let way = (high - low).max(1e-12);
                less.iter().zip(&more).map(|(a, b)| (b - a) / way).collect()
            } else {
                vec![0.0; count]
            };
            columns.push(column);
            prior.push(12.0 / (range.high - range.low).powi(2));
        }
        for (signal, a) in signals.into_iter().zip(&point.amplitudes) {
            // An amplitude at zero stays there.
            columns.push(if *a > 0.0 { signal } else { vec![0.0; count] });
            prior.push(0.0);
        }
        let x = DMatrix::from_fn(count, columns.len(), |i, j| columns[j][i]);
        let y = DVector::from_fn(count, |i, _| motion.torque_nm[i] - symptom[i]);
        // The limb's coefficients at this shape.
        let scale: Vec<f64> = (0..x.ncols())
            .map(|j| x.column(j).norm().max(1e-12))
            .collect();
        let scaled = DMatrix::from_fn(count, x.ncols(), |i, j| x[(i, j)] / scale[j]);
        let normal = scaled.tr_mul(&scaled);
        let limb_normal = normal.view((0, 0), (limb, limb)) + DMatrix::identity(limb, limb) * 1e-10;
        let limb_right = scaled.columns(0, limb).tr_mul(&y);
        let coefficients = limb_normal.cholesky()?.solve(&limb_right);
        let residual = &y - scaled.columns(0, limb) * &coefficients;
        let variance = residual.norm_squared() / count as f64;
        let information = |j: usize| 1e-8 + variance * prior[j] / (scale[j] * scale[j]);
        let prior = DMatrix::from_diagonal(&DVector::from_fn(x.ncols(), |j, _| information(j)));
        let mut moves = Vec::new();
        let mut left_out = Vec::new();
        for block in problem.blocks {
            let rows = scaled.rows(block.start, block.len());
            let of_block = residual.rows(block.start, block.len());
            let without = &normal - rows.tr_mul(&rows) + &prior;
            let by = without.cholesky()?.solve(&(-rows.tr_mul(&of_block)));
            left_out.push((of_block - rows * &by).norm_squared());
            moves.push(DVector::from_fn(x.ncols() - limb, |j, _| {
                by[limb + j] / scale[limb + j]
            }));
        }
        let inverse = (&normal + &prior).cholesky()?.inverse();
        let mut groups: BTreeMap<(i32, i8), DVector<f64>> = BTreeMap::new();
        for i in 0..count {
            let sum = groups
                .entry(group(motion, i))
                .or_insert_with(|| DVector::zeros(x.ncols()));
            sum.axpy(residual[i], &scaled.row(i).transpose(), 1.0);
        }
        let mut by_angle = DMatrix::zeros(x.ncols() - limb, x.ncols() - limb);
        for sum in groups.values() {
            let by = &inverse * sum;
            let by = DVector::from_fn(x.ncols() - limb, |j, _| by[limb + j] / scale[limb + j]);
            by_angle += &by * by.transpose();
        }
        let strokes = moves.len() as f64;
        let mean = moves.iter().sum::<DVector<f64>>() / strokes;
        let mut covariance = DMatrix::zeros(mean.len(), mean.len());
        for by in &moves {
            let off = by - &mean;
            covariance += &off * off.transpose() * ((strokes - 1.0) / strokes);
        }
        Some(Self {
            covariance,
            by_angle,
            moves,
            left_out,
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
        let squares: Vec<f64> = self.moves.iter().map(|by| by.dot(slopes).powi(2)).collect();
        let (sum, fourth) = squares
            .iter()
            .fold((0.0, 0.0), |(s, f), q| (s + q, f + q * q));
        let strokes = self.moves.len() as f64;
        // As many strokes as count: three times the ratio is all of them where the moves are normal.
        let counting = if fourth > 0.0 {
            (3.0 * sum * sum / fourth).min(strokes)
        } else {
            strokes
        };
        (student(counting - 1.0) * deviation(&self.covariance))
            .hypot(DEVIATIONS * deviation(&self.by_angle))
    }
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

/// Half width of the 95 % interval of Student's t, by the expansion of Peiser (1943).
pub(crate) fn student(freedom: f64) -> f64 {
    let n = freedom.max(2.0);
    let z: f64 = DEVIATIONS;
    z + (z.powi(3) + z) / (4.0 * n)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n)
        + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / (384.0 * n * n * n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_is_that_of_the_tables() {
        for (freedom, table) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!((student(freedom) / table - 1.0).abs() < 0.012, "{freedom}");
        }
    }
}
