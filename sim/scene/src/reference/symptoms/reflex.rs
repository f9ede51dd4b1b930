//! `spasticity`, form `reflex` (section 6): threshold control, delayed.
//!
//! ```text
//! u = min(Tmax, k·max(0, s(φ − λ + μΩ)))
//! τ_a·ẏ + y = u(t − τ_d)        T = s·y
//! ```
//!
//! `onset` and `offset` are where u leaves and reaches 0, `cap` and `uncap`
//! where it reaches and leaves Tmax. Between these u is a known function of the
//! motion, so y has a closed form (`delayed_response`).
//!
//! Readings: before the start u = 0, so y = 0 up to τ_d; a start beyond the
//! threshold is an `onset` at 0. A jump of Ω may be two events at one time. A
//! touch is no event. The rule μ ≥ τ_d + τ_a is the scene's to check. The tank
//! of the active effects is a later stage: this is the torque that the law asks
//! for.

use super::Word as Kind;
use super::delayed_response::{DelayedResponse, Particular};
use super::guard::{Guard, When};
use super::keys::{Reader, SymptomError};
use super::runner::{Instant, Law, Reported, Watches};
use crepitus_plant::Piece;

/// The reflex of one group of muscles.
#[derive(Clone, Debug)]
pub(super) struct Reflex {
    /// s·λ, rad.
    threshold: f64,
    /// μ, s.
    shift_s: f64,
    /// k, N·m/rad.
    gain: f64,
    /// Tmax, N·m.
    torque_nm: f64,
    /// τ_a, s.
    activation_s: f64,
    state: State,
    /// The present piece of the motion, and s.
    stretch: Option<(Piece, f64)>,
    response: DelayedResponse,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Silent,
    Active,
    Capped,
}

impl Reflex {
    pub(super) fn read(reader: &Reader<'_>, sign: f64) -> Result<Self, SymptomError> {
        let activation_s = reader.positive("activation_s", 0.01)?;
        Ok(Self {
            threshold: sign * reader.angle("threshold_deg", 75.0)?,
            shift_s: reader.at_least_zero("velocity_shift_s", 0.27)?,
            gain: reader.at_least_zero("gain_nm_per_rad", 2.43)?,
            torque_nm: reader.at_least_zero("torque_nm", 4.5)?,
            activation_s,
            state: State::Silent,
            stretch: None,
            response: DelayedResponse::new(reader.at_least_zero("delay_s", 0.05)?, activation_s),
        })
    }

    /// The condition at which k·s(φ − λ + μΩ) rises above `torque_nm`.
    fn rises_above(&self, torque_nm: f64) -> Guard {
        Guard {
            constant: torque_nm + self.gain * self.threshold,
            terms: torque_nm.abs() + (self.gain * self.threshold).abs(),
            angle: -self.gain,
            velocity: -self.gain * self.shift_s,
            decay: None,
        }
    }

    /// The condition at which it falls below.
    fn falls_below(&self, torque_nm: f64) -> Guard {
        let up = self.rises_above(torque_nm);
        Guard {
            constant: -up.constant,
            angle: -up.angle,
            velocity: -up.velocity,
            ..up
        }
    }

    /// The input from now on.
    fn change_input(&mut self, at: &Instant) {
        let particular = match (self.state, &self.stretch) {
            (State::Active, Some((piece, sign))) => Particular::of_stretch(
                piece,
                (sign * self.gain, self.shift_s, self.gain * self.threshold),
                self.activation_s,
            ),
            (State::Capped, _) => Particular::constant(self.torque_nm),
            _ => Particular::constant(0.0),
        };
        self.response.input(at, particular);
    }
}

impl Law for Reflex {
    /// The state that begins.
    type Action = State;

    fn arm(&mut self, _: &Instant) {}

    fn enter(&mut self, piece: &Piece, sign: f64, at: &Instant) {
        self.stretch = Some((*piece, sign));
        self.change_input(at);
    }

    fn watches(&self, watches: &mut Watches<State>) {
        if self.gain <= 0.0 || self.torque_nm <= 0.0 {
            return;
        }
        let mut watch = |guard, state| watches.push((When::Crosses(guard), state));
        match self.state {
            State::Silent => watch(self.rises_above(0.0), State::Active),
            State::Active => {
                watch(self.falls_below(0.0), State::Silent);
                watch(self.rises_above(self.torque_nm), State::Capped);
            }
            State::Capped => watch(self.falls_below(self.torque_nm), State::Active),
        }
    }

    fn act(&mut self, action: State, at: &Instant) -> Option<Reported> {
        let kind = match (self.state, action) {
            (State::Silent, _) => Kind::Onset,
            (_, State::Silent) => Kind::Offset,
            (_, State::Capped) => Kind::Cap,
            (_, State::Active) => Kind::Uncap,
        };
        self.state = action;
        self.change_input(at);
        Some(kind.into())
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.response.at(at.time_s)
    }
}
