//! The play element, which carries most symptoms: a spring whose other end is
//! dragged along where its torque meets a limit.
//!
//! ```text
//! T = σ·(φ − a)        T > u:  T = u, a = φ − u/σ       "upper"
//!                      T < ℓ:  T = ℓ, a = φ − ℓ/σ       "lower"
//! ```
//!
//! The play needs no velocity, has no chatter at rest, and is exact at a tick's end if
//! the motion in the tick is monotone and no limit is steeper than σ. A limit
//! that falls takes the torque with it, one that rises changes nothing. Where a
//! limit jumps inside a tick, follow up to there with the old limits, then on with
//! the new ones.
//!
//! The end of the spring is kept as a place and the torque there, and renewed
//! only where the play is dragged: nothing accumulates.
//!
//! **Energy.** Over any time and motion it returns at most
//!
//! ```text
//! E ≤ T₀²/2σ + (½ + d)·σ·h·∫Ω² dt          d ticks late
//! ```

use super::symptom::{Change, Hear, Word};
use crate::real::Real;
use crate::render::position::{Position, Travel};

/// State of the spring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// Torque within the limits.
    #[default]
    Elastic,
    /// Dragged at the upper limit.
    Upper,
    /// Dragged at the lower limit.
    Lower,
    /// Dragged at a limit of zero: no torque.
    Slack,
}

/// The limits of a play, N·m: lower ≤ 0 ≤ upper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<F> {
    /// ℓ.
    pub lower_nm: F,
    /// u.
    pub upper_nm: F,
}

impl<F: Real> Limits<F> {
    /// Equal limits in both directions.
    #[inline]
    pub fn both(nm: F) -> Self {
        Self {
            lower_nm: -nm,
            upper_nm: nm,
        }
    }
}

/// A play element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play<F> {
    /// Place at which the torque was `there_nm`.
    place: Position<F>,
    there_nm: F,
    now_nm: F,
    hold: Hold,
    /// The torque that is still allowed beyond the limits after they were changed, N·m.
    allowed_nm: F,
    /// Fall of `allowed_nm` in a tick, N·m.
    slew_nm: F,
}

impl<F: Real> Default for Play<F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<F: Real> Play<F> {
    /// Returns a play without torque and not placed yet: [`Self::rest`] places it.
    pub fn new() -> Self {
        Self {
            place: Position::at(0),
            there_nm: F::ZERO,
            now_nm: F::ZERO,
            hold: Hold::Elastic,
            allowed_nm: F::ZERO,
            slew_nm: F::ZERO,
        }
    }

    /// Puts it at this place without torque.
    #[inline]
    pub fn rest(&mut self, place: &Position<F>) {
        self.put(place, F::ZERO, Hold::Elastic);
        self.allowed_nm = F::ZERO;
    }

    /// Puts it at this place with this torque.
    #[inline]
    pub fn put(&mut self, place: &Position<F>, nm: F, hold: Hold) {
        self.place = *place;
        (self.there_nm, self.now_nm, self.hold) = (nm, nm, hold);
    }

    /// The torque, N·m.
    #[inline]
    pub fn torque_nm(&self) -> F {
        self.now_nm
    }

    /// Place at which the spring, stretched on in the direction `sense`·φ, has this torque; `None`
    /// while more than the limits is allowed.
    pub fn reaches(&self, nm: F, stiffness: F, sense: F) -> Option<Position<F>> {
        let stretch_rad = (nm - self.there_nm) / stiffness;
        (self.allowed_nm == F::ZERO).then(|| self.place.moved(sense * stretch_rad))
    }

    /// State of the spring.
    #[inline]
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// The spring and the limits are others. With a stiffer spring the torque goes
    /// on, with a softer one it falls in proportion: its energy never rises. What
    /// lies beyond the new limits falls by `slew_nm` a tick.
    pub fn change(&mut self, stiffness: F, new_stiffness: F, slew_nm: F) {
        if stiffness > F::ZERO {
            let moved_rad = (self.now_nm - self.there_nm) / stiffness;
            self.now_nm = self.now_nm * (new_stiffness / stiffness).at_most(F::ONE);
            self.there_nm = self.now_nm - new_stiffness * moved_rad;
        }
        // Only in the direction of the torque, and no more than it is: a wall never
        // pulls, and none exceeds its cap.
        self.allowed_nm = self.now_nm;
        self.slew_nm = slew_nm;
        // A play has no place on limits that it has not met yet.
        if self.hold != Hold::Slack {
            self.hold = Hold::Elastic;
        }
    }

    /// Lets go of so much torque.
    pub fn release(&mut self, nm: F) {
        let less_nm = self.now_nm.within(nm);
        self.now_nm -= less_nm;
        self.there_nm -= less_nm;
        self.allowed_nm -= self.allowed_nm.within(nm);
        // Within its limits now: one that is dragged would go on from its limit.
        if less_nm != F::ZERO {
            self.hold = Hold::Elastic;
        }
    }

    /// Follows the joint, in the direction `sense`·φ, from the share `from` of a
    /// travel to the share `to`: the torque there, N·m. `limits` are those of a
    /// share of the travel.
    #[inline]
    pub fn follow<O: Hear<F>>(
        &mut self,
        travel: &Travel<F>,
        part: Part<F>,
        stiffness: F,
        limits: impl Fn(F) -> Limits<F>,
        on_change: &mut O,
    ) -> F {
        let end = End {
            place: part.end_place(travel),
            limits: limits(part.to),
        };
        self.follow_to(&end, (travel, part), stiffness, limits, on_change)
    }

    /// Follows the joint where the part's end is known already. The part's shares matter only to
    /// somebody who listens, and in f64.
    #[inline]
    pub fn follow_to<O: Hear<F>>(
        &mut self,
        end: &End<F>,
        (travel, part): (&Travel<F>, Part<F>),
        stiffness: F,
        limits: impl Fn(F) -> Limits<F>,
        on_change: &mut O,
    ) -> F {
        let End {
            place,
            limits:
                Limits {
                    mut lower_nm,
                    mut upper_nm,
                },
        } = *end;
        let moved_rad = part.sense * place.beyond(&self.place, travel.rad_per_count);
        let elastic_nm = self.there_nm + stiffness * moved_rad;
        if self.allowed_nm != F::ZERO {
            lower_nm = lower_nm.at_most(self.allowed_nm);
            upper_nm = upper_nm.at_least(self.allowed_nm);
            self.allowed_nm = self.allowed_nm - self.allowed_nm.within(self.slew_nm);
        }
        let was = self.hold;
        // A joint that rests at a limit is still there.
        if elastic_nm >= upper_nm {
            self.put(&place, upper_nm, dragged(Hold::Upper, upper_nm));
        } else if elastic_nm <= lower_nm {
            self.put(&place, lower_nm, dragged(Hold::Lower, lower_nm));
        } else {
            (self.now_nm, self.hold) = (elastic_nm, Hold::Elastic);
        }
        if self.hold != was && (O::LISTENS || !F::IS_SINGLE) {
            let passage = Passage {
                travel,
                part,
                stiffness,
                elastic_nm,
                limits,
            };
            passage.tell(was, self.hold, on_change);
            if !F::IS_SINGLE && travel.ticks == 1 && self.hold == Hold::Elastic {
                // As exact as f64 can show; f32 cannot, and saves the time. Where the
                // joint has been over a gap nobody knows.
                let turned = passage.turned(was);
                let there = travel.place(turned);
                let there_nm = passage.limit_nm(was, turned);
                let moved_rad = part.sense * place.beyond(&there, travel.rad_per_count);
                let now_nm = there_nm + stiffness * moved_rad;
                // A travel that goes far back in a tick has met another limit.
                if now_nm <= upper_nm && now_nm >= lower_nm {
                    (self.place, self.there_nm, self.now_nm) = (there, there_nm, now_nm);
                }
            }
        }
        self.now_nm
    }
}

/// State of a play that is at a limit.
#[inline]
pub fn dragged<F: Real>(at: Hold, limit_nm: F) -> Hold {
    if limit_nm == F::ZERO { Hold::Slack } else { at }
}

/// The end of a part of a travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<F> {
    /// The joint's place then.
    pub place: Position<F>,
    /// The limits there.
    pub limits: Limits<F>,
}

/// Part of a travel, in the direction of a torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part<F> {
    /// ±1: the torque is that against growing `sense`·φ.
    pub sense: F,
    /// Share of the travel at which it begins.
    pub from: F,
    /// Share of the travel at which it ends.
    pub to: F,
}

impl<F: Real> Part<F> {
    /// All of it.
    #[inline]
    pub fn whole(sense: F) -> Self {
        Self {
            sense,
            from: F::ZERO,
            to: F::ONE,
        }
    }

    /// All of it up to a share.
    #[inline]
    pub fn until(sense: F, to: F) -> Self {
        Self {
            sense,
            from: F::ZERO,
            to,
        }
    }

    /// All of it from a share on.
    #[inline]
    pub fn since(sense: F, from: F) -> Self {
        Self {
            sense,
            from,
            to: F::ONE,
        }
    }

    #[inline]
    fn end_place(&self, travel: &Travel<F>) -> Position<F> {
        if self.to == F::ONE {
            travel.to
        } else {
            travel.place(self.to)
        }
    }
}

/// A part of a travel in which the spring began to do something else.
struct Passage<'a, F, L> {
    travel: &'a Travel<F>,
    part: Part<F>,
    stiffness: F,
    elastic_nm: F,
    limits: L,
}

impl<F: Real, L: Fn(F) -> Limits<F>> Passage<'_, F, L> {
    /// Says what has changed, and when.
    fn tell(&self, was: Hold, is: Hold, on_change: &mut impl Hear<F>) {
        let mut tell = |word, fraction, hold| {
            let nm = self.part.sense * self.limit_nm(hold, fraction);
            on_change.hear(Change::at(word, fraction, nm, nm));
        };
        match was {
            Hold::Elastic => {}
            Hold::Slack => tell(Word::Take, self.turned(was), was),
            Hold::Upper | Hold::Lower if is == Hold::Slack => {}
            Hold::Upper | Hold::Lower => tell(Word::Turn, self.turned(was), was),
        }
        match is {
            Hold::Elastic => {}
            Hold::Slack => tell(Word::Slack, self.met(is), is),
            Hold::Upper | Hold::Lower => tell(Word::Flow, self.met(is), is),
        }
    }

    /// The limit at which the spring is dragged.
    fn limit_nm(&self, hold: Hold, fraction: F) -> F {
        let Limits { lower_nm, upper_nm } = (self.limits)(fraction);
        match hold {
            Hold::Upper => upper_nm,
            Hold::Lower => lower_nm,
            Hold::Elastic | Hold::Slack => F::ZERO,
        }
    }

    /// Share of the travel at which the torque of the spring met the limit: a few steps of the secant.
    fn met(&self, hold: Hold) -> F {
        let Self { travel, part, .. } = self;
        let end = part.end_place(travel);
        let beyond_nm = |fraction: F| {
            let back_rad = end.beyond(&travel.place(fraction), travel.rad_per_count);
            let elastic_nm = self.elastic_nm - self.stiffness * part.sense * back_rad;
            elastic_nm - self.limit_nm(hold, fraction)
        };
        let (mut low, mut fraction) = (part.from, part.to);
        let (mut low_nm, mut nm) = (beyond_nm(low), beyond_nm(fraction));
        for _ in 0..6 {
            if low_nm == nm {
                break;
            }
            let next = (low - low_nm * (fraction - low) / (nm - low_nm))
                .at_least(part.from)
                .at_most(part.to);
            (low, low_nm) = (fraction, nm);
            (fraction, nm) = (next, beyond_nm(next));
        }
        fraction
    }

    /// Share of the travel at which the spring fell behind the limit: where σΩ is the limit's rate. It may be
    /// noticed a tick later, so up to a tick before the travel.
    fn turned(&self, hold: Hold) -> F {
        let Self { travel, part, .. } = self;
        let stiffness = self.stiffness * part.sense;
        // The rate of φ over the travel is Δφ − b at its beginning, Δφ + b at its end.
        let rises_nm = stiffness * F::TWO * travel.bend_rad;
        let first_nm = stiffness * (travel.delta_rad - travel.bend_rad);
        let mut fraction = F::HALF;
        for _ in 0..4 {
            let rate_nm =
                self.limit_nm(hold, fraction + F::HALF) - self.limit_nm(hold, fraction - F::HALF);
            if rises_nm == F::ZERO {
                return part.from;
            }
            fraction = (rate_nm - first_nm) / rises_nm;
        }
        let earliest = if part.from > F::ZERO {
            part.from
        } else {
            -F::ONE
        };
        if fraction >= earliest && fraction <= part.to {
            fraction
        } else {
            // The velocity has jumped.
            part.from
        }
    }
}
