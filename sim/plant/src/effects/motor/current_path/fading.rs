//! Rests of an exponential at the first sample, by factors that are computed once.
//!
//! The edges of half a tick are x = h/4·|d| before and after its middle h/4, each with a dead time D after it. With the
//! first sample at s, and c = s − h/4 − D, that leaves of what begins as a dead time ends
//!
//! ```text
//! at the later edge:    l = e^(−(c − x)/τ)            as it begins: l·e^(−D/τ)
//! at the earlier one:   e^(−(c + x)/τ) = e^(−2c/τ)/l                e^(−2c/τ)/l·e^(−D/τ)
//! ```
//!
//! One exponential is left of four. Of that, l is tabled at 128 places of x, and between them times a series:
//!
//! ```text
//! l(x) = l(x₀)·e^y,   y = (x − x₀)/τ,   |y| ≤ h/1024τ ≤ 0.1
//! ```
//!
//! What the series of ten terms leaves out is less than 0.1¹⁰/10!·1.01 < u/3 of it, with the unit roundoff u = 2⁻⁵³. The
//! rest is rounding, of the product and of times: a rest is off by less than u·(8 + h/τ), as an exponential of each time
//! would be. A time constant below 0.49 µs is beyond the reach of the series, and has its exponential.

use super::{HALF_S, SAMPLES_S};

/// Places at which a rest is tabled, over a quarter of a tick.
const PLACES: usize = 128;

/// Distance between them, s.
const PLACE_S: f64 = HALF_S / 2.0 / 128.0;

/// The furthest from a place in time constants.
const REACH: f64 = 0.1;

/// An addend that rounds a number below 2⁵¹ to a whole one, which its last bits are.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Coefficients of the series of an exponential, from the last one.
const SERIES: [f64; 10] = [
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    1.0 / 2.0,
    1.0,
    1.0,
];

/// The first sample, from the beginning of the half tick before it, s.
pub(super) const FIRST_SAMPLE_S: f64 = HALF_S + SAMPLES_S[0];

/// An exponential with its factors.
#[derive(Clone, Debug)]
pub(super) struct Fading {
    /// 1/τ, 1/s.
    per_s: f64,
    /// c, s.
    centre_s: f64,
    /// l at each place; none beyond the reach of the series.
    later: Option<[f64; PLACES]>,
    /// e^(−2c/τ).
    both: f64,
    /// The rest after a dead time.
    dead: f64,
    /// The rest from the beginning of half a tick to the first sample.
    pub(super) to_first: f64,
    /// The rest from the first sample to the end of half a tick.
    pub(super) to_end: f64,
    /// Mean at all samples of what was there at the first.
    pub(super) sampled: f64,
}

/// Rests at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rests {
    /// Of what began with the dead time of the earlier edge, and of what began as it ended.
    pub(super) earlier: [f64; 2],
    /// Those of the later edge.
    pub(super) later: [f64; 2],
}

impl Fading {
    /// An exponential of this time constant, s; one of 0 is over at once.
    pub(super) fn new(time_constant_s: f64, dead_s: f64) -> Self {
        let per_s = time_constant_s.recip().min(f64::MAX);
        let left = |length_s: f64| (-length_s * per_s).exp();
        let centre_s = FIRST_SAMPLE_S - HALF_S / 2.0 - dead_s;
        let mut later = [0.0; PLACES];
        let mut place = 0.0;
        for rest in &mut later {
            // Not summed up: its rounding is that of a product, which `rests` has, too.
            *rest = left(centre_s - PLACE_S * place);
            place += 1.0;
        }
        Self {
            per_s,
            centre_s,
            later: (0.5 * PLACE_S * per_s <= REACH).then_some(later),
            both: left(2.0 * centre_s),
            dead: left(dead_s),
            to_first: left(FIRST_SAMPLE_S),
            to_end: left(HALF_S - FIRST_SAMPLE_S),
            sampled: SAMPLES_S
                .map(|at_s| left(at_s - SAMPLES_S[0]))
                .iter()
                .sum::<f64>()
                / 4.0,
        }
    }

    /// The rest after a time, s.
    #[inline]
    pub(super) fn left(&self, length_s: f64) -> f64 {
        (-length_s * self.per_s).exp()
    }

    /// Rests of what begins with edges that are `apart_s` from the middle of the half tick, s, whose dead times end before
    /// the first sample.
    #[inline]
    pub(super) fn rests(&self, apart_s: f64) -> Rests {
        let later = match &self.later {
            Some(later) => {
                let rounded = apart_s * (1.0 / PLACE_S) + WHOLE;
                let away_s = apart_s - PLACE_S * (rounded - WHOLE);
                let [place, ..] = rounded.to_le_bytes();
                let y = away_s * self.per_s;
                let [first, terms @ ..] = SERIES;
                let series = terms.iter().fold(first, |sum, term| sum * y + term);
                later[usize::from(place) % PLACES] * series
            }
            None => self.left(self.centre_s - apart_s),
        };
        // Of an exponential that is over long before, both are zero.
        let earlier = self.both / later.max(f64::MIN_POSITIVE);
        Rests {
            earlier: [earlier * self.dead, earlier],
            later: [later * self.dead, later],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time constants from 0.1 ns to 0.1 ms and zero, and dead times, at every duty up to the first sample.
    #[test]
    fn rests_are_exponentials_to_rounding() {
        let mut worst = 0.0_f64;
        let time_constants_s = (-60..=60).map(|n| 1e-7 * 10_f64.powf(0.05 * f64::from(n)));
        for time_constant_s in time_constants_s.chain([0.0]) {
            let bound = 0.5 * f64::EPSILON * (8.0 + 2.0 * HALF_S / time_constant_s.max(1e-10));
            for dead_s in [0.0, 1e-9, 0.1e-6, 0.4e-6, 1e-6] {
                let fading = Fading::new(time_constant_s, dead_s);
                for n in 0..=1_000 {
                    let apart_s = fading.centre_s * 1e-3 * f64::from(n);
                    let Rests { earlier, later } = fading.rests(apart_s);
                    for (rests, edge_s) in [
                        (earlier, HALF_S / 2.0 - apart_s),
                        (later, HALF_S / 2.0 + apart_s),
                    ] {
                        let since_s = FIRST_SAMPLE_S - edge_s;
                        for (rest, since_s) in rests.into_iter().zip([since_s, since_s - dead_s]) {
                            // Without a length there is no exponential of a time constant of zero.
                            if since_s > 1e-19 {
                                let exact = (-since_s / time_constant_s).exp();
                                worst = worst.max((rest - exact).abs() / bound);
                            }
                        }
                    }
                }
            }
        }
        println!("off by at most {worst} of the bound");
        assert!(worst < 1.0, "{worst}");
    }
}
