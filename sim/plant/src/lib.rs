//! # What the joint is attached to
//!
//! The motion that somebody makes, the sensors that see the shaft, and what
//! stands between the motor and the hand: effects that a scene lists one by
//! one.
//!
//! | to find | look in |
//! |---|---|
//! | the kinds of motion: φ, Ω, Ω̇ exactly, with bounds of their derivatives | [`motion`] |
//! | the smooth pieces that every motion is made of | [`piece`] |
//! | a motion from a file | [`recording`] |
//! | counts of the encoder at the motor | [`encoder`] |
//! | what an effect is, and the table of them | [`effect`], [`effects`] |
//! | how listed effects become a plant | [`assembly`] |
//! | how a plant is stepped | [`plant`], [`chain`], [`load`], [`actuator`], [`holder`] |
//! | a motor that is driven by its terminals | [`winding`], [`bridge`] |
//! | where its energy is | [`ledger`] |

pub mod actuator;
pub mod assembly;
pub mod bridge;
pub mod chain;
pub mod effect;
pub mod effects;
pub mod encoder;
pub mod holder;
pub mod ledger;
pub mod load;
pub mod motion;
pub mod piece;
pub mod plant;
pub mod recording;
pub mod winding;

pub use motion::Motion;
pub use piece::{Piece, ShaftState};
pub use plant::Plant;
