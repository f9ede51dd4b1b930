//! Draws a run of Crepitus, or a recording of a device, as one HTML page that
//! needs nothing else.
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
//! only where there is a plant; a figure for each symptom besides crepitus only
//! where there is one. Those are in the words of a clinic: torque over the knee's
//! angle with its limits, torque over time with its states, angle of catch against
//! speed, beats over time, and a table of what an examiner would note.
//!
// Counts become numbers to be drawn; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

mod balance_table;
mod channels;
mod chart_beats;
mod chart_catches;
mod chart_energy;
mod chart_hand;
mod chart_motion;
mod chart_orbit;
mod chart_plant;
mod chart_spectrum;
mod chart_symptoms;
mod chart_torque;
mod chart_zoom;
mod choice;
mod collector;
mod course;
mod envelope;
mod examiner_notes;
mod fast_part;
mod hysteresis;
mod levels;
mod orbit;
mod overlay;
mod page;
mod phases;
mod plant;
mod spectrum;
mod symptom_chart;
mod symptoms;
mod text;
mod window;

#[cfg(test)]
#[path = "../tests/pages/fixture/mod.rs"]
mod fixture;

pub use crate::plot::page::Section;
pub use crate::plot::{Column, Mark, Paper, Picture};
pub use channels::{Setup, TorqueLevels};
pub use collector::{Collector, Figures};
pub use overlay::{Difference, Measured, Quantity};
pub use page::{html, pictures};
pub use text::Text;
