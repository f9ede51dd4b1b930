//! The encoder's two channels.

use super::HALF;
use crate::time::Time;

/// Levels of A and B, count by count: A leads as counts grow.
const LEVELS: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];

/// First and last time of an edge, hundredths of a half tick.
const FIRST: u64 = 40;
const LAST: u64 = 95;

/// State of the channels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Edges {
    place: u32,
}

impl Edges {
    /// The edges between two counts, in a half tick that begins at `begin`:
    /// when, which channel, its new level.
    pub(super) fn between(&mut self, from: i32, to: i32, begin: Time) -> Vec<(Time, usize, bool)> {
        let turned = to.wrapping_sub(from);
        let count = u64::from(turned.unsigned_abs());
        let step = turned.signum().cast_unsigned();
        let window = HALF.units() * (LAST - FIRST) / 100;
        (1..=count)
            .map(|n| {
                let (a, b) = self.levels();
                self.place = self.place.wrapping_add(step);
                let (new_a, new_b) = self.levels();
                let into = HALF.units() * FIRST / 100 + window * n / (count + 1);
                let at = begin + Time::from_units(into);
                // Exactly one of them has changed.
                if a == new_a {
                    debug_assert_ne!(b, new_b);
                    (at, 1, new_b)
                } else {
                    (at, 0, new_a)
                }
            })
            .collect()
    }

    fn levels(self) -> (bool, bool) {
        LEVELS[(self.place % 4) as usize]
    }
}
