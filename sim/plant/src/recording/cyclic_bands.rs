//! Symmetric positive definite equations with five diagonals that wrap around, as those of a
//! periodic spline do.
//!
//! The last two unknowns border the rest, whose matrix has five diagonals and no corners:
//! ```text
//! ⎡A  B⎤ ⎡u⎤   ⎡f⎤        (C − Bᵀ A⁻¹ B) v = g − Bᵀ A⁻¹ f
//! ⎣Bᵀ C⎦ ⎣v⎦ = ⎣g⎦                       u = A⁻¹ f − A⁻¹ B v
//! ```
//! A by L D Lᵀ without pivots: stable, as the whole matrix is positive definite.

/// The fewest unknowns: below, the diagonals would meet.
pub(super) const LEAST: usize = 6;

/// One equation: of unknown j with itself, with j + 1 and with j + 2, counted round.
#[derive(Clone, Copy)]
pub(super) struct Equation {
    pub(super) diagonal: f64,
    pub(super) next: f64,
    pub(super) after: f64,
    pub(super) right: f64,
}

/// The unknowns of at least [`LEAST`] equations; of fewer, none.
pub(super) fn solve(equations: &[Equation]) -> Vec<f64> {
    let (Some((inner, [y, z])), true) =
        (equations.split_last_chunk::<2>(), equations.len() >= LEAST)
    else {
        return Vec::new();
    };
    let count = inner.len();
    // Columns of B: unknown n − 2 meets n − 4, n − 3 and, round the corner, 0; n − 1 meets n − 3,
    // 0 and 1.
    let mut columns = vec![[0.0, 0.0, 0.0]; count];
    for (column, equation) in columns.iter_mut().zip(inner) {
        column[0] = equation.right;
    }
    if let [first, second, .., before, last] = columns.as_mut_slice()
        && let [.., far, near] = inner
    {
        before[1] += far.after;
        last[1] += near.next;
        last[2] += near.after;
        first[1] += y.after;
        first[2] += z.next;
        second[2] += z.after;
    }
    let border = columns.clone();
    inner_solve(inner, &mut columns);
    let product = |i: usize, j: usize| -> f64 {
        let pairs = border.iter().zip(&columns);
        pairs.map(|(border, column)| border[i] * column[j]).sum()
    };
    let (c00, c01, c11) = (
        y.diagonal - product(1, 1),
        y.next - product(1, 2),
        z.diagonal - product(2, 2),
    );
    let (g0, g1) = (y.right - product(1, 0), z.right - product(2, 0));
    // L D Lᵀ of two.
    let l = c01 / c00;
    let last = (g1 - l * g0) / (c11 - l * c01);
    let before = g0 / c00 - l * last;
    let unknowns = columns
        .iter()
        .map(|[f, b0, b1]| f - b0 * before - b1 * last);
    unknowns.chain([before, last]).collect()
}

/// A⁻¹ of three columns, in place.
fn inner_solve(equations: &[Equation], columns: &mut [[f64; 3]]) {
    // Of the two rows before: D, the two entries of L below it; and their columns.
    let (mut before, mut last) = ([0.0; 3], [0.0; 3]);
    let (mut column_before, mut column_last) = ([0.0; 3], [0.0; 3]);
    let mut factors = Vec::with_capacity(equations.len());
    for (j, (equation, column)) in equations.iter().zip(columns.iter_mut()).enumerate() {
        let left = equations.len() - 1 - j;
        let next = if left >= 1 { equation.next } else { 0.0 };
        let after = if left >= 2 { equation.after } else { 0.0 };
        let [[d2, _, far2], [d1, near1, far1]] = [before, last];
        let pivot = equation.diagonal - d1 * near1 * near1 - d2 * far2 * far2;
        for ((value, last), before) in column.iter_mut().zip(column_last).zip(column_before) {
            *value -= near1 * last + far2 * before;
        }
        let factor = [pivot, (next - d1 * near1 * far1) / pivot, after / pivot];
        factors.push(factor);
        (before, last) = (last, factor);
        (column_before, column_last) = (column_last, *column);
    }
    let (mut next, mut after) = ([0.0; 3], [0.0; 3]);
    for (column, [pivot, near, far]) in columns.iter_mut().zip(&factors).rev() {
        for ((value, next), after) in column.iter_mut().zip(next).zip(after) {
            *value = *value / pivot - near * next - far * after;
        }
        (after, next) = (next, *column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;

    #[test]
    fn the_unknowns_satisfy_every_equation() {
        let mut rng = Rng::with_seed(11);
        for n in (LEAST..30).chain([1000]) {
            for wide in [0.0, 1.0] {
                // Diagonally dominant, so positive definite.
                let equations: Vec<Equation> = (0..n)
                    .map(|_| Equation {
                        diagonal: 4.5 + rng.f64(),
                        next: 2.0 * rng.f64() - 1.0,
                        after: wide * (2.0 * rng.f64() - 1.0),
                        right: 2.0 * rng.f64() - 1.0,
                    })
                    .collect();
                let found = solve(&equations);
                assert_eq!(found.len(), n);
                for j in 0..n {
                    let at = |k: usize| (equations[(j + k) % n], found[(j + k) % n]);
                    let ((here, x), (_, right1), (_, right2)) = (at(0), at(1), at(2));
                    let ((left1, x1), (left2, x2)) = (at(n - 1), at(n - 2));
                    let sum = left2.after * x2
                        + left1.next * x1
                        + here.diagonal * x
                        + here.next * right1
                        + here.after * right2;
                    assert!((sum - here.right).abs() < 1e-14, "{n}, {j}: {sum}");
                }
            }
        }
    }
}
