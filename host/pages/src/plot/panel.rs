//! Pairs of axes above each other on one chart.

use crate::plot::axis::Axis;
use crate::plot::drawing::{Anchor, Drawing, Stroke, Svg};
use crate::plot::layout::{Frame, GAP, TICK, frames, y_title};
use crate::plot::palette::{AXIS, TEXT};
use crate::plot::plot::{Mark, Plot};
use crate::plot::strip::Strip;
use crate::plot::text::{LINE, SIZE, width};

/// One pair of axes, and what draws between them.
pub struct Panel<'d> {
    pub(crate) height: f64,
    pub(crate) head: f64,
    heading: Option<&'d str>,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) x_title: Option<&'d str>,
    pub(crate) y_title: &'d str,
    pub(crate) right: f64,
    pub(crate) names: Vec<(f64, String)>,
    moments: Vec<Mark>,
    draw: Box<dyn FnOnce(&mut Plot) + 'd>,
}

impl<'d> Panel<'d> {
    /// A panel of this height, CSS pixels, with its numbers and titles.
    pub fn new(
        height: f64,
        x: Axis,
        (y_title, y): (&'d str, Axis),
        draw: impl FnOnce(&mut Plot) + 'd,
    ) -> Self {
        Self {
            height,
            head: 0.0,
            heading: None,
            x,
            y,
            x_title: None,
            y_title,
            right: 16.0,
            names: Vec::new(),
            moments: Vec::new(),
            draw: Box::new(draw),
        }
    }

    /// The title of x, below its numbers. Without it a panel below has the
    /// same axis, and its numbers.
    #[must_use]
    pub fn x_title(mut self, title: Option<&'d str>) -> Self {
        self.x_title = title;
        self
    }

    /// More room above, CSS pixels, with a heading if there is one.
    #[must_use]
    pub fn head(mut self, head: f64, heading: Option<&'d str>) -> Self {
        (self.head, self.heading) = (head, heading);
        self
    }

    /// Reserves at least this much room at the right, CSS pixels.
    #[must_use]
    pub fn right(mut self, right: f64) -> Self {
        self.right = right;
        self
    }

    /// Names of values of y at the right edge, which makes room for them.
    #[must_use]
    pub fn names(mut self, names: Vec<(f64, String)>) -> Self {
        self.names = names;
        self
    }

    /// Names of moments in a strip above the axes, which makes room for them; in rows, where they
    /// would touch. [`Plot::moments`] draws their lines.
    #[must_use]
    pub fn moments(mut self, marks: Vec<Mark>) -> Self {
        self.moments = marks;
        self
    }

    /// The strip of a panel whose axes are this wide, CSS pixels.
    pub(crate) fn strip(&self, width: f64) -> Strip {
        Strip::of(&self.moments, &self.x, width)
    }
}

/// Draws panels one above the other, on one width.
pub fn stack(total: f64, label: &str, panels: Vec<Panel>) -> Svg {
    let (frames, height) = frames(total, &panels);
    let mut drawing = Drawing::default();
    for ((frame, strip), panel) in frames.into_iter().zip(panels) {
        let titles = y_title(&panel);
        if let Some(heading) = panel.heading {
            let y = frame.top - strip.height() - 18.0;
            drawing.text((frame.left, y), Anchor::Start, TEXT, heading);
        }
        strip.draw(frame, &mut drawing);
        let x = panel.x.fitting(frame.right - frame.left);
        let mut plot = Plot::new(x, panel.y, frame, drawing);
        (panel.draw)(&mut plot);
        for (value, name) in &panel.names {
            let (x, y) = plot.at((plot.x().high(), *value));
            plot.over.text((x + GAP, y), Anchor::Start, TEXT, name);
        }
        axes(&mut plot, panel.x_title, &titles, (total, height));
        drawing = plot.over;
    }
    drawing.svg((total, height), label)
}

/// Lines, ticks, numbers and titles.
fn axes(plot: &mut Plot, x_title: Option<&str>, y_title: &[&str], (total, height): (f64, f64)) {
    let Frame {
        left,
        top,
        right,
        bottom,
    } = plot.frame();
    let mut lines = vec![
        [(left, top), (left, bottom)],
        [(left, bottom), (right, bottom)],
    ];
    for (value, label) in plot.x().clone().labels() {
        let x = plot.at((value, plot.y().low())).0;
        lines.push([(x, bottom), (x, bottom + TICK)]);
        if x_title.is_some() {
            plot.over
                .text((x, bottom + 14.0), Anchor::Middle, TEXT, &label);
        }
    }
    for (value, label) in plot.y().clone().labels() {
        let y = plot.at((plot.x().low(), value)).1;
        lines.push([(left - TICK, y), (left, y)]);
        plot.over.text((left - GAP, y), Anchor::End, TEXT, &label);
    }
    plot.over.lines(lines, Stroke::new(AXIS, 1.0));
    // A title is in the middle, if it is not too long for that.
    let inside = |middle: f64, title: &str, end: f64| {
        let half = 0.5 * width(title, SIZE).min(end);
        middle.clamp(half, end - half)
    };
    if let Some(title) = x_title {
        let middle = inside(f64::midpoint(left, right), title, total);
        plot.over
            .text((middle, bottom + 36.0), Anchor::Middle, TEXT, title);
    }
    for (i, title) in y_title.iter().enumerate() {
        let middle = inside(f64::midpoint(top, bottom), title, height);
        plot.over.upright((LINE * (i as f64 + 1.0), middle), title);
    }
}
