//! The form `catch`.
//!
//! ```text
//! armed ─> caught where s·(φ − λ + μΩ) ≥ 0 and s·Ω ≥ Ωth first hold
//! P = min(Tmax, b·sΩc)
//! u = P·[r + (1 − r)·e^(−(t − tc)/τ)] + k·max(0, s·(φ − φc))        T = s·play(σ, 0 … u)
//! armed again where s·(φc − φ) ≥ Δ
//! ```
//!
//! The torque never pushes: stop, and it falls along σ; go on, and it is there
//! again.

use super::{SpasticitySettings, Threshold};
use crate::joint::SettingsError;
use crate::real::Real;
use crate::render::effects::Timing;
use crate::render::effects::play::{Hold, Limits, Part, Play};
use crate::render::effects::symptom::{Change, Hear, Word, way_back};
use crate::render::position::{Position, Scale, Travel, decay, rise};

/// Coefficients of [`Caught`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CaughtCoefficients<F> {
    scale: Scale<F>,
    threshold: Threshold<F>,
    least_rad_s: F,
    per_rad_s: F,
    most_nm: F,
    residual: F,
    slope: F,
    /// −h/τ, and the share that a tick loses.
    rate: F,
    lost: F,
    stiffness: F,
    rearm_rad: F,
}

impl<F: Real> CaughtCoefficients<F> {
    pub(super) fn new(
        s: &SpasticitySettings,
        threshold: Threshold<F>,
        timing: &Timing,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            scale: timing.scale()?,
            threshold,
            least_rad_s: F::from_f64(s.threshold_velocity_deg_s.to_radians()),
            per_rad_s: F::from_f64(s.velocity_torque_nms_per_rad),
            most_nm: F::from_f64(s.torque_nm),
            residual: F::from_f64(s.residual_share),
            slope: F::from_f64(s.stiffness_nm_per_rad),
            rate: F::from_f64(-timing.step_s / s.release_s),
            lost: F::from_f64(-libm::expm1(-timing.step_s / s.release_s)),
            stiffness: F::from_f64(s.catch_stiffness_nm_per_rad),
            rearm_rad: way_back(s.rearm_deg),
        })
    }
}

/// A catch.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Catch<F> {
    place: Position<F>,
    /// P·r, N·m.
    left_nm: F,
    /// P·(1 − r)·e^(−(t − tc)/τ), N·m.
    decaying_nm: F,
}

/// A muscle that catches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Caught<F> {
    with: CaughtCoefficients<F>,
    play: Play<F>,
    /// The catch, until it is armed again.
    catch: Option<Catch<F>>,
    torque_nm: F,
}

impl<F: Real> Caught<F> {
    pub(super) fn new(with: CaughtCoefficients<F>) -> Self {
        Self {
            with,
            play: Play::new(),
            catch: None,
            torque_nm: F::ZERO,
        }
    }

    pub(super) fn rest(&mut self, place: &Position<F>) {
        self.play.rest(place);
        self.catch = None;
        self.torque_nm = F::ZERO;
    }

    pub(super) fn torque_nm(&self) -> F {
        self.torque_nm
    }

    pub(super) fn is_caught(&self) -> bool {
        self.catch.is_some()
    }

    pub(super) fn adopt(&mut self, with: CaughtCoefficients<F>, slew_nm: F) {
        if with.threshold.sense == self.with.threshold.sense {
            self.play
                .change(self.with.stiffness, with.stiffness, slew_nm);
            self.torque_nm = with.threshold.sense * self.play.torque_nm();
            // The play slews down to what another catch would leave at most.
            if let Some(catch) = &mut self.catch {
                let most_left_nm = with.most_nm * with.residual;
                catch.left_nm = catch.left_nm.at_most(most_left_nm);
                catch.decaying_nm = catch.decaying_nm.at_most(with.most_nm - most_left_nm);
            }
            self.with = with;
        } else {
            *self = Self::new(with);
        }
    }

    pub(super) fn retime(&mut self, s: &SpasticitySettings, timing: &Timing) {
        let share = timing.step_s / s.release_s;
        self.with.rate = F::from_f64(-share);
        self.with.lost = F::from_f64(-libm::expm1(-share));
    }

    pub(super) fn release(&mut self, slew_nm: F) {
        self.play.release(slew_nm);
        self.torque_nm = self.with.threshold.sense * self.play.torque_nm();
    }

    #[inline]
    pub(super) fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let nm = match &mut self.catch {
            Some(_) => self.follow_catch(travel, on_change),
            None => self.wait(travel, on_change),
        };
        self.torque_nm = self.with.threshold.sense * nm;
        self.torque_nm
    }

    /// Armed: whether the stretch is fast and far enough.
    #[inline]
    fn wait(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        let sense = with.threshold.sense;
        let stretch_rad_s = sense * travel.omega_end_rad_s;
        if stretch_rad_s < with.least_rad_s && sense * travel.omega_start_rad_s < with.least_rad_s {
            return F::ZERO;
        }
        self.look(travel, on_change)
    }

    /// Locates the catch of a stretch that is fast enough, if it also goes far enough. Not
    /// inlined: a muscle that waits then saves no registers for it.
    #[inline(never)]
    fn look(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        let sense = with.threshold.sense;
        let stretch_rad_s = sense * travel.omega_end_rad_s;
        let start = with.threshold.start_beyond(travel);
        let start_faster = sense * travel.omega_start_rad_s - with.least_rad_s;
        if start >= F::ZERO && start_faster >= F::ZERO {
            return self.catch(F::ZERO, travel, on_change);
        }
        if stretch_rad_s < with.least_rad_s || with.threshold.end_beyond(travel) < F::ZERO {
            return F::ZERO;
        }
        let faster = stretch_rad_s - with.least_rad_s - start_faster;
        let there = if start < F::ZERO {
            with.threshold.rises_to(F::ZERO, start, travel)
        } else {
            F::ZERO
        };
        let fast = if start_faster < F::ZERO {
            rise(faster, F::ZERO, -start_faster)
        } else {
            F::ZERO
        };
        self.catch(there.at_least(fast), travel, on_change)
    }

    /// Caught after this share of the travel.
    #[cold]
    fn catch(&mut self, fraction: F, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        let sense = with.threshold.sense;
        let peak_nm = (with.per_rad_s * sense * travel.omega_rad_s(fraction)).at_most(with.most_nm);
        let place = travel.place(fraction);
        let left_nm = peak_nm * with.residual;
        let mut catch = Catch {
            place,
            left_nm,
            decaying_nm: peak_nm - left_nm,
        };
        on_change.hear(Change::at(Word::Catch, fraction, F::ZERO, F::ZERO));
        self.play.put(&place, F::ZERO, Hold::Elastic);
        let nm = self.follow_from(fraction, &mut catch, travel, on_change);
        self.catch = Some(catch);
        nm
    }

    /// Caught, before this travel or within it.
    #[expect(
        clippy::inline_always,
        reason = "otherwise another call in every tick, 50 cycles on the target"
    )]
    #[inline(always)]
    fn follow_from(
        &mut self,
        from: F,
        catch: &mut Catch<F>,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let with = &self.with;
        let sense = with.threshold.sense;
        let before_nm = catch.decaying_nm;
        let after_nm = if from == F::ZERO {
            travel.decayed(before_nm, with.lost)
        } else {
            before_nm * decay(travel.exponent(with.rate, from, F::ONE))
        };
        catch.decaying_nm = after_nm.settled();
        let part = Part::since(sense, from);
        let limits = |fraction: F| {
            let at = travel.place(fraction);
            let beyond = sense * at.beyond(&catch.place, travel.rad_per_count);
            let decaying_nm = if fraction == F::ONE {
                after_nm
            } else {
                before_nm * travel.exponent(with.rate, from, fraction).exp()
            };
            Limits {
                lower_nm: F::ZERO,
                upper_nm: catch.left_nm + decaying_nm + with.slope * beyond.at_least(F::ZERO),
            }
        };
        self.play
            .follow(travel, part, with.stiffness, limits, on_change)
    }

    #[inline]
    fn follow_catch(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let Some(mut catch) = self.catch else {
            return F::ZERO;
        };
        let sense = self.with.threshold.sense;
        let nm = self.follow_from(F::ZERO, &mut catch, travel, on_change);
        let back_rad = -sense * travel.end_beyond(&catch.place);
        if back_rad >= self.with.rearm_rad {
            let place = catch.place.moved(-sense * self.with.rearm_rad);
            on_change.tell(Word::Rearm, || travel.reaches(&place), sense * nm, F::ZERO);
            self.catch = None;
            self.play.rest(&travel.to);
            return F::ZERO;
        }
        self.catch = Some(catch);
        nm
    }
}
