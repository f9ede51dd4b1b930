//! Distribution of a difference over time, in bounded memory.

/// Bins of a profile.
const BINS: u64 = 4096;

/// Distribution of a difference over time: its magnitude, in bins of equal length.
#[derive(Clone, Debug)]
pub(in crate::effects) struct Profile {
    pub(super) ticks_per_bin: u64,
    count: u64,
    pub(super) bins: Vec<f64>,
}

impl Profile {
    /// Empty profile for this number of ticks.
    pub(in crate::effects) fn new(ticks: u64) -> Self {
        Self {
            ticks_per_bin: ticks.div_ceil(BINS).max(1),
            count: 0,
            bins: Vec::new(),
        }
    }

    pub(in crate::effects) fn push(&mut self, difference: f64) {
        if self.count.is_multiple_of(self.ticks_per_bin) {
            self.bins.push(0.0);
        }
        self.count += 1;
        if let Some(bin) = self.bins.last_mut() {
            *bin += difference.abs();
        }
    }
}
