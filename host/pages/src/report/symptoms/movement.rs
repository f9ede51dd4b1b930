//! Distance and duration of the joint's motion, and the events meanwhile.
//!
//! An angle comes in counts of an encoder, and rows may be shorter than a count takes: whether the
//! joint moves is judged over a stretch of several rows.

use crepitus_scene::trace::Word;

/// The length of a stretch, s, at least.
const STRETCH_S: f64 = 0.02;

/// Slower, a joint is at rest: one degree a second.
const SLOWEST_RAD_S: f64 = std::f64::consts::PI / 180.0;

/// Number of events of one kind while the joint moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    pub(crate) word: Word,
    pub(crate) count: u64,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct Movement {
    pub(crate) travel_rad: f64,
    pub(crate) moving_s: f64,
    pub(crate) rates: Vec<Rate>,
    /// Start of the stretch: s, rad.
    from: Option<(f64, f64)>,
    /// Events in it so far.
    waiting: Vec<Rate>,
}

impl Movement {
    /// Rows are missing: nothing is known of the stretch.
    pub(crate) fn gap(&mut self) {
        self.from = None;
        self.waiting.clear();
    }

    pub(crate) fn row(&mut self, time_s: f64, angle_rad: f64) {
        let (from_s, from_rad) = *self.from.get_or_insert((time_s, angle_rad));
        let (passed_s, moved_rad) = (time_s - from_s, (angle_rad - from_rad).abs());
        if passed_s < STRETCH_S {
            return;
        }
        if moved_rad > SLOWEST_RAD_S * passed_s {
            self.travel_rad += moved_rad;
            self.moving_s += passed_s;
            for rate in &self.waiting {
                add(&mut self.rates, *rate);
            }
        }
        self.waiting.clear();
        self.from = Some((time_s, angle_rad));
    }

    /// Takes something that happened before the next row.
    pub(crate) fn count(&mut self, word: Word) {
        add(&mut self.waiting, Rate { word, count: 1 });
    }
}

fn add(rates: &mut Vec<Rate>, more: Rate) {
    match rates.iter_mut().find(|rate| rate.word == more.word) {
        Some(rate) => rate.count += more.count,
        None => rates.push(more),
    }
}
