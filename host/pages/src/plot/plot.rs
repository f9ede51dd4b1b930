//! Drawing between a pair of axes, in the units of the data.

use crate::plot::axis::Axis;
use crate::plot::drawing::Drawing;
use crate::plot::frame::Frame;
use crate::plot::marker::Marker;
use crate::plot::palette::{GRID, Ink, LEVEL, PAPER, TEXT};
use crate::plot::simplify::simplify;
use crate::plot::stroke::Stroke;
use crate::plot::thinned::Point;

/// Least width of a stretch that must be seen, CSS pixels.
const NARROWEST: f64 = 3.0;

/// Invisible distance, CSS pixels.
const TOLERANCE: f64 = 0.15;

/// See the module.
#[derive(Debug)]
pub struct Plot {
    x: Axis,
    y: Axis,
    frame: Frame,
    /// Drawing area, in CSS pixels of the whole chart.
    pub over: Drawing,
}

/// A moment with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Value of x.
    pub at: f64,
    /// Event at this moment, in a few words.
    pub name: String,
}

impl Plot {
    pub(crate) fn new(x: Axis, y: Axis, frame: Frame, over: Drawing) -> Self {
        Self { x, y, frame, over }
    }

    /// The axis to the right.
    pub fn x(&self) -> &Axis {
        &self.x
    }

    /// The axis upwards.
    pub fn y(&self) -> &Axis {
        &self.y
    }

    /// Edges of the plot.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Position of a point, CSS pixels of the whole chart; what is outside
    /// stands at the edge.
    pub fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let Frame {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        (
            left + self.x.place(x) * (right - left),
            bottom - self.y.place(y) * (bottom - top),
        )
    }

    /// Lines at the ticks: after shading, before curves.
    pub fn grid(&mut self) {
        let Frame {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        let upright = self
            .x
            .labels()
            .map(|(value, _)| self.at((value, self.y.low())).0);
        let level = self
            .y
            .labels()
            .map(|(value, _)| self.at((self.x.low(), value)).1);
        let mut lines: Vec<_> = upright.map(|x| [(x, top), (x, bottom)]).collect();
        lines.extend(level.map(|y| [(left, y), (right, y)]));
        // Opaque enough on either paper.
        let mut grid = Drawing::default();
        grid.lines(lines, Stroke::new(GRID, 1.0));
        self.over
            .push(&maud::html! { g stroke-opacity="0.11" { (maud::PreEscaped(grid.finish())) } });
    }

    /// Stretches of x over the full height.
    pub fn shade(&mut self, stretches: impl IntoIterator<Item = (f64, f64)>, ink: Ink) {
        let (low, high) = (self.y.low(), self.y.high());
        let corners: Vec<_> = stretches
            .into_iter()
            .map(|(from, to)| [self.at((from, low)), self.at((to, high))])
            .collect();
        self.over.rectangles(corners, ink);
    }

    /// Stretches of x about which nothing is known: nothing is left of what was
    /// drawn there, and dotted lines stand at both ends. However short, each can
    /// be seen.
    pub fn blank(&mut self, stretches: &[(f64, f64)]) {
        let (low, high) = (self.x.low(), self.x.high());
        let Frame { top, bottom, .. } = self.frame;
        for (from, to) in stretches
            .iter()
            .filter(|(from, to)| *to >= low && *from <= high)
        {
            let (from, to) = (self.at((*from, 0.0)).0, self.at((*to, 0.0)).0);
            let middle = 0.5 * (from + to);
            let half = (0.5 * (to - from)).max(0.5 * NARROWEST);
            let (from, to) = (middle - half, middle + half);
            self.over.rectangles([[(from, top), (to, bottom)]], PAPER);
            let dotted = Stroke {
                dashes: "1 3",
                ..Stroke::new(TEXT, 1.0)
            };
            self.over
                .lines([from, to].map(|x| [(x, top), (x, bottom)]), dotted);
        }
    }

    /// A line through points, as wide as this, CSS pixels.
    pub fn line(&mut self, points: &[Point], ink: Ink, width: f64) {
        self.stroke(points, Stroke::new(ink, width));
    }

    /// A line through points.
    pub fn stroke(&mut self, points: &[Point], stroke: Stroke) {
        let path = self.visible(points);
        self.over.line(&path, stroke);
    }

    /// A filled band between a lower and an upper line; less opaque than 1
    /// lets others show through.
    pub fn band(&mut self, lower: &[Point], upper: &[Point], ink: Ink, opacity: f64) {
        let mut outline = self.visible(lower);
        outline.extend(self.visible(upper).into_iter().rev());
        self.over.area(&outline, ink, opacity);
    }

    /// The points that can be seen to matter, CSS pixels.
    fn visible(&self, points: &[Point]) -> Vec<(f64, f64)> {
        let path: Vec<_> = points
            .iter()
            .map(|point| self.at((point.x, point.y)))
            .collect();
        simplify(&path, TOLERANCE)
    }

    /// A dashed line across, at a level of y.
    pub fn across(&mut self, y: f64) {
        let ends = [(self.x.low(), y), (self.x.high(), y)].map(|end| self.at(end));
        self.over.line(&ends, Stroke::dashed(LEVEL, 1.25));
    }

    /// The sign of an event.
    pub fn mark(&mut self, at: (f64, f64), marker: Marker, ink: Ink) {
        self.over.sign(self.at(at), marker, ink);
    }

    /// Thin dotted lines at moments; [`Panel::moments`](crate::plot::Panel::moments) names them.
    pub fn moments(&mut self, marks: &[Mark]) {
        let (low, high) = (self.x.low(), self.x.high());
        let inside = marks.iter().filter(|mark| (low..=high).contains(&mark.at));
        for mark in inside {
            let (x, bottom) = self.at((mark.at, self.y.low()));
            self.over
                .line(&[(x, self.frame.top), (x, bottom)], Stroke::MOMENT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let frame = Frame {
            left: 100.0,
            top: 10.0,
            right: 900.0,
            bottom: 210.0,
        };
        let axis = || Axis::linear(0.0, 10.0, 5);
        Plot::new(axis(), axis(), frame, Drawing::default())
    }

    #[test]
    fn what_is_outside_stands_at_the_edge() {
        let plot = plot();
        assert_eq!(plot.at((5.0, 5.0)), (500.0, 110.0));
        assert_eq!(plot.at((-5.0, 99.0)), (100.0, 10.0));
    }

    #[test]
    fn moments_outside_have_no_line() {
        let mut plot = plot();
        let mark = |at| Mark {
            at,
            name: "a change".to_owned(),
        };
        plot.moments(&[mark(5.0), mark(99.0)]);
        let out = plot.over.finish();
        assert_eq!(
            (out.matches("<path").count(), out.matches("<text").count()),
            (1, 0)
        );
    }
}
