//! Ranges of the axes that diagrams side by side share.

use std::ops::RangeInclusive;

use crate::accuracy::Point;

use super::curve::FLOOR;
use super::measure::Measure;
use crepitus_pages::plot::{Plot, extent};

/// Errors above this are not compared.
const HIGHEST: f64 = 1e100;

/// Cost of a point, µs per simulated second: first quartile, median, third quartile. A
/// quartile that no axis can show is the median.
pub(crate) fn costs(point: &Point) -> [f64; 3] {
    let median = point.us_per_simulated_s;
    [
        point.ns_per_step_q1,
        point.ns_per_step,
        point.ns_per_step_q3,
    ]
    .map(|ns| {
        let us = median * ns / point.ns_per_step;
        if us > 0.0 && us.is_finite() {
            us
        } else {
            median
        }
    })
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Axes {
    pub(crate) cost: RangeInclusive<f64>,
    pub(crate) error: RangeInclusive<f64>,
    /// Value at which an error of nothing is drawn.
    nothing: f64,
}

impl Axes {
    /// `None` without points.
    pub(crate) fn new<'p>(
        points: impl Iterator<Item = &'p Point>,
        measure: Measure,
    ) -> Option<Self> {
        let points: Vec<&Point> = points.collect();
        let (cheapest, dearest) = extent(points.iter().copied().flat_map(costs));
        let errors = points.iter().map(|p| measure.of(p));
        let lines = measure.lines().iter().map(|line| line.value);
        let (smallest, largest) = extent(errors.filter(|e| *e >= FLOOR).chain(lines));
        if points.is_empty() {
            return None;
        }
        let (smallest, largest) = if smallest <= largest {
            // What diverged stands at the edge.
            (smallest.min(HIGHEST), largest.min(HIGHEST))
        } else {
            (FLOOR, 10.0 * FLOOR)
        };
        let below = |value: f64| 10_f64.powf((value * 0.1).log10().floor());
        let above = |value: f64| 10_f64.powf((value * 1.4).log10().ceil());
        let nothing = points.iter().any(|p| measure.of(p) < FLOOR);
        // With room for the arrow below the sign.
        let foot = below(smallest) * if nothing { 0.1 } else { 1.0 };
        Some(Self {
            cost: cheapest * 0.75..=dearest * 1.33,
            error: foot..=above(largest),
            nothing: 10.0 * foot,
        })
    }

    /// Ends of the bar from the first to the third quartile of the cost.
    pub(crate) fn bar(&self, plot: &Plot, measure: Measure, point: &Point) -> [(f64, f64); 2] {
        let (_, y) = self.place(plot, measure, point);
        let [first, _, third] = costs(point).map(|cost| plot.at((cost, self.nothing)).0);
        [(first, y), (third, y)]
    }

    /// CSS pixels of the whole drawing.
    pub(crate) fn place(&self, plot: &Plot, measure: Measure, point: &Point) -> (f64, f64) {
        let error = match measure.of(point) {
            error if error < FLOOR => self.nothing,
            error => error,
        };
        plot.at((point.us_per_simulated_s, error))
    }
}
