//! Names at the right of a diagram: those of the perceptual lines beside
//! them, those of the curves around these.

use super::axes::Axes;
use super::curve::Curve;
use super::hand::Hand;
use super::labels::{LINE, spread};
use super::measure::Measure;
use super::overlay::{Anchor, Overlay};
use crate::canvas::Plot;
use crate::palette::{Ink, LEVEL, TEXT};

/// Room for the sign before the name of a curve, grid lines.
const SIGN: i32 = 44;

/// What is named, and where it ends.
#[derive(Debug)]
struct Named {
    end: (i32, i32),
    ink: Ink,
    /// Of a curve.
    hand: Option<Hand>,
    name: &'static str,
}

/// Names in one column, each with a thin line from its end. Without room for
/// all curves only the lines are named; the legend has the curves.
pub(crate) fn draw(
    plot: &Plot,
    axes: &Axes,
    measure: Measure,
    curves: &[Curve],
    over: &mut Overlay,
) {
    let (edge, bottom) = plot.at((plot.x().high(), plot.y().low()));
    let (_, top) = plot.at((plot.x().high(), plot.y().high()));
    let lines: Vec<Named> = measure
        .lines()
        .iter()
        .map(|line| Named {
            end: plot.at((plot.x().high(), line.value)),
            ink: LEVEL,
            hand: None,
            name: line.label,
        })
        .collect();
    let mut ends: Vec<Named> = curves
        .iter()
        .filter_map(|curve| {
            let hand = Hand::of(curve.rung);
            Some(Named {
                end: axes.place(plot, measure, curve.points().last()?),
                ink: hand.ink,
                hand: Some(hand),
                name: curve.name,
            })
        })
        .collect();
    ends.sort_by_key(|named| named.end.1);
    let mut column = |names: &[Named], top, bottom| {
        let wishes: Vec<i32> = names.iter().map(|named| named.end.1).collect();
        let heights = spread(&wishes, top, bottom)?;
        for (named, height) in names.iter().zip(&heights) {
            over.leader(named.end, (edge + 20, *height), named.ink);
            let indent = if let Some(hand) = named.hand {
                over.marker((edge + 40, *height), hand, false, "");
                SIGN
            } else {
                0
            };
            let start = (edge + 28 + indent, *height);
            // Legible in grey, so in no curve's colour.
            over.text(start, Anchor::Start, TEXT, named.name);
        }
        Some((*heights.first()?, *heights.last()?))
    };
    let Some((upper, lower)) = column(&lines, top, bottom) else {
        column(&ends, top, bottom);
        return;
    };
    // As many above the lines as belong there and find room.
    let middle = i32::midpoint(upper, lower);
    let belong = ends.partition_point(|named| named.end.1 < middle);
    let room = usize::try_from((upper - top) / LINE).unwrap_or(0);
    let (above, below) = ends.split_at(belong.min(room));
    if spread(&vec![0; below.len()], lower + LINE, bottom).is_some() {
        column(above, top, upper - LINE);
        column(below, lower + LINE, bottom);
    }
}
