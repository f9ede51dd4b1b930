//! Results of choices: counts by level, means of reversals, and whether anybody feels a difference.
//!
//! The psychometric function is fitted in Python (`crepitus.experiments.fit_threshold`), from these counts.
//!
//! Of `n` trials of A, B and X `k` are right; without a difference each is right with probability ½. The interval of
//! the share is Wilson's (*Probable inference*, JASA 22, 1927), p the probability of `k` or more by chance.

use super::trial::{AbxRow, ThresholdRow};

/// Answers at one difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count {
    /// Comparison less reference.
    pub difference: f64,
    /// Number of trials.
    pub trials: u32,
    /// Right ones; in catch trials choices of the first interval.
    pub right: u32,
}

/// Answers by difference, from the least to the largest; catch trials are at 0.
pub fn counts<'a>(rows: impl IntoIterator<Item = &'a ThresholdRow>) -> Vec<Count> {
    let mut counts: Vec<Count> = Vec::new();
    for row in rows {
        let is_right = if row.difference == 0.0 {
            row.answer == 1
        } else {
            row.is_right
        };
        let found = counts.iter().position(|c| c.difference == row.difference);
        let place = found.unwrap_or_else(|| {
            counts.push(Count {
                difference: row.difference,
                trials: 0,
                right: 0,
            });
            counts.len() - 1
        });
        if let Some(count) = counts.get_mut(place) {
            count.trials += 1;
            count.right += u32::from(is_right);
        }
    }
    counts.sort_by(|a, b| a.difference.total_cmp(&b.difference));
    counts
}

/// Mean difference at the reversals of each staircase of a session, without the first `skip`, an even number of
/// them: as many peaks as valleys. `None` if fewer than four are left in all.
pub fn mean_of_reversals(rows: &[ThresholdRow], skip: usize) -> Option<f64> {
    let last = rows.iter().map(|row| row.staircase).max()?;
    let mut kept = Vec::new();
    for staircase in 1..=last {
        let own = rows
            .iter()
            .filter(|row| row.staircase == staircase && row.has_turned);
        let own: Vec<f64> = own.map(|row| row.difference).collect();
        let left = own.get(skip..).unwrap_or_default();
        kept.extend_from_slice(left.get(left.len() % 2..).unwrap_or_default());
    }
    (kept.len() >= 4).then(|| kept.iter().sum::<f64>() / kept.len() as f64)
}

/// Whether A and B are told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Number of trials.
    pub trials: u32,
    /// Right ones.
    pub right: u32,
    /// 95 % interval of the share of right ones.
    pub interval: [f64; 2],
    /// Probability of as many or more right ones by chance.
    pub p: f64,
}

/// The result of trials of A, B and X; `None` without a trial.
pub fn told<'a>(rows: impl IntoIterator<Item = &'a AbxRow>) -> Option<Told> {
    let (mut trials, mut right) = (0, 0);
    for row in rows {
        trials += 1;
        right += u32::from(row.answer == row.x);
    }
    (trials > 0).then(|| Told {
        trials,
        right,
        interval: wilson(right, trials),
        p: tail(right, trials),
    })
}

/// 95 % interval of a share.
pub fn wilson(right: u32, trials: u32) -> [f64; 2] {
    let (k, n) = (f64::from(right), f64::from(trials));
    let z2 = super::agreement::QUANTILE.powi(2);
    let centre = (k + z2 / 2.0) / (n + z2);
    let half = (z2 * (k * (n - k) / n + z2 / 4.0)).sqrt() / (n + z2);
    [(centre - half).max(0.0), (centre + half).min(1.0)]
}

/// Probability that `trials` throws of a coin give `right` heads or more.
fn tail(right: u32, trials: u32) -> f64 {
    let n = f64::from(trials);
    // ln of n over k times 2^-n, from k = 0 on.
    let mut ln = -n * std::f64::consts::LN_2;
    let mut sum = 0.0;
    for k in 0..=trials {
        if k >= right {
            sum += ln.exp();
        }
        ln += ((n - f64::from(k)) / (f64::from(k) + 1.0)).ln();
    }
    sum.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `scipy.stats.binomtest(k, n, alternative="greater")` and its interval of the method "wilson" for two sides.
    #[test]
    fn scipy_agrees() {
        let rows = |right: u32, trials: u32| {
            (0..trials).map(move |k| AbxRow {
                trial: 1,
                x: 1,
                answer: if k < right { 1 } else { 2 },
                unix_s: 0.0,
            })
        };
        for (right, trials, p, low, high) in SCIPY {
            let rows: Vec<_> = rows(right, trials).collect();
            let found = told(&rows).expect("trials");
            assert!(
                (found.p - p).abs() < 1e-11,
                "{right} of {trials}: {}",
                found.p
            );
            assert!((found.interval[0] - low).abs() < 1e-12, "{found:?}");
            assert!((found.interval[1] - high).abs() < 1e-12, "{found:?}");
        }
        assert_eq!(told(&[]), None);
    }

    fn row(staircase: usize, difference: f64, has_turned: bool) -> ThresholdRow {
        ThresholdRow {
            trial: 1,
            staircase,
            difference,
            comparison_in: 1,
            answer: 1,
            is_right: true,
            has_turned,
            unix_s: 0.0,
        }
    }

    #[test]
    fn reversals_are_averaged_in_pairs_of_each_staircase() {
        let mut rows: Vec<_> = [9.0, 8.0, 1.0, 3.0, 1.0].map(|x| row(1, x, true)).into();
        rows.push(row(1, 50.0, false));
        rows.extend([9.0, 9.0, 5.0, 7.0].map(|x| row(2, x, true)));
        // Of the first the one after the skipped is left out.
        assert_eq!(mean_of_reversals(&rows, 2), Some(4.0));
        assert_eq!(mean_of_reversals(&rows, 4), None);
        assert_eq!(mean_of_reversals(&[], 0), None);
    }

    #[test]
    fn catch_trials_count_the_first_interval() {
        let mut first = row(0, 0.0, false);
        first.is_right = false;
        let rows = [
            row(0, 2.0, false),
            first,
            row(0, 1.0, false),
            row(0, 2.0, false),
        ];
        let found: Vec<_> = counts(&rows)
            .iter()
            .map(|c| (c.difference, c.trials, c.right))
            .collect();
        assert_eq!(found, [(0.0, 1, 1), (1.0, 1, 1), (2.0, 2, 2)]);
    }

    const SCIPY: [(u32, u32, f64, f64, f64); 5] = [
        (
            14,
            20,
            0.057_659_149_169_921_875,
            0.481_027_181_646_476_6,
            0.854_522_755_132_395_7,
        ),
        (
            20,
            20,
            9.536_743_164_062_5e-07,
            0.838_874_841_947_180_8,
            1.0,
        ),
        (0, 7, 1.0, 0.0, 0.354_330_435_066_687_43),
        (
            55,
            100,
            0.184_100_808_663_348_08,
            0.452_446_029_974_421_35,
            0.643_854_620_204_880_3,
        ),
        (
            1040,
            2000,
            0.038_643_445_281_334_295,
            0.498_087_096_854_668_1,
            0.541_836_221_254_081_8,
        ),
    ];
}
