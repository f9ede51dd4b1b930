//! Intervals by resampling.
//!
//! Of `n` units (knees, or clinicians) `n` are drawn with replacement, [`RESAMPLES`] times; the interval has the
//! middle 95 % of the statistic (Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, ch. 13: the
//! percentile method). Quantiles interpolate between order statistics, as NumPy's `linear`. Draws come from
//! [`SplitMix64`] with the seed 1: equal data give equal intervals.
//!
//! With few units the interval is too narrow, and its ends are rough to some hundredths of its width. A
//! resample without the statistic is left out; with fewer than half of them there is no interval.

use super::order::SplitMix64;

/// Number of resamples.
pub const RESAMPLES: usize = 2_000;

/// An estimate with its 95 % interval, if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Of the data.
    pub value: f64,
    /// Limits.
    pub interval: Option<[f64; 2]>,
    /// Number of units that were resampled.
    pub units: usize,
}

/// Estimates a statistic of units, and its interval; `None` where the data have none.
pub fn estimate<T>(units: &[T], statistic: impl Fn(&[&T]) -> Option<f64>) -> Option<Estimate> {
    let all: Vec<&T> = units.iter().collect();
    let value = statistic(&all)?;
    let mut random = SplitMix64::new(1);
    let mut drawn = Vec::with_capacity(all.len());
    let mut found = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        drawn.clear();
        for _ in 0..all.len() {
            let place = usize::try_from(random.below(all.len() as u64)).unwrap_or(0);
            drawn.extend(all.get(place).copied());
        }
        found.extend(statistic(&drawn));
    }
    found.sort_by(f64::total_cmp);
    let is_enough = units.len() > 1 && found.len() * 2 >= RESAMPLES;
    Some(Estimate {
        value,
        interval: is_enough.then(|| [quantile(&found, 0.025), quantile(&found, 0.975)]),
        units: units.len(),
    })
}

/// Quantile of sorted numbers.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() as f64 - 1.0);
    let low = place.floor();
    let at = |offset: usize| {
        // Below the number of resamples.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let index = low as usize + offset;
        sorted
            .get(index)
            .or(sorted.last())
            .copied()
            .unwrap_or(f64::NAN)
    };
    at(0) + (place - low) * (at(1) - at(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(units: &[&f64]) -> Option<f64> {
        let of = |count: usize| units.iter().copied().sum::<f64>() / count as f64;
        (!units.is_empty()).then(|| of(units.len()))
    }

    /// The interval of a mean is that of the normal distribution, to the Monte-Carlo error.
    #[test]
    fn a_mean_has_the_interval_that_theory_gives() {
        let units: Vec<f64> = (0..400).map(|k| f64::from(k % 20)).collect();
        let found = estimate(&units, mean).expect("a mean");
        let [low, high] = found.interval.expect("an interval");
        let half = 1.96 * (399.0_f64 / 12.0 / 400.0).sqrt();
        assert_eq!(found.value, 9.5);
        assert!((low - (9.5 - half)).abs() < 0.06, "{low}");
        assert!((high - (9.5 + half)).abs() < 0.06, "{high}");
    }

    #[test]
    fn it_is_the_same_every_time_and_one_unit_has_none() {
        let units = [1.0, 2.0, 5.0];
        assert_eq!(estimate(&units, mean), estimate(&units, mean));
        assert_eq!(estimate(&[1.0], mean).expect("a mean").interval, None);
        assert_eq!(estimate(&[] as &[f64], |_| None), None);
    }

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&[0.0, 1.0, 2.0, 3.0], 0.5), 1.5);
        assert_eq!(quantile(&[4.0], 0.975), 4.0);
    }
}
