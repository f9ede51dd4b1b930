//! The motion of a scene, step by step, and the plant that goes along.

use crepitus_model::Real;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::mechanics::Mechanics;
use crepitus_plant::piece::Parabola;
use crepitus_plant::{Motion, Piece};
use std::borrow::Borrow;

/// Walks through a motion, which it owns or borrows.
#[derive(Clone)]
pub struct Walk<M> {
    motion: M,
    piece: Piece,
    /// The piece, where its velocity is linear.
    parabola: Option<Parabola>,
    clock: Clock,
    n: u64,
    time_s: f64,
    now: Body,
    /// The parts of the last step that was split; none if it is whole.
    parts: Vec<Part>,
    /// Both ends of that one.
    ends: (Body, Body),
    /// The shortest part, s: a break closer to an end of its part counts as there.
    least_part_s: f64,
}

/// A part of a step that is split where the motion breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Length of the part, s.
    pub length_s: f64,
    /// The motion as it begins, just inside.
    pub from: Body,
    /// The motion as it ends, just inside.
    pub to: Body,
}

/// A break of the motion within a step, as the shaft of a plant gets to feel it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Time of the break, s.
    pub time_s: f64,
    /// The shaft just before it.
    pub before: Body,
    /// The shaft just after it.
    pub after: Body,
}

/// The shortest part of a step, as a share of it. Velocities are rounded, and over a very
/// short part that would be an acceleration.
fn least_part<F: Real>() -> f64 {
    if F::IS_SINGLE { 1.0 / 128.0 } else { 1e-6 }
}

impl<M: Borrow<Motion>> Walk<M> {
    /// Walk from the motion's beginning, in steps of `step_s`.
    pub fn new(motion: M, step_s: f64) -> Self {
        let piece = motion.borrow().piece(0.0);
        let now = body(&piece, 0.0);
        Self {
            motion,
            parabola: piece.parabola(),
            piece,
            clock: Clock::new(step_s),
            n: 0,
            time_s: 0.0,
            now,
            parts: Vec::new(),
            ends: (now, now),
            least_part_s: 0.0,
        }
    }

    /// The walk for a joint that computes in `F`, to be made by
    /// [`step_or_parts`](Self::step_or_parts) or [`advance_in_parts`](Self::advance_in_parts).
    #[must_use]
    pub fn in_parts<F: Real>(mut self) -> Self {
        self.least_part_s = least_part::<F>() * self.clock.step_s;
        self
    }

    /// Goes on with another motion, from its beginning. It begins where this one is, with the same
    /// velocity: both sides have that to the bit.
    pub fn turn_to(&mut self, motion: M) {
        self.enter(motion.borrow().piece(0.0));
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
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub fn step(&mut self) -> (Body, Body) {
        self.n += 1;
        self.time_s = self.clock.time_s(self.n);
        let from = self.now;
        while self.piece.end_s < self.time_s {
            self.enter(self.motion.borrow().piece(self.piece.end_s));
        }
        let to = self.body_now();
        self.arrive(to);
        (from, to)
    }

    #[inline]
    fn enter(&mut self, piece: Piece) {
        self.parabola = piece.parabola();
        self.piece = piece;
    }

    /// The motion at the time reached.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of each tick, whose result would pass through memory"
    )]
    fn body_now(&self) -> Body {
        let (angle_rad, omega_rad_s) = match &self.parabola {
            Some(parabola) => parabola.angle_and_velocity(self.time_s),
            None => self.piece.angle_and_velocity(self.time_s),
        };
        Body {
            angle_rad,
            omega_rad_s,
        }
    }

    /// The end of a step within its piece, or at the end of that.
    #[inline]
    fn arrive(&mut self, to: Body) {
        self.now = to;
        if self.piece.end_s == self.time_s {
            self.begin_piece();
        }
    }

    /// Enters the piece that begins at the time reached.
    #[cold]
    fn begin_piece(&mut self) {
        self.enter(self.motion.borrow().piece(self.time_s));
        // Without a jump both sides are one velocity, to the bit.
        if self.piece.jump {
            self.now = self.body_now();
        }
    }

    /// Makes a [`step`](Self::step); `None` if the motion breaks within the step, which
    /// [`parts`](Self::parts) then has the parts of.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub fn step_or_parts(&mut self) -> Option<(Body, Body)> {
        self.n += 1;
        self.time_s = self.clock.time_s(self.n);
        if self.piece.end_s < self.time_s {
            self.split();
            return self.parts.is_empty().then_some(self.ends);
        }
        let from = self.now;
        let to = self.body_now();
        self.arrive(to);
        Some((from, to))
    }

    /// Makes a step that ends inside its piece, and returns the motion at both ends; `None`, and
    /// nothing is done, for one that does not.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub(crate) fn step_within(&mut self) -> Option<(Body, Body)> {
        let n = self.n + 1;
        let time_s = self.clock.time_s(n);
        if time_s >= self.piece.end_s {
            return None;
        }
        (self.n, self.time_s) = (n, time_s);
        let from = self.now;
        self.now = self.body_now();
        Some((from, self.now))
    }

    /// The parts of the step that has just been split.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Splits the step to the present time at the ends of its pieces; leaves it whole where
    /// these are all as good as at its ends.
    #[cold]
    fn split(&mut self) {
        let end_s = self.time_s;
        let mut part_s = self.clock.time_s(self.n - 1);
        let mut from = self.now;
        // Velocity with which the step ends, where that jumps just before its end.
        let mut ends_with = None;
        self.parts.clear();
        while self.piece.end_s < end_s {
            let at_s = self.piece.end_s;
            let next = self.motion.borrow().piece(at_s);
            if at_s - part_s < self.least_part_s {
                if next.jump {
                    from.omega_rad_s = body(&next, part_s).omega_rad_s;
                }
            } else if end_s - at_s < self.least_part_s {
                if next.jump {
                    ends_with = ends_with.or(Some(body(&self.piece, end_s).omega_rad_s));
                }
            } else {
                let to = body(&self.piece, at_s);
                self.parts.push(Part {
                    length_s: at_s - part_s,
                    from,
                    to,
                });
                from = if next.jump { body(&next, at_s) } else { to };
                part_s = at_s;
            }
            self.enter(next);
        }
        let mut to = body(&self.piece, end_s);
        self.arrive(to);
        to.omega_rad_s = ends_with.unwrap_or(to.omega_rad_s);
        self.ends = (from, to);
        if !self.parts.is_empty() {
            self.parts.push(Part {
                length_s: end_s - part_s,
                from,
                to,
            });
        }
    }

    /// One step of the motion and of a plant that is held by it; returns the shaft at its
    /// end, just inside it, and just behind it: before and after its velocity jumps, if it does.
    #[inline]
    pub fn advance(&mut self, plant: &mut impl Mechanics) -> (Body, Body) {
        let (from, to) = self.step();
        plant.advance(&MotionStep {
            length_s: self.clock.step_s,
            from,
            to,
        });
        self.arrive_with(plant, to)
    }

    /// The shaft of a plant at the end of a step, before and after its velocity jumps from that of
    /// `to`.
    #[inline]
    fn arrive_with(&self, plant: &mut impl Mechanics, to: Body) -> (Body, Body) {
        let shaft = plant.shaft();
        if self.now.omega_rad_s == to.omega_rad_s {
            return (shaft, shaft);
        }
        plant.jump(self.now.omega_rad_s);
        (shaft, plant.shaft())
    }

    /// Makes an [`advance`](Self::advance), split where the motion breaks; adds what the
    /// plant's shaft made of each break within the step, or as it began, to `cuts`.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    pub fn advance_in_parts(
        &mut self,
        plant: &mut impl Mechanics,
        cuts: &mut Vec<Cut>,
    ) -> (Body, Body) {
        let (start_s, before) = (self.time_s, self.now);
        let to = match self.step_or_parts() {
            Some((from, to)) => {
                if from.omega_rad_s != before.omega_rad_s {
                    cuts.push(cut(plant, start_s, (before, from)));
                }
                plant.advance(&MotionStep {
                    length_s: self.clock.step_s,
                    from,
                    to,
                });
                to
            }
            None => self.advance_through_parts(plant, (start_s, before), cuts),
        };
        self.arrive_with(plant, to)
    }

    /// Advances `plant` through the parts of the step that began at this time, with this motion.
    #[cold]
    fn advance_through_parts(
        &self,
        plant: &mut impl Mechanics,
        (start_s, before): (f64, Body),
        cuts: &mut Vec<Cut>,
    ) -> Body {
        let (mut time_s, mut last) = (start_s, before);
        for part in &self.parts {
            if time_s > start_s || part.from.omega_rad_s != before.omega_rad_s {
                cuts.push(cut(plant, time_s, (last, part.from)));
            }
            plant.advance(&MotionStep {
                length_s: part.length_s,
                from: part.from,
                to: part.to,
            });
            time_s += part.length_s;
            last = part.to;
        }
        last
    }
}

/// Takes a plant over a break of its motion, which is `last` before it and `next` after.
fn cut(plant: &mut impl Mechanics, time_s: f64, (last, next): (Body, Body)) -> Cut {
    let before = plant.shaft();
    if next.omega_rad_s != last.omega_rad_s {
        plant.jump(next.omega_rad_s);
    }
    Cut {
        time_s,
        before,
        after: plant.shaft(),
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
#[derive(Clone)]
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
