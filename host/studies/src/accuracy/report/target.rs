//! The second axis: the error of every rung against what a step costs on the
//! device's core, at the device's tick and in f32. One sign a rung, with a line
//! to its worst step.

use crate::accuracy::Point;
use crate::accuracy::target::{LABEL, TICK_CYCLES};

use super::curve::{FLOOR, unfit};
use super::diagram::{Diagram, file_name};
use super::measure::Measure;
use super::pair::{Pair, Study, View, is_device_tick};
use crepitus_pages::plot::labels::{LINE, spread};
use crepitus_pages::plot::number::{fixed, rounded, scientific};
use crepitus_pages::plot::palette::TEXT;
use crepitus_pages::plot::{
    Anchor, Axis, Chart, CurveStyle, Drawing, Figure, Frame, Key, Panel, Paper, Plot, Sign, extent,
    stack,
};

/// CSS pixels.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
/// Measure that is drawn: the error that says most of a rung.
const MEASURE: Measure = Measure::Frequency;
const VIEW: View = View {
    precision: "f32",
    is_exact: true,
};
const COST: &str = "Cycles of a step, modelled, 0 wait states; a tick has 8,400";

/// A rung of the pair.
struct Spot<'p> {
    rung: usize,
    name: &'static str,
    point: &'p Point,
}

/// The figure of a pair; none where nothing was run on the target.
pub(crate) fn figure(study: &Study, pair: &Pair) -> Option<Figure> {
    diagram(study, pair, Paper::Screen).map(|diagram| Figure {
        name: "target",
        title: "On the device's core",
        legend: diagram.legend,
        charts: vec![Chart::full(diagram.svg)],
        caption: format!(
            "Error of the cycle frequency at the device's tick of 50 µs in f32, against the cycles \
             of a step: {LABEL}. A sign stands at the mean, its line ends at the worst step of \
             this scene. Down is more accurate, left is cheaper. Rungs with wrong events are left \
             out."
        ),
    })
}

/// Drawing of the figure of a pair; none where nothing was run on the target.
pub(crate) fn diagram(study: &Study, pair: &Pair, paper: Paper) -> Option<Diagram> {
    let spots = spots(study, pair);
    if spots.is_empty() {
        return None;
    }
    let label = format!(
        "{} against cycles on the target, one sign a rung",
        MEASURE.axis()
    );
    let (smallest, largest) = extent(spots.iter().map(|spot| error(spot.point)));
    let (_, worst) = extent(spots.iter().map(|spot| spot.point.worst_cycles));
    let y = Axis::decades(
        10_f64.powf((0.3 * smallest).log10().floor()),
        10_f64.powf((3.0 * largest).log10().ceil()),
        9,
    );
    let names = spots.iter().map(|spot| Drawing::label_width(spot.name));
    let panel = Panel::new(
        HEIGHT,
        Axis::linear(0.0, 1.05 * worst, 8),
        (MEASURE.axis(), y),
        |plot| draw(plot, &spots),
    )
    .x_title(Some(COST))
    .right(names.fold(0.0, f64::max) + 10.0);
    let svg = stack(paper.width(WIDTH), &label, vec![panel]);
    let legend = spots
        .iter()
        .map(|spot| Key::new(Sign::Filled(CurveStyle::of(spot.rung)), spot.name))
        .collect();
    Some(Diagram {
        name: file_name("target", pair, VIEW),
        view: VIEW,
        svg,
        legend,
    })
}

fn spots<'p>(study: &Study<'p>, pair: &Pair<'p>) -> Vec<Spot<'p>> {
    let rungs = study.rungs.iter().copied().enumerate();
    rungs
        .filter_map(|(rung, name)| {
            let mut points = pair.of(name, VIEW).into_iter();
            let point = points.find(|point| is_device_tick(point.step_s))?;
            let is_known = point.cycles_per_step > 0.0 && point.worst_cycles > 0.0;
            (is_known && unfit(point, MEASURE).is_none()).then_some(Spot { rung, name, point })
        })
        .collect()
}

fn draw(plot: &mut Plot, spots: &[Spot]) {
    plot.grid();
    names(plot, spots);
    for spot in spots {
        let (style, point) = (CurveStyle::of(spot.rung), spot.point);
        let mean = plot.at((point.cycles_per_step, error(point)));
        let worst = plot.at((point.worst_cycles, error(point)));
        plot.over.line(&[mean, worst], style.stroke());
        let title = format!(
            "{}: error {}, mean {} cycles and {} instructions, worst {} cycles ({} % of a tick)",
            spot.name,
            scientific(MEASURE.of(point)),
            rounded(point.cycles_per_step),
            rounded(point.instructions_per_step),
            rounded(point.worst_cycles),
            fixed(100.0 * point.worst_cycles / TICK_CYCLES, 1),
        );
        plot.over.marker(mean, style, true, &title);
    }
}

/// An error of nothing stands at the foot.
fn error(point: &Point) -> f64 {
    MEASURE.of(point).max(FLOOR)
}

/// Draws the names in a column at the right, each with a thin line from the worst step.
fn names(plot: &mut Plot, spots: &[Spot]) {
    let Frame {
        right: edge,
        top,
        bottom,
        ..
    } = plot.frame();
    let mut ends: Vec<_> = spots
        .iter()
        .map(|spot| {
            let end = plot.at((spot.point.worst_cycles, error(spot.point)));
            (end, spot)
        })
        .collect();
    ends.sort_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
    let wishes: Vec<f64> = ends.iter().map(|((_, y), _)| *y).collect();
    let Some(heights) = spread(&wishes, top, bottom.max(top + LINE)) else {
        return;
    };
    for ((end, spot), height) in ends.iter().zip(&heights) {
        plot.over
            .leader(*end, (edge + 5.0, *height), CurveStyle::of(spot.rung).ink);
        plot.over
            .label((edge + 7.0, *height), Anchor::Start, TEXT, spot.name);
    }
}
