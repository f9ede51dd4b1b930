//! Slips side by side: the same operations for each, in arrays.

use crepitus_model::Real;
use crepitus_model::joint::SlipLane;
use std::array::from_fn;

/// Joints side by side.
pub(crate) const LANES: usize = 8;

/// States and numbers of slips, by lane; zeros of a joint that does not slip.
#[derive(Clone)]
pub(crate) struct Slips<F> {
    pub(crate) x: [F; LANES],
    pub(crate) v: [F; LANES],
    sign: [F; LANES],
    transition: [[F; LANES]; 4],
    bound: [[F; LANES]; 2],
    pub(crate) middle_rad: [F; LANES],
    /// Speed of the shaft, rad/s.
    pub(crate) omega: [F; LANES],
}

impl<F: Real> Slips<F> {
    pub(crate) fn new() -> Self {
        let zeros = [F::ZERO; LANES];
        Self {
            x: zeros,
            v: zeros,
            sign: zeros,
            transition: [zeros; 4],
            bound: [zeros; 2],
            middle_rad: zeros,
            omega: zeros,
        }
    }

    /// Takes a slip into a lane.
    pub(crate) fn set(&mut self, i: usize, slip: &SlipLane<F>, omega_rad_s: F) {
        self.omega[i] = omega_rad_s;
        (self.x[i], self.v[i], self.sign[i]) = (slip.x, slip.v, slip.sign);
        for (lanes, factor) in self.transition.iter_mut().zip(slip.transition) {
            lanes[i] = factor;
        }
        for (lanes, factor) in self.bound.iter_mut().zip(slip.bound) {
            lanes[i] = factor;
        }
        self.middle_rad[i] = slip.middle_rad;
    }

    /// Takes what slips on for ever into a lane that has nothing to do, so that it holds up no other: an object
    /// far too slow to be met.
    pub(crate) fn rest(&mut self, i: usize) {
        let slip = SlipLane {
            v: F::from_f64(-1e30),
            sign: F::ONE,
            ..SlipLane::default()
        };
        self.set(i, &slip, F::ZERO);
    }

    /// (x, v) of all lanes after a step to these speeds of the shafts, and which of them surely slip on; one
    /// of zeros never does.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    pub(crate) fn stepped(
        &self,
        ends: &[F; LANES],
        (step_s, per_step): (F, F),
    ) -> ([F; LANES], [F; LANES], [bool; LANES]) {
        let (mut x, mut v) = ([F::ZERO; LANES], [F::ZERO; LANES]);
        let mut is_sure = [false; LANES];
        for i in 0..LANES {
            let slip = SlipLane {
                x: self.x[i],
                v: self.v[i],
                sign: self.sign[i],
                transition: from_fn(|k| self.transition[k][i]),
                bound: from_fn(|k| self.bound[k][i]),
                middle_rad: self.middle_rad[i],
            };
            (x[i], v[i], is_sure[i]) = slip.stepped(self.omega[i], ends[i], step_s, per_step);
        }
        (x, v, is_sure)
    }
}
