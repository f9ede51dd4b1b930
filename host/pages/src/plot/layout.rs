//! Room that the axes of charts need at their edges, so that no label is
//! cut.

use crate::plot::frame::Frame;
use crate::plot::panel::Panel;
use crate::plot::strip::Strip;
use crate::plot::text::{LINE, SIZE, lines, width};

/// Length of a tick.
pub(crate) const TICK: f64 = 4.0;
/// Least room at the edges.
const LEFT: f64 = 74.0;
const TOP: f64 = 10.0;
const FOOT: f64 = 48.0;
const FOOT_WITHOUT_NUMBERS: f64 = 6.0;
/// Gap beside a label.
pub(crate) const GAP: f64 = 8.0;
const EDGE: f64 = 3.0;

/// Frames of panels one above the other, with the strips above them, and the height of all; all begin
/// and end at the same x.
pub(crate) fn frames(total: f64, panels: &[Panel]) -> (Vec<(Frame, Strip)>, f64) {
    let most = |room: fn(&Panel) -> f64| panels.iter().map(room).fold(0.0, f64::max).ceil();
    let left = most(left);
    let right = (total - most(right)).max(left + 1.0);
    let mut top = 0.0;
    let frames = panels.iter().map(|panel| {
        let strip = panel.strip(right - left);
        let head = panel.head + strip.height();
        let frame = Frame {
            left,
            top: top + head + TOP,
            right,
            bottom: top + head + panel.height - foot(panel),
        };
        top += head + panel.height;
        (frame, strip)
    });
    (frames.collect(), top)
}

/// Lines of the title of y; half of it may stand beyond each end.
pub(crate) fn y_title<'p>(panel: &Panel<'p>) -> Vec<&'p str> {
    lines(panel.y_title, panel.head + panel.height - EDGE)
}

pub(crate) fn foot(panel: &Panel) -> f64 {
    if panel.x_title.is_some() {
        FOOT
    } else {
        FOOT_WITHOUT_NUMBERS
    }
}

fn left(panel: &Panel) -> f64 {
    let labels = panel
        .y
        .labels()
        .map(|(_, label)| width(&label, SIZE))
        .fold(0.0, f64::max);
    let titles = LINE * y_title(panel).len() as f64;
    LEFT.max(EDGE + titles + GAP + labels + GAP)
}

fn right(panel: &Panel) -> f64 {
    let names = panel
        .names
        .iter()
        .map(|(_, name)| GAP + width(name, SIZE))
        .fold(0.0, f64::max);
    // The last number of x may reach beyond its tick.
    let last = match (panel.x_title, panel.x.labels().last()) {
        (Some(_), Some((at, label))) if panel.x.place(at) > 0.9 => 0.5 * width(&label, SIZE),
        _ => 0.0,
    };
    panel.right.max(names + EDGE).max(last + EDGE)
}
