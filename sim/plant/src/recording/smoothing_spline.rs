//! The values of a cubic smoothing spline: Reinsch's equations.
//!
//! With h the spacings, γ = f″ at the inner samples, R and Q as below,
//! ```text
//! (R + Qᵀ W⁻¹ Q) γ = Qᵀ y          f = y − W⁻¹ Q γ
//!
//! R: tridiagonal, (hⱼ₋₁ + hⱼ)/3 and hⱼ/6      column j of Q: 1/hⱼ₋₁, −1/hⱼ₋₁ − 1/hⱼ, 1/hⱼ
//! ```
//! has the least Σ w (y − f)² + ∫ f″² dt. The matrix has five diagonals and is positive definite,
//! so L D Lᵀ without pivots solves it, in time and memory that grow with the samples.
//!
//! Source: Reinsch, "Smoothing by spline functions", Numer. Math. 10 (1967); with weights as in
//! Green and Silverman, "Nonparametric Regression and Generalized Linear Models", section 2.3.

/// The spline's values where the samples are; times grow, weights are above zero.
pub(super) fn smoothed(time: &[f64], value: &[f64], weight: &[f64]) -> Vec<f64> {
    // Rows of Qᵀ: weights of a second difference of three samples.
    let rows: Vec<Row> = time
        .array_windows()
        .zip(value.array_windows())
        .zip(weight.array_windows())
        .map(|((t, y), w)| Row::new(t, y, w))
        .collect();
    let curvature = solve(&rows);
    let mut values = value.to_vec();
    for (j, (row, gamma)) in rows.iter().zip(&curvature).enumerate() {
        for (value, share) in values.iter_mut().skip(j).zip(row.shares()) {
            *value -= share * gamma;
        }
    }
    values
}

/// An inner sample with its neighbours.
struct Row {
    /// Column of Q.
    q: [f64; 3],
    /// 1/w of the three.
    per_weight: [f64; 3],
    /// Entries of R: on the diagonal, and right of it.
    r: [f64; 2],
    /// Qᵀ y.
    second_difference: f64,
}

impl Row {
    fn new([t0, t1, t2]: &[f64; 3], [y0, y1, y2]: &[f64; 3], w: &[f64; 3]) -> Self {
        let (h0, h1) = (t1 - t0, t2 - t1);
        Self {
            q: [1.0 / h0, -1.0 / h0 - 1.0 / h1, 1.0 / h1],
            per_weight: w.map(|w| 1.0 / w),
            r: [(h0 + h1) / 3.0, h1 / 6.0],
            second_difference: (y2 - y1) / h1 - (y1 - y0) / h0,
        }
    }

    /// Column of W⁻¹ Q.
    fn shares(&self) -> [f64; 3] {
        let ([q0, q1, q2], [v0, v1, v2]) = (self.q, self.per_weight);
        [q0 * v0, q1 * v1, q2 * v2]
    }
}

/// γ, by L D Lᵀ.
fn solve(rows: &[Row]) -> Vec<f64> {
    // Of the two rows before: D, the two entries of L below it, and the right side.
    let (mut before, mut last) = (Step::default(), Step::default());
    let mut steps = Vec::with_capacity(rows.len());
    for (j, row) in rows.iter().enumerate() {
        let ([q0, q1, q2], [s0, s1, s2]) = (row.q, row.shares());
        let diagonal = row.r[0] + q0 * s0 + q1 * s1 + q2 * s2;
        let right = rows
            .get(j + 1)
            .map_or(0.0, |next| row.r[1] + s1 * next.q[0] + s2 * next.q[1]);
        let far = rows.get(j + 2).map_or(0.0, |next| s2 * next.q[0]);
        let pivot = diagonal - last.d * last.l1 * last.l1 - before.d * before.l2 * before.l2;
        let step = Step {
            d: pivot,
            l1: (right - last.d * last.l1 * last.l2) / pivot,
            l2: far / pivot,
            right: row.second_difference - last.l1 * last.right - before.l2 * before.right,
        };
        steps.push(step);
        (before, last) = (last, step);
    }
    let (mut next, mut after) = (0.0, 0.0);
    let mut curvature: Vec<f64> = steps
        .iter()
        .rev()
        .map(|step| {
            let gamma = step.right / step.d - step.l1 * next - step.l2 * after;
            (next, after) = (gamma, next);
            gamma
        })
        .collect();
    curvature.reverse();
    curvature
}

/// A column of the factors.
#[derive(Clone, Copy, Default)]
struct Step {
    d: f64,
    /// One below the diagonal, and two.
    l1: f64,
    l2: f64,
    /// The right side, forward-substituted.
    right: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    /// Weighted squares and the integral of f″², of the natural spline through
    /// `f`: γ solves R γ = Qᵀ f, and the integral is γᵀ R γ = γᵀ Qᵀ f.
    fn cost(time: &[f64], value: &[f64], weight: &[f64], f: &[f64]) -> f64 {
        // With huge weights the smoothing equations are those of the spline.
        let heavy: Vec<f64> = weight.iter().map(|_| 1e30).collect();
        let rows: Vec<Row> = time
            .array_windows()
            .zip(f.array_windows())
            .zip(heavy.array_windows())
            .map(|((t, y), w)| Row::new(t, y, w))
            .collect();
        let bending: f64 = solve(&rows)
            .iter()
            .zip(&rows)
            .map(|(gamma, row)| gamma * row.second_difference)
            .sum();
        let squares = |((y, f), w): ((&f64, &f64), &f64)| w * (y - f).powi(2);
        bending + value.iter().zip(f).zip(weight).map(squares).sum::<f64>()
    }

    #[test]
    fn no_other_values_cost_less() {
        let mut rng = Rng::with_seed(7);
        for n in [3, 4, 5, 9, 40] {
            let mut at = 0.0;
            let time: Vec<f64> = (0..n)
                .map(|_| {
                    at += 0.05 + rng.f64();
                    at
                })
                .collect();
            let value: Vec<f64> = (0..n).map(|_| rng.f64() - 0.5).collect();
            let weight: Vec<f64> = (0..n).map(|_| 0.1 + rng.f64()).collect();
            let best = smoothed(&time, &value, &weight);
            let least = cost(&time, &value, &weight, &best);
            for place in 0..n {
                for change in [1e-3, -1e-3] {
                    let mut other = best.clone();
                    other[place] += change;
                    let more = cost(&time, &value, &weight, &other) - least;
                    // A parabola around the least: at least w·change².
                    assert!(more >= 0.99 * weight[place] * change * change, "{n} {more}");
                }
            }
        }
    }

    #[test]
    fn a_straight_line_stays_and_two_samples_do() {
        let time = [0.0, 0.3, 0.4, 1.1, 2.0];
        let line = time.map(|t| 2.0 - 3.0 * t);
        for (found, expected) in smoothed(&time, &line, &[1.0; 5]).iter().zip(line) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert_eq!(smoothed(&[0.0, 1.0], &[3.0, 4.0], &[1.0; 2]), [3.0, 4.0]);
    }
}
