//! Course of a column over a whole run: a line; or, where cycles are too many
//! to draw each, the range that it covers and its mean.

use crate::plot::palette::{Ink, RANGE};
use crate::plot::{Axis, Plot, Point, Thinned, extent};
use crate::report::envelope::{Bin, Envelope, edges};

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    line: Thinned,
    envelope: Envelope,
}

/// Part of a course that an axis shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shown {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The largest magnitude beyond, where a few peaks would squeeze all
    /// else.
    pub(crate) beyond: Option<f64>,
}

impl Course {
    /// Bins of the line: more than a chart has pixels.
    pub(crate) const LINE: usize = 1600;

    pub(crate) fn new(rows_expected: u64) -> Self {
        Self {
            line: Thinned::new(Self::LINE),
            envelope: Envelope::new(rows_expected),
        }
    }

    /// Appends a value; one that is not finite is left out.
    pub(crate) fn push(&mut self, time: f64, value: f64) {
        self.line.push(time, value);
        self.envelope.row(time, value, None);
    }

    pub(crate) fn finish(self) -> Self {
        Self {
            envelope: self.envelope.finish(),
            ..self
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.line.is_empty()
    }

    /// Returns whether it ever is anything but zero.
    pub(crate) fn is_zero(&self) -> bool {
        let (low, high) = self.extent();
        low == 0.0 && high == 0.0
    }

    pub(crate) fn points(&self) -> Vec<Point> {
        self.line.points()
    }

    pub(crate) fn extent(&self) -> (f64, f64) {
        extent(self.points().iter().map(|p| p.y))
    }

    /// The range worth showing: all, or where a few stretches in a hundred go
    /// beyond ten times the range of the others, that of the others.
    pub(crate) fn shown(&self) -> Shown {
        const OFTEN: usize = 40;
        const SQUEEZED: f64 = 10.0;
        let (low, high) = self.extent();
        let all = Shown {
            low,
            high,
            beyond: None,
        };
        let bins: Vec<&Bin> = self.bins().collect();
        if bins.len() < OFTEN {
            return all;
        }
        let sorted = |pick: fn(&Bin) -> f64| {
            let mut values: Vec<f64> = bins.iter().map(|bin| pick(bin)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let few = bins.len() / 25;
        let usual_low = sorted(|bin| bin.value.low)[few];
        let usual_high = sorted(|bin| bin.value.high)[bins.len() - 1 - few];
        if usual_high > usual_low && high - low > SQUEEZED * (usual_high - usual_low) {
            Shown {
                low: usual_low,
                high: usual_high,
                beyond: Some(low.abs().max(high.abs())),
            }
        } else {
            all
        }
    }

    /// An axis for it.
    pub(crate) fn axis(&self, ticks: u32) -> Axis {
        let shown = self.shown();
        Axis::covering([shown.low, shown.high], ticks)
    }

    fn bins(&self) -> impl Iterator<Item = &Bin> {
        self.envelope
            .bins
            .iter()
            .filter(|bin| !bin.value.is_empty())
    }

    /// Draws it: as range and mean of so many bins each, or as a line.
    pub(crate) fn draw(&self, plot: &mut Plot, bins: Option<usize>, ink: Ink) {
        let Some(bins) = bins else {
            plot.line(&self.points(), ink, 1.5);
            return;
        };
        let bins: Vec<Bin> = self
            .envelope
            .wide_bins(bins)
            .into_iter()
            .filter(|bin| !bin.value.is_empty())
            .collect();
        let mean: Vec<Point> = bins
            .iter()
            .map(|bin| Point::new(bin.middle(), bin.mean()))
            .collect();
        let [low, high] = edges(&bins);
        plot.band(&low, &high, RANGE, 1.0);
        plot.line(&mean, ink, 1.5);
    }

    #[cfg(test)]
    pub(crate) fn stored(&self) -> usize {
        self.line.stored() + self.envelope.bins.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(value: impl Fn(u32) -> f64) -> Course {
        let mut course = Course::new(10_000);
        for i in 0..10_000 {
            course.push(f64::from(i), value(i));
        }
        course.finish()
    }

    #[test]
    fn peaks_do_not_squeeze_the_rest() {
        let wave = |i: u32| (f64::from(i) * 0.01).sin();
        let calm = course(wave).shown();
        assert_eq!(calm.beyond, None);
        assert!(calm.high > 0.99 && calm.low < -0.99);
        let hit = course(|i| if i % 1000 == 500 { 700.0 } else { wave(i) }).shown();
        assert_eq!(hit.beyond, Some(700.0));
        assert!(hit.high < 1.1, "{hit:?}");
        // A lasting rise is no peak.
        let step = course(|i| if i < 5000 { 0.0 } else { 700.0 + wave(i) });
        assert_eq!(step.shown().beyond, None);
    }

    #[test]
    fn nothing_is_nothing() {
        let course = course(|_| f64::NAN);
        assert!(course.is_empty() && !course.is_zero());
        assert_eq!(course.shown().beyond, None);
        assert!(super::Course::new(0).finish().is_empty());
    }
}
