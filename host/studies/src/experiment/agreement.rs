//! Agreement of answers with the truth: Cohen's kappa and its interval.
//!
//! `n` answers fall into a square table: `p_ij` is the share of answers `j` to knees `i`, `p_i.`
//! and `p_.j` are its margins. A weight `w_ij` says how well an answer agrees:
//!
//! ```text
//! nominal   w_ij = 1 if i = j, else 0
//! linear    w_ij = 1 - |i - j| / (k - 1)          k ordered categories
//! quadratic w_ij = 1 - ((i - j) / (k - 1))²
//!
//! po = Σ w_ij p_ij       observed agreement
//! pe = Σ w_ij p_i. p_.j  agreement by chance
//! κ  = (po - pe) / (1 - pe)
//! ```
//!
//! (Cohen, *A coefficient of agreement for nominal scales*, Educational and Psychological
//! Measurement 20, 1960; *Weighted kappa*, Psychological Bulletin 70, 1968.) κ is 1 if all agree,
//! 0 if as many agree as by chance. It is undefined if `pe` is 1: all knees and all answers are of
//! one category.
//!
//! The asymptotic standard error is that of Fleiss, Cohen and Everitt (*Large sample standard
//! errors of kappa and weighted kappa*, Psychological Bulletin 72, 1969), with the mean weights of
//! row and column `u_i = Σ_j p_.j w_ij` and `v_j = Σ_i p_i. w_ij`:
//!
//! ```text
//! se² = [ Σ p_ij (w_ij (1 - pe) - (u_i + v_j)(1 - po))² - (po pe - 2 pe + po)² ] / (n (1 - pe)⁴)
//! ```
//!
//! The 95 % interval is κ ± 1.96 se, cut to -1 … 1. It is *asymptotic*: with few answers it is
//! rough, and if all answers agree it has no width, which does not mean certainty.

// Numbers of answers are far below 2^53.
#![allow(clippy::cast_precision_loss)]

/// Half the width of a 95 % interval in standard errors: the 0.975 quantile of the normal
/// distribution.
pub(super) const QUANTILE: f64 = 1.959_963_984_540_054;

/// Cohen's kappa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kappa {
    /// Estimate, at most 1.
    pub value: f64,
    /// Asymptotic standard error.
    pub standard_error: f64,
}

impl Kappa {
    /// Limits of the 95 % interval, within -1 to 1.
    pub fn interval(self) -> (f64, f64) {
        let half = QUANTILE * self.standard_error;
        let low = (self.value - half).clamp(-1.0, 1.0);
        let high = (self.value + half).clamp(-1.0, 1.0);
        (low, high)
    }
}

/// Degree to which an answer of another category agrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// No agreement.
    Nominal,
    /// The less the further it is away.
    Linear,
    /// The less the further it is away, by the square.
    Quadratic,
}

impl Weights {
    /// Weight of categories `i` and `j` of `K`.
    fn of<const K: usize>(self, i: usize, j: usize) -> f64 {
        match self {
            Self::Nominal => f64::from(u8::from(i == j)),
            _ if K < 2 => 1.0,
            Self::Linear => 1.0 - i.abs_diff(j) as f64 / (K - 1) as f64,
            Self::Quadratic => 1.0 - (i.abs_diff(j) as f64 / (K - 1) as f64).powi(2),
        }
    }
}

/// Numbers of answers: rows are the truth, columns the answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table<const K: usize>(pub [[usize; K]; K]);

impl<const K: usize> Default for Table<K> {
    fn default() -> Self {
        Self([[0; K]; K])
    }
}

impl<const K: usize> Table<K> {
    /// Counts an answer; ignores a category that is not in the table.
    pub fn count(&mut self, truth: usize, answer: usize) {
        let cell = self.0.get_mut(truth).and_then(|row| row.get_mut(answer));
        if let Some(cell) = cell {
            *cell += 1;
        }
    }

    /// Number of answers.
    pub fn total(&self) -> usize {
        self.0.iter().flatten().sum()
    }

    /// Number of categories that the truth has.
    pub fn truths(&self) -> usize {
        let rows = self.0.iter();
        rows.filter(|row| row.iter().any(|n| *n > 0)).count()
    }

    /// Cohen's kappa; `None` where it is undefined.
    pub fn kappa(&self, weights: Weights) -> Option<Kappa> {
        let n = self.total() as f64;
        let cells = || {
            let rows = self.0.iter().enumerate();
            rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, count)| (i, j, *count)))
        };
        let weight = |i, j| weights.of::<K>(i, j);
        let (mut rows, mut columns) = ([0.0; K], [0.0; K]);
        for (i, j, count) in cells() {
            add(&mut rows, i, count as f64 / n);
            add(&mut columns, j, count as f64 / n);
        }
        // u_i and v_j, the mean weights.
        let (mut of_row, mut of_column) = ([0.0; K], [0.0; K]);
        for (i, j, _) in cells() {
            add(&mut of_row, i, weight(i, j) * at(&columns, j));
            add(&mut of_column, j, weight(i, j) * at(&rows, i));
        }
        let po: f64 = cells()
            .map(|(i, j, count)| weight(i, j) * count as f64 / n)
            .sum();
        let pe: f64 = (0..K).map(|i| at(&rows, i) * at(&of_row, i)).sum();
        let chance = 1.0 - pe;
        // An empty table has NaN.
        if chance.is_nan() || chance < 1e-12 {
            return None;
        }
        let spread: f64 = cells()
            .map(|(i, j, count)| {
                let mean = at(&of_row, i) + at(&of_column, j);
                count as f64 / n * (weight(i, j) * chance - mean * (1.0 - po)).powi(2)
            })
            .sum();
        let variance = (spread - (po * pe - 2.0 * pe + po).powi(2)) / (n * chance.powi(4));
        Some(Kappa {
            value: (po - pe) / chance,
            // Rounding can make a variance of zero negative.
            standard_error: variance.max(0.0).sqrt(),
        })
    }
}

fn add(sums: &mut [f64], place: usize, term: f64) {
    if let Some(sum) = sums.get_mut(place) {
        *sum += term;
    }
}

fn at(numbers: &[f64], place: usize) -> f64 {
    numbers.get(place).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests;
