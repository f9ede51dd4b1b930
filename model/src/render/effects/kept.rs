//! A symptom on a device that runs: its state outlives a commit.

use super::symptom::{Given, Law};
use super::{Observe, Switched, Tick};
use crate::real::Real;
use crate::render::Shown;
use crate::render::input_check::{Checked, HOLD_TICKS};
use crate::render::position::Position;

/// Keeps a law and what it remembers while its coefficients change.
///
/// One that appears begins without torque, wherever the joint is. One that is
/// removed goes on within a limit that falls from its torque with the slew limit:
/// it returns no more energy than it holds. While the bridge floats it rests. What
/// samples are missing for is held for a millisecond, then released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept<F, E> {
    /// Also while it is off: a law may have much to remember, and a commit moves
    /// nothing of it.
    law: E,
    is_on: bool,
    /// It has no place yet.
    is_new: bool,
    slew_nm: F,
    way: Way<F>,
    last_nm: F,
}

/// How a law's torque is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way<F> {
    /// As it is.
    Free,
    /// Within the slew limit, until that has caught up.
    CatchingUp,
    /// Within this limit, which falls to nothing.
    Leaving(F),
}

impl<F: Real, E: Law<Real = F>> Switched<F, E> for Kept<F, E> {
    fn new(slew_nm: F) -> Self {
        Self {
            law: E::new(E::Coefficients::default()),
            is_on: false,
            is_new: false,
            slew_nm,
            way: Way::Free,
            last_nm: F::ZERO,
        }
    }

    fn change(&mut self, coefficients: &Option<Option<E::Coefficients>>, slew_nm: F) {
        self.slew_nm = slew_nm;
        match (*coefficients, self.is_on) {
            (None, _) | (Some(None), false) => {}
            (Some(None), true) => self.way = Way::Leaving(self.last_nm.abs()),
            (Some(Some(coefficients)), true) => {
                self.law.adopt(coefficients, slew_nm);
                self.way = Way::CatchingUp;
            }
            (Some(Some(coefficients)), false) => {
                self.law.adopt(coefficients, slew_nm);
                (self.is_on, self.is_new) = (true, true);
                self.way = Way::Free;
            }
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        if matches!(self.way, Way::Leaving(_)) {
            self.is_on = false;
        }
        Law::rest(&mut self.law, place);
        self.is_new = false;
        self.way = Way::Free;
        self.last_nm = F::ZERO;
    }

    #[inline]
    fn law(&self) -> Option<&E> {
        self.is_on.then_some(&self.law)
    }

    #[inline(always)]
    fn tick(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F {
        if !self.is_on {
            return F::ZERO;
        }
        // Copies: whose address is taken lives in memory also where this is off.
        let (seen, input) = (*tick.seen, *tick.input);
        let tick = Tick {
            seen: &seen,
            input: &input,
            paid_share: tick.paid_share,
        };
        let given = self.tick_on(&tick, observe);
        shown.torque_nm += given.nm;
        shown.jump_nm += given.jump_nm;
        shown.active_nm += given.active_nm;
        shown.settling |= given.is_settling;
        given.nm
    }
}

impl<F: Real, E: Law<Real = F>> Kept<F, E> {
    /// A tick of one that is on. On its own: so one that is off costs a look, and no
    /// register of those around it.
    #[inline(never)]
    fn tick_on(&mut self, tick: &Tick<'_, F>, observe: &mut impl Observe<F>) -> Given<F> {
        if self.is_new || !tick.seen.is_driven {
            self.rest(&tick.seen.place);
            return Given::NOTHING;
        }
        if let Checked::Missing(ticks) = tick.input
            && *ticks > HOLD_TICKS
        {
            self.law.release(self.slew_nm);
        }
        let mut given = Given::by(&mut self.law, tick, observe);
        if self.way != Way::Free {
            given.nm = self.held_back(given.nm);
            given.is_settling = true;
        }
        self.last_nm = given.nm;
        given
    }
}

impl<F: Real, E> Kept<F, E> {
    /// What is shown of a law's torque while it is exchanged.
    #[cold]
    fn held_back(&mut self, law_nm: F) -> F {
        match self.way {
            Way::Free => law_nm,
            Way::CatchingUp => {
                let step_nm = law_nm - self.last_nm;
                if step_nm.abs() > self.slew_nm {
                    self.last_nm + step_nm.within(self.slew_nm)
                } else {
                    self.way = Way::Free;
                    law_nm
                }
            }
            Way::Leaving(most_nm) => {
                let most_nm = (most_nm - self.slew_nm).at_least(F::ZERO);
                self.way = Way::Leaving(most_nm);
                if most_nm == F::ZERO {
                    self.is_on = false;
                    self.way = Way::Free;
                }
                law_nm.within(most_nm)
            }
        }
    }
}
