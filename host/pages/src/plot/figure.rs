//! A figure as a page shows it: heading, legend, charts, caption.

use crate::plot::curve_style::CurveStyle;
use crate::plot::drawing::Svg;
use crate::plot::palette::Ink;

/// See the module.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name for files.
    pub name: &'static str,
    /// Heading of the figure, above all.
    pub title: &'static str,
    /// Meanings of lines, patches and signs.
    pub legend: Vec<Key>,
    /// Charts, in order.
    pub charts: Vec<Chart>,
    /// Explanation of what one sees and of how to read it.
    pub caption: String,
}

/// One chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Heading above the chart, if it has one.
    pub heading: Option<String>,
    /// The drawing.
    pub svg: Svg,
    /// Two of these stand side by side where there is room.
    pub half: bool,
}

impl Chart {
    /// A chart over the full width, without a heading.
    pub fn full(svg: Svg) -> Self {
        Self {
            heading: None,
            svg,
            half: false,
        }
    }
}

/// One entry of a legend.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    pub(crate) sign: Sign,
    /// Meaning.
    pub text: &'static str,
}

/// Sign of a legend's entry.
#[derive(Clone, Copy, Debug)]
pub enum Sign {
    /// A line.
    Line(Ink),
    /// A dashed line.
    Dashed(Ink),
    /// A filled patch.
    Patch(Ink),
    /// A character.
    Mark(&'static str),
    /// A curve with its sign.
    Curve(CurveStyle),
    /// The sign of a curve, filled.
    Filled(CurveStyle),
}

impl Sign {
    /// CSS pixels.
    pub(crate) fn width(self) -> f64 {
        match self {
            Self::Line(_) | Self::Dashed(_) | Self::Patch(_) | Self::Mark(_) => 18.0,
            Self::Curve(_) | Self::Filled(_) => 44.0,
        }
    }
}

impl Key {
    /// A sign and its meaning.
    pub const fn new(sign: Sign, text: &'static str) -> Self {
        Self { sign, text }
    }
}
