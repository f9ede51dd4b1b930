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
use crate::shaft::Linear;
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

impl<F: Real, L: Locate<F, Shape = Linear>> Renderer<F, L> {
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
        self.follow(Ramp::new(
            *self.object.joint().active(),
            next,
            slew_nm_per_s,
        ));
    }

    /// As [`Self::commit`], along a ramp that was made elsewhere: it must
    /// begin with the numbers in force, so none may be under way.
    pub fn follow(&mut self, ramp: Ramp<F>) {
        self.ramp = ramp;
    }

    /// Whether parameters are on their way.
    pub fn is_settling(&self) -> bool {
        self.ramp.is_settling()
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
        let model_torque_nm = self.object.joint().torque_nm();
        Shown {
            torque_nm: if turned_back {
                F::ZERO
            } else if self.object.is_holding() {
                self.object.torque_nm()
            } else {
                model_torque_nm
            },
            model_torque_nm,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::locate::ExactEvents;
    use crate::{Phase, Settings, ShaftStep};

    const TICK_S: f64 = 5e-5;
    const COUNT_RAD: f32 = 3.6e-5;

    fn moved(delta_phi_rad: f32) -> Sample<f32> {
        Sample::Taken(ShaftStep {
            delta_phi_rad,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 1.0,
        })
    }

    /// One that has gone on for so many ticks of 50 µrad: 10 are a stick at
    /// 0.2 N·m, 40 the middle of a slip.
    fn after(ticks: u32) -> Renderer<f32, ExactEvents> {
        let active = Active::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let limits = InputLimits::device(TICK_S);
        let mut renderer = Renderer::new(active, limits, COUNT_RAD, 1.0);
        for _ in 0..ticks {
            renderer.tick(&moved(5e-5), |_| {});
        }
        renderer
    }

    #[test]
    fn a_shaft_out_of_sight_is_said_to_be_and_its_torque_held() {
        let mut renderer = after(10);
        let shown = renderer.tick(&Sample::Lost, |_| {});
        assert!(shown.holding && !shown.turned_back && !shown.settling);
        assert!((shown.torque_nm - 0.2).abs() < 1e-6);
        assert_eq!(shown.torque_nm, shown.model_torque_nm);
        let shown = renderer.tick(&moved(1e-4), |_| {});
        assert!(!shown.holding);
        assert!((shown.torque_nm - 0.24).abs() < 1e-6);
    }

    #[test]
    fn a_sample_that_is_refused_is_no_turning_back() {
        let mut renderer = after(40);
        assert_eq!(renderer.joint().phase().sign(), 1);
        // Three counts back: but no shaft has this speed.
        let refused = Sample::Taken(ShaftStep {
            delta_phi_rad: -3.0 * COUNT_RAD,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 60.0,
        });
        for sample in [refused, moved(-1.0), moved(f32::NAN)] {
            let shown = renderer.tick(&sample, |_| {});
            assert!(shown.holding && !shown.turned_back, "{sample:?}");
            assert_eq!(shown.torque_nm, 0.2);
        }
        // Seen to be that far back, it has turned.
        let shown = renderer.tick(&moved(-3.0 * COUNT_RAD), |_| {});
        assert!(shown.turned_back && !shown.holding);
        assert_eq!((shown.torque_nm, shown.model_torque_nm), (0.0, 0.2));
        // Out of sight then, what was shown is held: nothing.
        let shown = renderer.tick(&Sample::Lost, |_| {});
        assert!(shown.turned_back && shown.holding);
        assert_eq!(shown.torque_nm, 0.0);
        let stick = (0..2000).find(|_| {
            renderer.tick(&moved(5e-5), |_| {});
            renderer.joint().phase() == Phase::Stick
        });
        assert!(stick.is_some());
        assert!(!renderer.tick(&moved(5e-5), |_| {}).turned_back);
    }

    #[test]
    fn what_happens_is_counted() {
        let mut renderer = after(10);
        assert_eq!(renderer.counters(), Counters::default());
        for sample in [Sample::Lost, Sample::Lost, moved(f32::NAN)] {
            renderer.tick(&sample, |_| {});
        }
        for _ in 0..3 {
            renderer.tick(&Sample::Lost, |_| {});
        }
        renderer.tick(&moved(5e-5), |_| {});
        // 30 rad/s: further than the millirad of a stick.
        let fast = |start, end| {
            Sample::Taken(ShaftStep {
                delta_phi_rad: 1.5e-3,
                omega_start_rad_s: start,
                omega_end_rad_s: end,
            })
        };
        renderer.tick(&fast(1.0, 9.0), |_| {});
        assert_eq!(
            renderer.counters(),
            Counters {
                lost: 5,
                refused: 1,
                restarts: 1,
                long_steps: 1,
                crowded_steps: 0,
            }
        );
    }
}
