//! Hold and release of the torque while samples are missing, and the resume.
//!
//! While samples are missing the last torque is held for a bounded number of
//! ticks and then released at a bounded rate. A few missing ticks are caught up
//! with the next valid sample; after more, the joint resumes in a new stick that
//! begins with the present torque.
//!
//! ```text
//! torque ──────held──────╲ released          ╱ a new stick, from the present torque
//!                          ╲____ 0 __________╱
//!        └ hold_ticks ┘   slew            valid samples again
//! ```
//!
//! A held torque T pushes a hand that retreats by x meanwhile, and returns T·x.
//! The new stick must not hold that energy a second time, so it begins with
//! less, by as much as the spring would have unwound:
//!
//! ```text
//! |T′| = max(0, |T| − kr·x)      T·x ≤ (T² − T′²)/2kr + ½·kr·x²
//! ```
//!
//! With x² ≤ N·h·∫Ω² dt over the N ticks of the gap, a gap returns no more than
//! a spring that is sampled once in N ticks: ½·N·kr·h·∫Ω² dt.
//!
//! A tick costs at most `CATCH_UP_TICKS` + 1 steps of the joint, and each of
//! these at most [`EVENTS_PER_STEP`] events.

use super::input_check::{Checked, Gap, InputLimits};
use crate::joint::{EVENTS_PER_STEP, Event, ShaftStep, StickSlip};
use crate::real::Real;

/// Counters of a joint; they saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointCounters {
    /// Gaps after which the joint went on in a new stick.
    pub restarts: u32,
    /// Steps in which the shaft moved further than a stick lasts, so that a
    /// solver without located events may have missed one.
    pub long_steps: u32,
    /// Steps with as many events as a step may have: more may have followed.
    pub crowded_steps: u32,
}

/// A joint on checked samples.
#[derive(Clone, Debug)]
pub struct Held<F, J> {
    joint: J,
    hold_ticks: u32,
    release_nm: F,
    counters: JointCounters,
    is_holding: bool,
    kept_nm: F,
}

impl<F: Real, J: StickSlip<F>> Held<F, J> {
    /// Creates it with these limits for missing samples.
    pub fn new(joint: J, limits: &InputLimits<F>) -> Self {
        Self {
            kept_nm: joint.torque_nm(),
            joint,
            hold_ticks: limits.hold_ticks,
            release_nm: limits.release_nm,
            counters: JointCounters::default(),
            is_holding: false,
        }
    }

    /// One tick. An event's fraction is that of the time since the last good
    /// sample, which is one tick unless some are missing.
    #[inline]
    pub fn follow(&mut self, input: &Checked<F>, on_event: impl FnMut(Event<F>)) {
        match input {
            Checked::Step(shaft) => self.step(shaft, on_event),
            Checked::CatchUp(gap) => self.catch_up(gap, on_event),
            Checked::Resume(gap) => self.resume(&gap.shaft),
            Checked::Missing(ticks) => {
                self.hold(*ticks);
                return;
            }
        }
        self.is_holding = false;
    }

    /// The torque shown: the joint's, or while the shaft is out of sensing what
    /// is left of its last, N·m.
    #[inline]
    pub fn torque_nm(&self) -> F {
        if self.is_holding {
            self.joint.coefficients().limited(self.kept_nm)
        } else {
            self.joint.torque_nm()
        }
    }

    /// Returns whether samples are missing.
    #[inline]
    pub fn is_holding(&self) -> bool {
        self.is_holding
    }

    /// Lets go of a torque that is held.
    pub fn release(&mut self) {
        self.kept_nm = F::ZERO;
    }

    /// The counters.
    pub fn counters(&self) -> JointCounters {
        self.counters
    }

    /// The joint itself.
    #[inline]
    pub fn joint(&self) -> &J {
        &self.joint
    }

    /// The joint, to be changed between two ticks.
    #[inline]
    pub fn joint_mut(&mut self) -> &mut J {
        &mut self.joint
    }

    /// The `ticks`-th tick in a row without a shaft.
    #[cold]
    fn hold(&mut self, ticks: u32) {
        if !self.is_holding {
            self.kept_nm = self.joint.torque_nm();
            self.is_holding = true;
        }
        if ticks > self.hold_ticks {
            let less = self.release_nm;
            let left = F::ZERO.at_least(self.kept_nm.abs() - less);
            self.kept_nm = if self.kept_nm < F::ZERO { -left } else { left };
        }
    }

    /// One step of the joint.
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let shaft = ShaftStep {
            delta_phi_rad: shaft.delta_phi_rad.settled(),
            omega_start_rad_s: shaft.omega_start_rad_s.settled(),
            omega_end_rad_s: shaft.omega_end_rad_s.settled(),
        };
        if self
            .joint
            .coefficients()
            .outlasts_a_stick(shaft.delta_phi_rad)
        {
            count(&mut self.counters.long_steps);
        }
        let mut events = 0;
        self.joint.step(&shaft, |event| {
            events += 1;
            on_event(event);
        });
        if events >= EVENTS_PER_STEP {
            count(&mut self.counters.crowded_steps);
        }
    }

    /// The held torque less what the spring loses where the shaft has gone
    /// back by this travel, N·m; never beyond zero.
    fn unwound_nm(&self, travel_rad: F) -> F {
        let held_nm = self.kept_nm;
        let change_nm = self.joint.coefficients().stiffness * travel_rad;
        if held_nm < F::ZERO {
            (held_nm + F::ZERO.at_least(change_nm)).at_most(F::ZERO)
        } else {
            (held_nm + F::ZERO.at_most(change_nm)).at_least(F::ZERO)
        }
    }

    /// Resumes at the first valid sample after a gap too long to catch up.
    #[cold]
    fn resume(&mut self, shaft: &ShaftStep<F>) {
        count(&mut self.counters.restarts);
        let torque_nm = self.unwound_nm(shaft.delta_phi_rad);
        self.joint.restart(torque_nm, shaft.omega_end_rad_s);
    }

    /// The first good sample after a few missing ones.
    #[cold]
    fn catch_up(&mut self, gap: &Gap<F>, mut on_event: impl FnMut(Event<F>)) {
        let part = gap.part();
        for (passed, piece) in gap.steps() {
            self.step(&piece, |event| {
                on_event(Event {
                    fraction: (passed + event.fraction) * part,
                    ..event
                });
            });
        }
    }
}

/// Increments a saturating counter.
#[cold]
fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
