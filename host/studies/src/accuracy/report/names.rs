//! Names at the right of a diagram: those of the perceptual lines beside
//! them, those of the curves around these.

use super::axes::Axes;
use super::curve::Curve;
use super::measure::Measure;
use crepitus_pages::plot::labels::{LINE, spread};
use crepitus_pages::plot::palette::{Ink, LEVEL, TEXT};
use crepitus_pages::plot::{Anchor, CurveStyle, Frame, Plot};

/// Room for the sign before the name of a curve, CSS pixels.
const SIGN: f64 = 11.0;

/// Named line or curve, and its end.
#[derive(Debug)]
struct Named {
    end: (f64, f64),
    ink: Ink,
    /// Style of a curve; none for a line.
    style: Option<CurveStyle>,
    name: &'static str,
}

/// Names in one column, each with a thin line from its end. Without room for
/// all curves only the lines are named; the legend has the curves.
pub(crate) fn draw(plot: &mut Plot, axes: &Axes, measure: Measure, curves: &[Curve]) {
    let Frame {
        right: edge,
        top,
        bottom,
        ..
    } = plot.frame();
    let lines: Vec<Named> = measure
        .lines()
        .iter()
        .map(|line| Named {
            end: plot.at((plot.x().high(), line.value)),
            ink: LEVEL,
            style: None,
            name: line.label,
        })
        .collect();
    let mut ends: Vec<Named> = curves
        .iter()
        .filter_map(|curve| {
            let style = CurveStyle::of(curve.rung);
            Some(Named {
                end: axes.place(plot, measure, curve.points().last()?),
                ink: style.ink,
                style: Some(style),
                name: curve.name,
            })
        })
        .collect();
    ends.sort_by(|a, b| a.end.1.total_cmp(&b.end.1));
    let over = &mut plot.over;
    let mut column = |names: &[Named], top, bottom| {
        let wishes: Vec<f64> = names.iter().map(|named| named.end.1).collect();
        let heights = spread(&wishes, top, bottom)?;
        for (named, height) in names.iter().zip(&heights) {
            over.leader(named.end, (edge + 5.0, *height), named.ink);
            let indent = if let Some(style) = named.style {
                over.marker((edge + 10.0, *height), style, false, "");
                SIGN
            } else {
                0.0
            };
            let start = (edge + 7.0 + indent, *height);
            // Legible in grey, so in no curve's colour.
            over.label(start, Anchor::Start, TEXT, named.name);
        }
        Some((*heights.first()?, *heights.last()?))
    };
    let Some((upper, lower)) = column(&lines, top, bottom) else {
        column(&ends, top, bottom);
        return;
    };
    // As many above the lines as belong there and find room.
    let middle = f64::midpoint(upper, lower);
    let belong = ends.partition_point(|named| named.end.1 < middle);
    // Few lines.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let room = ((upper - top) / LINE).max(0.0) as usize;
    let (above, below) = ends.split_at(belong.min(room));
    if spread(&vec![0.0; below.len()], lower + LINE, bottom).is_some() {
        column(above, top, upper - LINE);
        column(below, lower + LINE, bottom);
    }
}
