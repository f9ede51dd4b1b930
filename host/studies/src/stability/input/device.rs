//! Inputs of a joint in a device: faulty or lost samples, commits, a shaking
//! hand, and settings that must be refused.

use super::Shaft;
use crepitus_model::{Parameters, Real, Settings};
use crepitus_plant::Motion;

/// Faults of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Every so many samples one is NaN, infinite, or implausible: each kind in
    /// turn.
    Impossible {
        /// Steps from one to the next.
        every: u64,
    },
    /// All samples are NaN from this time on.
    Blind {
        /// Time since the start, s.
        from_s: f64,
    },
    /// All samples are missing between two times.
    Gap {
        /// From, s.
        from_s: f64,
        /// To, s.
        to_s: f64,
    },
    /// All samples are missing while the shaft moves backwards.
    Retreating,
    /// Every so many samples the velocity at the end of one is 20 rad/s off:
    /// a plausible speed, but not within a tick.
    Jumps {
        /// Steps from one to the next.
        every: u64,
    },
}

/// The input of a joint in a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The motion.
    pub shaft: Shaft,
    /// Whether the joint gets counts of the device's encoder, or the true motion.
    pub counts: bool,
    /// Lost samples.
    pub lost: Lost,
    /// A commit every so many ticks; 0 for none.
    pub commit_every: u64,
    /// The committed parameters, in turn.
    pub commits: Vec<Parameters>,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

/// Lost samples: bursts that may repeat, from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lost {
    /// Samples in a row; 0 for none.
    pub ticks: u64,
    /// Ticks from one burst to the next; 0 for one burst only.
    pub every: u64,
    /// Start of the first, s.
    pub from_s: f64,
}

impl Lost {
    /// None.
    pub const NONE: Self = Self {
        ticks: 0,
        every: 0,
        from_s: 0.0,
    };

    /// Returns whether sample `n`, counted from 1, is lost.
    pub(in crate::stability) fn takes(&self, n: u64, step_s: f64) -> bool {
        let first = (self.from_s / step_s).round().whole() + 1;
        let Some(since) = n.checked_sub(first) else {
            return false;
        };
        let place = if self.every == 0 {
            since
        } else {
            since % self.every
        };
        place < self.ticks
    }
}

/// New parameters at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Time of the change, s.
    pub at_s: f64,
    /// The new parameters.
    pub parameters: Parameters,
}

/// φ = A·sin(2π·f·t), by a hand that gets the torque with a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shake {
    /// A, rad.
    pub amplitude_rad: f64,
    /// f, Hz.
    pub frequency_hz: f64,
    /// Ticks between a sample and its torque.
    pub delay_ticks: usize,
    /// Whether the joint gets counts of the device's encoder, or the true motion.
    pub counts: bool,
    /// Lost samples.
    pub lost: Lost,
}

/// Settings or a step that must be refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// Mistake in the settings or the step.
    pub what: &'static str,
    /// The settings.
    pub settings: Settings,
    /// The step, s.
    pub step_s: f64,
}

impl Shake {
    /// The motion of the hand.
    pub fn motion(&self) -> Motion {
        Motion::sine(self.amplitude_rad, self.frequency_hz, 0.0)
    }
}
