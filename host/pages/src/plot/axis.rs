//! One axis of a chart: its range, and ticks at round numbers with exactly
//! the decimals they need.

use crate::plot::number;
use crate::plot::text::{SIZE, width};
use crepitus_plant::Extremes;

/// See the module.
#[derive(Clone, Debug)]
pub struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    decimals: usize,
    logarithmic: bool,
    /// Ticks are written as powers of ten.
    powers: bool,
}

impl Axis {
    /// Linear axis from `low` to `high`, with about `ticks` ticks.
    pub fn linear(low: f64, high: f64, ticks: u32) -> Self {
        let (low, high) = sound(low, high);
        let step = round_step((high - low) / f64::from(ticks.max(1)));
        let first = (low / step - 1e-6).ceil();
        let ticks = (0..100_u8)
            .map(|i| (first + f64::from(i)) * step)
            .take_while(|tick| *tick <= high + 1e-6 * step)
            .collect();
        // The step is 1, 2 or 5 times a power of ten.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let decimals = (-step.log10() - 1e-9).ceil().clamp(0.0, 12.0) as usize;
        Self {
            low,
            high,
            ticks,
            decimals,
            logarithmic: false,
            powers: false,
        }
    }

    /// Covers all values, with a little room at both ends.
    pub fn covering(values: impl IntoIterator<Item = f64>, ticks: u32) -> Self {
        let (low, high) = extent(values);
        let (low, high) = sound(low, high);
        let room = 0.05 * (high - low);
        Self::linear(low - room, high + room, ticks)
    }

    /// Logarithmic; both ends positive. `marks` are the labelled ticks.
    pub fn logarithmic(low: f64, high: f64, marks: &[f64]) -> Self {
        Self {
            low,
            high: if high > low { high } else { low * 10.0 },
            ticks: marks
                .iter()
                .copied()
                .filter(|mark| (low..=high * 1.000_001).contains(mark))
                .collect(),
            decimals: 0,
            logarithmic: true,
            powers: false,
        }
    }

    /// Logarithmic; both ends positive, ticks at 1, 2 and 5 times powers of
    /// ten.
    pub fn one_two_five(low: f64, high: f64) -> Self {
        let marks: Vec<f64> = (-3..8)
            .flat_map(|exponent| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(exponent)))
            .collect();
        Self::logarithmic(low, high, &marks)
    }

    /// Logarithmic; both ends positive, ticks at powers of ten, `most` of
    /// them.
    pub fn decades(low: f64, high: f64, most: i32) -> Self {
        // Exponents of doubles.
        #[allow(clippy::cast_possible_truncation)]
        let (from, to) = (
            (low.log10() - 1e-9).ceil() as i32,
            (high.log10() + 1e-9).floor() as i32,
        );
        let stride = ((to - from) / most.max(1) + 1).max(1);
        let marks: Vec<f64> = (from..=to)
            .filter(|exponent| exponent.rem_euclid(stride) == 0)
            .map(|exponent| 10_f64.powi(exponent))
            .collect();
        Self {
            powers: from < -2 || to > 5,
            ..Self::logarithmic(low, high, &marks)
        }
    }

    /// The range with as many ticks as have room for their labels, to the right, on this many
    /// CSS pixels.
    pub(crate) fn fitting(self, px: f64) -> Self {
        let mut fewer = self;
        while fewer.ticks.len() > 2 && !fewer.labels_fit(px) {
            fewer = fewer.thinner();
        }
        fewer
    }

    /// Returns whether no label touches the next one.
    fn labels_fit(&self, px: f64) -> bool {
        /// Least distance between labels: half the letters' size.
        const GAP: f64 = 0.5 * SIZE;
        let spans: Vec<(f64, f64)> = self
            .labels()
            .map(|(at, label)| (px * self.place(at), 0.5 * width(&label, SIZE)))
            .collect();
        spans
            .array_windows()
            .all(|[(a, half_a), (b, half_b)]| b - a >= half_a + half_b + GAP)
    }

    /// The next coarser round step; of a logarithmic axis every second tick.
    fn thinner(self) -> Self {
        if self.logarithmic {
            let ticks = self.ticks.into_iter().step_by(2).collect();
            return Self { ticks, ..self };
        }
        let count = self.ticks.len();
        let (low, high) = (self.low, self.high);
        (1..8)
            .rev()
            .map(|ticks| Self::linear(low, high, ticks))
            .find(|axis| axis.ticks.len() < count)
            .unwrap_or(Self {
                ticks: self.ticks.into_iter().take(1).collect(),
                ..Self::linear(low, high, 1)
            })
    }

    /// The ticks with their labels.
    pub fn labels(&self) -> impl Iterator<Item = (f64, String)> {
        self.ticks.iter().map(|tick| (*tick, self.label(*tick)))
    }

    fn label(&self, value: f64) -> String {
        if self.powers {
            number::power(value)
        } else if self.logarithmic {
            number::rounded(value)
        } else {
            number::fixed(value, self.decimals)
        }
    }

    /// The low end.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The high end.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// Position of a value: 0 at the low end, 1 at the high end. What is
    /// outside stands at the edge.
    pub fn place(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        share.clamp(0.0, 1.0)
    }
}

/// The smallest and largest finite value.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let extremes: Extremes<f64> = finite.collect();
    (extremes.low, extremes.high)
}

/// A range that can be drawn: finite, and wider than rounding noise.
fn sound(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite() && low <= high) {
        return (0.0, 1.0);
    }
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size && high > low {
        (low, high)
    } else {
        let half = if size > 0.0 { 0.5 * size } else { 1.0 };
        (low - half, high + half)
    }
}

/// The nearest round number: 1, 2 or 5 times a power of ten.
fn round_step(raw: f64) -> f64 {
    let power = 10_f64.powf(raw.log10().floor());
    // Halfway between two steps on a logarithmic scale.
    let step = match raw / power {
        r if r < 1.41 => 1.0,
        r if r < 3.16 => 2.0,
        r if r < 7.07 => 5.0,
        _ => 10.0,
    };
    step * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.labels().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_and_evenly_written() {
        let axis = Axis::linear(-0.05, 0.42, 5);
        assert_eq!(labels(&axis), ["0.0", "0.1", "0.2", "0.3", "0.4"]);
        let axis = Axis::linear(7.3, 7.42, 6);
        assert_eq!(labels(&axis)[0], "7.30");
        let axis = Axis::linear(0.0, 20_000.0, 2);
        assert_eq!(labels(&axis), ["0", "10\u{202F}000", "20\u{202F}000"]);
        let axis = Axis::logarithmic(0.5, 500.0, &[0.1, 1.0, 10.0, 100.0]);
        assert_eq!(labels(&axis), ["1", "10", "100"]);
        let axis = Axis::decades(1e-4, 0.5, 2);
        assert_eq!(labels(&axis), ["10⁻⁴", "10⁻²"]);
        let axis = Axis::decades(3.0, 2e3, 6);
        assert_eq!(labels(&axis), ["10", "100", "1000"]);
    }

    #[test]
    fn labels_do_not_touch_on_a_narrow_chart() {
        for (low, high) in [(0.0, 10.0), (7.301, 7.4234), (-1e4, 2e4), (0.0, 1.0)] {
            let axis = Axis::linear(low, high, 8);
            // Wide enough: as it was.
            assert_eq!(labels(&axis.clone().fitting(900.0)), labels(&axis));
            for px in [500.0, 300.0, 200.0, 120.0] {
                let narrow = axis.clone().fitting(px);
                assert!(
                    narrow.labels_fit(px) || narrow.ticks.len() <= 2,
                    "{px}: {narrow:?}"
                );
                assert!(!narrow.ticks.is_empty());
                assert_eq!((narrow.low, narrow.high), (low, high));
            }
        }
        let axis = Axis::decades(1e-12, 1e3, 16);
        let narrow = axis.clone().fitting(250.0);
        assert!(narrow.ticks.len() < axis.ticks.len() && narrow.labels_fit(250.0));
    }

    #[test]
    fn no_range_is_too_odd() {
        for (low, high) in [
            (f64::NAN, 1.0),
            (f64::INFINITY, f64::NEG_INFINITY),
            (0.0, 0.0),
            (5.0, 5.0),
            (5.0, 5.0 + 1e-15),
            (-1e300, 1e300),
            (0.0, 1e-300),
        ] {
            let axis = Axis::covering([low, high], 5);
            assert!(axis.low < axis.high, "{low} {high}");
            assert!(!axis.ticks.is_empty(), "{low} {high}");
            assert!((0.0..=1.0).contains(&axis.place(low)) || low.is_nan());
        }
    }
}
