//! Draws a run of Crepitus, and the study of what accuracy costs, each as one
//! HTML page that needs nothing else: no network, no scripts, no fonts. It
//! follows light and dark, prints, and reads on a phone.
//!
//! ```text
//! rows, events → Collector → Figures ┐
//!                 (bounded)          ├→ html → report.html
//! titles, tables, warnings → Text ───┘
//! ```
//!
//! A [`Collector`] sees every row and every event of a run but keeps only
//! what the figures need, so its memory does not depend on how long the run
//! is. What a scene does not have is not drawn: leg, hand, motor and energy
//! only where there is a plant.
//!
//! [`accuracy`] is the report of the study: work-precision diagrams from its
//! points. [`stability`] is that of the hard cases: a heat map of the matrix,
//! and the stories that [`story`] draws. [`coupled`] is the map of stiffness. [`effects`] is that of the effects of
//! a scene: their influence against their cost.

// Counts become numbers to be drawn; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

pub mod accuracy;
mod axis;
mod balance;
mod balance_table;
mod canvas;
mod channels;
mod chart_energy;
mod chart_hand;
mod chart_motion;
mod chart_orbit;
mod chart_plant;
mod chart_spectrum;
mod chart_torque;
mod chart_zoom;
mod choice;
mod collector;
pub mod coupled;
mod course;
pub mod effects;
mod envelope;
mod error;
mod escape;
mod fast_part;
mod figure;
mod frame;
mod hysteresis;
mod levels;
mod number;
mod orbit;
mod page;
mod palette;
mod picture;
mod plant;
mod simplify;
mod spectrum;
pub mod stability;
pub mod story;
mod text;
mod thinned;
mod window;

#[cfg(test)]
#[path = "../tests/fixture/mod.rs"]
mod fixture;

pub use balance::{Account, Balance, Term as EnergyTerm};
pub use channels::{Setup, TorqueLevels};
pub use collector::{Collector, Figures};
pub use error::ReportError;
pub use page::html;
pub use picture::{Picture, pictures};
pub use text::{Section, Text};
