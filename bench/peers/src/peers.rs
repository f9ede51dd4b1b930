//! The libraries that we compare with, one file each.
//!
//! All of them do the same: integrate a mode until its event, take the state there, set v = Ω
//! exactly, go on in the other mode with the step that this mode used last. The libraries locate
//! the events with their own detectors and interpolate with their own dense output.

mod differential_equations;
mod diffsol;
pub(crate) mod falls_at;
mod ivp;

use crate::work::{Mode, Runner, Work};

/// A method of a library.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// Library and version.
    pub library: &'static str,
    /// Method of the library.
    pub method: &'static str,
    build: fn(Work, Setting) -> Result<Runner, String>,
}

/// Settings of a method.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Setting {
    /// Relative tolerance, and absolute, both components being of order one.
    pub tolerance: f64,
    /// Whether slips are limited to [`Work::safe_step_s`].
    pub limited: bool,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self {
            library: "differential-equations 0.7.0",
            method: "dopri5",
            build: |work, setting| Ok(differential_equations::dopri5(work, setting)),
        },
        Self {
            library: "differential-equations 0.7.0",
            method: "dop853",
            build: |work, setting| Ok(differential_equations::dop853(work, setting)),
        },
        Self {
            library: "diffsol 0.18.0",
            method: "tsit45",
            build: diffsol::tsit45,
        },
        Self {
            library: "diffsol 0.18.0",
            method: "bdf",
            build: diffsol::bdf,
        },
        Self {
            library: "ivp 0.6.0",
            method: "dopri5",
            build: |work, setting| Ok(ivp::dopri5(work, setting)),
        },
        Self {
            library: "ivp 0.6.0",
            method: "dop853",
            build: |work, setting| Ok(ivp::dop853(work, setting)),
        },
    ];

    /// Sets the method up.
    pub fn build(&self, work: Work, setting: Setting) -> Result<Runner, String> {
        (self.build)(work, setting)
    }
}

/// The step with which each mode goes on when its turn comes again.
#[derive(Clone, Copy, Debug)]
struct Steps {
    /// Longest step of a slip, s.
    longest_s: f64,
    /// First step of a stick, s.
    stick: f64,
    /// Last step of a slip, s.
    slip: Option<f64>,
}

impl Steps {
    /// A stick is a straight line: one step, a little longer than it, is all it takes.
    fn new(work: &Work, setting: Setting) -> Self {
        Self {
            longest_s: if setting.limited {
                work.safe_step_s()
            } else {
                f64::INFINITY
            },
            stick: 1.25 * work.stick_s,
            slip: None,
        }
    }

    /// The longest step of a mode. A stick needs no limit: its event function is monotone.
    fn limit(&self, mode: Mode) -> f64 {
        match mode {
            Mode::Stick => f64::INFINITY,
            Mode::Slip => self.longest_s,
        }
    }

    /// The step to begin with; none where the library has to find one.
    fn first(&self, mode: Mode) -> Option<f64> {
        match mode {
            Mode::Stick => Some(self.stick),
            Mode::Slip => self.slip.map(|h| h.min(self.longest_s)),
        }
    }

    /// Notes the step with which a mode would have gone on.
    fn note(&mut self, mode: Mode, step_s: f64) {
        if mode == Mode::Slip {
            self.slip = Some(step_s);
        }
    }
}
