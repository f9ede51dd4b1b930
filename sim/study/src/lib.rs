//! # Studies
//!
//! What accuracy costs in time: every rung of the solver ladder, in both
//! precisions, over a range of steps, against the event-driven reference.

pub mod point;

pub use point::Point;
