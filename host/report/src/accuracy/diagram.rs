//! One work-precision diagram: the error of every rung against its cost, at
//! one precision.

use crepitus_study::accuracy::Point;

use super::axes::Axes;
use super::curve::{Curve, FLOOR};
use super::hand::Hand;
use super::measure::Measure;
use super::overlay::Overlay;
use super::pair::{Pair, Study, is_device_tick};
use super::{names, steps};
use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Area, Fault, Panel, Plot, svg_with};
use crate::figure::{Key, Sign};
use crate::number::{duration, rounded, scientific};
use crate::palette::LEVEL;

/// CSS pixels.
const SIZE: (u32, u32) = (560, 440);
/// Room for a letter of a label, CSS pixels.
const LETTER: u32 = 6;

/// See the module.
#[derive(Debug)]
pub(crate) struct Diagram {
    /// For files.
    pub(crate) name: String,
    pub(crate) precision: &'static str,
    pub(crate) svg: String,
    pub(crate) legend: Vec<Key>,
}

/// Every diagram of a pair.
pub(crate) fn all(study: &Study, pair: &Pair) -> Result<Vec<Diagram>, ReportError> {
    let mut all = Vec::new();
    for measure in Measure::ALL {
        all.extend(side_by_side(study, pair, measure)?);
    }
    Ok(all)
}

/// One diagram a precision, on the same axes.
pub(crate) fn side_by_side(
    study: &Study,
    pair: &Pair,
    measure: Measure,
) -> Result<Vec<Diagram>, ReportError> {
    let curves = |precision: &str| -> Vec<Curve> {
        let rungs = study.rungs.iter().copied().enumerate();
        rungs
            .filter_map(|rung| Curve::new(pair, rung, precision, measure))
            .collect()
    };
    let by_precision: Vec<_> = study.precisions.iter().map(|p| (*p, curves(p))).collect();
    let shown = || by_precision.iter().flat_map(|(_, curves)| curves);
    let Some(axes) = Axes::new(shown().flat_map(Curve::points), measure) else {
        return Ok(Vec::new());
    };
    let names = shown().map(|curve| curve.name);
    let labels = names.chain(measure.lines().iter().map(|line| line.label));
    let right = labels.map(|label| label.chars().fold(0, |n, _| n + LETTER));
    let right = right.max().unwrap_or(0).min(SIZE.0 / 3) + 36;
    let mut diagrams = Vec::new();
    for (precision, curves) in &by_precision {
        let label = format!(
            "{} against {COST}, {precision}, one curve a rung",
            measure.axis()
        );
        let svg = svg_with(SIZE, &label, |area| {
            draw(area, &axes, right, measure, curves)
        })?;
        diagrams.push(Diagram {
            name: file_name(measure.name(), pair, precision),
            precision,
            svg,
            legend: legend(study, curves),
        });
    }
    Ok(diagrams)
}

const COST: &str = "Cost (µs of one core per simulated second)";

/// `what-scene-convention-precision`.
pub(crate) fn file_name(what: &str, pair: &Pair, precision: &str) -> String {
    let raw = format!("{what}-{}-{}-{precision}", pair.scene, pair.convention);
    raw.chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect()
}

/// The rungs of these curves, and what a filled sign says.
fn legend(study: &Study, curves: &[Curve]) -> Vec<Key> {
    let mut keys: Vec<Key> = curves
        .iter()
        .map(|curve| Key::new(Sign::Curve(Hand::of(curve.rung)), study.rungs[curve.rung]))
        .collect();
    let ticks = || curves.iter().flat_map(Curve::points);
    if ticks().any(|point| is_device_tick(point.step_s)) {
        keys.push(Key::new(
            Sign::Filled(Hand::NEUTRAL),
            "filled: 50 µs, the device's tick",
        ));
    }
    keys
}

fn draw(
    area: &Area,
    axes: &Axes,
    right: u32,
    measure: Measure,
    curves: &[Curve],
) -> Result<String, Fault> {
    let mut plot = Panel {
        x: Axis::decades(*axes.cost.start(), *axes.cost.end(), 6),
        y: Axis::decades(*axes.error.start(), *axes.error.end(), 9),
        x_title: Some(COST),
        y_title: measure.axis(),
        right,
    }
    .on(area)?;
    plot.grid()?;
    for line in measure.lines() {
        plot.across(line.value, LEVEL, 5)?;
    }
    let mut over = Overlay::default();
    names::draw(&plot, axes, measure, curves, &mut over);
    for curve in curves {
        let hand = Hand::of(curve.rung);
        for piece in &curve.pieces {
            let path: Vec<_> = piece
                .iter()
                .map(|p| axes.place(&plot, measure, p))
                .collect();
            over.line(&path, hand);
        }
    }
    for curve in curves {
        for point in curve.points() {
            mark(&plot, axes, measure, curve, point, &mut over);
        }
    }
    steps::draw(&plot, axes, measure, curves, &mut over);
    Ok(over.finish())
}

fn mark(
    plot: &Plot,
    axes: &Axes,
    measure: Measure,
    curve: &Curve,
    point: &Point,
    over: &mut Overlay,
) {
    let hand = Hand::of(curve.rung);
    let place = axes.place(plot, measure, point);
    let error = measure.of(point);
    if error < FLOOR {
        over.arrow_down(place, hand.ink);
    }
    let title = format!(
        "{}, {}, step {}: error {}{}, cost {} µs per simulated second",
        curve.name,
        point.precision,
        duration(point.step_s),
        scientific(error),
        measure.unit(),
        rounded(point.us_per_simulated_s),
    );
    over.marker(place, hand, is_device_tick(point.step_s), &title);
}
