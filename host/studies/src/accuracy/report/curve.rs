//! The curve of one rung: which points it may show, and in which pieces.

use crate::accuracy::Point;

use super::measure::Measure;
use super::pair::{Pair, View};

/// An error of nothing, or less than this, is drawn at the foot of the
/// diagram with an arrow down.
pub(crate) const FLOOR: f64 = 1e-17;

/// Reason why a point is in no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unfit {
    /// Events without a partner: errors of the others mean nothing.
    WrongEvents,
    /// An error or a cost that is NaN or infinite.
    NoNumber,
}

/// `None`: a curve may show the point.
pub(crate) fn unfit(point: &Point, measure: Measure) -> Option<Unfit> {
    let sound = |value: f64| value.is_finite() && value >= 0.0;
    let cost = point.us_per_simulated_s;
    if point.unmatched > 0 {
        Some(Unfit::WrongEvents)
    } else if sound(measure.of(point)) && sound(cost) && cost > 0.0 {
        None
    } else {
        Some(Unfit::NoNumber)
    }
}

/// One rung in one view.
#[derive(Debug)]
pub(crate) struct Curve<'p> {
    /// Place of the rung among those of the study.
    pub(crate) rung: usize,
    pub(crate) name: &'static str,
    /// Steps from long to short; where a point is left out, the curve is
    /// broken.
    pub(crate) pieces: Vec<Vec<&'p Point>>,
}

impl<'p> Curve<'p> {
    /// `None` without a point to show.
    pub(crate) fn new(
        pair: &Pair<'p>,
        (rung, name): (usize, &'static str),
        view: View,
        measure: Measure,
    ) -> Option<Self> {
        let points = pair.of(name, view);
        let pieces: Vec<Vec<&Point>> = points
            .split(|point| unfit(point, measure).is_some())
            .filter(|piece| !piece.is_empty())
            .map(<[&Point]>::to_vec)
            .collect();
        (!pieces.is_empty()).then_some(Self { rung, name, pieces })
    }

    pub(crate) fn points(&self) -> impl Iterator<Item = &'p Point> {
        self.pieces.iter().flatten().copied()
    }
}
