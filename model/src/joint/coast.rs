//! Steps within a slip whose course is known: only time passes.
//!
//! Under `frozen` the object swings freely for a known time, so its motion after each of the next
//! steps is a closed form of the step's number. A loop over many of them has no chain of
//! dependencies and no branch: a compiler makes lanes of it.

use crate::joint::oscillator::Oscillator;
use crate::joint::ticks::Ticks;
use crate::joint::{Sense, StepCoefficients};
use crate::real::Real;

/// Steps computed before it is looked whether one of them needs another way.
const CHUNK: usize = 64;

/// The next steps of a slip that goes on through all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coast<F> {
    /// Number of steps, at least one.
    pub steps: u32,
    /// Sense of the slip.
    pub sense: Sense,
    /// Torque in all of them, N·m.
    pub torque_nm: F,
    oscillator: Oscillator<F>,
    step_s: F,
    /// Time since (x, v), in ticks, as the first step begins.
    since: Ticks<F>,
    /// θ − s·Tk/kr, rad, and θ̇, rad/s, at the anchor of the slip.
    anchor: (F, F),
    /// s·Tk/kr, rad.
    middle_rad: F,
}

impl<F: Real> Coast<F> {
    /// A slip that lasts `ticks` whole steps, `since` its anchor; `None` if that is now.
    #[inline]
    pub(crate) fn new(
        coefficients: &StepCoefficients<F>,
        ticks: u64,
        since: Ticks<F>,
        anchor: (F, F),
        sense: Sense,
    ) -> Option<Self> {
        // A time that was cut off at the anchor does not grow by whole steps from there.
        if since == Ticks::default() {
            return None;
        }
        // The numbers of all steps are i32.
        let most = u64::from(i32::MAX.unsigned_abs()).checked_sub(since.whole)?;
        let steps = u32::try_from(ticks.min(most)).ok().filter(|n| *n > 0)?;
        Some(Self {
            steps,
            sense,
            torque_nm: sense.of_signed(coefficients.kinetic_nm),
            oscillator: coefficients.oscillator,
            step_s: coefficients.step_s,
            since,
            anchor,
            middle_rad: sense.of_signed(coefficients.kinetic_angle_rad),
        })
    }

    /// θ, rad, and θ̇, rad/s, after each of the steps, as many as there is room for: the bits of the joint,
    /// made in lanes where the compiler has them. It is inlined, for the target features of its caller.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    pub fn motions(&self, theta_rad: &mut [F], theta_dot_rad_s: &mut [F]) {
        let after = i32::try_from(self.since.whole).unwrap_or(i32::MAX);
        // The first steps after a break are short times, all others are not.
        let short = (1..)
            .take(theta_rad.len())
            .take_while(|n| {
                self.oscillator
                    .is_short(self.time_s(after.saturating_add(*n)))
            })
            .count();
        let (theta, long_theta) = theta_rad.split_at_mut_checked(short).unwrap_or_default();
        let (theta_dot, long_theta_dot) = theta_dot_rad_s
            .split_at_mut_checked(short)
            .unwrap_or_default();
        self.all::<true>(after, theta, theta_dot);
        let after = after.saturating_add(i32::try_from(short).unwrap_or(i32::MAX));
        self.all::<false>(after, long_theta, long_theta_dot);
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn all<const SHORT: bool>(&self, mut after: i32, theta: &mut [F], theta_dot: &mut [F]) {
        let chunks = theta.chunks_mut(CHUNK).zip(theta_dot.chunks_mut(CHUNK));
        for (theta, theta_dot) in chunks {
            if !self.chunk::<SHORT>(after, theta, theta_dot) {
                self.one_by_one(after, theta, theta_dot);
            }
            after = after.saturating_add(i32::try_from(theta.len()).unwrap_or(i32::MAX));
        }
    }

    /// Time since the anchor after a whole number of ticks, s.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn time_s(&self, ticks: i32) -> F {
        (F::from_count(ticks) + self.since.fraction) * self.step_s
    }

    /// Computes a chunk without a branch; returns whether it is right.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    fn chunk<const SHORT: bool>(&self, after: i32, theta: &mut [F], theta_dot: &mut [F]) -> bool {
        let (x, v) = self.anchor;
        let mut is_plain = true;
        let mut ticks = after;
        for (theta, theta_dot) in theta.iter_mut().zip(theta_dot) {
            ticks = ticks.wrapping_add(1);
            let (transition, plain) = self
                .oscillator
                .straight_transition::<SHORT>(self.time_s(ticks));
            let (x, v) = transition.apply(x, v);
            *theta = x + self.middle_rad;
            *theta_dot = v;
            is_plain &= plain;
        }
        is_plain
    }

    /// As a joint does it.
    #[inline(never)]
    fn one_by_one(&self, after: i32, theta: &mut [F], theta_dot: &mut [F]) {
        let (x, v) = self.anchor;
        let mut ticks = after;
        for (theta, theta_dot) in theta.iter_mut().zip(theta_dot) {
            ticks = ticks.wrapping_add(1);
            let (x, v) = self.oscillator.transition(self.time_s(ticks)).apply(x, v);
            *theta = x + self.middle_rad;
            *theta_dot = v;
        }
    }
}
