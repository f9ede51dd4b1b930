//! One work-precision diagram: the error of every rung against its cost, in
//! one view.

use crate::accuracy::Point;

use super::axes::{Axes, costs};
use super::curve::{Curve, FLOOR};
use super::measure::Measure;
use super::pair::{Pair, Study, View, is_device_tick};
use super::{names, steps};
use crepitus_pages::plot::number::{duration, rounded, scientific};
use crepitus_pages::plot::{
    Axis, CurveStyle, Drawing, Key, Panel, Paper, Plot, Sign, Stroke, Svg, stack,
};

/// CSS pixels.
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 440.0;
/// Room for the sign before a name, CSS pixels.
const SIGN: f64 = 22.0;
/// Half the height of the end of an error bar, CSS pixels.
const CAP: f64 = 3.5;

/// See the module.
#[derive(Debug)]
pub(crate) struct Diagram {
    /// Name for files.
    pub(crate) name: String,
    pub(crate) view: View,
    pub(crate) svg: Svg,
    pub(crate) legend: Vec<Key>,
}

/// Every diagram of a pair.
pub(crate) fn all(study: &Study, pair: &Pair, paper: Paper) -> Vec<Diagram> {
    let all = Measure::ALL.into_iter();
    all.flat_map(|measure| side_by_side(study, pair, measure, paper))
        .collect()
}

/// One diagram a view, on the same axes.
pub(crate) fn side_by_side(
    study: &Study,
    pair: &Pair,
    measure: Measure,
    paper: Paper,
) -> Vec<Diagram> {
    let curves = |view: View| -> Vec<Curve> {
        let rungs = study.rungs.iter().copied().enumerate();
        rungs
            .filter_map(|rung| Curve::new(pair, rung, view, measure))
            .collect()
    };
    let by_view: Vec<_> = pair.views(study).map(|v| (v, curves(v))).collect();
    let shown = || by_view.iter().flat_map(|(_, curves)| curves);
    let Some(axes) = Axes::new(shown().flat_map(Curve::points), measure) else {
        return Vec::new();
    };
    let names = shown().map(|curve| curve.name);
    let labels = names.chain(measure.lines().iter().map(|line| line.label));
    let widest = labels.map(Drawing::label_width).fold(0.0, f64::max);
    let right = widest + SIGN;
    let mut diagrams = Vec::new();
    for (view, curves) in &by_view {
        let label = format!(
            "{} against {COST}, {}, one curve a rung",
            measure.axis(),
            view.name()
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
            name: file_name(measure.name(), pair, *view),
            view: *view,
            svg,
            legend: legend(study, curves),
        });
    }
    diagrams
}

const COST: &str = "Cost (µs of one core per simulated second)";

/// `what-scene-convention-precision`, behind the encoder with `-encoder`.
pub(crate) fn file_name(what: &str, pair: &Pair, view: View) -> String {
    let behind = if view.is_exact { "" } else { "-encoder" };
    let (scene, convention, precision) = (pair.scene, pair.convention, view.precision);
    let raw = format!("{what}-{scene}-{convention}-{precision}{behind}");
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
    keys.push(Key::new(
        Sign::Line(CurveStyle::NEUTRAL.ink),
        "bar: quartiles of the timings",
    ));
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
        let bars = curve
            .points()
            .map(|point| axes.bar(plot, measure, point))
            .collect::<Vec<_>>();
        let ends = bars.iter().flatten();
        let ends = ends.map(|(x, y)| [(*x, y - CAP), (*x, y + CAP)]);
        let lines = bars.iter().copied().chain(ends);
        let ink = CurveStyle::of(curve.rung).ink;
        plot.over.lines(lines, Stroke::new(ink, 1.0));
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
    let [first, cost, third] = costs(point);
    let title = format!(
        "{}, {}, step {}: error {}{}, cost {} ({}–{}) µs per simulated second",
        curve.name,
        View::of(point).name(),
        duration(point.step_s),
        scientific(error),
        measure.unit(),
        rounded(cost),
        rounded(first),
        rounded(third),
    );
    plot.over
        .marker(place, style, is_device_tick(point.step_s), &title);
}
