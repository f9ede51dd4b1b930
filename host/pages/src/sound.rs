//! # A torque as sound
//!
//! ```text
//! rows, evenly spaced ─ Resampler ─> 48 kHz ─ HighPass ─> from 30 Hz on ─ Sound ─> normalised, WAV
//! ```
//! The raw torque has 93 % of its power below 60 Hz, where small loudspeakers have nothing; its
//! derivative is clicks. What is above 30 Hz spreads over 60 to 1000 Hz, which is what grating
//! sounds like. Nothing else is changed, so that a sine in is a sine out.
//!
//! [`Sound`] takes one value after the other and keeps them on disk, so memory does not grow with
//! the length.
// Counts and rates; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

mod high_pass;
mod info_chunk;
mod resampler;
mod sound;
#[cfg(test)]
mod twin;

pub use high_pass::HIGH_PASS_HZ;
pub use sound::{RATE_HZ, Sound, SoundError, SoundSummary};
