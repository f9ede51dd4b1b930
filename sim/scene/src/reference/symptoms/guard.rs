//! Conditions that end a state of a symptom, and the search for the first time
//! at which one does.
//!
//! Every condition of every law is one form, with x = s·φ and v = s·Ω:
//!
//! ```text
//! g(t) = c + α·x + β·v + D·e^(−(t − t₀)/τ)
//! ```
//!
//! The derivatives of g are known and the second one is bounded over a piece of the
//! motion, so the search cannot step over a root, however short the visit is
//! (see [`first_root`](super::super::first_root)).

use super::super::first_root::{Sample, Touch, first_root};
use crepitus_plant::piece::Bounds;
use crepitus_plant::{Piece, ShaftState};
use std::convert::Infallible;
use std::ops::ControlFlow;

/// Number of roundings of its terms that count as zero of a condition.
const ROUNDINGS: f64 = 8.0;

/// D·e^(−(t − t₀)/τ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decay {
    /// D.
    pub(super) amplitude: f64,
    /// t₀, s.
    pub(super) start_s: f64,
    /// τ > 0, s.
    pub(super) time_s: f64,
}

impl Decay {
    pub(super) fn at(&self, time_s: f64) -> f64 {
        self.amplitude * (-(time_s - self.start_s) / self.time_s).exp()
    }
}

/// A condition, positive until it is met.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Guard {
    /// c.
    pub(super) constant: f64,
    /// Size of what c is the sum of, where its terms may cancel: by that it is rounded.
    pub(super) terms: f64,
    /// α, per rad.
    pub(super) angle: f64,
    /// β, per rad/s.
    pub(super) velocity: f64,
    /// The decaying term.
    pub(super) decay: Option<Decay>,
}

impl Guard {
    /// Met where x rises to `level`.
    pub(super) fn above(level: f64) -> Self {
        Self {
            constant: level,
            angle: -1.0,
            ..Self::default()
        }
    }

    /// Met where x falls to `level`.
    pub(super) fn below(level: f64) -> Self {
        Self {
            constant: -level,
            angle: 1.0,
            ..Self::default()
        }
    }

    /// Met where v rises to `level`.
    pub(super) fn faster(level: f64) -> Self {
        Self {
            constant: level,
            velocity: -1.0,
            ..Self::default()
        }
    }

    /// The condition with a c that is the sum of terms of this size.
    pub(super) fn of_terms(self, terms: f64) -> Self {
        Self { terms, ..self }
    }

    /// The condition on −x and −v if `sign` is −1.
    pub(super) fn mirrored(self, sign: f64) -> Self {
        Self {
            angle: sign * self.angle,
            velocity: sign * self.velocity,
            ..self
        }
    }
}

/// The end of a state of a symptom.
#[derive(Clone, Copy, Debug)]
pub(super) enum When {
    /// A time is reached, s.
    At(f64),
    /// A condition falls below zero; to touch zero is not enough.
    Crosses(Guard),
    /// A condition is first at or below zero.
    Holds(Guard),
    /// Two conditions are first at or below zero together.
    BothHold([Guard; 2]),
}

/// A stretch of time within a piece of the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span<'a> {
    piece: &'a Piece,
    /// s of x = s·φ.
    sign: f64,
    from_s: f64,
    to_s: f64,
    bounds: Bounds,
}

impl<'a> Span<'a> {
    pub(super) fn new(piece: &'a Piece, sign: f64, from_s: f64, to_s: f64) -> Self {
        Self {
            piece,
            sign,
            from_s,
            to_s,
            bounds: piece.bounds(from_s, to_s),
        }
    }

    /// The first time in the span at which `when` is met, s.
    pub(super) fn first(&self, when: &When) -> Option<f64> {
        match when {
            When::At(time_s) => (*time_s <= self.to_s).then(|| time_s.max(self.from_s)),
            When::Crosses(guard) => self.root(guard, self.from_s, Touch::Passes),
            When::Holds(guard) => self.holds(guard, self.from_s),
            When::BothHold(guards) => self.both_hold(guards),
        }
    }

    fn holds(&self, guard: &Guard, from_s: f64) -> Option<f64> {
        if self.is_met(guard, from_s) {
            return Some(from_s);
        }
        let touch = Touch::Counts { from_above: true };
        self.root(guard, from_s, touch)
            .or_else(|| self.is_met(guard, self.to_s).then_some(self.to_s))
    }

    /// Alternates between the two: each is met no earlier than the other was.
    fn both_hold(&self, [one, other]: &[Guard; 2]) -> Option<f64> {
        let mut from_s = self.from_s;
        loop {
            let one_s = self.holds(one, from_s)?;
            let both_s = self.holds(other, one_s)?;
            if self.is_met(one, both_s) {
                return Some(both_s);
            }
            if both_s >= self.to_s {
                return None;
            }
            from_s = both_s.max(from_s.next_up());
        }
    }

    fn is_met(&self, guard: &Guard, time_s: f64) -> bool {
        let sample = self.sample(guard, time_s);
        sample.value <= sample.noise
    }

    fn root(&self, guard: &Guard, from_s: f64, touch: Touch) -> Option<f64> {
        let mut proceed = || ControlFlow::<Infallible>::Continue(());
        let ControlFlow::Continue(found) =
            first_root(from_s, self.to_s, touch, &mut proceed, |time_s| {
                self.sample(guard, time_s)
            });
        found
    }

    fn sample(&self, guard: &Guard, time_s: f64) -> Sample {
        let ShaftState {
            phi_rad,
            omega_rad_s,
            omega_dot,
            ..
        } = self.piece.at(time_s);
        let (angle, velocity) = (self.sign * guard.angle, self.sign * guard.velocity);
        let (decay, decay_s) = guard
            .decay
            .map_or((0.0, 1.0), |decay| (decay.at(time_s), decay.time_s));
        let slope = angle * omega_rad_s + velocity * omega_dot - decay / decay_s;
        // The velocity and the angle are rounded by the sizes of their terms.
        let age_s = self.piece.age_s(time_s);
        let turned = omega_rad_s.abs() + self.bounds.omega_dot * age_s;
        let size = guard.constant.abs().max(guard.terms)
            + angle.abs() * (phi_rad.abs() + turned * age_s)
            + velocity.abs() * turned
            + decay.abs()
            + slope.abs() * time_s.abs();
        let noise = ROUNDINGS * f64::EPSILON * size;
        Sample {
            value: guard.constant + angle * phi_rad + velocity * omega_rad_s + decay,
            slope,
            bound: angle.abs() * self.bounds.omega_dot
                + velocity.abs() * self.bounds.omega_ddot
                + decay.abs() / (decay_s * decay_s),
            noise,
            slack: 2.0 * noise,
        }
    }
}
