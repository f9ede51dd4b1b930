//! A pair of axes, with its titles and what draws between them.

use crate::plot::axis::Axis;
use crate::plot::plot::{Mark, Plot};
use crate::plot::strip::Strip;

/// One pair of axes, and what draws between them.
pub struct Panel<'d> {
    pub(crate) height: f64,
    pub(crate) head: f64,
    pub(crate) heading: Option<&'d str>,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) x_title: Option<&'d str>,
    pub(crate) y_title: &'d str,
    pub(crate) right: f64,
    pub(crate) names: Vec<(f64, String)>,
    moments: Vec<Mark>,
    pub(crate) draw: Box<dyn FnOnce(&mut Plot) + 'd>,
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
