//! The second axis: the error of every rung against what a step costs on the
//! device's core, at the device's tick and in f32. One sign a rung, with a line
//! to its worst step.

use crepitus_study::accuracy::Point;
use crepitus_study::accuracy::target::{LABEL, TICK_CYCLES};

use super::curve::{FLOOR, unfit};
use super::diagram::{Diagram, file_name};
use super::hand::Hand;
use super::labels::{LINE, spread};
use super::measure::Measure;
use super::overlay::{Anchor, Overlay};
use super::pair::{Pair, Study, is_device_tick};
use crate::ReportError;
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Fault, Panel, Plot, svg_with};
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::{fixed, rounded, scientific};
use crate::palette::TEXT;

/// CSS pixels.
const SIZE: (u32, u32) = (760, 440);
/// Room for the names, CSS pixels.
const NAMES: u32 = 170;
/// What is drawn: the error that says most of a rung.
const MEASURE: Measure = Measure::Frequency;
const PRECISION: &str = "f32";
const COST: &str = "Cycles of a step, modelled, 0 wait states; a tick has 8,400";

/// A rung of the pair.
struct Spot<'p> {
    rung: usize,
    name: &'static str,
    point: &'p Point,
}

/// The figure of a pair; none where nothing was run on the target.
pub(crate) fn figure(study: &Study, pair: &Pair) -> Result<Option<Figure>, ReportError> {
    Ok(diagram(study, pair)?.map(|diagram| Figure {
        name: "target",
        title: "On the device's core",
        legend: diagram.legend,
        charts: vec![Chart {
            heading: None,
            svg: diagram.svg,
            half: false,
        }],
        caption: format!(
            "Error of the cycle frequency at the device's tick of 50 µs in f32, against the cycles \
             of a step: {LABEL}. A sign stands at the mean, its line ends at the worst step of \
             this scene. Down is more accurate, left is cheaper. Rungs with wrong events are left \
             out."
        ),
    }))
}

/// The same as a drawing.
pub(crate) fn diagram(study: &Study, pair: &Pair) -> Result<Option<Diagram>, ReportError> {
    let spots = spots(study, pair);
    if spots.is_empty() {
        return Ok(None);
    }
    let label = format!(
        "{} against cycles on the target, one sign a rung",
        MEASURE.axis()
    );
    let svg = svg_with(SIZE, &label, |area| draw(area, &spots))?;
    let legend = spots
        .iter()
        .map(|spot| Key::new(Sign::Filled(Hand::of(spot.rung)), spot.name))
        .collect();
    Ok(Some(Diagram {
        name: file_name("target", pair, PRECISION),
        precision: PRECISION,
        svg,
        legend,
    }))
}

fn spots<'p>(study: &Study<'p>, pair: &Pair<'p>) -> Vec<Spot<'p>> {
    let rungs = study.rungs.iter().copied().enumerate();
    rungs
        .filter_map(|(rung, name)| {
            let mut points = pair.of(name, PRECISION).into_iter();
            let point = points.find(|point| is_device_tick(point.step_s))?;
            let is_known = point.cycles_per_step > 0.0 && point.worst_cycles > 0.0;
            (is_known && unfit(point, MEASURE).is_none()).then_some(Spot { rung, name, point })
        })
        .collect()
}

fn draw(area: &Area, spots: &[Spot]) -> Result<String, Fault> {
    let errors = || spots.iter().map(|spot| error(spot.point));
    let (smallest, largest) = extent(errors());
    let (_, worst) = extent(spots.iter().map(|spot| spot.point.worst_cycles));
    let mut plot = Panel {
        x: Axis::linear(0.0, 1.05 * worst, 8),
        y: Axis::decades(
            10_f64.powf((0.3 * smallest).log10().floor()),
            10_f64.powf((3.0 * largest).log10().ceil()),
            9,
        ),
        x_title: Some(COST),
        y_title: MEASURE.axis(),
        right: NAMES,
    }
    .on(area)?;
    plot.grid()?;
    let mut over = Overlay::default();
    names(&plot, spots, &mut over);
    for spot in spots {
        let (hand, point) = (Hand::of(spot.rung), spot.point);
        let mean = plot.at((point.cycles_per_step, error(point)));
        let worst = plot.at((point.worst_cycles, error(point)));
        over.line(&[mean, worst], hand);
        let title = format!(
            "{}: error {}, mean {} cycles and {} instructions, worst {} cycles ({} % of a tick)",
            spot.name,
            scientific(MEASURE.of(point)),
            rounded(point.cycles_per_step),
            rounded(point.instructions_per_step),
            rounded(point.worst_cycles),
            fixed(100.0 * point.worst_cycles / TICK_CYCLES, 1),
        );
        over.marker(mean, hand, true, &title);
    }
    Ok(over.finish())
}

/// An error of nothing stands at the foot.
fn error(point: &Point) -> f64 {
    MEASURE.of(point).max(FLOOR)
}

/// In a column at the right, each with a thin line from the worst step.
fn names(plot: &Plot, spots: &[Spot], over: &mut Overlay) {
    let (edge, bottom) = plot.at((plot.x().high(), plot.y().low()));
    let (_, top) = plot.at((plot.x().high(), plot.y().high()));
    let mut ends: Vec<_> = spots
        .iter()
        .map(|spot| {
            let end = plot.at((spot.point.worst_cycles, error(spot.point)));
            (end, spot)
        })
        .collect();
    ends.sort_by_key(|((_, y), _)| *y);
    let wishes: Vec<i32> = ends.iter().map(|((_, y), _)| *y).collect();
    let Some(heights) = spread(&wishes, top, bottom.max(top + LINE)) else {
        return;
    };
    for ((end, spot), height) in ends.iter().zip(&heights) {
        over.leader(*end, (edge + 20, *height), Hand::of(spot.rung).ink);
        over.text((edge + 28, *height), Anchor::Start, TEXT, spot.name);
    }
}
