//! An effect that is followed at most as fast as the slew limit.

use super::{Adds, DeviceEffect, Observe, Switched, Tick};
use crate::real::Real;
use crate::render::{Limit, Shown};

/// Follows the law's torque within the slew limit, also when it is switched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slewed<F, E> {
    law: Option<E>,
    /// The largest change in a tick, N·m.
    slew_nm: F,
    /// Torque added now, N·m.
    now_nm: F,
}

impl<F: Real, E: DeviceEffect<F>> Switched<F, E> for Slewed<F, E> {
    fn new(slew_nm: F) -> Self {
        Self {
            law: None,
            slew_nm,
            now_nm: F::ZERO,
        }
    }

    fn change(&mut self, coefficients: &Option<Option<E::Coefficients>>, slew_nm: F) {
        if let Some(coefficients) = *coefficients {
            self.law = coefficients.map(E::new);
        }
        self.slew_nm = slew_nm;
    }

    #[inline]
    fn law(&self) -> Option<&E> {
        self.law.as_ref()
    }
}

impl<F: Real, E: DeviceEffect<F>> Adds<F, E> for Slewed<F, E> {
    #[inline]
    fn tick(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F {
        let target_nm = match &mut self.law {
            Some(law) => law.added(tick, shown, observe),
            None if self.now_nm == F::ZERO => return F::ZERO,
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
        shown.torque_nm += self.now_nm;
        self.now_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FrictionCompensation;
    use crate::render::effects::friction_compensation::FrictionCompensationSettings;
    use crate::render::effects::tests::{after, law, missing, seen};

    /// 0.4 N·m along.
    fn slewed(slew_nm: f32) -> Slewed<f32, FrictionCompensation<f32>> {
        let law = law(&FrictionCompensationSettings::default());
        let mut stage = Slewed::new(slew_nm);
        stage.change(&Some(Some(law)), slew_nm);
        stage
    }

    #[test]
    fn compensation_comes_and_goes_within_the_slew_limit() {
        let mut stage = slewed(0.3);
        let (added_nm, first) = after(&mut stage, 1.0, 0.0);
        assert_eq!((first.torque_nm, first.limit), (0.7, Limit::Slew));
        assert_eq!(added_nm, -0.3);
        let (_, second) = after(&mut stage, 1.0, 0.0);
        assert!((second.torque_nm - 0.6).abs() < 1e-6);
        assert_eq!(second.limit, Limit::None);
        assert!(stage.law().is_some());
        stage.change(&None, 0.3);
        let (_, kept) = after(&mut stage, 1.0, 0.0);
        assert_eq!(kept.torque_nm, second.torque_nm);
        stage.change(&Some(None), 0.3);
        assert_eq!(stage.law(), None);
        let (_, leaving) = after(&mut stage, 1.0, 0.0);
        assert!((leaving.torque_nm - 0.9).abs() < 1e-6);
        assert_eq!(leaving.limit, Limit::Slew);
        assert_eq!(after(&mut stage, 1.0, 0.0).1.torque_nm, 1.0);
        let (_, gone) = after(&mut stage, 1.0, 0.0);
        assert_eq!((gone.torque_nm, gone.limit), (1.0, Limit::None));
    }

    #[test]
    fn a_step_as_large_as_the_slew_limit_is_not_limited() {
        let (whole_nm, _) = after(&mut slewed(2.0), 1.0, 0.0);
        for (slew_nm, limit) in [(-whole_nm, Limit::None), (-whole_nm.next_up(), Limit::Slew)] {
            let (added_nm, shown) = after(&mut slewed(slew_nm), 1.0, 0.0);
            assert_eq!((added_nm, shown.limit), (-slew_nm, limit));
        }
    }

    #[test]
    fn a_reason_from_before_is_not_replaced_by_the_slew_limit() {
        let mut stage = slewed(0.1);
        let mut shown = Shown {
            limit: Limit::TurnedBack,
            ..Shown::nothing()
        };
        let added_nm = stage.tick(&missing(&seen(1.0)), &mut shown, &mut ());
        assert_eq!(shown.limit, Limit::TurnedBack);
        assert_eq!(added_nm, -0.1);
    }
}
