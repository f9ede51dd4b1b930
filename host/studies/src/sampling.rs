//! A motion cut into steps: for each the exact Δφ and the velocity at both
//! ends, computed in f64 and rounded once.

use crepitus_model::{Real, ShaftStep};
use crepitus_plant::{Motion, Piece};

/// Number of steps prepared at a time: few enough to stay in the cache.
pub const CHUNK_STEPS: usize = 2048;

/// A motion cut into steps.
#[derive(Clone, Copy, Debug)]
pub struct Sampling<'a> {
    motion: &'a Motion,
    step_s: f64,
    /// Steps per second if that is a whole number: 20,000 steps of 50 µs
    /// are one second to the bit, and 20,000 · 5e-5 is not always.
    rate_hz: Option<f64>,
    steps: u64,
}

impl<'a> Sampling<'a> {
    /// Whole steps of `step_s` in `duration_s`.
    pub fn new(motion: &'a Motion, duration_s: f64, step_s: f64) -> Self {
        let rate = 1.0 / step_s;
        let whole = (rate - rate.round()).abs() <= 1e-9 * rate;
        Self {
            motion,
            step_s,
            rate_hz: whole.then_some(rate.round()),
            // A decimal duration may miss a whole number of steps by rounding.
            steps: (duration_s / step_s * (1.0 + 1e-12) + 1e-9).whole(),
        }
    }

    /// The step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Number of steps.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// End of the last step, s.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.steps, 0.0)
    }

    /// Time at which `fraction` of a step has passed after `n` whole ones, s.
    #[inline]
    pub fn time_s(&self, n: u64, fraction: f64) -> f64 {
        let steps = f64::from_whole(n) + fraction;
        match self.rate_hz {
            Some(rate) => steps / rate,
            None => steps * self.step_s,
        }
    }

    /// The steps from step `n` on.
    pub fn walk_from(&self, n: u64) -> Walk<'a> {
        let time_s = self.time_s(n, 0.0);
        let piece = self.motion.piece(time_s);
        Walk {
            sampling: *self,
            n,
            piece,
            now: piece.angle_and_velocity(time_s),
        }
    }
}

/// Iterates over the steps of a motion in the order of time.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    sampling: Sampling<'a>,
    n: u64,
    piece: Piece,
    /// Angle and velocity as the next step starts.
    now: (f64, f64),
}

impl Walk<'_> {
    /// Angle and velocity as the next step starts, rad and rad/s.
    pub fn now(&self) -> (f64, f64) {
        self.now
    }

    /// Replaces `chunk` by the next steps, at most `most`; empty at the end.
    pub fn fill<F: Real>(&mut self, chunk: &mut Vec<ShaftStep<F>>, most: usize) {
        chunk.clear();
        while chunk.len() < most && self.n < self.sampling.steps {
            chunk.push(self.step());
        }
    }

    /// The same, each with the angle where it ends, rad.
    pub fn fill_with_angles<F: Real>(&mut self, chunk: &mut Vec<(f64, ShaftStep<F>)>, most: usize) {
        chunk.clear();
        while chunk.len() < most && self.n < self.sampling.steps {
            let step = self.step();
            chunk.push((self.now.0, step));
        }
    }

    fn step<F: Real>(&mut self) -> ShaftStep<F> {
        self.n += 1;
        let time_s = self.sampling.time_s(self.n, 0.0);
        let (phi_start, omega_start) = self.now;
        while self.piece.end_s < time_s {
            self.piece = self.sampling.motion.piece(self.piece.end_s);
        }
        let (phi_end, omega_end) = self.piece.angle_and_velocity(time_s);
        self.now = (phi_end, omega_end);
        if self.piece.end_s == time_s {
            self.piece = self.sampling.motion.piece(time_s);
            // Without a jump both sides are one velocity, to the bit.
            if self.piece.jump {
                self.now = self.piece.angle_and_velocity(time_s);
            }
        }
        ShaftStep {
            delta_phi_rad: F::from_f64(phi_end - phi_start),
            omega_start_rad_s: F::from_f64(omega_start),
            omega_end_rad_s: F::from_f64(omega_end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::motion::VelocityKnot;

    #[test]
    fn whole_rates_divide() {
        let motion = Motion::constant(1.0);
        let sampling = Sampling::new(&motion, 10.0, 5e-5);
        assert_eq!(sampling.steps(), 200_000);
        assert_eq!(sampling.end_s(), 10.0);
        assert_eq!(sampling.time_s(6000, 0.0), 0.3);
        assert_eq!(sampling.time_s(6000, 0.5), 0.300_025);
        assert_eq!(Sampling::new(&motion, 1.0, 3e-4).steps(), 3333);
    }

    #[test]
    fn steps_add_up_to_the_motion_and_see_both_sides_of_a_jump() {
        let knot = |time_s, left, right| VelocityKnot {
            time_s,
            omega_left_rad_s: left,
            omega_right_rad_s: right,
        };
        let motion = Motion::velocity_knots(&[knot(0.0, 1.0, 1.0), knot(0.5, 2.0, -1.0)]);
        let sampling = Sampling::new(&motion, 1.0, 0.125);
        let mut chunk: Vec<ShaftStep<f64>> = Vec::new();
        let mut walk = sampling.walk_from(0);
        walk.fill(&mut chunk, 100);
        assert_eq!(chunk.len(), 8);
        let travelled: f64 = chunk.iter().map(|s| s.delta_phi_rad).sum();
        assert!((travelled - motion.at(1.0).phi_rad).abs() < 1e-15);
        assert_eq!(chunk[3].omega_end_rad_s, 2.0);
        assert_eq!(chunk[4].omega_start_rad_s, -1.0);
        let mut later: Vec<ShaftStep<f64>> = Vec::new();
        sampling.walk_from(4).fill(&mut later, 4);
        assert_eq!(later, chunk[4..]);
        walk.fill(&mut chunk, 100);
        assert!(chunk.is_empty());
    }
}
