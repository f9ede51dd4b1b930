//! How the device adds to the torque of its symptoms while parameters change
//! under way: no switch makes a jolt.

use super::bone_shaping::BoneShaping;
use super::friction_compensation::FrictionCompensation;
use super::input_check::Sample;
use super::{Addition, Limit, Seen, Shown};
use crate::real::Real;

/// Friction compensation that follows its law at most as fast as the slew
/// limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlewedCompensation<F> {
    law: Option<FrictionCompensation<F>>,
    /// How far it moves in a tick, N·m.
    slew_nm: F,
    /// What it adds now, N·m.
    now_nm: F,
}

impl<F: Real> SlewedCompensation<F> {
    /// Nothing is added yet.
    pub fn new(law: Option<FrictionCompensation<F>>, slew_nm: F) -> Self {
        Self {
            law,
            slew_nm,
            now_nm: F::ZERO,
        }
    }

    /// From the next tick on towards this law, or none.
    pub fn change(&mut self, law: Option<FrictionCompensation<F>>, slew_nm: F) {
        self.law = law;
        self.slew_nm = slew_nm;
    }
}

impl<F: Real> Addition<F> for SlewedCompensation<F> {
    #[inline]
    fn tick(&mut self, seen: &Seen<F>, shown: &mut Shown<F>) {
        let target_nm = match &self.law {
            Some(law) => law.torque_nm(seen.omega_rad_s),
            None if self.now_nm == F::ZERO => return,
            None => F::ZERO,
        };
        let step_nm = target_nm - self.now_nm;
        self.now_nm = if step_nm.abs() > self.slew_nm {
            if shown.limit == Limit::None {
                shown.limit = Limit::Slew;
            }
            self.now_nm + step_nm.within(self.slew_nm)
        } else {
            target_nm
        };
        shown.compensation_nm = self.now_nm;
        shown.torque_nm += self.now_nm;
    }
}

/// A bone that rings; one that is exchanged fades out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingingBone<F> {
    bone: Option<BoneShaping<F>>,
    /// How far a bone that is gone fades in a tick, N·m.
    slew_nm: F,
    /// What is left of the ringing of a bone that was exchanged, N·m.
    fading_nm: F,
    rung_nm: F,
}

impl<F: Real> RingingBone<F> {
    /// At rest.
    pub fn new(bone: Option<BoneShaping<F>>, slew_nm: F) -> Self {
        Self {
            bone,
            slew_nm,
            fading_nm: F::ZERO,
            rung_nm: F::ZERO,
        }
    }

    /// From the next tick on, another bone, or none.
    pub fn exchange(&mut self, bone: Option<BoneShaping<F>>) {
        self.fading_nm += self.rung_nm;
        self.rung_nm = F::ZERO;
        self.bone = bone;
    }

    /// From the next tick on, this slew limit.
    pub fn set_slew(&mut self, slew_nm: F) {
        self.slew_nm = slew_nm;
    }
}

impl<F: Real> Addition<F> for RingingBone<F> {
    #[inline]
    fn tick(&mut self, seen: &Seen<F>, shown: &mut Shown<F>) {
        if let Some(bone) = &mut self.bone {
            self.rung_nm = rung_nm(bone, seen, shown.jump_nm);
            shown.ringing_nm = self.rung_nm;
            shown.torque_nm += self.rung_nm;
        }
        if self.fading_nm != F::ZERO {
            self.fade(shown);
        }
    }
}

impl<F: Real> RingingBone<F> {
    /// What is left of a bone that is gone.
    #[cold]
    fn fade(&mut self, shown: &mut Shown<F>) {
        let left_nm = (self.fading_nm.abs() - self.slew_nm).at_least(F::ZERO);
        self.fading_nm = if self.fading_nm < F::ZERO {
            -left_nm
        } else {
            left_nm
        };
        shown.ringing_nm += self.fading_nm;
        shown.torque_nm += self.fading_nm;
    }
}

/// Without a device around it, the law alone.
impl<F: Real> Addition<F> for FrictionCompensation<F> {
    // By name in a profile: a test looks for it where it should not be.
    #[inline(never)]
    fn tick(&mut self, seen: &Seen<F>, shown: &mut Shown<F>) {
        shown.compensation_nm = self.torque_nm(seen.omega_rad_s);
        shown.torque_nm += shown.compensation_nm;
    }
}

/// Without a device around it, the bone alone.
impl<F: Real> Addition<F> for BoneShaping<F> {
    // As above.
    #[inline(never)]
    fn tick(&mut self, seen: &Seen<F>, shown: &mut Shown<F>) {
        shown.ringing_nm = rung_nm(self, seen, shown.jump_nm);
        shown.torque_nm += shown.ringing_nm;
    }
}

/// Strikes the bone with the jumps of a tick.
#[inline]
fn rung_nm<F: Real>(bone: &mut BoneShaping<F>, seen: &Seen<F>, jump_nm: F) -> F {
    let travel_rad = match seen.sample {
        Sample::Taken(step) => step.delta_phi_rad,
        Sample::Lost => F::ZERO,
    };
    bone.ring(jump_nm);
    bone.tick(travel_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShaftStep;
    use crate::render::bone_shaping::BoneShapingSettings;
    use crate::render::friction_compensation::FrictionCompensationSettings;
    use std::vec::Vec;

    fn seen(omega_rad_s: f32) -> Seen<f32> {
        Seen::taken(&ShaftStep {
            delta_phi_rad: 0.0,
            omega_start_rad_s: omega_rad_s,
            omega_end_rad_s: omega_rad_s,
        })
    }

    fn after(stage: &mut impl Addition<f32>, omega_rad_s: f32, jump_nm: f32) -> Shown<f32> {
        let mut shown = Shown {
            torque_nm: 1.0,
            jump_nm,
            ..Shown::nothing()
        };
        stage.tick(&seen(omega_rad_s), &mut shown);
        shown
    }

    /// 0.4 N·m along.
    fn law() -> FrictionCompensation<f32> {
        FrictionCompensation::new(&FrictionCompensationSettings::default()).unwrap()
    }

    #[test]
    fn compensation_comes_and_goes_within_the_slew_limit() {
        let mut stage = SlewedCompensation::new(Some(law()), 0.3);
        let first = after(&mut stage, 1.0, 0.0);
        assert_eq!((first.torque_nm, first.limit), (0.7, Limit::Slew));
        assert_eq!(first.compensation_nm, -0.3);
        let second = after(&mut stage, 1.0, 0.0);
        assert!((second.torque_nm - 0.6).abs() < 1e-6);
        assert_eq!(second.limit, Limit::None);
        stage.change(None, 0.3);
        let leaving = after(&mut stage, 1.0, 0.0);
        assert!((leaving.torque_nm - 0.9).abs() < 1e-6);
        assert_eq!(leaving.limit, Limit::Slew);
        assert_eq!(after(&mut stage, 1.0, 0.0).torque_nm, 1.0);
        let gone = after(&mut stage, 1.0, 0.0);
        assert_eq!((gone.torque_nm, gone.limit), (1.0, Limit::None));
    }

    #[test]
    fn a_reason_from_before_is_not_replaced_by_the_slew_limit() {
        let mut stage = SlewedCompensation::new(Some(law()), 0.1);
        let mut shown = Shown {
            limit: Limit::TurnedBack,
            ..Shown::nothing()
        };
        stage.tick(&seen(1.0), &mut shown);
        assert_eq!(shown.limit, Limit::TurnedBack);
        assert_eq!(shown.compensation_nm, -0.1);
    }

    #[test]
    fn a_bone_that_is_exchanged_fades_out() {
        let bone = || BoneShaping::new(&BoneShapingSettings::default(), 5e-5, 1).unwrap();
        let mut stage = RingingBone::<f32>::new(Some(bone()), 0.01);
        after(&mut stage, 0.0, 0.4);
        let ringing: Vec<f32> = (0..40)
            .map(|_| after(&mut stage, 0.0, 0.0).ringing_nm)
            .collect();
        let last = ringing[39];
        assert!(last.abs() > 0.1, "{last}");
        stage.exchange(None);
        let fading = after(&mut stage, 0.0, 0.0);
        assert!((fading.ringing_nm - (last.abs() - 0.01).copysign(last)).abs() < 1e-6);
        assert_eq!(fading.torque_nm, 1.0 + fading.ringing_nm);
        let ticks = (0..100).take_while(|_| after(&mut stage, 0.0, 0.0).ringing_nm != 0.0);
        assert!(ticks.count() < 60);
        // The law alone does what a bone that nobody exchanges does.
        let (mut alone, mut staged) = (bone(), RingingBone::<f32>::new(Some(bone()), 0.01));
        for n in 0..50_u8 {
            let jump_nm = if n == 3 { -0.2 } else { 0.0 };
            let both = (
                after(&mut alone, 0.0, jump_nm),
                after(&mut staged, 0.0, jump_nm),
            );
            assert_eq!(both.0, both.1);
        }
    }
}
