//! # Parameters of the vibration actuator from its coil
//!
//! A chirp of voltage moves a mass on a flexure; what the motion induces in the coil
//! shows in its current. So voltage and current alone tell resistance, inductance,
//! resonance and damping, and the force constant once the mass is known.
//!
//! ```text
//! volts, amperes ─> Series ─> spectrum ─> start ─> fit ─┬─> refused: why, and what to do
//!                                                        └─> Actuator: values with intervals
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | a recording, from CSV or in memory | [`Series`] |
//! | the equations | [`impedance`](crepitus_plant::effects::reaction_mass::impedance), `mass.rs` |
//! | the fit and its intervals | `fit.rs`, `derived.rs` |
//! | what is refused | [`Refusal`], `explained_chirp.rs` |
//!
//! Not visible in any current: a ring that moves as one with the shell. The mass then swings
//! against both, and the resonance is that of m·M/(m + M). Hence the vice.

mod bands;
mod derived;
mod explained_chirp;
mod fit;
mod mass;
mod numbers;
mod parameters;
mod refusal;
mod second;
mod series;
mod spectrum;
mod start;
#[cfg(test)]
mod synthetic;

pub use mass::Weighed;
pub use parameters::{Actuator, ImpedancePoint, MassEvidence, identify};
pub use refusal::Refusal;
pub use series::{Current, Hold, Series, SeriesError};

/// Frequency band of the fit, Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower end, Hz.
    pub from_hz: f64,
    /// Upper end, Hz.
    pub to_hz: f64,
}

impl Band {
    /// Returns the band that a chirp covers at full amplitude, without its fades.
    pub fn of_chirp(from_hz: f64, to_hz: f64) -> Self {
        /// Length of a fade, as a share of the sweep.
        const FADE_SHARE: f64 = 1.0 / 32.0;
        let fade = (to_hz / from_hz).powf(FADE_SHARE);
        Self {
            from_hz: from_hz * fade,
            to_hz: to_hz / fade,
        }
    }
}
