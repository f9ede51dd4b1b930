//! Least squares with bounds, on normal equations.

use nalgebra::{DMatrix, DVector};

/// Share of its diagonal that is added to each equation: columns of a limb are nearly dependent.
const RIDGE: f64 = 1e-11;

/// Most changes of the active set for each unknown.
const CHANGES: usize = 6;

/// Solution of bounded least squares.
#[derive(Clone, Debug)]
pub(crate) struct Bounded {
    pub(crate) values: DVector<f64>,
    /// Whether each is between its bounds.
    pub(crate) is_free: Vec<bool>,
    /// zᵀ·N·z − 2·bᵀ·z: the sum of squares above that of nothing.
    pub(crate) objective: f64,
}

impl Bounded {
    /// Minimises zᵀ·N·z − 2·bᵀ·z between bounds that hold 0; an unknown without a column stays at 0.
    pub(crate) fn solve(
        normal: &DMatrix<f64>,
        right: &DVector<f64>,
        bounds: &[(f64, f64)],
    ) -> Option<Self> {
        let size = right.len();
        let scale: Vec<f64> = (0..size).map(|i| normal[(i, i)].max(0.0).sqrt()).collect();
        let has_column = |i: usize| scale[i] > 1e-9;
        // Of columns of length 1.
        let unit = |i: usize| if has_column(i) { 1.0 / scale[i] } else { 0.0 };
        let n = DMatrix::from_fn(size, size, |i, j| {
            let ridge = if i == j { RIDGE } else { 0.0 };
            normal[(i, j)] * unit(i) * unit(j) + ridge
        });
        let b = DVector::from_fn(size, |i, _| right[i] * unit(i));
        let low: Vec<f64> = (0..size).map(|i| bounds[i].0 * scale[i]).collect();
        let high: Vec<f64> = (0..size).map(|i| bounds[i].1 * scale[i]).collect();
        let mut z = DVector::<f64>::zeros(size);
        let mut is_free: Vec<bool> = (0..size).map(has_column).collect();
        for _ in 0..CHANGES * size {
            let free: Vec<usize> = (0..size).filter(|i| is_free[*i]).collect();
            let at_bounds = DVector::from_fn(size, |i, _| if is_free[i] { 0.0 } else { z[i] });
            let rest = &b - &n * at_bounds;
            let of_free = DMatrix::from_fn(free.len(), free.len(), |i, j| n[(free[i], free[j])]);
            let rest = DVector::from_fn(free.len(), |i, _| rest[free[i]]);
            let there = of_free.cholesky()?.solve(&rest);
            // As far as the first bound.
            let mut way = 1.0;
            let mut stopped = None;
            for (k, i) in free.iter().enumerate() {
                let step = there[k] - z[*i];
                let bound = if step < 0.0 { low[*i] } else { high[*i] };
                let share = (bound - z[*i]) / step;
                if share < way {
                    (way, stopped) = (share.max(0.0), Some((*i, bound)));
                }
            }
            for (k, i) in free.iter().enumerate() {
                z[*i] += way * (there[k] - z[*i]);
            }
            if let Some((i, bound)) = stopped {
                (z[i], is_free[i]) = (bound, false);
                continue;
            }
            // Of those at a bound, the one that is pulled away from it most.
            let pull = &b - &n * &z;
            let inward = |i: usize| if z[i] <= low[i] { pull[i] } else { -pull[i] };
            let held = (0..size).filter(|i| !is_free[*i] && has_column(*i));
            let most = held.max_by(|i, j| inward(*i).total_cmp(&inward(*j)));
            match most.filter(|i| inward(*i) > 1e-9 * b.norm()) {
                Some(i) => is_free[i] = true,
                None => break,
            }
        }
        let objective = (&n * &z).dot(&z) - 2.0 * b.dot(&z);
        Some(Self {
            values: DVector::from_fn(size, |i, _| z[i] * unit(i)),
            is_free,
            objective,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scipy_finds_the_same() {
        let i = |i: usize| i as f64;
        let columns = DMatrix::from_fn(20, 5, |row, column| match column {
            0 => 1.0,
            1 => (0.3 * i(row)).sin(),
            2 => (0.11 * i(row)).exp(),
            3 => (0.12 * i(row)).exp(),
            _ => (1.7 * i(row)).cos(),
        });
        let y = DVector::from_fn(20, |row, _| {
            (0.2 * i(row)).exp() - 3.0 * (0.3 * i(row)).sin() + (2.9 * i(row)).sin()
        });
        let bounds = [
            (-4.0, 40.0),
            (-1.0, 1.0),
            (0.0, 3.0),
            (-9.0, 9.0),
            (0.0, f64::INFINITY),
        ];
        let (normal, right) = (columns.tr_mul(&columns), columns.tr_mul(&y));
        let found = Bounded::solve(&normal, &right, &bounds).unwrap();
        for (value, scipy) in found.values.iter().zip(SCIPY) {
            assert!((value - scipy).abs() < 1e-6, "{} {SCIPY:?}", found.values);
        }
        let cost = (&y - &columns * &found.values).norm_squared();
        assert!((y.norm_squared() + found.objective - cost).abs() < 1e-8 * cost);
        // A signal that is silent has no amplitude.
        let silent = DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 0.0]));
        let found = Bounded::solve(
            &silent,
            &DVector::from_vec(vec![1.0, 0.0]),
            &[(0.0, 9.0); 2],
        )
        .unwrap();
        assert!((found.values[0] - 0.5).abs() < 1e-9);
        assert_eq!(found.values[1].to_bits(), 0);
    }

    /// Of `reference.py`.
    const SCIPY: [f64; 5] = [
        -4.0,
        -1.0,
        0.0,
        4.404_530_496_086_485,
        0.604_523_013_286_819_5,
    ];
}
