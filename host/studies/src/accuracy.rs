//! Cost of accuracy in time: every rung of the solver ladder, in both
//! precisions, over a range of steps, against the event-driven reference.
//!
//! ```text
//! scenes ─┬─> reference: true events, true torque ─┐
//!         └─> each rung × precision × step ────────┴─> errors ─┐
//!             each rung × precision × step, interleaved ─> time ┴─> points ─┬─> points.csv, orders
//!                                                                           └─> an answer to a need
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | what is studied, at which steps, and how a rung sees it | [`scenes`], [`steps`], [`input`] |
//! | the whole study and its results | [`study`], [`results`] |
//! | one point of the diagram, and its file | [`point`], [`points_table`] |
//! | the torque to compare with, at the ends of steps and within them | [`reference_torque`], [`held_torque`] |
//! | accuracy and time of a run | [`measure`], [`timing`] |
//! | cost of a step on the device's core | [`target`] |
//! | instructions of a step on the host | [`price`] |
//! | the other symptoms: errors, and cost over a step of crepitus | [`symptoms`] |
//! | orders of convergence, and on motions of other kinds | [`orders`], [`convergence`] |
//! | limits, and the cheapest rung within them | [`need`], [`mod@answer`] |
//! | what is printed, and the page's text | [`AccuracyOutcome`], [`need_words`] |

pub mod actuator;
pub mod answer;
pub mod convergence;
mod hands;
pub mod held_torque;
pub mod input;
pub mod measure;
pub mod need;
pub mod orders;
pub mod point;
pub mod points_table;
pub mod price;
pub mod reference_torque;
pub mod report;
pub mod results;
pub mod scenes;
pub mod steps;
pub mod study;
pub mod symptoms;
pub mod target;
pub mod timing;
mod words;

pub use answer::{Question, answer};
pub use input::Input;
pub use need::Need;
pub use point::Point;
pub use results::Study;
pub use scenes::StudyScene;
pub use study::{Plan, run};
pub use words::{AccuracyOutcome, need as need_words};
