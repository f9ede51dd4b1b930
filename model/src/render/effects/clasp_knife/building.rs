//! Resistance that builds, up to its collapse or to the way back.

use super::{ClaspKnife, Stage};
use crate::real::Real;
use crate::render::effects::play::{Hold, Limits, Part, Play};
use crate::render::effects::symptom::{Change, Hear, Word};
use crate::render::position::{Position, Travel};

impl<F: Real> ClaspKnife<F> {
    /// The onset is met, within this travel or before (armed beyond it): at this share
    /// of it.
    #[cold]
    pub(super) fn begin(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        self.stage = Stage::Build;
        let started =
            self.with.sense * (travel.end_beyond(&self.with.onset) - travel.delta_rad) < F::ZERO;
        let (place, fraction) = if started {
            (self.with.onset, travel.reaches(&self.with.onset))
        } else {
            // Armed beyond the onset, or the onset was moved: it pushes nobody.
            (travel.place(F::ZERO), F::ZERO)
        };
        self.play.put(&place, F::ZERO, Hold::Elastic);
        on_change.hear(Change::at(Word::Onset, fraction, F::ZERO, F::ZERO));
        fraction
    }

    /// u while it builds, N·m.
    #[inline]
    pub(super) fn limit_nm(&self, beyond_rad: F) -> F {
        self.with.onset_nm + self.with.slope * beyond_rad.at_least(F::ZERO)
    }

    /// Builds since the share `from` of a travel; a long one may reach the release, too.
    #[inline]
    pub(super) fn build(
        &mut self,
        from: F,
        beyond_rad: F,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let with = self.with;
        if let Some(release) = &with.release
            && with.sense * travel.end_beyond(release) >= F::ZERO
        {
            let before_rad = with.sense * (travel.end_beyond(release) - travel.delta_rad);
            let fraction = if before_rad >= F::ZERO {
                F::ZERO
            } else {
                travel.reaches(release).at_least(from)
            };
            return self.collapse(fraction, travel, on_change);
        }
        let before = self.play;
        let nm = self.grow(F::ONE, beyond_rad, travel, on_change);
        if with.release.is_none() && nm >= with.release_nm {
            let before_nm = before.torque_nm();
            let line = (with.release_nm - before_nm) / (nm - before_nm).at_least(F::EPSILON);
            let located = self.release_place(&before).map(|place| {
                let beyond_rad = with.sense * travel.end_beyond(&place);
                if beyond_rad >= with.sense * travel.delta_rad {
                    F::ZERO
                } else {
                    travel.reaches(&place)
                }
            });
            let fraction = located.unwrap_or(line).at_least(from).at_most(F::ONE);
            self.play = before;
            return self.collapse(fraction, travel, on_change);
        }
        nm
    }

    /// Place at which both the spring and the limit, each a line over the angle, have come to the
    /// torque of the release, from a play that was as `before`. In f32, and where a commit left
    /// torque beyond the limit, the torque is taken for a line over the travel instead.
    fn release_place(&self, before: &Play<F>) -> Option<Position<F>> {
        let with = &self.with;
        let spring = before.reaches(with.release_nm, with.stiffness, with.sense)?;
        let missing_nm = with.release_nm - with.onset_nm;
        if F::IS_SINGLE || (missing_nm > F::ZERO && with.slope <= F::ZERO) {
            return None;
        }
        if missing_nm <= F::ZERO {
            return Some(spring);
        }
        let limit = with.onset.moved(with.sense * (missing_nm / with.slope));
        let further_rad = with.sense * limit.beyond(&spring, with.scale.rad_per_count);
        Some(if further_rad > F::ZERO { limit } else { spring })
    }

    /// Follows the limit that builds, up to a share of the travel.
    #[inline]
    pub(super) fn grow(
        &mut self,
        to: F,
        beyond_rad: F,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let with = self.with;
        let limit_nm = |fraction: F| {
            let beyond = if fraction == F::ONE {
                beyond_rad
            } else {
                with.sense
                    * travel
                        .place(fraction)
                        .beyond(&with.onset, travel.rad_per_count)
            };
            Limits {
                lower_nm: F::ZERO,
                upper_nm: with.onset_nm + with.slope * beyond.at_least(F::ZERO),
            }
        };
        let part = Part::until(with.sense, to);
        self.play
            .follow(travel, part, with.stiffness, limit_nm, on_change)
    }

    /// Turned back before it collapsed.
    #[cold]
    pub(super) fn back(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let fraction = travel.reaches(&self.with.onset);
        let nm = self.grow(fraction, F::ZERO, travel, on_change);
        on_change.hear(Change::at(
            Word::Back,
            fraction,
            self.with.sense * nm,
            F::ZERO,
        ));
        self.stage = Stage::Out;
        self.play.rest(&travel.to);
        F::ZERO
    }
}
