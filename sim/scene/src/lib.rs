//! # Scenes
//!
//! A scene file describes a simulation; this crate reads and validates it, runs
//! it, and sums the run up.
//!
//! ```text
//! scene file ── scene ──> Scene ── run ──> rows, events ──> Observer
//!                                   └────> Summary
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the form of a scene file, its checks and errors | [`scene`], [`error`] |
//! | the scenes that ship | [`shipped`] |
//! | a knee with a disorder as a file, and those that ship | [`preset`] |
//! | the parameters of a device that renders a scene or a preset | [`values`] |
//! | the limits of a symptom's torque by angle, and the largest torque of all | [`static_limits`] |
//! | the loop, the totals, the summary | [`mod@run`] |
//! | the motion step by step, for who steps a plant himself | [`walk`] |
//! | columns, rows and events | [`trace`] |
//! | the files of a run, written whole or not at all | [`output`] |
//! | the clock of every cost, and a count where it is too noisy | [`cpu_time`], [`instructions`] |
//! | the event-driven solver without a step | [`mod@reference`] |
//! | the same for the symptoms besides crepitus | [`reference::symptoms`] |

pub mod any_joint;
pub mod cpu_time;
mod device_checks;
mod document;
mod effects;
pub mod error;
pub mod instructions;
mod knee;
pub mod output;
pub mod preset;
pub mod reference;
pub mod run;
pub mod scene;
pub mod shipped;
pub mod similar;
pub mod static_limits;
pub mod trace;
pub mod values;
pub mod walk;

pub use error::SceneError;
pub use knee::Knee;
pub use preset::Preset;
pub use run::{Observer, RunError, Summary, run};
pub use scene::{Overrides, Scene};
pub use walk::Walk;
