//! # The mechanics around the joint: motor, gear, cuff, leg, hand
//!
//! The motion, the sensors that see the shaft, and what stands between the
//! motor and the hand: effects that a scene lists one by one.
//!
//! | to find | look in |
//! |---|---|
//! | the kinds of motion: φ, Ω, Ω̇ exactly, with bounds of their derivatives | [`motion`] |
//! | the smooth pieces that every motion is made of | [`piece`] |
//! | a motion from a file | [`recording`] |
//! | counts of the encoder at the motor | [`encoder`] |
//! | what an effect is, and the table of them | [`effect`], [`effects`] |
//! | how listed effects become a plant | [`assembly`] |
//! | how a plant is stepped | [`plant`], [`chain`], [`branch`], [`compliance`], [`load`], [`actuator`], [`boundary`] |
//! | the hand of a person at a screen | [`guiding_hand`] |
//! | where its energy is | [`energy_balance`] |
//! | a weight that swings in the brace, as a fit simulates it | [`swing`] |
//! | the spectrum of what vibrates | [`spectrum`] |
//! | the lowest and highest of a series | [`Extremes`] |

pub mod actuator;
pub mod assembly;
pub mod boundary;
mod boxed;
pub mod branch;
pub mod chain;
mod coil;
pub mod compliance;
pub mod effect;
pub mod effects;
pub mod encoder;
pub mod energy_balance;
mod extremes;
pub mod guiding_hand;
pub mod load;
pub mod mechanics;
pub mod motion;
pub mod piece;
pub mod plant;
pub mod recording;
pub mod rigid_shaft;
pub mod spectrum;
pub mod swing;

pub use extremes::Extremes;
pub use motion::Motion;
pub use piece::{Piece, ShaftState};
pub use plant::Plant;
