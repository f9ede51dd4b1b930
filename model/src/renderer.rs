//! What the device renders: the frozen joint behind the check of its input,
//! with parameters that change while it runs and no push from a slip whose
//! hand has turned back.
//!
//! ```text
//! sample ─> input check ─> joint ─> turn-back guard ─> torque to show
//!                            ↑
//! commit ─> ramp ─> numbers of the tick
//! ```

use crate::active::Active;
use crate::event::Event;
use crate::frozen::Frozen;
use crate::guarded::{Counters, Guarded, InputLimits, Sample};
use crate::locate::Locate;
use crate::ramp::Ramp;
use crate::real::Real;
use crate::stick_slip::StickSlip;
use crate::turn_back::TurnBack;

/// What a tick shows, and why it may not be the joint's own torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown<F> {
    /// The torque to show, N·m.
    pub torque_nm: F,
    /// The joint's own torque, N·m.
    pub model_torque_nm: F,
    /// Parameters are on their way.
    pub settling: bool,
    /// The shaft is out of sight: the torque is held, or being released.
    pub holding: bool,
    /// The hand has turned back inside a slip: the torque is zero.
    pub turned_back: bool,
}

/// The joint as the device renders it.
#[derive(Clone, Debug)]
pub struct Renderer<F, L> {
    object: Guarded<F, Frozen<F, L>>,
    ramp: Ramp<F>,
    turn_back: TurnBack<F>,
}

impl<F: Real, L: Locate<F>> Renderer<F, L> {
    /// A joint in stick at θ = 0 on a shaft that moves with `omega_rad_s`,
    /// seen by an encoder with this angle of one count.
    pub fn new(
        active: Active<F>,
        limits: InputLimits<F>,
        rad_per_count: F,
        omega_rad_s: F,
    ) -> Self {
        Self {
            object: Guarded::new(Frozen::new(active, omega_rad_s), limits, omega_rad_s),
            ramp: Ramp::at(active),
            turn_back: TurnBack::new(rad_per_count),
        }
    }

    /// From the next tick on, towards these numbers, no torque faster than
    /// `slew_nm_per_s`. A change that is still under way ends where it is.
    pub fn commit(&mut self, next: Active<F>, slew_nm_per_s: f64) {
        self.ramp = Ramp::new(*self.object.joint().active(), next, slew_nm_per_s);
    }

    /// One tick.
    #[inline]
    pub fn tick(&mut self, sample: &Sample<F>, on_event: impl FnMut(Event<F>)) -> Shown<F> {
        if let Some(active) = self.ramp.advance() {
            self.object.joint_mut().adjust(active);
        }
        self.object.tick(sample, on_event);
        let joint = self.object.joint();
        match sample {
            Sample::Taken(shaft) if !self.object.is_holding() => {
                self.turn_back
                    .moved(shaft.delta_phi_rad, joint.phase(), joint.slip_number());
            }
            _ => {}
        }
        let turned_back = self.turn_back.is_turned();
        if turned_back && self.object.is_holding() {
            // What is held is what was shown.
            self.object.let_go();
        }
        Shown {
            torque_nm: if turned_back {
                F::ZERO
            } else {
                self.object.torque_nm()
            },
            model_torque_nm: self.object.joint().torque_nm(),
            settling: self.ramp.is_settling(),
            holding: self.object.is_holding(),
            turned_back,
        }
    }

    /// The joint behind it all.
    pub fn joint(&self) -> &Frozen<F, L> {
        self.object.joint()
    }

    /// What has happened so far.
    pub fn counters(&self) -> Counters {
        self.object.counters()
    }
}
