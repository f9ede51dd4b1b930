//! One end of the range, followed by its own play.

use super::End;
use crate::real::Real;
use crate::render::effects::play::{Hold, Limits, Part, Play};
use crate::render::effects::symptom::{Change, Hear, Word};
use crate::render::position::{Position, Scale, Travel};

/// State of a joint at an end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    #[default]
    Out,
    In,
    AtCap,
}

/// One end of the range, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall<F> {
    pub(super) play: Play<F>,
    pub(super) stage: Stage,
}

impl<F: Real> Wall<F> {
    pub(super) fn new() -> Self {
        Self {
            play: Play::new(),
            stage: Stage::Out,
        }
    }

    pub(super) fn rest(&mut self, end: &End<F>, sense: F, place: &Position<F>, scale: &Scale<F>) {
        self.play.rest(place);
        let beyond_rad = sense * place.beyond(&end.place, scale.rad_per_count);
        self.stage = if beyond_rad > F::ZERO {
            Stage::In
        } else {
            Stage::Out
        };
    }

    /// Follows the joint: the wall's torque, against growing `sense`·φ, N·m.
    #[expect(
        clippy::inline_always,
        reason = "twice in the same task, which else passes its numbers through memory: 110 cycles"
    )]
    #[inline(always)]
    pub(super) fn follow<O: Hear<F>>(
        &mut self,
        end: &End<F>,
        sense: F,
        flicker_rad: F,
        travel: &Travel<F>,
        on_change: &mut O,
    ) -> F {
        let beyond_rad = sense * travel.end_beyond(&end.place);
        if self.stage == Stage::Out {
            // Torque is left here only where the wall was moved away.
            if beyond_rad <= F::ZERO && self.play.torque_nm() == F::ZERO {
                return F::ZERO;
            }
            if beyond_rad > F::ZERO {
                self.enter(
                    end,
                    beyond_rad - sense * travel.delta_rad,
                    travel,
                    on_change,
                );
            }
        }
        let is_below_cap = self.stage != Stage::AtCap;
        let mut is_reported = false;
        let envelope_nm = |fraction: F| {
            end.envelope_nm(if fraction == F::ONE {
                beyond_rad
            } else {
                sense
                    * travel
                        .place(fraction)
                        .beyond(&end.place, travel.rad_per_count)
            })
        };
        let limits = |fraction: F| Limits {
            lower_nm: F::ZERO,
            upper_nm: envelope_nm(fraction),
        };
        let part = Part::whole(sense);
        let mut report = |mut change: Change<F>| {
            // Met at its cap, the limit is the cap and no envelope to flow along.
            if is_below_cap && change.word == Word::Flow && change.after_nm.abs() >= end.cap_nm {
                change.word = Word::Cap;
                is_reported = true;
            }
            on_change.hear(change);
        };
        let nm = if O::LISTENS {
            self.play
                .follow(travel, part, end.spring, limits, &mut report)
        } else {
            self.play.follow(travel, part, end.spring, limits, &mut ())
        };
        if beyond_rad < -flicker_rad {
            if self.stage != Stage::Out {
                self.stage = Stage::Out;
                on_change.tell(Word::Leave, || travel.reaches(&end.place), nm, nm);
            }
        } else if self.turns_back(end, nm) || beyond_rad < end.cap_rad {
            self.stage = Stage::In;
        } else {
            if is_below_cap && !is_reported {
                let place = end.place.moved(sense * end.cap_rad);
                let nm = sense * nm;
                on_change.tell(Word::Cap, || travel.reaches(&place), nm, nm);
            }
            self.stage = Stage::AtCap;
        }
        nm
    }

    /// Returns whether the torque is below its limit. Of a joint that rests at the cap it is not, although rounding in
    /// f64 would let it come to the cap once more; counts are not rounded.
    #[inline]
    fn turns_back(&self, end: &End<F>, nm: F) -> bool {
        let is_rounded = !F::IS_SINGLE
            && self.stage == Stage::AtCap
            && nm > end.cap_nm - F::LIMIT_SLACK * end.cap_nm;
        self.play.hold() != Hold::Upper && !is_rounded
    }

    /// The joint meets the wall: the spring begins at its place. If the wall was moved
    /// under the joint, `before_rad` beyond it already, the spring begins there.
    #[cold]
    fn enter(
        &mut self,
        end: &End<F>,
        before_rad: F,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) {
        self.stage = Stage::In;
        let fraction = || {
            if before_rad > F::ZERO {
                F::ZERO
            } else {
                travel.reaches(&end.place)
            }
        };
        if self.play.torque_nm() == F::ZERO {
            let (place, hold) = if before_rad > F::ZERO {
                (travel.place(F::ZERO), Hold::Slack)
            } else {
                (end.place, Hold::Upper)
            };
            // Of the torque that a commit let fall nothing is left.
            self.play.rest(&place);
            self.play.put(&place, F::ZERO, hold);
        }
        on_change.tell(Word::Contact, fraction, F::ZERO, F::ZERO);
    }
}
