//! What a joint meets in a device: samples that go wrong or are lost, commits,
//! a hand that shakes, and settings that must be refused.

use super::Shaft;
use crepitus_model::{Parameters, Real, Settings};
use crepitus_plant::Motion;

/// What goes wrong with samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Every so many samples one is no number, infinite, or what no shaft can
    /// do: each kind in turn.
    Impossible {
        /// Steps from one to the next.
        every: u64,
    },
    /// None is a number from this time on.
    Blind {
        /// Since the start, s.
        from_s: f64,
    },
    /// None is taken between two times.
    Gap {
        /// From, s.
        from_s: f64,
        /// To, s.
        to_s: f64,
    },
    /// None is taken while the shaft moves backwards.
    Retreating,
    /// Every so many samples the velocity at the end of one is 20 rad/s off:
    /// slow enough for a shaft, but no shaft gets there in a tick.
    Jumps {
        /// Steps from one to the next.
        every: u64,
    },
}

/// What a joint meets in a device, beside its hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The motion.
    pub shaft: Shaft,
    /// Whether the joint sees counts of the device's encoder, or the truth.
    pub counts: bool,
    /// The samples that are lost.
    pub lost: Lost,
    /// A commit every so many ticks; 0 for none.
    pub commit_every: u64,
    /// To what, in turn.
    pub commits: Vec<Parameters>,
    /// How long, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

/// Which samples are lost: so many of every so many, from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lost {
    /// Samples in a row; 0 for none.
    pub ticks: u64,
    /// From one burst to the next, in ticks; 0 for one burst only.
    pub every: u64,
    /// When the first begins, s.
    pub from_s: f64,
}

impl Lost {
    /// None.
    pub const NONE: Self = Self {
        ticks: 0,
        every: 0,
        from_s: 0.0,
    };

    /// Whether sample `n`, counted from 1, is lost.
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
    /// When, s.
    pub at_s: f64,
    /// To what.
    pub parameters: Parameters,
}

/// φ = A·sin(2π·f·t), by a hand that feels the torque late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shake {
    /// A, rad.
    pub amplitude_rad: f64,
    /// f, Hz.
    pub frequency_hz: f64,
    /// Ticks between a sample and its torque.
    pub delay_ticks: usize,
    /// Whether the joint sees counts of the device's encoder, or the truth.
    pub counts: bool,
    /// The samples that are lost.
    pub lost: Lost,
}

/// Something to be refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// What is wrong with it.
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
