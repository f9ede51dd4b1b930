//! SVG elements in CSS pixels, the last on top.

use maud::{Markup, PreEscaped, Render, html};

use crate::plot::curve_style::CurveStyle;
use crate::plot::marker::Marker;
use crate::plot::palette::{Ink, PAPER, TEXT};
use crate::plot::path::path;
use crate::plot::stroke::Stroke;
use crate::plot::text::SIZE;

/// Size of labels beside curves, CSS pixels.
pub(crate) const LABEL: f64 = 13.0;

/// Position of a text's point, relative to the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Left of it.
    Start,
    /// In the middle.
    Middle,
    /// Right of it.
    End,
}

impl Anchor {
    fn name(self) -> Option<&'static str> {
        match self {
            Self::Start => None,
            Self::Middle => Some("middle"),
            Self::End => Some("end"),
        }
    }
}

/// See the module.
#[derive(Debug, Default)]
pub struct Drawing {
    out: String,
}

/// A chart as an element for a page; [`crate::plot::Picture`] makes a file of it.
#[derive(Clone, Debug)]
pub struct Svg {
    pub(crate) width: f64,
    pub(crate) height: f64,
    label: String,
    pub(crate) body: String,
}

impl Drawing {
    /// Any elements.
    pub fn push(&mut self, elements: &Markup) {
        self.out.push_str(&elements.0);
    }

    /// A line through points.
    pub fn line(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        if points.len() > 1 {
            self.stroke(&path(points), stroke);
        }
    }

    /// Lines from point to point, as one element.
    pub fn lines(&mut self, pairs: impl IntoIterator<Item = [(f64, f64); 2]>, stroke: Stroke) {
        let path: String = pairs.into_iter().map(|pair| path(&pair)).collect();
        self.stroke(&path, stroke);
    }

    fn stroke(&mut self, path: &str, Stroke { ink, width, dashes }: Stroke) {
        let dashes = (!dashes.is_empty()).then_some(dashes);
        self.push(&html! {
            path d=(path) fill="none" stroke=(ink) stroke-width=(width) stroke-dasharray=[dashes] {}
        });
    }

    /// A filled outline; less opaque than 1 lets others show through.
    pub fn area(&mut self, outline: &[(f64, f64)], ink: Ink, opacity: f64) {
        let opacity = (opacity < 1.0).then_some(opacity);
        if outline.len() > 2 {
            self.push(
                &html! { path d={ (path(outline)) "z" } fill=(ink) fill-opacity=[opacity] {} },
            );
        }
    }

    /// Rectangles of one colour, from corner to corner, as one element.
    pub fn rectangles(&mut self, corners: impl IntoIterator<Item = [(f64, f64); 2]>, ink: Ink) {
        let mut d = String::new();
        for [(x0, y0), (x1, y1)] in corners {
            d.push_str(&path(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]));
            d.push('z');
        }
        if !d.is_empty() {
            self.push(&html! { path d=(d) fill=(ink) {} });
        }
    }

    /// A text whose middle is at this height.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, ink: Ink, text: &str) {
        let (x, y) = (px(at.0), px(at.1 + 0.35 * SIZE));
        self.push(&html! { text x=(x) y=(y) fill=(ink) text-anchor=[anchor.name()] { (text) } });
    }

    /// A text that reads upwards, in lines, about a point.
    pub(crate) fn upright(&mut self, (x, y): (f64, f64), text: &str) {
        let turn = format!("rotate(-90 {} {})", px(x), px(y));
        self.push(&html! {
            text x=(px(x)) y=(px(y)) fill=(TEXT) text-anchor="middle" transform=(turn) { (text) }
        });
    }

    /// A label, on a rim of paper so that it reads over lines.
    pub fn label(&mut self, at: (f64, f64), anchor: Anchor, ink: Ink, text: &str) {
        let (x, y) = (px(at.0), px(at.1 + 0.35 * LABEL));
        self.push(&html! {
            text x=(x) y=(y) text-anchor=[anchor.name()] font-size=(LABEL) paint-order="stroke"
                stroke=(PAPER) stroke-width="3.5" fill=(ink) { (text) }
        });
    }

    /// Most that a label is wide, CSS pixels.
    pub fn label_width(text: &str) -> f64 {
        crate::plot::text::width(text, LABEL)
    }

    /// A thin line from a curve to its label.
    pub fn leader(&mut self, from: (f64, f64), to: (f64, f64), ink: Ink) {
        self.push(&html! {
            path d=(path(&[from, to])) fill="none" stroke-width="1" stroke-opacity="0.55" stroke=(ink) {}
        });
    }

    /// The sign of a curve; the title shows under the pointer.
    pub fn marker(&mut self, at: (f64, f64), style: CurveStyle, filled: bool, title: &str) {
        let fill = if filled { style.ink } else { PAPER };
        self.push(&html! {
            path d=(style.marker.path(at)) fill=(fill) stroke=(style.ink) stroke-width="1.25" {
                @if !title.is_empty() { title { (title) } }
            }
        });
    }

    /// A filled sign with a rim of paper, so that it stands out from a line.
    pub fn sign(&mut self, at: (f64, f64), marker: Marker, ink: Ink) {
        self.push(&html! {
            path d=(marker.path(at)) fill=(ink) stroke=(PAPER) stroke-width="3" paint-order="stroke" {}
        });
    }

    /// An arrow down, from a sign at the foot of a diagram.
    pub fn arrow_down(&mut self, (x, y): (f64, f64), ink: Ink) {
        let head = [(x - 2.75, y + 9.5), (x, y + 13.0), (x + 2.75, y + 9.5)];
        let shaft = [(x, y + 4.5), (x, y + 13.0)];
        self.stroke(&(path(&shaft) + &path(&head)), Stroke::new(ink, 1.5));
    }

    /// An arrow to the left, from a sign at the left edge of a diagram.
    pub fn arrow_left(&mut self, (x, y): (f64, f64), ink: Ink) {
        let head = [(x - 9.5, y - 2.75), (x - 13.0, y), (x - 9.5, y + 2.75)];
        let shaft = [(x - 4.5, y), (x - 13.0, y)];
        self.stroke(&(path(&shaft) + &path(&head)), Stroke::new(ink, 1.5));
    }

    /// The drawing as an element of this size; the label is read out to those
    /// who cannot see it.
    pub fn svg(self, (width, height): (f64, f64), label: &str) -> Svg {
        Svg {
            width,
            height,
            label: label.to_owned(),
            body: self.out,
        }
    }

    pub(crate) fn finish(self) -> String {
        self.out
    }
}

impl Render for Svg {
    fn render(&self) -> Markup {
        let view = format!("0 0 {} {}", px(self.width), px(self.height));
        let style = format!("--nominal:{}px", px(self.width));
        html! {
            svg role="img" aria-label=(self.label) viewBox=(view) font-size=(SIZE) stroke-linejoin="round"
                style=(style) { (PreEscaped(&self.body)) }
        }
    }
}

/// A coordinate with at most two decimals.
pub(crate) fn px(x: f64) -> f64 {
    // No minus before a zero.
    (x * 100.0).round() / 100.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_escaped_and_coordinates_short() {
        let mut drawing = Drawing::default();
        drawing.text((1.0 / 3.0, 2.0), Anchor::End, TEXT, "<a & \"b\">");
        let out = drawing.finish();
        assert!(
            out.contains("x=\"0.33\" y=\"7.25\"") && out.contains("&lt;a &amp; &quot;b&quot;&gt;"),
            "{out}"
        );
    }
}
