//! One work-precision diagram: the error of every rung against its cost, at
//! one precision.

use crate::accuracy::Point;

use super::axes::Axes;
use super::curve::{Curve, FLOOR};
use super::measure::Measure;
use super::pair::{Pair, Study, is_device_tick};
use super::{names, steps};
use crepitus_pages::plot::number::{duration, rounded, scientific};
use crepitus_pages::plot::{Axis, CurveStyle, Drawing, Key, Panel, Paper, Plot, Sign, Svg, stack};

/// CSS pixels.
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 440.0;
/// Room for the sign before a name, CSS pixels.
const SIGN: f64 = 22.0;

/// See the module.
#[derive(Debug)]
pub(crate) struct Diagram {
    /// Name for files.
    pub(crate) name: String,
    pub(crate) precision: &'static str,
    pub(crate) svg: Svg,
    pub(crate) legend: Vec<Key>,
}

/// Every diagram of a pair.
pub(crate) fn all(study: &Study, pair: &Pair, paper: Paper) -> Vec<Diagram> {
    let all = Measure::ALL.into_iter();
    all.flat_map(|measure| side_by_side(study, pair, measure, paper))
        .collect()
}

/// One diagram a precision, on the same axes.
pub(crate) fn side_by_side(
    study: &Study,
    pair: &Pair,
    measure: Measure,
    paper: Paper,
) -> Vec<Diagram> {
    let curves = |precision: &str| -> Vec<Curve> {
        let rungs = study.rungs.iter().copied().enumerate();
        rungs
            .filter_map(|rung| Curve::new(pair, rung, precision, measure))
            .collect()
    };
    let by_precision: Vec<_> = study.precisions.iter().map(|p| (*p, curves(p))).collect();
    let shown = || by_precision.iter().flat_map(|(_, curves)| curves);
    let Some(axes) = Axes::new(shown().flat_map(Curve::points), measure) else {
        return Vec::new();
    };
    let names = shown().map(|curve| curve.name);
    let labels = names.chain(measure.lines().iter().map(|line| line.label));
    let widest = labels.map(Drawing::label_width).fold(0.0, f64::max);
    let right = widest + SIGN;
    let mut diagrams = Vec::new();
    for (precision, curves) in &by_precision {
        let label = format!(
            "{} against {COST}, {precision}, one curve a rung",
            measure.axis()
        );
        let (cost, error) = (&axes.cost, &axes.error);
        let x = Axis::decades(*cost.start(), *cost.end(), 6);
        let y = Axis::decades(*error.start(), *error.end(), 9);
        let panel = Panel::new(HEIGHT, x, (measure.axis(), y), |plot| {
            draw(plot, &axes, measure, curves);
        })
        .x_title(Some(COST))
        .right(right);
        let svg = stack(paper.width(WIDTH), &label, vec![panel]);
        diagrams.push(Diagram {
            name: file_name(measure.name(), pair, precision),
            precision,
            svg,
            legend: legend(study, curves),
        });
    }
    diagrams
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
        .map(|curve| {
            Key::new(
                Sign::Curve(CurveStyle::of(curve.rung)),
                study.rungs[curve.rung],
            )
        })
        .collect();
    let ticks = || curves.iter().flat_map(Curve::points);
    if ticks().any(|point| is_device_tick(point.step_s)) {
        keys.push(Key::new(
            Sign::Filled(CurveStyle::NEUTRAL),
            "filled: 50 µs, the device's tick",
        ));
    }
    keys
}

fn draw(plot: &mut Plot, axes: &Axes, measure: Measure, curves: &[Curve]) {
    plot.grid();
    for line in measure.lines() {
        plot.across(line.value);
    }
    names::draw(plot, axes, measure, curves);
    for curve in curves {
        for piece in &curve.pieces {
            let path: Vec<_> = piece.iter().map(|p| axes.place(plot, measure, p)).collect();
            plot.over.line(&path, CurveStyle::of(curve.rung).stroke());
        }
    }
    for curve in curves {
        for point in curve.points() {
            mark(plot, axes, measure, curve, point);
        }
    }
    steps::draw(plot, axes, measure, curves);
}

fn mark(plot: &mut Plot, axes: &Axes, measure: Measure, curve: &Curve, point: &Point) {
    let style = CurveStyle::of(curve.rung);
    let place = axes.place(plot, measure, point);
    let error = measure.of(point);
    if error < FLOOR {
        plot.over.arrow_down(place, style.ink);
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
    plot.over
        .marker(place, style, is_device_tick(point.step_s), &title);
}
