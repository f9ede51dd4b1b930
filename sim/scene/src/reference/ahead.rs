//! The search for the end of the present phase, ahead of the requested time.
//!
//! A phase is searched in windows that begin where it begins, or where a piece
//! of the motion does, and are laid without regard to where the run is asked
//! for: so an event is the same to the bit, and found at the same cost,
//! whether the state is asked for once or a million times on the way. Windows
//! grow, so that a phase that does not end costs few of them.

use super::{Reference, State};
use crepitus_model::Sense;
use crepitus_plant::piece::Curve;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// The end of a phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct PhaseEnd {
    pub(super) time_s: f64,
    /// Sense of the slip that begins, or ends.
    pub(super) sense: Sense,
}

/// State of the search for the end of the present phase in the present piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    /// Time from which on the piece has not been searched, s.
    from_s: f64,
    /// Whether anything has been searched.
    begun: bool,
    /// Length of the next window, as a multiple of the first.
    windows: f64,
    end: Option<PhaseEnd>,
}

impl Ahead {
    /// State in which nothing is known from `time_s` on.
    pub(super) fn from(time_s: f64) -> Self {
        Self {
            from_s: time_s,
            begun: false,
            windows: 1.0,
            end: None,
        }
    }
}

impl Reference<'_> {
    /// The end of the present phase, if it is not after `horizon_s`, which is
    /// within the piece. Not asked for in a frozen slip, whose end is known.
    #[inline(never)]
    pub(super) fn look_ahead<B>(
        &mut self,
        horizon_s: f64,
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<PhaseEnd>> {
        while self.ahead.end.is_none() && !(self.ahead.begun && self.ahead.from_s >= horizon_s) {
            let from_s = self.ahead.from_s;
            let to_s = (from_s + self.ahead.windows * self.window_s()).min(self.piece.end_s);
            self.ahead.end = match self.state {
                State::Stick { theta, phi } => self.find_break(theta, phi, (from_s, to_s), poll)?,
                State::Slip(slip) => {
                    let sense = slip.sense;
                    let time_s = self.find_match(&slip, (from_s, to_s), poll)?;
                    time_s.map(|time_s| PhaseEnd { time_s, sense })
                }
            };
            self.ahead.begun = true;
            self.ahead.from_s = to_s;
            self.ahead.windows *= 2.0;
        }
        ControlFlow::Continue(self.ahead.end.filter(|end| end.time_s <= horizon_s))
    }

    /// Length of the first window, s: about the time in which a bound of the
    /// motion, or of the object's swing, is near to what it bounds.
    fn window_s(&self) -> f64 {
        match (self.state, self.piece.curve) {
            (State::Slip(_), _) => TAU / self.natural_rad_s,
            (State::Stick { .. }, Curve::Sine { frequency_hz, .. }) => 1.0 / frequency_hz,
            // To the end of the piece; one without an end is parabolic, and so
            // is the torque.
            (State::Stick { .. }, Curve::Polynomial(_)) => f64::INFINITY,
        }
    }
}
