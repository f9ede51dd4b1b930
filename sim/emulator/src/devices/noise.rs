//! Noise of the converters: deterministic, the same in every run.

use fastrand::Rng;

/// Uniform numbers in a sum, whose variance is then 1.
const UNIFORM: u32 = 12;

/// Normally distributed numbers, as far as a sum of twelve uniform ones is: mean 0, at
/// most six standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    deviation: f64,
    random: Rng,
}

impl Noise {
    /// Noise of this standard deviation.
    pub(crate) fn new(deviation: f64) -> Self {
        Self {
            deviation,
            random: Rng::with_seed(0),
        }
    }

    /// The next number.
    pub(crate) fn next(&mut self) -> f64 {
        let sum: f64 = (0..UNIFORM).map(|_| self.random.f64()).sum();
        (sum - f64::from(UNIFORM) / 2.0) * self.deviation
    }
}
