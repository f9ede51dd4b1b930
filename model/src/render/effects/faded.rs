//! An effect whose torque fades out where it is exchanged.

use super::{Adds, DeviceEffect, Observe, Switched, Target, Tick, give};
use crate::real::Real;
use crate::render::Shown;

/// Adds the law's torque as it is; of a law that was exchanged for another,
/// which begins at rest, the last torque fades out within the slew limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faded<F, E> {
    law: Option<E>,
    /// Amount by which a torque fades in a tick, N·m.
    slew_nm: F,
    /// Remaining torque of laws that were exchanged, N·m.
    fading_nm: F,
    /// The last torque of the law, N·m.
    last_nm: F,
    /// Destination of that torque.
    target: Target,
    /// Destination of the remaining torque: where it went before.
    fading_target: Target,
}

impl<F: Real, E: DeviceEffect<F>> Switched<F, E> for Faded<F, E> {
    fn new(slew_nm: F) -> Self {
        Self {
            law: None,
            slew_nm,
            fading_nm: F::ZERO,
            last_nm: F::ZERO,
            target: Target::Joint,
            fading_target: Target::Joint,
        }
    }

    fn change(&mut self, coefficients: &Option<Option<E::Coefficients>>, slew_nm: F) {
        if let Some(coefficients) = *coefficients {
            if self.fading_target != self.target {
                // One of them fades; what is older is nearly over.
                self.fading_nm = F::ZERO;
                self.fading_target = self.target;
            }
            self.fading_nm += self.last_nm;
            self.last_nm = F::ZERO;
            self.law = coefficients.map(E::new);
        }
        self.slew_nm = slew_nm;
    }

    #[inline]
    fn law(&self) -> Option<&E> {
        self.law.as_ref()
    }
}

impl<F: Real, E: DeviceEffect<F>> Adds<F, E> for Faded<F, E> {
    #[inline]
    fn tick(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F {
        if let Some(law) = &mut self.law {
            self.last_nm = law.added(tick, shown, observe);
            self.target = law.target();
            give(self.target, self.last_nm, shown);
        }
        if self.fading_nm == F::ZERO {
            self.last_nm
        } else {
            let fading = self.fade();
            give(self.fading_target, fading, shown);
            self.last_nm + fading
        }
    }
}

impl<F: Real, E> Faded<F, E> {
    /// Remaining torque of a law that is gone, N·m. What is shown is not lent: it would have to lie in
    /// memory in every tick.
    #[cold]
    fn fade(&mut self) -> F {
        self.fading_nm -= self.fading_nm.within(self.slew_nm);
        self.fading_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BoneShaping;
    use crate::render::effects::bone_shaping::BoneShapingSettings;
    use crate::render::effects::tests::{after, law, missing, seen};
    use std::vec::Vec;

    fn bone() -> BoneShaping<f32> {
        law(&BoneShapingSettings::default())
    }

    fn faded() -> Faded<f32, BoneShaping<f32>> {
        let mut stage = Faded::new(0.01);
        stage.change(&Some(Some(bone())), 0.01);
        stage
    }

    #[test]
    fn a_bone_that_is_exchanged_fades_out() {
        for jump_nm in [0.4, -0.4] {
            let mut stage = faded();
            after(&mut stage, 0.0, jump_nm);
            let ringing: Vec<f32> = (0..40).map(|_| after(&mut stage, 0.0, 0.0).0).collect();
            let last = ringing[39];
            assert!(last.abs() > 0.1, "{last}");
            stage.change(&Some(None), 0.01);
            let mut left = last.abs();
            for _ in 0..60 {
                left = (left - 0.01).max(0.0);
                let (fading_nm, shown) = after(&mut stage, 0.0, 0.0);
                assert!(
                    (fading_nm - left.copysign(last)).abs() < 1e-6,
                    "{fading_nm}"
                );
                assert_eq!(shown.torque_nm, 1.0 + fading_nm);
            }
            assert_eq!(after(&mut stage, 0.0, 0.0).0, 0.0);
        }
    }

    /// Ringing that is sent elsewhere in its middle fades where it was: on the motor it would be a
    /// step of torque.
    #[test]
    fn what_fades_stays_where_it_was() {
        let ringing = |output| BoneShapingSettings {
            output,
            ..BoneShapingSettings::default()
        };
        for (from, to) in [(0, 1), (1, 0)] {
            let mut stage = Faded::<f32, BoneShaping<f32>>::new(0.01);
            stage.change(&Some(Some(law(&ringing(from)))), 0.01);
            after(&mut stage, 0.0, 0.4);
            let last = (0..40)
                .map(|_| after(&mut stage, 0.0, 0.0))
                .next_back()
                .unwrap();
            let is_on_motor = |shown: &Shown<f32>| shown.torque_nm != 1.0;
            assert_eq!(is_on_motor(&last.1), from == 0);
            stage.change(&Some(Some(law(&ringing(to)))), 0.01);
            let (fading, shown) = after(&mut stage, 0.0, 0.0);
            assert!(fading.abs() > 1e-3, "{fading}");
            assert_eq!(is_on_motor(&shown), from == 0);
        }
    }

    #[test]
    fn a_law_that_nobody_exchanges_is_the_law_alone() {
        let (mut alone, mut staged) = (bone(), faded());
        for n in 0..50_u8 {
            let jump_nm = if n == 3 { -0.2 } else { 0.0 };
            if n == 20 {
                staged.change(&None, 0.02);
            }
            let (added_nm, shown) = after(&mut staged, 0.0, jump_nm);
            let mut before = Shown {
                jump_nm,
                ..Shown::nothing()
            };
            let expected_nm = alone.added(&missing(&seen(0.0)), &mut before, &mut ());
            assert_eq!(
                (added_nm, shown.torque_nm),
                (expected_nm, 1.0 + expected_nm)
            );
        }
    }
}
