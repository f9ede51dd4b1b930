//! A symptom on a device that runs: its state outlives a commit.

use super::symptom::{Besides, Law, law_nm};
use super::{Observe, Switched, Tick};
use crate::joint::MOST_STIFFNESS_NM_PER_RAD;
use crate::real::Real;
use crate::render::input_check::HOLD_TICKS;
use crate::render::position::{Position, Travel};

/// Keeps a law and what it remembers while its coefficients change.
///
/// One that appears begins without torque, wherever the joint is. One that is
/// removed goes on within a limit that falls from its torque with the slew limit:
/// it returns no more energy than it holds. While the bridge floats it rests. What
/// samples are missing for is held for a millisecond, then released.
///
/// Where a commit makes its torque jump, the jump J is made up for by a torque that
/// fades with the slew limit, and gives way as a spring of stiffness S where the hand
/// moves along with it: it returns at most J²/2S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliving<F, E> {
    /// The law, also while it is off: a law may have much to remember, and a commit moves
    /// nothing of it.
    law: E,
    is_on: bool,
    passage: Passage<F>,
}

/// The passage of a torque from what was shown to what a law has. The same code for all laws: in the tick after a
/// commit all symptoms may pass, and only the first fetches it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Passage<F> {
    slew_nm: F,
    way: Way<F>,
    last_nm: F,
}

/// Way in which a law's torque is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way<F> {
    /// As it is.
    Free,
    /// Not at all: it appears, and has no place yet.
    Appearing,
    /// With other coefficients, for the first time.
    Adopted,
    /// With this torque besides, which fades, N·m.
    Fading(F),
    /// Within this limit, which falls to nothing.
    Leaving(F),
    /// Not any more.
    Gone,
}

impl<F: Real, E: Law<Real = F>> Switched<F, E> for Outliving<F, E> {
    fn new(slew_nm: F) -> Self {
        Self {
            law: E::new(E::Coefficients::default()),
            is_on: false,
            passage: Passage {
                slew_nm,
                way: Way::Free,
                last_nm: F::ZERO,
            },
        }
    }

    fn change(&mut self, coefficients: &Option<Option<E::Coefficients>>, slew_nm: F) {
        self.passage.slew_nm = slew_nm;
        // By reference: most commits change none, and would copy it.
        let Some(coefficients) = coefficients else {
            return;
        };
        match (coefficients, self.is_on) {
            (None, false) => {}
            (None, true) => self.passage.way = Way::Leaving(self.passage.last_nm.abs()),
            (Some(coefficients), true) => {
                if matches!(self.passage.way, Way::Leaving(_)) {
                    // What has left does not come back: that would push.
                    let left_nm = self.law.torque_nm().abs() - self.passage.last_nm.abs();
                    self.law.release(left_nm.at_least(F::ZERO));
                }
                self.law.adopt(*coefficients, slew_nm);
                if self.passage.way != Way::Appearing {
                    self.passage.way = Way::Adopted;
                }
            }
            (Some(coefficients), false) => {
                self.law.adopt(*coefficients, slew_nm);
                self.is_on = true;
                self.passage.way = Way::Appearing;
            }
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        if matches!(self.passage.way, Way::Leaving(_)) {
            self.is_on = false;
        }
        Law::rest(&mut self.law, place);
        self.passage.way = Way::Free;
        self.passage.last_nm = F::ZERO;
    }

    #[inline]
    fn law(&self) -> Option<&E> {
        self.is_on.then_some(&self.law)
    }
}

impl<F: Real, E: Law<Real = F>> Outliving<F, E> {
    /// Follows a sample while the motor is driven; returns the torque, N·m. Not inlined: a
    /// symptom that is off then costs one test, and no saved registers.
    #[inline(never)]
    pub(super) fn follow<O: Observe<F>>(
        &mut self,
        travel: &Travel<F>,
        paid_share: F,
        besides: &mut Besides<F>,
        observe: &mut O,
    ) -> F {
        if matches!(self.passage.way, Way::Appearing) {
            return self.appear(&travel.to, besides);
        }
        let law_nm = law_nm(&mut self.law, Some(travel), besides, observe);
        if O::LISTENS && self.law.is_active() {
            observe.paid(const { &<E as Law>::SPEC }, law_nm, paid_share * law_nm);
        }
        self.show(law_nm, paid_share, Some(travel), besides)
    }

    /// Handles a tick without a sample, or with a motor that is not driven; returns the
    /// torque, N·m.
    #[cold]
    pub(super) fn unseen(&mut self, tick: &Tick<'_, F>, besides: &mut Besides<F>) -> F {
        if !tick.is_driven {
            self.rest(&tick.place);
            return F::ZERO;
        }
        if matches!(self.passage.way, Way::Appearing) {
            return self.appear(&tick.place, besides);
        }
        if tick.missing_ticks > HOLD_TICKS {
            self.law.release(self.passage.slew_nm);
        }
        let law_nm = self.law.torque_nm();
        self.show(law_nm, tick.paid_share, None, besides)
    }

    /// Starts without torque at the joint's present place.
    #[cold]
    fn appear(&mut self, place: &Position<F>, besides: &mut Besides<F>) -> F {
        Law::rest(&mut self.law, place);
        self.passage.way = Way::Adopted;
        besides.is_settling = true;
        F::ZERO
    }

    /// Returns the torque to show for the law's torque, N·m.
    #[inline]
    fn show(
        &mut self,
        law_nm: F,
        paid_share: F,
        travel: Option<&Travel<F>>,
        besides: &mut Besides<F>,
    ) -> F {
        let is_active = self.law.is_active();
        let mut nm = law_nm;
        if is_active {
            nm = besides.pay(law_nm, paid_share);
        }
        if !matches!(self.passage.way, Way::Free) {
            nm = self.passage.held_back(nm, travel);
            besides.is_settling = true;
            if self.passage.way == Way::Gone {
                self.is_on = false;
                self.passage.way = Way::Free;
            }
        }
        if is_active && nm != F::ZERO {
            // The tank pays for what is shown, also where the law itself has none any more.
            besides.active_nm += nm;
        }
        self.passage.last_nm = nm;
        nm
    }
}

impl<F: Real> Passage<F> {
    /// Returns the torque to show for the law's torque while the law is exchanged, N·m.
    #[cold]
    #[inline(never)]
    fn held_back(&mut self, law_nm: F, travel: Option<&Travel<F>>) -> F {
        match self.way {
            Way::Free | Way::Appearing | Way::Gone => law_nm,
            Way::Adopted => {
                let shown_nm = self.fade(law_nm, self.last_nm - law_nm, self.slew_nm);
                // What a law makes of its coefficients shows with a sample.
                if travel.is_none() {
                    self.way = Way::Adopted;
                }
                shown_nm
            }
            Way::Fading(besides_nm) => {
                let moved_rad = travel.map_or(F::ZERO, |travel| travel.delta_rad);
                let along = besides_nm * moved_rad < F::ZERO;
                let gives_nm = if along {
                    F::from_f64(MOST_STIFFNESS_NM_PER_RAD) * moved_rad.abs()
                } else {
                    F::ZERO
                };
                self.fade(law_nm, besides_nm, self.slew_nm + gives_nm)
            }
            Way::Leaving(most_nm) => {
                let most_nm = (most_nm - self.slew_nm).at_least(F::ZERO);
                self.way = if most_nm == F::ZERO {
                    Way::Gone
                } else {
                    Way::Leaving(most_nm)
                };
                law_nm.within(most_nm)
            }
        }
    }

    /// The law's torque with what is left of `besides_nm` besides: between nothing, what
    /// it is and what was shown. A law that gives way faster leaves no push behind.
    fn fade(&mut self, law_nm: F, besides_nm: F, fades_nm: F) -> F {
        let left_nm = besides_nm - besides_nm.within(fades_nm);
        let (low_nm, high_nm) = if law_nm < self.last_nm {
            (law_nm, self.last_nm)
        } else {
            (self.last_nm, law_nm)
        };
        let shown_nm = (law_nm + left_nm)
            .at_least(low_nm.at_most(F::ZERO))
            .at_most(high_nm.at_least(F::ZERO));
        self.way = if left_nm == F::ZERO {
            Way::Free
        } else {
            Way::Fading(shown_nm - law_nm)
        };
        shown_nm
    }
}
