//! # What the joint is attached to
//!
//! The motion of the shaft, prescribed as a function of time, and the sensors
//! that see it.
//!
//! | to find | look in |
//! |---|---|
//! | the kinds of motion: φ, Ω, Ω̇ exactly, with bounds of their derivatives | [`motion`] |
//! | the smooth pieces that every motion is made of | [`piece`] |
//! | a motion from a file | [`recording`] |
//! | counts of the encoder at the motor | [`encoder`] |

pub mod encoder;
pub mod motion;
pub mod piece;
pub mod recording;

pub use motion::Motion;
pub use piece::{Piece, ShaftState};
