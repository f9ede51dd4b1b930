//! Plausibility check of samples.
//!
//! A sample that is NaN, implausible or missing never reaches a symptom. A few
//! missing ticks are caught up with the next valid sample; after a longer gap
//! symptoms get the present position, but not the path to it.

use super::Check;
use crate::joint::ShaftStep;
use crate::real::Real;

/// The most missing ticks that are caught up, step by step.
pub const CATCH_UP_TICKS: u32 = 3;

/// Ticks for which a torque is held without samples; then it is released.
pub const HOLD_TICKS: u32 = 20;

/// Sample of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample<F> {
    /// The shaft's motion since the last sample that was taken.
    Taken(ShaftStep<F>),
    /// No sample.
    Lost,
}

/// Checked sample, for the symptoms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Checked<F> {
    /// One step of the shaft.
    Step(ShaftStep<F>),
    /// The shaft is seen again after a few missing ticks.
    CatchUp(Gap<F>),
    /// The first valid sample after a gap too long to catch up; the step has
    /// the travel since, and the present velocity.
    Resume(Gap<F>),
    /// No valid sample, for this many ticks so far.
    Missing(u32),
}

impl<F: Real> Checked<F> {
    /// Travel of the shaft since it was seen last, rad; `None` while it
    /// is out of sensing.
    #[inline]
    pub fn travel_rad(&self) -> Option<F> {
        match self {
            Self::Step(shaft)
            | Self::Resume(Gap { shaft, .. })
            | Self::CatchUp(Gap { shaft, .. }) => Some(shaft.delta_phi_rad),
            Self::Missing(_) => None,
        }
    }
}

/// Ticks without a sample, and the step that ends them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<F> {
    /// The motion since the last good sample.
    pub shaft: ShaftStep<F>,
    /// Ticks that are missing.
    pub missed: u32,
    /// Velocity at the last good sample, rad/s.
    pub omega_rad_s: F,
}

impl<F: Real> Gap<F> {
    /// Steps of the gap, along a straight line of the velocity that meets both ends,
    /// each with the ticks before it.
    #[inline]
    pub fn steps(&self) -> impl Iterator<Item = (F, ShaftStep<F>)> {
        let ticks = self.missed.saturating_add(1);
        let part = self.part();
        let (from, to) = (self.omega_rad_s, self.shaft.omega_end_rad_s);
        let rise = (to - from) * part;
        let travel_rad = self.shaft.delta_phi_rad * part;
        (0..ticks).map(move |n| {
            let passed = F::from_whole(u64::from(n));
            let omega = from + rise * passed;
            let piece = ShaftStep {
                delta_phi_rad: travel_rad,
                omega_start_rad_s: omega,
                // To the bit at both ends: a rounding error would be a jump.
                omega_end_rad_s: if n.saturating_add(1) == ticks {
                    to
                } else {
                    omega + rise
                },
            };
            (passed, piece)
        })
    }

    /// A tick's share of it.
    #[inline]
    pub fn part(&self) -> F {
        F::ONE / F::from_whole(u64::from(self.missed.saturating_add(1)))
    }
}

/// Limits of plausible samples, and of holding without them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputLimits<F> {
    /// The fastest plausible shaft, rad/s.
    pub speed_rad_s: F,
    /// The largest change of its velocity in one tick, rad/s.
    pub jump_rad_s: F,
    /// Ticks for which the last torque is held.
    pub hold_ticks: u32,
    /// Amount by which the torque falls in a tick after that, N·m.
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
            hold_ticks: HOLD_TICKS,
            release_nm: F::from_f64(100.0 * step_s),
        }
    }
}

/// Counters of rejected samples; they saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputCounters {
    /// Samples that were not taken.
    pub lost: u32,
    /// Samples that were refused: no numbers, or no motion of a shaft.
    pub refused: u32,
}

/// The check of a device's input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputCheck<F> {
    speed_rad_s: F,
    jump_rad_s: F,
    /// Largest plausible travel of a tick, rad.
    reach_rad: F,
    counters: InputCounters,
    /// Ticks since the last good sample.
    missed: u32,
    omega_rad_s: F,
}

impl<F: Real> InputCheck<F> {
    /// Check for ticks of `step_s` and a shaft that moves with `omega_rad_s`.
    pub fn new(limits: &InputLimits<F>, step_s: F, omega_rad_s: F) -> Self {
        Self {
            speed_rad_s: limits.speed_rad_s,
            jump_rad_s: limits.jump_rad_s,
            // Twice: the speed within a gap may have been above that at its
            // ends, and a count comes whole.
            reach_rad: F::TWO * limits.speed_rad_s * step_s,
            counters: InputCounters::default(),
            missed: 0,
            omega_rad_s,
        }
    }

    /// The counters.
    pub fn counters(&self) -> InputCounters {
        self.counters
    }

    /// Returns whether a shaft can have made this step. A NaN passes no comparison.
    #[inline]
    fn is_plausible(&self, shaft: &ShaftStep<F>) -> bool {
        let mut reach = self.reach_rad;
        if self.missed > 0 {
            reach = reach * F::from_whole(u64::from(self.missed).saturating_add(1));
        }
        shaft.omega_start_rad_s.abs() <= self.speed_rad_s
            && shaft.omega_end_rad_s.abs() <= self.speed_rad_s
            && (shaft.omega_end_rad_s - shaft.omega_start_rad_s).abs() <= self.jump_rad_s
            && shaft.delta_phi_rad.abs() <= reach
    }

    /// A tick without a shaft.
    #[cold]
    fn miss(&mut self) -> Checked<F> {
        self.missed = self.missed.saturating_add(1);
        Checked::Missing(self.missed)
    }
}

impl<F: Real> Check<F> for InputCheck<F> {
    #[inline]
    fn check(&mut self, sample: &Sample<F>) -> Checked<F> {
        match sample {
            Sample::Taken(shaft) if self.is_plausible(shaft) => {
                let missed = core::mem::take(&mut self.missed);
                let omega_rad_s = core::mem::replace(&mut self.omega_rad_s, shaft.omega_end_rad_s);
                let gap = Gap {
                    shaft: *shaft,
                    missed,
                    omega_rad_s,
                };
                if missed == 0 {
                    Checked::Step(*shaft)
                } else if missed <= CATCH_UP_TICKS {
                    Checked::CatchUp(gap)
                } else {
                    Checked::Resume(gap)
                }
            }
            Sample::Taken(_) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                self.miss()
            }
            Sample::Lost => {
                self.counters.lost = self.counters.lost.saturating_add(1);
                self.miss()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const TICK_S: f64 = 5e-5;

    fn check() -> InputCheck<f64> {
        InputCheck::new(&InputLimits::device(TICK_S), TICK_S, 1.0)
    }

    fn moved(delta_phi_rad: f64, from: f64, to: f64) -> Sample<f64> {
        Sample::Taken(ShaftStep {
            delta_phi_rad,
            omega_start_rad_s: from,
            omega_end_rad_s: to,
        })
    }

    #[test]
    fn what_a_shaft_can_make_passes_as_it_is() {
        let mut check = check();
        // Also the most of each: 2·50 rad/s·h, 50 rad/s, and 10 rad/s of change.
        let most = 100.0 * TICK_S;
        for (travel, from, to) in [
            (5e-5, 1.0, 1.0),
            (-4.9e-3, 49.0, 40.0),
            (0.0, -50.0, -50.0),
            (most, 1.0, 1.0),
            (-most, 1.0, 1.0),
            (0.0, -6.0, 4.0),
        ] {
            let Sample::Taken(step) = moved(travel, from, to) else {
                unreachable!()
            };
            assert_eq!(check.check(&Sample::Taken(step)), Checked::Step(step));
        }
        assert_eq!(check.counters(), InputCounters::default());
    }

    #[test]
    fn what_no_shaft_makes_is_counted_and_missing() {
        let bad = [
            moved(f64::NAN, 1.0, 1.0),
            moved(0.0, f64::NAN, 1.0),
            moved(0.0, 1.0, f64::INFINITY),
            // Too fast at either end, a jump, too far.
            moved(0.0, 50.1, 45.0),
            moved(0.0, 45.0, -50.1),
            moved(0.0, -6.0, 4.1),
            moved(5.1e-3, 1.0, 1.0),
        ];
        for sample in bad {
            let mut check = check();
            assert_eq!(check.check(&sample), Checked::Missing(1), "{sample:?}");
            assert_eq!(check.check(&Sample::Lost), Checked::Missing(2));
            let counters = InputCounters {
                lost: 1,
                refused: 1,
            };
            assert_eq!(check.counters(), counters);
        }
    }

    #[test]
    fn a_short_gap_is_made_up_for_and_a_long_one_is_not() {
        for missing in 0..6_u32 {
            let mut check = check();
            for n in 1..=missing {
                assert_eq!(check.check(&Sample::Lost), Checked::Missing(n));
            }
            // A travel that only a gap of its own length explains.
            let travel = 0.9 * 5e-3 * f64::from(missing + 1);
            let seen = check.check(&moved(travel, 1.0, 2.0));
            assert_eq!(seen.travel_rad(), Some(travel));
            match seen {
                Checked::Step(_) => assert_eq!(missing, 0),
                Checked::CatchUp(gap) => {
                    assert!((1..=CATCH_UP_TICKS).contains(&missing));
                    assert_eq!((gap.missed, gap.omega_rad_s), (missing, 1.0));
                    let steps: Vec<_> = gap.steps().collect();
                    assert_eq!(steps.len(), missing as usize + 1);
                    let whole: f64 = steps.iter().map(|s| s.1.delta_phi_rad).sum();
                    assert!((whole - travel).abs() < 1e-15);
                }
                Checked::Resume(gap) => {
                    assert!(missing > CATCH_UP_TICKS);
                    assert_eq!((gap.missed, gap.omega_rad_s), (missing, 1.0));
                }
                Checked::Missing(_) => panic!("it was seen"),
            }
            // Afterwards it continues from there.
            assert!(matches!(
                check.check(&moved(1e-4, 2.0, 2.0)),
                Checked::Step(_)
            ));
        }
        assert_eq!(Checked::<f64>::Missing(1).travel_rad(), None);
    }
}
