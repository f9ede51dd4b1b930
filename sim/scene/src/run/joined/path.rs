//! The motion of the shaft in blocks of steps, with what all joints on it have in common.

use crate::run::accounting::whole_stretch;
use crate::run::sensor::{Ideal, Sensor};
use crate::run::stepping::CHECK_STEPS;
use crate::run::tally::Stretch;
use crate::walk::{Part, Walk};
use crepitus_model::{Real, ShaftStep};
use crepitus_plant::Motion;

/// The most steps of a block: their states stay in a processor's cache.
pub(super) const BLOCK_STEPS: u64 = 256;

/// A whole step.
#[derive(Clone, Copy, Debug)]
pub(super) struct OfStep<F> {
    /// Times of its ends, s.
    pub(super) start_s: f64,
    pub(super) end_s: f64,
    pub(super) seen: ShaftStep<F>,
    /// The shaft for a joint that sticks through all of it.
    pub(super) stretch: Stretch,
    /// Angle of the shaft at its end, as joints have seen it, rad.
    pub(super) phi_rad: f64,
}

/// Steps one after the other, without a jump of the velocity between them.
#[derive(Debug)]
pub(super) struct Block<F> {
    /// Velocity to which the shaft jumps before the first step, rad/s.
    pub(super) jumps_to: Option<F>,
    pub(super) steps: Vec<OfStep<F>>,
    /// Turn in each, rad, and speed at its end, rad/s.
    pub(super) turns_rad: Vec<F>,
    pub(super) speeds_rad_s: Vec<F>,
    /// That speed in f64.
    pub(super) omega_rad_s: Vec<f64>,
}

impl<F> Default for Block<F> {
    fn default() -> Self {
        Self {
            jumps_to: None,
            steps: Vec::new(),
            turns_rad: Vec::new(),
            speeds_rad_s: Vec::new(),
            omega_rad_s: Vec::new(),
        }
    }
}

impl<F: Real> Block<F> {
    fn clear(&mut self) {
        self.jumps_to = None;
        self.steps.clear();
        self.turns_rad.clear();
        self.speeds_rad_s.clear();
        self.omega_rad_s.clear();
    }

    fn push(&mut self, step: OfStep<F>) {
        self.turns_rad.push(step.seen.delta_phi_rad);
        self.speeds_rad_s.push(step.seen.omega_end_rad_s);
        self.omega_rad_s.push(step.seen.omega_end_rad_s.to_f64());
        self.steps.push(step);
    }
}

/// A step in the parts that the motion breaks it into.
pub(super) struct SplitStep<'a> {
    /// Time at which it begins, s.
    pub(super) start_s: f64,
    pub(super) parts: &'a [Part],
}

/// The way of the shaft.
pub(super) struct Path<'m, F> {
    walk: Walk<&'m Motion>,
    step_s: f64,
    steps: u64,
    /// A step that begins with another velocity than the last one ended with.
    pending: Option<OfStep<F>>,
    /// Speed at the end of the last step of a block, rad/s.
    omega_rad_s: F,
    /// Angle of the shaft at the end of the last step, as joints have seen it, rad.
    phi_rad: f64,
    split_s: f64,
    fastest_rad_s: f64,
}

impl<'m, F: Real> Path<'m, F> {
    pub(super) fn new(motion: &'m Motion, step_s: f64, steps: u64) -> Self {
        let walk = Walk::new(motion, step_s).in_parts::<F>();
        let omega_rad_s = walk.now().omega_rad_s;
        Self {
            walk,
            step_s,
            steps,
            pending: None,
            omega_rad_s: F::from_f64(omega_rad_s),
            phi_rad: 0.0,
            split_s: 0.0,
            fastest_rad_s: omega_rad_s.abs(),
        }
    }

    /// Number of steps that were given out.
    pub(super) fn steps_made(&self) -> u64 {
        self.walk.steps() - u64::from(self.pending.is_some())
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.steps_made() >= self.steps
    }

    /// Time reached, s.
    pub(super) fn time_s(&self) -> f64 {
        self.walk.time_s()
    }

    /// Highest speed so far, rad/s.
    pub(super) fn fastest_rad_s(&self) -> f64 {
        self.fastest_rad_s
    }

    /// Fills a block, up to a step at which states are checked; returns whether a [split step](Self::split_step)
    /// follows it.
    pub(super) fn next_block(&mut self, block: &mut Block<F>) -> bool {
        block.clear();
        let made = self.steps_made();
        let check = (made / CHECK_STEPS + 1) * CHECK_STEPS;
        let to = (made + BLOCK_STEPS).min(check).min(self.steps);
        while self.steps_made() < to {
            let step = match self.pending.take() {
                Some(step) => step,
                None => match self.whole_step() {
                    Some(step) => step,
                    None => return true,
                },
            };
            let from = step.seen.omega_start_rad_s;
            if from != self.omega_rad_s {
                if !block.steps.is_empty() {
                    self.pending = Some(step);
                    return false;
                }
                block.jumps_to = Some(from);
            }
            self.omega_rad_s = step.seen.omega_end_rad_s;
            block.push(step);
        }
        false
    }

    /// The step that followed the last block.
    pub(super) fn split_step(&self) -> SplitStep<'_> {
        SplitStep {
            start_s: self.split_s,
            parts: self.walk.parts(),
        }
    }

    /// The next step; `None` for one that the motion breaks.
    fn whole_step(&mut self) -> Option<OfStep<F>> {
        let start_s = self.walk.time_s();
        let Some((from, to)) = self.walk.step_or_parts() else {
            self.split_s = start_s;
            for part in self.walk.parts() {
                self.fastest_rad_s = self.fastest_rad_s.max(part.to.omega_rad_s.abs());
                let seen: ShaftStep<F> = Ideal.see(&part.from, &part.to);
                self.phi_rad += seen.delta_phi_rad.to_f64();
                self.omega_rad_s = seen.omega_end_rad_s;
            }
            return None;
        };
        self.fastest_rad_s = self.fastest_rad_s.max(to.omega_rad_s.abs());
        let seen: ShaftStep<F> = Ideal.see(&from, &to);
        self.phi_rad += seen.delta_phi_rad.to_f64();
        Some(OfStep {
            start_s,
            end_s: self.walk.time_s(),
            seen,
            stretch: whole_stretch(&seen, self.step_s),
            phi_rad: self.phi_rad,
        })
    }
}
