//! The play (stop operator) of section 1, in continuous time.
//!
//! ```text
//! T = σ·(x − a), held within ℓ(t, x) ≤ T ≤ u(t, x) by moving a
//! ```
//!
//! The play is elastic (a is fixed) until T meets a limit, follows the limit, and is
//! elastic again from where σ·v < du/dt (upper limit), or σ·v > dℓ/dt (lower).
//!
//! Readings: armed, a = φ; a one-sided play is then elastic if the joint moves
//! in, and slack otherwise, without an event: to move in later is a `take`. At a
//! limit that jumps to the torque or below it, the torque stays at the limit,
//! which is no `flow`, unless it is being turned back, which is no `turn`.

use super::guard::{Guard, When};
use super::limit::Limit;
use super::runner::Instant;

/// Rounding of a torque, relative to its terms.
const SAME: f64 = 64.0 * f64::EPSILON;

/// A torque that jumps by less than this does so from rounding, N·m.
pub(super) const FELT_NM: f64 = 1e-11;

/// One of the two limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Upper,
    Lower,
}

impl End {
    /// The direction in which the limit acts.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Upper => 1.0,
            Self::Lower => -1.0,
        }
    }
}

/// Both limits; the lower one in its own direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) upper: Limit,
    pub(super) lower: Limit,
}

impl Limits {
    /// ℓ = 0.
    pub(super) fn one_sided(upper: Limit) -> Self {
        Self {
            upper,
            lower: Limit::level(0.0),
        }
    }

    /// u = −ℓ, everywhere the same.
    pub(super) fn symmetric(torque_nm: f64) -> Self {
        Self {
            upper: Limit::level(torque_nm),
            lower: Limit::level(torque_nm),
        }
    }

    fn of(&self, end: End) -> &Limit {
        match end {
            End::Upper => &self.upper,
            End::Lower => &self.lower,
        }
    }

    /// The torque at a limit, N·m.
    pub(super) fn torque_nm(&self, end: End, at: &Instant) -> f64 {
        let sign = end.sign();
        sign * self.of(end).value(at.time_s, sign * at.x)
    }
}

/// State of a play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mode {
    /// Both limits are zero: T = 0, and a goes along.
    Closed,
    /// T = σ·(x − anchor).
    Elastic { anchor: f64 },
    /// T is at a limit.
    Flow(End),
}

/// Actions of a play.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlayAction {
    /// The torque meets a limit.
    Meet(End),
    /// The torque leaves the limit that it is at.
    Turn,
}

/// A play.
#[derive(Clone, Copy, Debug)]
pub(super) struct Play {
    /// σ, N·m/rad; above 0 unless it is always closed.
    pub(super) sigma: f64,
    pub(super) mode: Mode,
}

impl Play {
    pub(super) fn closed(sigma: f64) -> Self {
        Self {
            sigma,
            mode: Mode::Closed,
        }
    }

    /// The torque now, N·m.
    pub(super) fn torque_nm(&self, limits: &Limits, at: &Instant) -> f64 {
        match self.mode {
            Mode::Closed => 0.0,
            Mode::Elastic { anchor } => self.sigma * (at.x - anchor),
            Mode::Flow(end) => limits.torque_nm(end, at),
        }
    }

    /// Lists what may happen next, with these limits.
    pub(super) fn watches(&self, limits: &Limits, mut watch: impl FnMut(When, PlayAction)) {
        match self.mode {
            Mode::Closed => {}
            Mode::Elastic { anchor } => {
                for end in [End::Upper, End::Lower] {
                    let sign = end.sign();
                    let guard = limits.of(end).reach(self.sigma, sign * anchor);
                    watch(When::Crosses(guard.mirrored(sign)), PlayAction::Meet(end));
                }
            }
            Mode::Flow(end) => {
                if let Some(guard) = self.turns(limits, end) {
                    watch(When::Crosses(guard), PlayAction::Turn);
                }
            }
        }
    }

    /// Carries out what has happened.
    pub(super) fn act(&mut self, action: PlayAction, limits: &Limits, at: &Instant) {
        self.mode = match action {
            PlayAction::Meet(end) => Mode::Flow(end),
            PlayAction::Turn => self.elastic(self.torque_nm(limits, at), at),
        };
    }

    /// Goes on within other limits, which may have jumped: a limit that is now
    /// below the torque takes the torque with it, one that is above changes
    /// nothing.
    pub(super) fn change(&mut self, torque_nm: f64, limits: &Limits, at: &Instant) {
        for end in [End::Upper, End::Lower] {
            let (sign, limit_nm) = (end.sign(), limits.torque_nm(end, at));
            let beyond_nm = sign * (torque_nm - limit_nm);
            if beyond_nm < -SAME * (torque_nm.abs() + limit_nm.abs() + self.sigma * at.x.abs()) {
                continue;
            }
            // At the limit, it stays there unless it is being turned back.
            let leaves = self.turns(limits, end).is_some_and(|g| {
                g.velocity * at.v + g.decay.map_or(0.0, |d| d.at(at.time_s)) < 0.0
            });
            self.mode = if leaves {
                self.elastic(limit_nm, at)
            } else {
                Mode::Flow(end)
            };
            return;
        }
        if !matches!(self.mode, Mode::Elastic { .. }) {
            self.mode = self.elastic(torque_nm, at);
        }
    }

    fn turns(&self, limits: &Limits, end: End) -> Option<Guard> {
        let guard = limits.of(end).turn(self.sigma)?;
        Some(guard.mirrored(end.sign()))
    }

    fn elastic(&self, torque_nm: f64, at: &Instant) -> Mode {
        Mode::Elastic {
            anchor: at.x - torque_nm / self.sigma,
        }
    }
}
