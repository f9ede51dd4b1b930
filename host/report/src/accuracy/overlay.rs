//! SVG elements that the drawing library has no word for: dashes, hollow
//! signs, and titles that show up under the pointer. In grid lines.

use std::fmt::Write as _;

use super::hand::Hand;
use crate::escape::escaped;
use crate::palette::{Ink, PAPER};

/// Size of labels, grid lines.
const LABEL_SIZE: u32 = 52;

/// Where a text ends, seen from its point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Start,
    Middle,
}

/// Elements in order, the last on top.
// Writing to a String cannot fail.
#[derive(Debug, Default)]
pub(crate) struct Overlay {
    out: String,
}

impl Overlay {
    pub(crate) fn line(&mut self, points: &[(i32, i32)], hand: Hand) {
        if points.len() < 2 {
            return;
        }
        let _ = write!(self.out, "<polyline fill=\"none\" stroke-width=\"7\"");
        let _ = write!(self.out, " stroke=\"{}\"", hand.ink.hex());
        if !hand.dashes.is_empty() {
            let _ = write!(self.out, " stroke-dasharray=\"{}\"", hand.dashes);
        }
        self.out.push_str(" points=\"");
        for (i, (x, y)) in points.iter().enumerate() {
            let space = if i == 0 { "" } else { " " };
            let _ = write!(self.out, "{space}{x},{y}");
        }
        self.out.push_str("\"/>");
    }

    /// A thin line from a curve to its label.
    pub(crate) fn leader(&mut self, from: (i32, i32), to: (i32, i32), ink: Ink) {
        let _ = write!(
            self.out,
            "<path d=\"M{} {}L{} {}\" fill=\"none\" stroke-width=\"3\" stroke-opacity=\"0.55\" \
             stroke=\"{}\"/>",
            from.0,
            from.1,
            to.0,
            to.1,
            ink.hex()
        );
    }

    pub(crate) fn marker(&mut self, at: (i32, i32), hand: Hand, filled: bool, title: &str) {
        let fill = if filled { hand.ink } else { PAPER };
        let _ = write!(
            self.out,
            "<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"5\" \
             stroke-linejoin=\"round\"",
            hand.marker.path(at),
            fill.hex(),
            hand.ink.hex()
        );
        if title.is_empty() {
            self.out.push_str("/>");
        } else {
            let _ = write!(self.out, "><title>{}</title></path>", escaped(title));
        }
    }

    /// An arrow down, from a sign at the foot of a diagram.
    pub(crate) fn arrow_down(&mut self, (x, y): (i32, i32), ink: Ink) {
        let _ = write!(
            self.out,
            "<path d=\"M{x} {}V{}M{} {}L{x} {}L{} {}\" fill=\"none\" stroke=\"{}\" \
             stroke-width=\"6\"/>",
            y + 18,
            y + 52,
            x - 11,
            y + 38,
            y + 52,
            x + 11,
            y + 38,
            ink.hex()
        );
    }

    /// An arrow to the left, from a sign at the left edge of a diagram.
    pub(crate) fn arrow_left(&mut self, (x, y): (i32, i32), ink: Ink) {
        let _ = write!(
            self.out,
            "<path d=\"M{} {y}H{}M{} {}L{} {y}L{} {}\" fill=\"none\" stroke=\"{}\" \
             stroke-width=\"6\"/>",
            x - 18,
            x - 52,
            x - 38,
            y - 11,
            x - 52,
            x - 38,
            y + 11,
            ink.hex()
        );
    }

    /// A label, on a rim of paper so that it reads over lines.
    pub(crate) fn text(&mut self, (x, y): (i32, i32), anchor: Anchor, ink: Ink, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
        };
        let _ = write!(
            self.out,
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.35em\" text-anchor=\"{anchor}\" \
             font-size=\"{LABEL_SIZE}\" paint-order=\"stroke\" stroke=\"{}\" stroke-width=\"14\" \
             stroke-linejoin=\"round\" fill=\"{}\">{}</text>",
            PAPER.hex(),
            ink.hex(),
            escaped(text)
        );
    }

    pub(crate) fn finish(self) -> String {
        self.out
    }
}
