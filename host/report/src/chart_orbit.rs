//! The imaginary object's angle θ against the shaft's angle φ: cycles from
//! near, and the whole run.

use crepitus_model::Phase;

use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Area, Drawn, Panel, svg};
use crate::chart_zoom::windows;
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign, Titled};
use crate::hysteresis::Range;
use crate::orbit::Segment;
use crate::palette::{Ink, OBJECT, SHAFT, TORQUE};
use crate::thinned::Point;

const HALF: (u32, u32) = (470, 340);
const FULL: (u32, u32) = (960, 360);
const X_TITLE: &str = "Shaft angle φ (°)";
const Y_TITLE: &str = "Object angle θ (mrad)";

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    if !figures.has_object {
        return Ok(None);
    }
    let mut charts = Vec::new();
    let mut phases = Vec::new();
    let whole = (figures.whole.start, figures.whole.end);
    for Titled { title, window } in windows(figures) {
        let view = window.view();
        // A window of nearly the whole run would be the same chart twice.
        let is_whole = view.1 - view.0 > 0.8 * (whole.1 - whole.0);
        let path = window.orbit.segments(view.0, view.1);
        if is_whole || path.is_empty() {
            continue;
        }
        phases.extend(path.iter().map(|segment| segment.phase));
        charts.push(chart(title, true, |area| draw_path(area, &path, true))?);
    }
    // Next to one other chart; alone or below two it takes the full width.
    let half = charts.len() == 1;
    let mut ranges = None;
    if figures.whole.overflowed() {
        // A few cycles a bin, as in the overview of the torque.
        let cycle = figures.hysteresis.travel() / figures.envelope.breaks().max(1) as f64;
        let both = figures.hysteresis.ranges(3.0 * cycle);
        charts.push(chart("The whole run".to_owned(), half, |area| {
            draw_ranges(area, &both, half)
        })?);
        ranges = Some(both);
    } else {
        let path = figures.whole.orbit.segments(whole.0, whole.1);
        if !path.is_empty() {
            phases.extend(path.iter().map(|segment| segment.phase));
            charts.push(chart("The whole run".to_owned(), half, |area| {
                draw_path(area, &path, half)
            })?);
        }
    }
    if charts.is_empty() {
        return Ok(None);
    }
    let (legend, caption) = words(&phases, ranges.as_ref());
    Ok(Some(Figure {
        name: "theta-phi",
        title: "Imaginary object against shaft",
        legend,
        charts,
        caption,
    }))
}

/// Legend and caption for what was drawn.
fn words(phases: &[Phase], ranges: Option<&[Vec<Range>; 2]>) -> (Vec<Key>, String) {
    let mut legend = Vec::new();
    let mut parts = Vec::new();
    if phases.contains(&Phase::Stick) {
        legend.push(Key::new(Sign::Line("torque"), "stick"));
        parts.push("Where the object sticks, θ and φ grow by the same amount.");
    }
    if phases.iter().any(|phase| *phase != Phase::Stick) {
        legend.push(Key::new(Sign::Line("object"), "slip"));
        parts.push("Where it slips, θ swings while the shaft moves on.");
    }
    if let Some([flexing, extending]) = ranges {
        if !flexing.is_empty() {
            legend.push(Key::new(Sign::Line("object"), "flexing, range"));
        }
        if !extending.is_empty() {
            legend.push(Key::new(Sign::Line("shaft"), "extending, range"));
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
    half: bool,
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<Chart, ReportError> {
    let label = format!("Object angle against shaft angle: {heading}");
    Ok(Chart {
        svg: svg(if half { HALF } else { FULL }, &label, draw)?,
        heading: Some(heading),
        half,
    })
}

fn axes(points: &[Point], half: bool) -> Panel<'static> {
    Panel {
        x: Axis::covering(points.iter().map(|p| p.x), if half { 5 } else { 9 }),
        y: Axis::covering(points.iter().map(|p| p.y), 5),
        x_title: Some(X_TITLE),
        y_title: Y_TITLE,
        right: 16,
    }
}

/// From rad to what the axes show: degrees and mrad.
fn shown(angle: f64, theta: f64) -> Point {
    Point::new(angle.to_degrees(), 1e3 * theta)
}

fn draw_path(area: &Area, path: &[Segment], half: bool) -> Drawn {
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
    let mut plot = axes(&all, half).on(area)?;
    plot.grid()?;
    for slipping in [true, false] {
        for (phase, points) in &lines {
            if (*phase != Phase::Stick) == slipping {
                let (ink, width) = if slipping { (OBJECT, 6) } else { (TORQUE, 10) };
                plot.line(points, ink, width)?;
            }
        }
    }
    Ok(())
}

fn draw_ranges(area: &Area, [flexing, extending]: &[Vec<Range>; 2], half: bool) -> Drawn {
    let edge = |ranges: &[Range], pick: fn(&Range) -> f64| -> Vec<Point> {
        ranges.iter().map(|r| shown(r.angle, pick(r))).collect()
    };
    let mut all = Vec::new();
    for ranges in [flexing, extending] {
        all.extend(edge(ranges, |r| r.low));
        all.extend(edge(ranges, |r| r.high));
    }
    let mut plot = axes(&all, half).on(area)?;
    plot.grid()?;
    let inks: [(&[Range], Ink); 2] = [(flexing, OBJECT), (extending, SHAFT)];
    for (ranges, ink) in inks {
        plot.veil(&edge(ranges, |r| r.low), &edge(ranges, |r| r.high), ink)?;
    }
    for (ranges, ink) in inks {
        plot.line(&edge(ranges, |r| r.low), ink, 6)?;
        plot.line(&edge(ranges, |r| r.high), ink, 6)?;
    }
    Ok(())
}
