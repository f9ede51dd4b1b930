//! Crepitus, the first symptom: the frozen joint with parameters that change
//! while it runs, and no push from a slip whose hand has turned back.
//!
//! ```text
//! checked sample ─> joint ─> turn-back guard ─> torque to show
//!                     ↑
//!           commit ─> ramp
//! ```

use super::guarded::Counters;
use super::held::{Held, JointCounters};
use super::input_check::{Checked, InputCheck, InputLimits, Sample};
use super::position::Position;
use super::ramp::Ramp;
use super::turn_back::TurnBack;
use super::{Limit, Pipeline, ShaftEstimate, Shown, Symptom, Torque};
use crate::joint::shaft::Linear;
use crate::joint::{Event, StepCoefficients, StickSlip};
use crate::real::Real;
use crate::solver::frozen::Frozen;
use crate::solver::locate::Locate;

/// The joint as a device renders it.
#[derive(Clone, Debug)]
pub struct Crepitus<F, L> {
    held: Held<F, Frozen<F, L>>,
    ramp: Ramp<F>,
    turn_back: TurnBack<F>,
}

/// A pipeline with this symptom and nothing after it.
pub type Renderer<F, L> = Pipeline<F, InputCheck<F>, Crepitus<F, L>>;

impl<F: Real, L: Locate<F, Shape = Linear>> Crepitus<F, L> {
    /// A joint in stick at θ = 0 on a shaft that moves with `omega_rad_s`,
    /// seen by an encoder with this angle of one count.
    pub fn new(
        coefficients: StepCoefficients<F>,
        limits: InputLimits<F>,
        rad_per_count: F,
        omega_rad_s: F,
    ) -> Self {
        Self {
            held: Held::new(Frozen::new(coefficients, omega_rad_s), &limits),
            ramp: Ramp::at(coefficients),
            turn_back: TurnBack::new(rad_per_count),
        }
    }

    /// Moves towards these numbers from the next tick on, no torque faster than
    /// `slew_nm_per_s`. A change that is still under way ends where it is.
    pub fn commit(&mut self, next: StepCoefficients<F>, slew_nm_per_s: f64) {
        let now = *self.held.joint().coefficients();
        self.follow(Ramp::new(now, next, slew_nm_per_s));
    }

    /// [`Self::commit`] along a ramp that was made elsewhere: it must
    /// start with the active coefficients, so none may be in progress.
    pub fn follow(&mut self, ramp: Ramp<F>) {
        self.ramp = ramp;
    }

    /// While samples are missing, the torque that is held, N·m.
    pub fn held_nm(&self) -> Option<F> {
        self.held.is_holding().then(|| self.held.torque_nm())
    }

    /// The joint behind it all.
    pub fn joint(&self) -> &Frozen<F, L> {
        self.held.joint()
    }

    /// The counters.
    pub fn counters(&self) -> JointCounters {
        self.held.counters()
    }
}

impl<F: Real, L: Locate<F, Shape = Linear>> Symptom<F> for Crepitus<F, L> {
    #[inline]
    fn tick(
        &mut self,
        input: &Checked<F>,
        shown: &mut Shown<F>,
        mut on_event: impl FnMut(Event<F>),
    ) -> Torque<F> {
        if let Some(coefficients) = self.ramp.advance() {
            self.held.joint_mut().adjust(coefficients);
        }
        // By itself: what is shown would live in memory if a part of it were lent.
        let mut jump_nm = F::ZERO;
        self.held.follow(input, |event| {
            jump_nm += event.torque_after_nm - event.torque_before_nm;
            on_event(event);
        });
        shown.jump_nm = jump_nm;
        let joint = self.held.joint();
        let model_nm = joint.torque_nm();
        let is_missing = matches!(input, Checked::Missing(_));
        if let Some(travel_rad) = input.travel_rad() {
            self.turn_back
                .moved(travel_rad, joint.phase(), joint.slip_number());
        }
        shown.phase = joint.phase();
        shown.settling = self.ramp.is_settling();
        let shown_nm = if self.turn_back.is_turned() {
            shown.limit = Limit::TurnedBack;
            if is_missing {
                // Hold the torque that was output.
                self.held.release();
            }
            F::ZERO
        } else if is_missing {
            shown.limit = Limit::Holding;
            self.held.torque_nm()
        } else {
            model_nm
        };
        Torque { shown_nm, model_nm }
    }
}

impl<F: Real, L: Locate<F, Shape = Linear>> Renderer<F, L> {
    /// See [`Crepitus::new`].
    pub fn of(
        coefficients: StepCoefficients<F>,
        limits: InputLimits<F>,
        rad_per_count: F,
        omega_rad_s: F,
    ) -> Self {
        let step_s = coefficients.step_s;
        Self::new(
            InputCheck::new(&limits, step_s, omega_rad_s),
            Crepitus::new(coefficients, limits, rad_per_count, omega_rad_s),
            (),
            (),
        )
    }

    /// One tick.
    #[inline]
    pub fn render(&mut self, sample: &Sample<F>, on_event: impl FnMut(Event<F>)) -> Shown<F> {
        // No later stage uses the rest.
        let seen = ShaftEstimate {
            sample: *sample,
            omega_rad_s: F::ZERO,
            place: Position::at(0),
            is_driven: true,
        };
        self.tick(&seen, on_event)
    }

    /// See [`Crepitus::commit`].
    pub fn commit(&mut self, next: StepCoefficients<F>, slew_nm_per_s: f64) {
        self.symptoms.commit(next, slew_nm_per_s);
    }

    /// The joint behind it all.
    pub fn joint(&self) -> &Frozen<F, L> {
        self.symptoms.joint()
    }

    /// The counters.
    pub fn counters(&self) -> Counters {
        Counters::new(self.check.counters(), self.symptoms.counters())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::locate::ExactEvents;
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
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let limits = InputLimits::device(TICK_S);
        let mut renderer = Renderer::of(coefficients, limits, COUNT_RAD, 1.0);
        for _ in 0..ticks {
            renderer.render(&moved(5e-5), |_| {});
        }
        renderer
    }

    #[test]
    fn missing_samples_are_reported_and_the_torque_held() {
        let mut renderer = after(10);
        let shown = renderer.render(&Sample::Lost, |_| {});
        assert_eq!((shown.limit, shown.settling), (Limit::Holding, false));
        assert!((shown.torque_nm - 0.2).abs() < 1e-6);
        assert_eq!(shown.torque_nm, shown.model_torque_nm);
        let shown = renderer.render(&moved(1e-4), |_| {});
        assert_eq!(shown.limit, Limit::None);
        assert!((shown.torque_nm - 0.24).abs() < 1e-6);
    }

    #[test]
    fn it_settles_from_a_commit_to_the_end_of_its_ramp() {
        let mut renderer = after(100);
        let mut settings = Settings::default();
        settings.parameters.static_torque_nm += 0.05;
        let next = StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap();
        renderer.commit(next, 100.0);
        // 5 mN·m a tick.
        let settling: std::vec::Vec<bool> = (0..12)
            .map(|_| renderer.render(&moved(5e-5), |_| {}).settling)
            .collect();
        let settles = settling.iter().filter(|is_settling| **is_settling).count();
        assert!((9..=10).contains(&settles) && settling[0], "{settling:?}");
    }

    /// Jumps of the torque, which ring a bone.
    #[test]
    fn the_jumps_of_a_tick_are_those_of_its_events() {
        let mut renderer = after(0);
        let mut jumps = 0;
        for _ in 0..4_000 {
            let mut jump_nm = 0.0;
            let shown = renderer.render(&moved(5e-5), |event| {
                jump_nm += event.torque_after_nm - event.torque_before_nm;
            });
            assert_eq!(shown.jump_nm, jump_nm);
            jumps += u32::from(jump_nm != 0.0);
        }
        assert!(jumps > 2);
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
            let shown = renderer.render(&sample, |_| {});
            assert_eq!(shown.limit, Limit::Holding, "{sample:?}");
            assert_eq!(shown.torque_nm, 0.2);
        }
        // Seen to be that far back, it has turned.
        let shown = renderer.render(&moved(-3.0 * COUNT_RAD), |_| {});
        assert_eq!(shown.limit, Limit::TurnedBack);
        assert_eq!(renderer.symptoms.held_nm(), None);
        assert_eq!((shown.torque_nm, shown.model_torque_nm), (0.0, 0.2));
        // With missing samples the output is held: zero.
        let shown = renderer.render(&Sample::Lost, |_| {});
        assert_eq!(shown.limit, Limit::TurnedBack);
        assert!(renderer.symptoms.held_nm().is_some());
        assert_eq!(shown.torque_nm, 0.0);
        let stick = (0..2000).find(|_| {
            renderer.render(&moved(5e-5), |_| {});
            renderer.joint().phase() == Phase::Stick
        });
        assert!(stick.is_some());
        assert_eq!(renderer.render(&moved(5e-5), |_| {}).limit, Limit::None);
    }

    #[test]
    fn what_happens_is_counted() {
        let mut renderer = after(10);
        assert_eq!(renderer.counters(), Counters::default());
        for sample in [Sample::Lost, Sample::Lost, moved(f32::NAN)] {
            renderer.render(&sample, |_| {});
        }
        for _ in 0..3 {
            renderer.render(&Sample::Lost, |_| {});
        }
        renderer.render(&moved(5e-5), |_| {});
        // 30 rad/s: further than the millirad of a stick.
        let fast = |start, end| {
            Sample::Taken(ShaftStep {
                delta_phi_rad: 1.5e-3,
                omega_start_rad_s: start,
                omega_end_rad_s: end,
            })
        };
        renderer.render(&fast(1.0, 9.0), |_| {});
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
