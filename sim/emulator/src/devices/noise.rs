//! Noise of the converters: deterministic, the same in every run.

/// Uniform numbers in a sum, whose variance is then 1.
const UNIFORM: u32 = 12;

/// Normally distributed numbers, as far as a sum of twelve uniform ones is: mean 0, at
/// most six standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    deviation: f64,
    state: u64,
}

impl Noise {
    /// Noise of this standard deviation.
    pub(crate) fn new(deviation: f64) -> Self {
        Self {
            deviation,
            state: 0,
        }
    }

    /// The next number.
    pub(crate) fn next(&mut self) -> f64 {
        let sum: f64 = (0..UNIFORM).map(|_| self.uniform()).sum();
        (sum - f64::from(UNIFORM) / 2.0) * self.deviation
    }

    /// Uniformly distributed number from 0 to 1: SplitMix64.
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
        let high = u32::try_from(mixed >> 32).unwrap_or(u32::MAX);
        f64::from(high) / 4_294_967_296.0
    }
}
