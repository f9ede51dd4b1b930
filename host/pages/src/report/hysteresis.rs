//! The imaginary object against the shaft angle over a whole run: for each
//! angle and each direction of motion the range that θ covered.
//!
//! The number of angle bins is bounded: when the shaft reaches further, bins
//! widen to twice their width and neighbours merge.

use crepitus_plant::Extremes;
use std::collections::BTreeMap;

/// Range of θ in one bin of angle, rad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub(crate) angle: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    angle: Extremes<f64>,
    theta: Extremes<f64>,
}

type Cells = BTreeMap<i64, Cell>;

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Hysteresis {
    flexing: Cells,
    extending: Cells,
    width: f64,
    last_angle: f64,
    last_was_flexing: bool,
    travel: f64,
}

impl Hysteresis {
    const CAPACITY: usize = 1000;

    pub(crate) fn new() -> Self {
        Self {
            flexing: Cells::new(),
            extending: Cells::new(),
            width: 1e-4,
            last_angle: f64::NAN,
            last_was_flexing: true,
            travel: 0.0,
        }
    }

    /// Rows are missing before the next one.
    pub(crate) fn gap(&mut self) {
        self.last_angle = f64::NAN;
    }

    pub(crate) fn row(&mut self, angle: f64, omega: f64, theta: f64) {
        if !(angle.is_finite() && theta.is_finite()) {
            return;
        }
        let moved = angle - self.last_angle;
        if moved.is_finite() {
            self.travel += moved.abs();
        }
        self.last_angle = angle;
        // At rest the last direction continues.
        if omega > 0.0 {
            self.last_was_flexing = true;
        } else if omega < 0.0 {
            self.last_was_flexing = false;
        }
        let bin = bin_of(angle, self.width);
        let cells = if self.last_was_flexing {
            &mut self.flexing
        } else {
            &mut self.extending
        };
        let cell = cells.entry(bin).or_default();
        cell.angle.add(angle);
        cell.theta.add(theta);
        if cells.len() > Self::CAPACITY {
            self.flexing = widened(&self.flexing, 2);
            self.extending = widened(&self.extending, 2);
            self.width *= 2.0;
        }
    }

    /// Total travel of the shaft, rad.
    pub(crate) fn travel(&self) -> f64 {
        self.travel
    }

    /// The ranges in bins of about `width` rad, narrower if that left only a
    /// few: those of growing angle, then those of falling angle.
    pub(crate) fn ranges(&self, width: f64) -> [Vec<Range>; 2] {
        const FEWEST_BINS: f64 = 30.0;
        let bins = || self.flexing.keys().chain(self.extending.keys());
        let span = match (bins().min(), bins().max()) {
            (Some(low), Some(high)) => (*high as f64 - *low as f64) * self.width,
            _ => 0.0,
        };
        let width = width.min(span / FEWEST_BINS);
        let factor = (width / self.width).ceil().clamp(1.0, 1e6);
        // In range by the clamp above.
        #[allow(clippy::cast_possible_truncation)]
        let factor_whole = factor as i64;
        [&self.flexing, &self.extending].map(|cells| {
            widened(cells, factor_whole)
                .values()
                .map(|cell| Range {
                    angle: 0.5 * (cell.angle.low + cell.angle.high),
                    low: cell.theta.low,
                    high: cell.theta.high,
                })
                .collect()
        })
    }

    #[cfg(test)]
    pub(crate) fn stored(&self) -> usize {
        self.flexing.len() + self.extending.len()
    }
}

// The cast saturates, which is what an absurd angle deserves.
#[allow(clippy::cast_possible_truncation)]
fn bin_of(angle: f64, width: f64) -> i64 {
    (angle / width).floor() as i64
}

fn widened(cells: &Cells, factor: i64) -> Cells {
    let mut wide = Cells::new();
    for (bin, cell) in cells {
        let known = wide.entry(bin.div_euclid(factor)).or_default();
        known.angle.join(cell.angle);
        known.theta.join(cell.theta);
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_stay_apart_and_memory_is_bounded() {
        let mut map = Hysteresis::new();
        for i in 0..200_000_u32 {
            let phase = f64::from(i) * 1e-3;
            map.row(phase.sin(), phase.cos(), phase.cos().signum() * 0.5);
        }
        assert!(map.stored() <= 2 * Hysteresis::CAPACITY + 2);
        let [flexing, extending] = map.ranges(0.05);
        // Halfway there is only the value of the direction itself.
        let near_zero = |ranges: &[Range]| {
            ranges
                .iter()
                .find(|r| r.angle.abs() < 0.05)
                .map(|r| (r.low, r.high))
        };
        assert_eq!(near_zero(&flexing), Some((0.5, 0.5)));
        assert_eq!(near_zero(&extending), Some((-0.5, -0.5)));
        assert!((map.travel() - 400.0 / std::f64::consts::PI * 1.0).abs() < 2.0);
    }
}
