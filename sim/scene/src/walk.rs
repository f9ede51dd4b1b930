//! The motion of a scene, step by step, and the plant that goes along.

use crepitus_plant::actuator::Actuator;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::{Motion, Piece, Plant};
use std::borrow::Borrow;

/// Walks through a motion, which it owns or borrows.
pub struct Walk<M> {
    motion: M,
    piece: Piece,
    clock: Clock,
    n: u64,
    time_s: f64,
    now: Body,
}

impl<M: Borrow<Motion>> Walk<M> {
    /// Walk from the motion's beginning, in steps of `step_s`.
    pub fn new(motion: M, step_s: f64) -> Self {
        let piece = motion.borrow().piece(0.0);
        let now = body(&piece, 0.0);
        Self {
            motion,
            piece,
            clock: Clock::new(step_s),
            n: 0,
            time_s: 0.0,
            now,
        }
    }

    /// Goes on with another motion, from its beginning. It begins where this one is, with the same
    /// velocity: both sides have that to the bit.
    pub fn turn_to(&mut self, motion: M) {
        self.piece = motion.borrow().piece(0.0);
        self.motion = motion;
        (self.n, self.time_s) = (0, 0.0);
    }

    /// Steps so far.
    #[inline]
    pub fn steps(&self) -> u64 {
        self.n
    }

    /// The time reached, s.
    #[inline]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The motion as the next step starts.
    #[inline]
    pub fn now(&self) -> Body {
        self.now
    }

    /// The motion at both ends of the next step, just inside it.
    #[inline]
    pub fn step(&mut self) -> (Body, Body) {
        self.n += 1;
        self.time_s = self.clock.time_s(self.n);
        let from = self.now;
        while self.piece.end_s < self.time_s {
            self.piece = self.motion.borrow().piece(self.piece.end_s);
        }
        let to = body(&self.piece, self.time_s);
        self.now = to;
        if self.piece.end_s == self.time_s {
            self.piece = self.motion.borrow().piece(self.time_s);
            // Without a jump both sides are one velocity, to the bit.
            if self.piece.jump {
                self.now = body(&self.piece, self.time_s);
            }
        }
        (from, to)
    }

    /// One step of the motion and of a plant that is held by it; returns the shaft at its
    /// end, just inside it: before its velocity jumps, if it does.
    #[inline]
    pub fn advance<A: Actuator>(&mut self, plant: &mut Plant<A>) -> Body {
        let (from, to) = self.step();
        plant.advance(&MotionStep {
            length_s: self.clock.step_s,
            from,
            to,
        });
        let shaft = plant.shaft();
        if self.now.omega_rad_s != to.omega_rad_s {
            plant.jump(self.now.omega_rad_s);
        }
        shaft
    }
}

/// Value held at `time_s` of `piece`.
#[inline]
pub(crate) fn body(piece: &Piece, time_s: f64) -> Body {
    let (angle_rad, omega_rad_s) = piece.angle_and_velocity(time_s);
    Body {
        angle_rad,
        omega_rad_s,
    }
}

/// The time of step `n`: by division where the rate is a whole number, so that
/// 20,000 steps of 50 µs are one second to the bit.
pub(crate) struct Clock {
    step_s: f64,
    rate_hz: Option<f64>,
}

impl Clock {
    pub(crate) fn new(step_s: f64) -> Self {
        let rate = 1.0 / step_s;
        let whole = (rate - rate.round()).abs() <= 1e-9 * rate;
        Self {
            step_s,
            rate_hz: whole.then_some(rate.round()),
        }
    }

    #[inline]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_wrap,
        reason = "below 2^53; a signed number converts in one instruction"
    )]
    pub(crate) fn time_s(&self, n: u64) -> f64 {
        let n = n as i64 as f64;
        match self.rate_hz {
            Some(rate) => n / rate,
            None => n * self.step_s,
        }
    }
}
