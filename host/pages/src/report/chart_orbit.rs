//! The imaginary object's angle θ against the shaft's angle φ: cycles from
//! near, and the whole run.

use crepitus_model::Phase;

use crate::plot::palette::{Ink, OBJECT, SHAFT, TORQUE};
use crate::plot::{Axis, Chart, Figure, Key, Panel, Paper, Plot, Point, Sign, stack};

use crate::report::chart_zoom::{Titled, windows};
use crate::report::collector::Figures;
use crate::report::hysteresis::Range;
use crate::report::orbit::Segment;

/// Width and height, CSS pixels.
const HALF: (f64, f64) = (470.0, 340.0);
const FULL: (f64, f64) = (960.0, 360.0);
const X_TITLE: &str = "Shaft angle φ (°)";
const WHOLE: &str = "The whole run";
const Y_TITLE: &str = "Object angle θ (mrad)";

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    if !figures.has_object {
        return None;
    }
    let mut charts = Vec::new();
    let mut phases = Vec::new();
    let whole = figures.whole.time;
    for Titled { title, window } in windows(figures) {
        let view = window.view();
        // A window of nearly the whole run would be the same chart twice.
        let is_whole = view.1 - view.0 > 0.8 * whole.width();
        let path = window.orbit.segments(view.0, view.1);
        if is_whole || path.is_empty() {
            continue;
        }
        phases.extend(path.iter().map(|segment| segment.phase));
        charts.push(path_chart(title, (true, paper), &path));
    }
    // Next to one other chart; alone or below two it takes the full width.
    let half = charts.len() == 1;
    let mut ranges = None;
    if figures.whole.overflowed() {
        // A few cycles a bin, as in the overview of the torque.
        let cycle = figures.hysteresis.travel() / figures.envelope.breaks().max(1) as f64;
        let both = figures.hysteresis.ranges(3.0 * cycle);
        charts.push(range_chart((half, paper), &both));
        ranges = Some(both);
    } else {
        let path = figures.whole.orbit.segments(whole.low, whole.high);
        if !path.is_empty() {
            phases.extend(path.iter().map(|segment| segment.phase));
            charts.push(path_chart(WHOLE.to_owned(), (half, paper), &path));
        }
    }
    if charts.is_empty() {
        return None;
    }
    let (legend, caption) = words(&phases, ranges.as_ref());
    Some(Figure {
        name: "theta-phi",
        title: "Imaginary object against shaft",
        legend,
        charts,
        caption,
    })
}

/// Legend and caption of the drawing.
fn words(phases: &[Phase], ranges: Option<&[Vec<Range>; 2]>) -> (Vec<Key>, String) {
    let mut legend = Vec::new();
    let mut parts = Vec::new();
    if phases.contains(&Phase::Stick) {
        legend.push(Key::new(Sign::Line(TORQUE), "stick"));
        parts.push("Where the object sticks, θ and φ grow by the same amount.");
    }
    if phases.iter().any(|phase| *phase != Phase::Stick) {
        legend.push(Key::new(Sign::Line(OBJECT), "slip"));
        parts.push("Where it slips, θ swings while the shaft moves on.");
    }
    if let Some([flexing, extending]) = ranges {
        if !flexing.is_empty() {
            legend.push(Key::new(Sign::Line(OBJECT), "flexing, range"));
        }
        if !extending.is_empty() {
            legend.push(Key::new(Sign::Line(SHAFT), "extending, range"));
        }
        parts.push(
            "Over the whole run the bands span all that θ did at each angle, for each \
             direction of motion. Friction drags the object along, so that slips swing around \
             +Tk/kr in flexion and −Tk/kr in extension, the wider the faster the shaft moves.",
        );
    }
    (legend, parts.join(" "))
}

fn chart(
    heading: String,
    (half, paper): (bool, Paper),
    points: &[Point],
    draw: impl FnOnce(&mut Plot),
) -> Chart {
    let (width, height) = if half { HALF } else { FULL };
    let x = Axis::covering(points.iter().map(|p| p.x), if half { 5 } else { 9 });
    let y = Axis::covering(points.iter().map(|p| p.y), 5);
    let panel = Panel::new(height, x, (Y_TITLE, y), draw).x_title(Some(X_TITLE));
    let label = format!("Object angle against shaft angle: {heading}");
    Chart {
        svg: stack(paper.width(width), &label, vec![panel]),
        heading: Some(heading),
        half,
    }
}

/// Converts from rad to the units of the axes: degrees and mrad.
fn shown(angle: f64, theta: f64) -> Point {
    Point::new(angle.to_degrees(), 1e3 * theta)
}

fn path_chart(heading: String, place: (bool, Paper), path: &[Segment]) -> Chart {
    let lines: Vec<(Phase, Vec<Point>)> = path
        .iter()
        .map(|segment| {
            let points = segment.points.iter().map(|p| shown(p.x, p.y)).collect();
            (segment.phase, points)
        })
        .collect();
    let all: Vec<Point> = lines
        .iter()
        .flat_map(|(_, points)| points.clone())
        .collect();
    chart(heading, place, &all, |plot| {
        plot.grid();
        for slipping in [true, false] {
            let (ink, width) = if slipping {
                (OBJECT, 1.5)
            } else {
                (TORQUE, 2.5)
            };
            for (phase, points) in &lines {
                if (*phase != Phase::Stick) == slipping {
                    plot.line(points, ink, width);
                }
            }
        }
    })
}

fn range_chart(place: (bool, Paper), [flexing, extending]: &[Vec<Range>; 2]) -> Chart {
    let edge = |ranges: &[Range], pick: fn(&Range) -> f64| -> Vec<Point> {
        ranges.iter().map(|r| shown(r.angle, pick(r))).collect()
    };
    let edges: [(Ink, Vec<Point>, Vec<Point>); 2] = [(OBJECT, flexing), (SHAFT, extending)]
        .map(|(ink, ranges)| (ink, edge(ranges, |r| r.low), edge(ranges, |r| r.high)));
    let all: Vec<Point> = edges
        .iter()
        .flat_map(|(_, low, high)| [low.clone(), high.clone()].concat())
        .collect();
    chart(WHOLE.to_owned(), place, &all, |plot| {
        plot.grid();
        for (ink, low, high) in &edges {
            plot.band(low, high, *ink, 0.25);
        }
        for (ink, low, high) in &edges {
            plot.line(low, *ink, 1.5);
            plot.line(high, *ink, 1.5);
        }
    })
}
