//! A joint protected from invalid input: the [check](super::input_check) of its
//! samples, and the [hold](super::held) while they are missing.

use super::Check;
use super::held::{Held, JointCounters};
use super::input_check::{InputCheck, InputCounters, InputLimits, Sample};
use crate::joint::{Event, StickSlip};
use crate::real::Real;

/// Counters of a guarded joint; they saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Samples that were not taken.
    pub lost: u32,
    /// Samples that were refused: no numbers, or no motion of a shaft.
    pub refused: u32,
    /// Gaps after which the joint went on in a new stick.
    pub restarts: u32,
    /// Steps in which the shaft moved further than a stick lasts, so that a
    /// solver without located events may have missed one.
    pub long_steps: u32,
    /// Steps with as many events as a step may have: more may have followed.
    pub crowded_steps: u32,
}

impl Counters {
    pub(super) fn new(input: InputCounters, joint: JointCounters) -> Self {
        Self {
            lost: input.lost,
            refused: input.refused,
            restarts: joint.restarts,
            long_steps: joint.long_steps,
            crowded_steps: joint.crowded_steps,
        }
    }
}

/// A joint behind a check of its input.
#[derive(Clone, Debug)]
pub struct Guarded<F, J> {
    check: InputCheck<F>,
    held: Held<F, J>,
}

impl<F: Real, J: StickSlip<F>> Guarded<F, J> {
    /// Guards a joint on a shaft that moves with `omega_rad_s`.
    pub fn new(joint: J, limits: InputLimits<F>, omega_rad_s: F) -> Self {
        Self {
            check: InputCheck::new(&limits, joint.coefficients().step_s, omega_rad_s),
            held: Held::new(joint, &limits),
        }
    }

    /// One tick; see [`Held::follow`].
    #[inline]
    pub fn tick(&mut self, sample: &Sample<F>, on_event: impl FnMut(Event<F>)) {
        let input = self.check.check(sample);
        self.held.follow(&input, on_event);
    }

    /// The torque shown, N·m.
    #[inline]
    pub fn torque_nm(&self) -> F {
        self.held.torque_nm()
    }

    /// Returns whether samples are missing and the torque is held.
    #[inline]
    pub fn is_holding(&self) -> bool {
        self.held.is_holding()
    }

    /// Lets go of a torque that is held.
    pub fn release(&mut self) {
        self.held.release();
    }

    /// The counters.
    pub fn counters(&self) -> Counters {
        Counters::new(self.check.counters(), self.held.counters())
    }

    /// The joint behind the check.
    #[inline]
    pub fn joint(&self) -> &J {
        self.held.joint()
    }

    /// The joint, to be changed between two ticks.
    #[inline]
    pub fn joint_mut(&mut self) -> &mut J {
        self.held.joint_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::ShaftStep;
    use crate::render::input_check::CATCH_UP_TICKS;
    use crate::solver::frozen::Frozen;
    use crate::solver::locate::ExactEvents;
    use crate::{Phase, Settings, StepCoefficients};
    use std::vec::Vec;

    const TICK_S: f64 = 5e-5;

    /// A joint that only records its steps.
    struct Remembers {
        coefficients: StepCoefficients<f32>,
        steps: Vec<ShaftStep<f32>>,
    }

    impl StickSlip<f32> for Remembers {
        fn step(&mut self, shaft: &ShaftStep<f32>, _: impl FnMut(Event<f32>)) {
            self.steps.push(*shaft);
        }

        fn restart(&mut self, _: f32, _: f32) {
            panic!("gaps here are short");
        }

        fn change_step(&mut self, coefficients: StepCoefficients<f32>) {
            self.coefficients = coefficients;
        }

        fn coefficients(&self) -> &StepCoefficients<f32> {
            &self.coefficients
        }

        fn phase(&self) -> Phase {
            Phase::Stick
        }

        fn torque_nm(&self) -> f32 {
            0.0
        }

        fn theta_rad(&self) -> f32 {
            0.0
        }

        fn theta_dot_rad_s(&self) -> f32 {
            0.0
        }
    }

    fn guarded(omega: f32) -> Guarded<f32, Remembers> {
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let steps = Vec::new();
        Guarded::new(
            Remembers {
                coefficients,
                steps,
            },
            InputLimits::device(TICK_S),
            omega,
        )
    }

    #[test]
    fn without_a_gap_a_joint_gets_the_steps_as_they_are() {
        // Also one whose velocity jumps at its start.
        let mut joint = guarded(1.0);
        let steps = [(1.0, 1.1), (1.1, 0.7), (-2.0, -1.0), (3.0, 3.0)].map(|(a, b)| ShaftStep {
            delta_phi_rad: 3e-5,
            omega_start_rad_s: a,
            omega_end_rad_s: b,
        });
        for step in steps {
            joint.tick(&Sample::Taken(step), |_| {});
        }
        assert_eq!(joint.joint().steps, steps);
    }

    #[test]
    fn a_gap_is_crossed_on_a_straight_line_that_meets_both_its_ends() {
        for missing in 1..=CATCH_UP_TICKS {
            for n in 0..200_u16 {
                let (from, to) = (f32::from(n) * 0.037 - 3.0, 4.1 - f32::from(n) * 0.043);
                let mut joint = guarded(from);
                for _ in 0..missing {
                    joint.tick(&Sample::Lost, |_| {});
                }
                let seen = ShaftStep {
                    delta_phi_rad: 2e-4,
                    omega_start_rad_s: from,
                    omega_end_rad_s: to,
                };
                joint.tick(&Sample::Taken(seen), |_| {});
                let steps = &joint.joint().steps;
                assert_eq!(steps.len(), missing as usize + 1);
                // To the bit at both ends: a rounding error would be a jump.
                assert_eq!(steps[0].omega_start_rad_s, from);
                assert_eq!(steps.last().unwrap().omega_end_rad_s, to);
                let rise = (to - from) / f32::from(u8::try_from(missing + 1).unwrap());
                for step in steps {
                    let own = step.omega_end_rad_s - step.omega_start_rad_s;
                    assert!((own - rise).abs() < 2e-6, "{own} {rise}");
                }
                for pair in steps.windows(2) {
                    assert!((pair[1].omega_start_rad_s - pair[0].omega_end_rad_s).abs() < 2e-6);
                }
                let travel: f32 = steps.iter().map(|s| s.delta_phi_rad).sum();
                assert!((travel - 2e-4).abs() < 1e-10);
            }
        }
    }

    /// The torque after a gap of `missing` ticks in which a stick that showed
    /// `held_nm` travelled by `travel_rad`.
    fn after_a_gap(held_nm: f32, missing: u32, travel_rad: f32) -> f32 {
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let mut joint = Guarded::new(
            Frozen::<f32, ExactEvents>::new(coefficients, 0.0),
            InputLimits::device(TICK_S),
            0.0,
        );
        joint.joint_mut().restart(held_nm, 0.0);
        for _ in 0..missing {
            joint.tick(&Sample::Lost, |_| panic!("no event without a shaft"));
        }
        let seen = ShaftStep {
            delta_phi_rad: travel_rad,
            ..ShaftStep::default()
        };
        joint.tick(&Sample::Taken(seen), |_| panic!("a stick begins"));
        joint.torque_nm()
    }

    #[test]
    fn a_hand_that_retreats_in_a_gap_finds_less_in_the_spring() {
        for missing in [4, 10, 19, 20] {
            for (held, travel, expected) in [
                // Back by as much as unwinds a quarter, all, and more than all.
                (0.3, -1.875e-4, 0.225),
                (0.3, -7.5e-4, 0.0),
                (0.3, -2e-3, 0.0),
                // Forward: the held torque continues.
                (0.3, 2e-3, 0.3),
                (0.3, 0.0, 0.3),
                (0.0, -1e-3, 0.0),
            ] {
                let found = after_a_gap(held, missing, travel);
                assert!((found - expected).abs() < 1e-6, "{held} {travel}: {found}");
                let mirrored = after_a_gap(-held, missing, -travel);
                assert_eq!(mirrored, -found);
            }
        }
        // Part of it was released before.
        let found = after_a_gap(0.3, 40, -1.25e-4);
        assert!((found - (0.3 - 0.1 - 0.05)).abs() < 1e-6, "{found}");
    }
}
