//! A figure as the page shows it: heading, legend, charts, caption.

use crepitus_model::{Phase, Sense};

use crate::accuracy::hand::Hand;
use crate::window::Window;

/// See the module.
#[derive(Debug)]
pub(crate) struct Figure {
    /// For files.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) legend: Vec<Key>,
    pub(crate) charts: Vec<Chart>,
    /// What one sees and how to read it.
    pub(crate) caption: String,
}

/// One chart.
#[derive(Debug)]
pub(crate) struct Chart {
    pub(crate) heading: Option<String>,
    pub(crate) svg: String,
    /// Two of these stand side by side where there is room.
    pub(crate) half: bool,
}

/// One entry of a legend.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    pub(crate) sign: Sign,
    pub(crate) text: &'static str,
}

/// How a legend shows what it explains.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sign {
    /// A class of the style sheet: a line in the ink of this name.
    Line(&'static str),
    /// A filled patch in the ink of this name.
    Patch(&'static str),
    /// A character.
    Mark(&'static str),
    /// A curve of a work-precision diagram.
    Curve(Hand),
    /// A sign on it, filled.
    Filled(Hand),
}

impl Sign {
    /// CSS pixels.
    pub(crate) fn width(self) -> u8 {
        match self {
            Self::Line(_) | Self::Patch(_) | Self::Mark(_) => 18,
            Self::Curve(_) | Self::Filled(_) => 44,
        }
    }
}

impl Key {
    pub(crate) const fn new(sign: Sign, text: &'static str) -> Self {
        Self { sign, text }
    }
}

/// The keys of the phases that occur.
pub(crate) fn phase_keys(phases: impl IntoIterator<Item = Phase>) -> Vec<Key> {
    let mut occurs = [false; 3];
    for phase in phases {
        match phase {
            Phase::Slip(Sense::Positive) => occurs[0] = true,
            Phase::Stick => occurs[1] = true,
            Phase::Slip(Sense::Negative) => occurs[2] = true,
        }
    }
    [
        Key::new(Sign::Patch("slip-positive"), "slip +"),
        Key::new(Sign::Patch("stick"), "stick"),
        Key::new(Sign::Patch("slip-negative"), "slip −"),
    ]
    .into_iter()
    .zip(occurs)
    .filter_map(|(key, occurs)| occurs.then_some(key))
    .collect()
}

/// A window with the words that say which one it is.
pub(crate) struct Titled<'w> {
    pub(crate) title: String,
    pub(crate) window: &'w Window,
}
