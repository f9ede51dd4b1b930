//! Torque of the limb itself: a linear model with bounds.
//!
//! Without bounds its columns imitate any early end of the range by forces of hundreds of N·m that cancel each other.
//! Bounded least squares with the amplitudes of a symptom are solved on the normal equations, by active sets (Stark &
//! Parker, Comput. Stat. 10 (1995), 129–141).

use super::bounded::Bounded;
use super::motion::Motion;
use super::symptom::play;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Travel over which the dry friction of limb and apparatus turns round, deg.
const DRY_DEG: f64 = 2.0;

/// Most columns of a limb, and of the signals of a symptom.
const MOST: usize = 12;

/// Largest gravity and offset, N·m: a heavy leg with the arm of a dynamometer.
const WEIGHT_NM: f64 = 25.0;

/// Largest elasticity, N·m/rad, and torques of the ends of the range, N·m: of the steep and of the soft part in extension
/// at 0°, and in flexion at 120°. Riener & Edrich have 9, 53 and 7 at the hip angles of sitting and lying.
const ELASTIC_NM: f64 = 3.0;
const STEEP_NM: f64 = 20.0;
const SOFT_NM: f64 = 60.0;
const FLEXED_NM: f64 = 10.0;

/// A column of the limb, and the bounds of its coefficient.
struct Column {
    values: Vec<f64>,
    low: f64,
    high: f64,
}

/// Returns the columns of the limb: offset, drift, gravity, elasticity, the steep ends of the range (growths of the
/// order of Riener & Edrich, J. Biomech. 32 (1999), 539–544), viscous damping, inertia, and dry friction if wanted.
fn columns(motion: &Motion, with_friction: bool) -> Vec<Column> {
    let column = |values: Vec<f64>, low: f64, high: f64| Column { values, low, high };
    let of = |f: &dyn Fn(f64) -> f64, low: f64, high: f64| {
        column(
            motion.angle_rad.iter().map(|angle| f(*angle)).collect(),
            low,
            high,
        )
    };
    let lasts = motion.time_s.last().copied().unwrap_or(1.0)
        - motion.time_s.first().copied().unwrap_or(0.0);
    let drift = motion.time_s.iter().map(|t| t / lasts.max(1e-9)).collect();
    let mut columns = vec![
        of(&|_| 1.0, -WEIGHT_NM, WEIGHT_NM),
        column(drift, -5.0, 5.0),
        of(&f64::sin, -WEIGHT_NM, WEIGHT_NM),
        of(&f64::cos, -WEIGHT_NM, WEIGHT_NM),
        of(&|angle| angle, -ELASTIC_NM, ELASTIC_NM),
        of(&|angle| (-angle.to_degrees() / 5.0).exp(), -STEEP_NM, 0.0),
        of(&|angle| (-angle.to_degrees() / 9.0).exp(), -STEEP_NM, 0.0),
        of(&|angle| (-angle.to_degrees() / 25.0).exp(), -SOFT_NM, 0.0),
        of(
            &|angle| ((angle.to_degrees() - 120.0) / 20.0).exp(),
            0.0,
            FLEXED_NM,
        ),
        column(motion.omega_rad_s.clone(), -0.5, 5.0),
    ];
    if !motion.is_released {
        columns.push(column(motion.alpha_rad_s2.clone(), -0.5, 5.0));
    }
    if with_friction {
        columns.push(column(play(motion, DRY_DEG), 0.0, 50.0));
    }
    columns
}

/// A limb without and with a symptom, by normal equations.
pub(crate) struct Limb {
    columns: Vec<Column>,
    /// Columns by rows, zeros up to [`MOST`], and the torque, N·m.
    rows: Vec<[f64; MOST + 1]>,
    /// Equations over all rows.
    all: (DMatrix<f64>, DVector<f64>, f64),
}

/// A fitted limb with the amplitudes of a symptom.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    /// Coefficients of the limb.
    pub(crate) limb: Vec<f64>,
    pub(crate) amplitudes: Vec<f64>,
    /// Whether each coefficient of the limb is between its bounds.
    pub(crate) is_free: Vec<bool>,
    /// Sum of squares that is left, (N·m)².
    pub(crate) cost: f64,
}

impl Limb {
    pub(crate) fn new(motion: &Motion, with_friction: bool) -> Self {
        let columns = columns(motion, with_friction);
        let row = |i: usize| {
            let mut row = [0.0; MOST + 1];
            for (x, column) in row.iter_mut().zip(&columns) {
                *x = column.values[i];
            }
            row[MOST] = motion.torque_nm[i];
            row
        };
        let mut limb = Self {
            rows: (0..motion.len()).map(row).collect(),
            all: (DMatrix::zeros(0, 0), DVector::zeros(0), 0.0),
            columns,
        };
        limb.all = limb.equations(0..motion.len());
        limb
    }

    /// Returns the products of a signal with the columns and with the torque, over some rows.
    fn products(&self, signal: &[f64], over: Range<usize>) -> [f64; MOST + 1] {
        let mut sums = [0.0; MOST + 1];
        for (row, x) in self.rows[over.clone()].iter().zip(&signal[over]) {
            // Most symptoms are silent most of the time.
            if *x != 0.0 {
                sums.iter_mut().zip(row).for_each(|(sum, q)| *sum += q * x);
            }
        }
        sums
    }

    /// Returns the equations of the limb over some rows: normal matrix, right-hand side, sum of squares.
    fn equations(&self, over: Range<usize>) -> (DMatrix<f64>, DVector<f64>, f64) {
        let size = self.columns.len();
        let (mut normal, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for (j, column) in self.columns.iter().enumerate() {
            let products = self.products(&column.values, over.clone());
            for (i, product) in products.iter().take(size).enumerate() {
                normal[(i, j)] = *product;
            }
            right[j] = products[MOST];
        }
        let torques = self.rows[over].iter().map(|row| row[MOST]);
        (normal, right, torques.map(|t| t * t).sum())
    }

    /// Fits limb and amplitudes, which are not negative; `None` if the equations have no solution.
    pub(crate) fn fit(&self, signals: &[Vec<f64>]) -> Option<Fitted> {
        let (normal, right, whole) = &self.all;
        self.solve(
            signals,
            (normal.clone(), right.clone(), *whole),
            std::slice::from_ref(&(0..self.rows.len())),
        )
    }

    /// Fits them to the rows outside a block.
    pub(crate) fn fit_without(&self, signals: &[Vec<f64>], block: &Range<usize>) -> Option<Fitted> {
        let (normal, right, whole) = &self.all;
        let of_block = self.equations(block.clone());
        let rest = (normal - of_block.0, right - of_block.1, whole - of_block.2);
        self.solve(signals, rest, &[0..block.start, block.end..self.rows.len()])
    }

    fn solve(
        &self,
        signals: &[Vec<f64>],
        (normal, right, whole): (DMatrix<f64>, DVector<f64>, f64),
        over: &[Range<usize>],
    ) -> Option<Fitted> {
        let (limb, size) = (self.columns.len(), self.columns.len() + signals.len());
        let mut normal = normal.resize(size, size, 0.0);
        let mut right = right.resize_vertically(size, 0.0);
        for (j, signal) in signals.iter().enumerate() {
            for rows in over {
                let products = self.products(signal, rows.clone());
                for (i, product) in products.iter().take(limb).enumerate() {
                    normal[(i, limb + j)] += product;
                }
                right[limb + j] += products[MOST];
                for (i, other) in signals.iter().enumerate().take(j + 1) {
                    let pairs = other[rows.clone()].iter().zip(&signal[rows.clone()]);
                    normal[(limb + i, limb + j)] += pairs.map(|(a, b)| a * b).sum::<f64>();
                }
            }
        }
        normal.fill_lower_triangle_with_upper_triangle();
        let bounds = self.columns.iter().map(|column| (column.low, column.high));
        let bounds = bounds.chain(signals.iter().map(|_| (0.0, f64::INFINITY)));
        let found = Bounded::solve(&normal, &right, &bounds.collect::<Vec<_>>())?;
        let (of_limb, amplitudes) = found.values.as_slice().split_at(limb);
        Some(Fitted {
            limb: of_limb.to_vec(),
            amplitudes: amplitudes.to_vec(),
            is_free: found.is_free[..limb].to_vec(),
            cost: whole + found.objective,
        })
    }

    /// Returns the sum of squares that a fit leaves in some rows, (N·m)².
    pub(crate) fn squares(
        &self,
        fitted: &Fitted,
        signals: &[Vec<f64>],
        rows: &Range<usize>,
    ) -> f64 {
        let left = rows.clone().map(|i| {
            let symptom = signals.iter().zip(&fitted.amplitudes);
            let symptom: f64 = symptom.map(|(signal, a)| a * signal[i]).sum();
            self.left(i, fitted) - symptom
        });
        left.map(|left| left * left).sum()
    }

    /// Returns the torque of a row without that of the limb, N·m.
    fn left(&self, i: usize, fitted: &Fitted) -> f64 {
        let row = &self.rows[i];
        let limb = row.iter().zip(&fitted.limb);
        row[MOST] - limb.map(|(x, c)| x * c).sum::<f64>()
    }

    /// Returns the torque without that of the limb, N·m.
    pub(crate) fn rest(&self, fitted: &Fitted) -> Vec<f64> {
        (0..self.rows.len()).map(|i| self.left(i, fitted)).collect()
    }

    /// Returns the columns between their bounds.
    pub(crate) fn free_columns(&self, fitted: &Fitted) -> Vec<Vec<f64>> {
        let pairs = self.columns.iter().zip(&fitted.is_free);
        pairs
            .filter(|(_, is_free)| **is_free)
            .map(|(column, _)| column.values.clone())
            .collect()
    }
}
