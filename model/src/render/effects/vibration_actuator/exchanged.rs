//! Exchange of an actuator's design while the device runs.

use super::{Coefficients, VibrationActuator};
use crate::real::Real;
use crate::render::Shown;
use crate::render::effects::{Adds, DeviceEffect, Observe, Switched, Tick};

/// The actuator of a device that runs: its gain is followed; what is designed otherwise
/// is exchanged once it is silent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchanged<F> {
    pub(super) law: Option<VibrationActuator<F>>,
    /// Successor of the law once that is silent.
    next: Option<Next<F>>,
}

/// Successor of a law that has faded out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next<F> {
    Nothing,
    Law(Coefficients<F>),
}

impl<F: Real> Switched<F, VibrationActuator<F>> for Exchanged<F> {
    fn new(_: F) -> Self {
        Self {
            law: None,
            next: None,
        }
    }

    fn change(&mut self, coefficients: &Option<Option<Coefficients<F>>>, _: F) {
        let Some(coefficients) = *coefficients else {
            return;
        };
        self.next = None;
        match (&mut self.law, coefficients) {
            (None, new) => self.law = new.map(VibrationActuator::new),
            (Some(law), Some(new)) if law.design == new.design => law.goal = new.gain,
            (Some(law), new) => {
                law.goal = F::ZERO;
                self.next = Some(new.map_or(Next::Nothing, Next::Law));
            }
        }
    }

    #[inline]
    fn law(&self) -> Option<&VibrationActuator<F>> {
        self.law.as_ref()
    }
}

impl<F: Real> Adds<F, VibrationActuator<F>> for Exchanged<F> {
    #[inline]
    fn tick(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F {
        let Some(law) = &mut self.law else {
            return F::ZERO;
        };
        let volts = law.added(tick, shown, observe);
        shown.coil_v = volts;
        if law.gain != law.goal && tick.is_driven {
            shown.settling = true;
        } else if self.next.is_some() {
            self.exchange();
        }
        volts
    }
}

impl<F: Real> Exchanged<F> {
    /// The next law takes over, with the coil as warm as it is.
    #[cold]
    #[inline(never)]
    fn exchange(&mut self) {
        if let Some(next) = self.next.take() {
            let heat = self.law.map_or(F::ZERO, |law| law.heat);
            self.law = match next {
                Next::Nothing => None,
                Next::Law(coefficients) => Some(VibrationActuator {
                    heat,
                    ..VibrationActuator::new(coefficients)
                }),
            };
        }
    }
}
