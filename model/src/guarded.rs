//! A joint that no input can poison.
//!
//! Between the sensor and the joint stands a check. A sample that is no
//! number, or that no shaft can make, never reaches the joint; neither does
//! one that was not taken at all. Meanwhile the last torque is held for a
//! bounded number of ticks and then let go of at a bounded rate. A few missing
//! ticks are made up for when the shaft is seen again; after more, the joint
//! goes on in a new stick that begins with the torque then shown.
//!
//! ```text
//! torque ──────held──────╲ released          ╱ a new stick, from what is shown
//!                          ╲____ 0 __________╱
//!        └ hold_ticks ┘   slew            shaft seen again
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

use crate::event::{EVENTS_PER_STEP, Event};
use crate::real::Real;
use crate::shaft::ShaftStep;
use crate::stick_slip::StickSlip;

/// The most missing ticks that are made up for, step by step.
pub const CATCH_UP_TICKS: u32 = 3;

/// What a tick brings from the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample<F> {
    /// The shaft's motion since the last sample that was taken.
    Taken(ShaftStep<F>),
    /// Nothing.
    Lost,
}

/// What is believed of a shaft, and how to go on without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputLimits<F> {
    /// The fastest shaft that is believed, rad/s.
    pub speed_rad_s: F,
    /// The largest change of its velocity in one tick, rad/s.
    pub jump_rad_s: F,
    /// How many ticks the last torque is held.
    pub hold_ticks: u32,
    /// How far the torque falls in a tick after that, N·m.
    pub release_nm: F,
}

impl<F: Real> InputLimits<F> {
    /// The device's: seven times the fastest its motor can turn the joint
    /// (420 deg/s), a millisecond of hold at 20 kHz, and release at
    /// 100 N·m/s.
    pub fn device(step_s: f64) -> Self {
        Self {
            speed_rad_s: F::from_f64(50.0),
            jump_rad_s: F::from_f64(10.0),
            hold_ticks: 20,
            release_nm: F::from_f64(100.0 * step_s),
        }
    }
}

/// What has happened to a guarded joint; counters stop at their largest value.
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

/// A joint behind a check of its input.
#[derive(Clone, Debug)]
pub struct Guarded<F, J> {
    joint: J,
    limits: InputLimits<F>,
    /// Travel of a tick that is believed, rad.
    reach_rad: F,
    counters: Counters,
    /// Ticks since the last good sample.
    missed: u32,
    held_nm: F,
    omega_rad_s: F,
}

impl<F: Real, J: StickSlip<F>> Guarded<F, J> {
    /// Guards a joint on a shaft that moves with `omega_rad_s`.
    pub fn new(joint: J, limits: InputLimits<F>, omega_rad_s: F) -> Self {
        Self {
            held_nm: joint.torque_nm(),
            // Twice: the speed within a gap may have been above that at its
            // ends, and a count comes whole.
            reach_rad: F::TWO * limits.speed_rad_s * joint.active().step_s,
            joint,
            limits,
            counters: Counters::default(),
            missed: 0,
            omega_rad_s,
        }
    }

    /// One tick. An event's fraction is that of the time since the last good
    /// sample, which is one tick unless some are missing.
    #[inline]
    pub fn tick(&mut self, sample: &Sample<F>, on_event: impl FnMut(Event<F>)) {
        match sample {
            Sample::Taken(shaft) if self.believes(shaft) => self.advance(shaft, on_event),
            Sample::Taken(_) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                self.hold();
            }
            Sample::Lost => {
                self.counters.lost = self.counters.lost.saturating_add(1);
                self.hold();
            }
        }
    }

    /// The torque shown: the joint's, or while the shaft is out of sight what
    /// is left of its last, N·m.
    #[inline]
    pub fn torque_nm(&self) -> F {
        if self.missed == 0 {
            self.joint.torque_nm()
        } else {
            self.joint.active().limited(self.held_nm)
        }
    }

    /// Whether the shaft is out of sight.
    #[inline]
    pub fn is_holding(&self) -> bool {
        self.missed > 0
    }

    /// Lets go of a torque that is held.
    pub fn let_go(&mut self) {
        self.held_nm = F::ZERO;
    }

    /// What has happened so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// The joint behind the check.
    #[inline]
    pub fn joint(&self) -> &J {
        &self.joint
    }

    /// The joint, to be changed between two ticks.
    #[inline]
    pub fn joint_mut(&mut self) -> &mut J {
        &mut self.joint
    }

    /// Whether a shaft can have made this step. A NaN passes no comparison.
    fn believes(&self, shaft: &ShaftStep<F>) -> bool {
        let l = &self.limits;
        let mut reach = self.reach_rad;
        if self.missed > 0 {
            reach = reach * F::from_whole(u64::from(self.missed).saturating_add(1));
        }
        shaft.omega_start_rad_s.abs() <= l.speed_rad_s
            && shaft.omega_end_rad_s.abs() <= l.speed_rad_s
            && (shaft.omega_end_rad_s - shaft.omega_start_rad_s).abs() <= l.jump_rad_s
            && shaft.delta_phi_rad.abs() <= reach
    }

    /// A tick without a shaft.
    fn hold(&mut self) {
        if self.missed == 0 {
            self.held_nm = self.joint.torque_nm();
        }
        self.missed = self.missed.saturating_add(1);
        if self.missed > self.limits.hold_ticks {
            let less = self.limits.release_nm;
            let left = F::ZERO.at_least(self.held_nm.abs() - less);
            self.held_nm = if self.held_nm < F::ZERO { -left } else { left };
        }
    }

    /// A tick with a shaft.
    #[inline]
    fn advance(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>)) {
        if self.missed > 0 {
            self.catch_up(shaft, on_event);
        } else {
            self.step(shaft, on_event);
        }
        self.missed = 0;
        self.omega_rad_s = shaft.omega_end_rad_s;
    }

    /// One step of the joint.
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let shaft = ShaftStep {
            delta_phi_rad: shaft.delta_phi_rad.settled(),
            omega_start_rad_s: shaft.omega_start_rad_s.settled(),
            omega_end_rad_s: shaft.omega_end_rad_s.settled(),
        };
        if self.joint.active().outlasts_a_stick(&shaft) {
            self.counters.long_steps = self.counters.long_steps.saturating_add(1);
        }
        let mut events = 0;
        self.joint.step(&shaft, |event| {
            events += 1;
            on_event(event);
        });
        if events >= EVENTS_PER_STEP {
            self.counters.crowded_steps = self.counters.crowded_steps.saturating_add(1);
        }
    }

    /// The held torque less what the spring loses where the shaft has gone
    /// back by this travel, N·m; never beyond zero.
    fn unwound_nm(&self, travel_rad: F) -> F {
        let held_nm = self.held_nm;
        let change_nm = self.joint.active().stiffness * travel_rad;
        if held_nm < F::ZERO {
            (held_nm + F::ZERO.at_least(change_nm)).at_most(F::ZERO)
        } else {
            (held_nm + F::ZERO.at_most(change_nm)).at_least(F::ZERO)
        }
    }

    /// The first good sample after missing ones.
    fn catch_up(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        if self.missed > CATCH_UP_TICKS {
            self.counters.restarts = self.counters.restarts.saturating_add(1);
            let torque_nm = self.unwound_nm(shaft.delta_phi_rad);
            self.joint.restart(torque_nm, shaft.omega_end_rad_s);
            return;
        }
        let ticks = self.missed + 1;
        let part = F::ONE / F::from_whole(u64::from(ticks));
        // Through the gap from where the shaft was last seen.
        let rise = (shaft.omega_end_rad_s - self.omega_rad_s) * part;
        for n in 0..ticks {
            let passed = F::from_whole(u64::from(n));
            let omega = self.omega_rad_s + rise * passed;
            let piece = ShaftStep {
                delta_phi_rad: shaft.delta_phi_rad * part,
                omega_start_rad_s: omega,
                omega_end_rad_s: if n + 1 == ticks {
                    shaft.omega_end_rad_s
                } else {
                    omega + rise
                },
            };
            self.step(&piece, |event| {
                on_event(Event {
                    fraction: (passed + event.fraction) * part,
                    ..event
                });
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frozen::Frozen;
    use crate::locate::ExactEvents;
    use crate::{Active, Phase, Settings};
    use std::vec::Vec;

    const TICK_S: f64 = 5e-5;

    /// A joint that does nothing but remember its steps.
    struct Remembers {
        active: Active<f32>,
        steps: Vec<ShaftStep<f32>>,
    }

    impl StickSlip<f32> for Remembers {
        fn step(&mut self, shaft: &ShaftStep<f32>, _: impl FnMut(Event<f32>)) {
            self.steps.push(*shaft);
        }

        fn restart(&mut self, _: f32, _: f32) {
            panic!("gaps here are short");
        }

        fn active(&self) -> &Active<f32> {
            &self.active
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
        let active = Active::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let steps = Vec::new();
        Guarded::new(
            Remembers { active, steps },
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
        let active = Active::new(&Settings::default().validate().unwrap(), TICK_S).unwrap();
        let mut joint = Guarded::new(
            Frozen::<f32, ExactEvents>::new(active, 0.0),
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
                // Forward: what was shown goes on.
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
        // Some of it was let go of before.
        let found = after_a_gap(0.3, 40, -1.25e-4);
        assert!((found - (0.3 - 0.1 - 0.05)).abs() < 1e-6, "{found}");
    }
}
