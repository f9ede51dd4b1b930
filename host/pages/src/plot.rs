//! # Charts as SVG, on pages of their own
//!
//! ```text
//! data → Axis, Panel ─> stack ─> Svg ┬─> Figure ─> page::document   one HTML file, offline
//!        Drawing ────────────────────┘          └> Picture          SVG files, PDF
//! ```
//!
//! Everything is in CSS pixels. Room at the edges of a chart follows from its
//! labels, so no label is cut. Colours are [`palette::Ink`]s: an element names
//! the colour on light paper, so any SVG program shows it, and a style sheet
//! puts a variable in its place where there is light and dark.
//!
//! | to find | look in |
//! |---|---|
//! | ranges, ticks and their labels | [`Axis`] |
//! | one or several pairs of axes above each other | [`Panel`], [`stack()`] |
//! | lines, signs and text anywhere | [`Drawing`] |
//! | how lines, signs and colours look | [`CurveStyle`], [`Marker`], [`palette`] |
//! | a line of any length in bounded memory | [`Thinned`] |
//! | legends, captions, files | [`Figure`], [`Picture`] |
//! | widths for a screen and for a journal | [`paper`] |
//! | the page and its style sheet | [`page`] |
//! | numbers for people | [`number`] |

// Counts become numbers to be drawn; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

mod axis;
mod curve_sample;
mod curve_style;
mod drawing;
mod figure;
mod frame;
pub mod labels;
mod layout;
mod marker;
pub mod number;
pub mod page;
pub mod palette;
mod panel;
pub mod paper;
mod path;
mod pdf;
mod picture;
mod plot;
mod simplify;
mod stack;
mod strip;
mod stroke;
pub mod text;
mod thinned;

pub use axis::{Axis, extent};
pub use curve_style::CurveStyle;
pub use drawing::{Anchor, Drawing, Svg};
pub use figure::{Chart, Figure, Key, Sign};
pub use frame::Frame;
pub use marker::Marker;
pub use panel::Panel;
pub use paper::{Column, Paper};
pub use pdf::PdfError;
pub use picture::{Picture, pictures};
pub use plot::{Mark, Plot};
pub use simplify::simplify;
pub use stack::stack;
pub use stroke::Stroke;
pub use thinned::{Point, Thinned};
