//! Steps along one curve: the longest, the device's and the shortest, where
//! the least is in the way.

use crate::accuracy::Point;

use super::axes::Axes;
use super::curve::Curve;
use super::measure::Measure;
use super::pair::is_device_tick;
use crepitus_pages::plot::number::duration;
use crepitus_pages::plot::palette::TEXT;
use crepitus_pages::plot::{Anchor, Frame, Plot};

/// Distance from a point to the middle of its label, CSS pixels.
const AWAY: f64 = 12.0;
/// Half the width and height of a label with some air.
const HALF: (f64, f64) = (19.0, 7.5);

/// A label: where its middle is, what it says, what it would cover.
#[derive(Debug)]
struct Label {
    at: (f64, f64),
    text: String,
    covered: usize,
}

/// Draws only the labels that cover nothing: the filled signs are there anyway.
pub(crate) fn draw(plot: &mut Plot, axes: &Axes, measure: Measure, curves: &[Curve]) {
    let mut inked = Vec::new();
    for piece in curves.iter().flat_map(|curve| &curve.pieces) {
        let path: Vec<_> = piece.iter().map(|p| axes.place(plot, measure, p)).collect();
        inked.extend(path.iter().copied());
        for pair in path.windows(2) {
            inked.extend(between(pair[0], pair[1]));
        }
    }
    let best = curves
        .iter()
        .flat_map(|curve| [AWAY, -AWAY].map(|away| labels(plot, axes, measure, curve, away)))
        .map(|mut labels| {
            for label in &mut labels {
                label.covered = inked.iter().filter(|p| covers(label.at, **p)).count();
            }
            labels.retain(|label| label.covered == 0);
            labels
        })
        // The last of the best: the lowest rung of the ladder as listed.
        .max_by_key(Vec::len);
    for label in best.into_iter().flatten() {
        plot.over.label(label.at, Anchor::Middle, TEXT, &label.text);
    }
}

/// The labels of a curve, above or below, that stand inside the diagram.
fn labels(plot: &Plot, axes: &Axes, measure: Measure, curve: &Curve, away: f64) -> Vec<Label> {
    let points: Vec<&Point> = curve.points().collect();
    let Frame {
        left,
        top,
        right,
        bottom,
    } = plot.frame();
    let mut labels = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let end = i == 0 || i + 1 == points.len();
        let (x, y) = axes.place(plot, measure, point);
        let at = (x, y + away);
        let inside = at.0 - HALF.0 >= left
            && at.0 + HALF.0 <= right
            && at.1 - HALF.1 >= top
            && at.1 + HALF.1 <= bottom;
        if inside && (end || is_device_tick(point.step_s)) {
            labels.push(Label {
                at,
                text: duration(point.step_s),
                covered: 0,
            });
        }
    }
    labels
}

/// Points of a straight line, as close as a label is high.
fn between(from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    // Few parts, and at least one.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let parts = (dx.abs().max(dy.abs()) / 5.0).max(1.0) as u32;
    (1..parts).map(move |i| {
        let share = f64::from(i) / f64::from(parts);
        (from.0 + dx * share, from.1 + dy * share)
    })
}

fn covers(label: (f64, f64), point: (f64, f64)) -> bool {
    (label.0 - point.0).abs() < HALF.0 && (label.1 - point.1).abs() < HALF.1
}
