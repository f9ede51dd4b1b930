//! Guide: whether the movement was made that shows a sign, and what was missing.

use super::LegSample;
use super::signs::{MOST, Rule, Sign, signs};
use crepitus_model::render::effects::EffectSettings;

/// Travel that is an examination at all, °.
const MOVED_DEG: f64 = 10.0;

/// A slower leg rests, °/s.
const REST_DEG_S: f64 = 3.0;

/// A sign, and whether it was shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The sign.
    pub sign: Sign,
    /// Whether it was shown.
    pub outcome: Outcome,
}

/// Whether the movement was made that shows a sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The movement was made.
    Shown,
    /// The leg was hardly moved.
    NotMoved,
    /// The movement was too slow.
    TooSlow {
        /// The highest speed in the sense of the sign, °/s.
        fastest_deg_s: f64,
        /// Speed from which the sign appears, °/s.
        least_deg_s: f64,
    },
    /// The leg did not come far enough.
    TooShort {
        /// Furthest angle in the sense of the sign, °.
        furthest_deg: f64,
        /// Angle at which the sign appears, °.
        needed_deg: f64,
    },
    /// The movement was fast enough, but no more so at the angle at which the sign appears then.
    NotThere {
        /// That angle, °.
        needed_deg: f64,
    },
    /// The leg was not held for long enough.
    NotHeld {
        /// Longest time for which it was held, s.
        held_s: f64,
        /// Time that it takes, s.
        needed_s: f64,
    },
}

impl Outcome {
    /// Name in messages and in texts of a page.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Shown => "shown",
            Self::NotMoved => "not-moved",
            Self::TooSlow { .. } => "too-slow",
            Self::TooShort { .. } => "too-short",
            Self::NotThere { .. } => "not-there",
            Self::NotHeld { .. } => "not-held",
        }
    }

    /// Numbers of what was reached and of what it takes, as far as there are any.
    pub const fn numbers(&self) -> [Option<f64>; 2] {
        match *self {
            Self::Shown | Self::NotMoved => [None, None],
            Self::TooSlow {
                fastest_deg_s: reached,
                least_deg_s: needed,
            }
            | Self::TooShort {
                furthest_deg: reached,
                needed_deg: needed,
            }
            | Self::NotHeld {
                held_s: reached,
                needed_s: needed,
            } => [Some(reached), Some(needed)],
            Self::NotThere { needed_deg } => [None, Some(needed_deg)],
        }
    }
}

/// Progress of all signs of a knee.
#[derive(Clone, Debug, Default)]
pub(super) struct Guide {
    all: [Option<Progress>; MOST],
}

/// Progress of a sign. Angles and speeds are in its sense.
#[derive(Clone, Copy, Debug)]
struct Progress {
    sign: Sign,
    is_shown: bool,
    /// Nearest and furthest angle, °; none before the first sample.
    ends_deg: Option<[f64; 2]>,
    fastest_deg_s: f64,
    /// Angle of the last sample, °.
    last_deg: Option<f64>,
    /// Time since which a leg is held that was stretched fast, s.
    held_since_s: Option<f64>,
    held_s: f64,
}

impl Guide {
    /// Begins with the signs of a knee.
    pub(super) fn new(effects: &EffectSettings, grates: bool) -> Self {
        let mut guide = Self::default();
        for (place, sign) in guide.all.iter_mut().zip(signs(effects, grates)) {
            *place = Some(Progress {
                sign,
                is_shown: false,
                ends_deg: None,
                fastest_deg_s: 0.0,
                last_deg: None,
                held_since_s: None,
                held_s: 0.0,
            });
        }
        guide
    }

    /// The signs, and whether they were shown.
    pub(super) fn findings(&self) -> impl Iterator<Item = Finding> {
        self.all.iter().flatten().map(|progress| Finding {
            sign: progress.sign,
            outcome: progress.outcome(),
        })
    }

    /// Samples are missing.
    pub(super) fn pause(&mut self) {
        for progress in self.all.iter_mut().flatten() {
            (progress.last_deg, progress.held_since_s) = (None, None);
        }
    }

    /// Takes the next sample.
    pub(super) fn take(&mut self, sample: &LegSample) {
        for progress in self.all.iter_mut().flatten() {
            progress.take(sample);
        }
    }
}

impl Progress {
    fn take(&mut self, sample: &LegSample) {
        let sense = self.sign.sense;
        let at_deg = sense * sample.angle_rad.to_degrees();
        let deg_s = sense * sample.omega_rad_s.to_degrees();
        // A leg that begins beyond an end has not met it.
        if let Rule::Reach { angle_deg } = self.sign.rule
            && self.ends_deg.is_none()
            && at_deg >= sense * angle_deg
        {
            return;
        }
        let [nearest_deg, furthest_deg] = self.ends_deg.unwrap_or([at_deg; 2]);
        self.ends_deg = Some([nearest_deg.min(at_deg), furthest_deg.max(at_deg)]);
        let last_deg = self.last_deg.replace(at_deg).unwrap_or(at_deg);
        let fast_deg_s = if matches!(self.sign.rule, Rule::Move { .. }) {
            deg_s.abs()
        } else {
            deg_s
        };
        self.fastest_deg_s = self.fastest_deg_s.max(fast_deg_s);
        let is_shown = match self.sign.rule {
            Rule::Move { least_deg_s } => {
                self.travel_deg() >= MOVED_DEG && fast_deg_s >= least_deg_s.max(REST_DEG_S)
            }
            Rule::Reach { angle_deg } => at_deg >= sense * angle_deg,
            Rule::Stretch {
                threshold_deg,
                shift_s,
                least_deg_s,
            } => {
                let beyond_deg = at_deg - sense * threshold_deg + shift_s * deg_s;
                deg_s >= least_deg_s && beyond_deg >= 0.0
            }
            Rule::Hold {
                angle_deg,
                back_deg,
                least_deg_s,
                time_s,
            } => {
                let hold_deg = sense * angle_deg;
                let crosses = last_deg < hold_deg && hold_deg <= at_deg;
                if crosses && deg_s >= least_deg_s {
                    self.held_since_s = Some(sample.time_s);
                } else if at_deg <= hold_deg - back_deg {
                    self.held_since_s = None;
                }
                let held_s = self.held_since_s.map(|since_s| sample.time_s - since_s);
                self.held_s = self.held_s.max(held_s.unwrap_or(0.0));
                self.held_s >= time_s
            }
        };
        self.is_shown |= is_shown;
    }

    fn travel_deg(&self) -> f64 {
        self.ends_deg
            .map_or(0.0, |[nearest, furthest]| furthest - nearest)
    }

    fn outcome(&self) -> Outcome {
        if self.is_shown {
            return Outcome::Shown;
        }
        if self.travel_deg() < MOVED_DEG {
            return Outcome::NotMoved;
        }
        let sense = self.sign.sense;
        let furthest_deg = self.ends_deg.map_or(0.0, |[_, furthest]| sense * furthest);
        let least_deg_s = self.sign.appears_from_deg_s();
        let too_slow = Outcome::TooSlow {
            fastest_deg_s: self.fastest_deg_s,
            least_deg_s,
        };
        let too_short = |needed_deg| Outcome::TooShort {
            furthest_deg,
            needed_deg,
        };
        match self.sign.rule {
            Rule::Move { .. } => too_slow,
            Rule::Reach { angle_deg } => too_short(angle_deg),
            Rule::Hold { time_s, .. } if self.held_s > 0.0 => Outcome::NotHeld {
                held_s: self.held_s,
                needed_s: time_s,
            },
            _ if self.fastest_deg_s < least_deg_s => too_slow,
            Rule::Stretch {
                threshold_deg,
                shift_s,
                ..
            } => Outcome::NotThere {
                needed_deg: threshold_deg - sense * shift_s * self.fastest_deg_s,
            },
            Rule::Hold { angle_deg, .. } if sense * (angle_deg - furthest_deg) > 0.0 => {
                too_short(angle_deg)
            }
            Rule::Hold { angle_deg, .. } => Outcome::NotThere {
                needed_deg: angle_deg,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::clonus::ClonusSettings;
    use crepitus_model::render::effects::range_limit::RangeLimitSettings;
    use crepitus_model::render::effects::spasticity::SpasticitySettings;

    /// Outcome of the last sign of a knee after strokes from 10°: each to an angle, °, at a speed,
    /// °/s, held for a time, s, and back at 30 °/s.
    fn outcome(effects: &EffectSettings, strokes: &[[f64; 3]]) -> Outcome {
        let mut guide = Guide::new(effects, false);
        let mut time_s = 0.0;
        // From an angle at a speed, for a time.
        let mut go = |from_deg: f64, deg_s: f64, seconds: f64| {
            let begin_s = time_s;
            while time_s < begin_s + seconds {
                guide.take(&LegSample {
                    time_s,
                    angle_rad: (from_deg + deg_s * (time_s - begin_s)).to_radians(),
                    omega_rad_s: deg_s.to_radians(),
                    torque_nm: 0.0,
                });
                time_s += 1e-3;
            }
        };
        for [to_deg, deg_s, held_s] in strokes {
            go(10.0, *deg_s, (to_deg - 10.0) / deg_s);
            go(*to_deg, 0.0, *held_s);
            go(*to_deg, -30.0, (to_deg - 10.0) / 30.0);
        }
        guide.findings().last().unwrap().outcome
    }

    fn spastic() -> EffectSettings {
        EffectSettings {
            spasticity: Some(SpasticitySettings {
                threshold_deg: 110.0,
                ..SpasticitySettings::default()
            }),
            ..EffectSettings::default()
        }
    }

    /// The catch appears from 80 °/s on, as (110 − 90)/0.25.
    #[test]
    fn a_stretch_was_fast_enough_where_it_mattered_or_not() {
        let effects = spastic();
        assert_eq!(outcome(&effects, &[[100.0, 120.0, 0.0]]), Outcome::Shown);
        let slow = outcome(&effects, &[[95.0, 45.0, 0.0]]);
        let Outcome::TooSlow {
            fastest_deg_s,
            least_deg_s,
        } = slow
        else {
            panic!("{slow:?}");
        };
        assert!((fastest_deg_s - 45.0).abs() < 1e-9 && (least_deg_s - 80.0).abs() < 1e-9);
        // 110 − 0.25·120: fast to 70°, and slowly beyond.
        let both = outcome(&effects, &[[70.0, 120.0, 0.0], [95.0, 45.0, 0.0]]);
        let Outcome::NotThere { needed_deg } = both else {
            panic!("{both:?}");
        };
        assert!((needed_deg - 80.0).abs() < 1e-9);
        assert_eq!(outcome(&effects, &[[12.0, 120.0, 0.0]]), Outcome::NotMoved);
    }

    #[test]
    fn clonus_needs_speed_angle_and_time() {
        let effects = EffectSettings {
            clonus: Some(ClonusSettings::default()),
            ..EffectSettings::default()
        };
        let of = |stroke: [f64; 3]| outcome(&effects, &[stroke]).name();
        assert_eq!(of([75.0, 200.0, 1.0]), "shown");
        assert_eq!(of([75.0, 60.0, 1.0]), "too-slow");
        assert_eq!(of([50.0, 200.0, 1.0]), "too-short");
        assert_eq!(of([65.0, 200.0, 0.0]), "not-held");
        // Fast to 50°, and slowly past 60°.
        let elsewhere = outcome(&effects, &[[50.0, 200.0, 0.0], [75.0, 30.0, 1.0]]);
        assert_eq!(elsewhere.name(), "not-there");
    }

    /// 5° of return stop clonus; 3° do not.
    #[test]
    fn a_return_within_the_hysteresis_is_still_a_hold() {
        let effects = EffectSettings {
            clonus: Some(ClonusSettings::default()),
            ..EffectSettings::default()
        };
        let held = |back_deg: f64| {
            let mut guide = Guide::new(&effects, false);
            for (time_s, deg, deg_s) in [
                (0.0, 10.0, 0.0),
                (0.3, 65.0, 200.0),
                (0.35, 65.0, 0.0),
                (0.4, 60.0 - back_deg, 0.0),
                (1.2, 60.0 - back_deg, 0.0),
            ] {
                guide.take(&LegSample {
                    time_s,
                    angle_rad: f64::to_radians(deg),
                    omega_rad_s: f64::to_radians(deg_s),
                    torque_nm: 0.0,
                });
            }
            guide.findings().last().unwrap().outcome.name()
        };
        assert_eq!((held(3.0), held(6.0)), ("shown", "not-held"));
    }

    #[test]
    fn an_end_is_reached_or_not() {
        let effects = EffectSettings {
            range_limit: Some(RangeLimitSettings {
                extension_limit_deg: -10.0,
                flexion_limit_deg: 105.0,
                ..RangeLimitSettings::default()
            }),
            ..EffectSettings::default()
        };
        assert_eq!(outcome(&effects, &[[110.0, 30.0, 0.0]]), Outcome::Shown);
        let short = outcome(&effects, &[[95.0, 30.0, 0.0]]);
        let [reached, needed] = short.numbers().map(Option::unwrap);
        assert_eq!(short.name(), "too-short");
        assert!((reached - 95.0).abs() < 0.1 && needed == 106.0);
    }

    /// A straight leg is beyond an end of 20° in extension, and is so again when it comes back.
    #[test]
    fn a_leg_that_begins_beyond_an_end_has_not_met_it() {
        let effects = EffectSettings {
            range_limit: Some(RangeLimitSettings {
                extension_limit_deg: 20.0,
                flexion_limit_deg: 135.0,
                ..RangeLimitSettings::default()
            }),
            ..EffectSettings::default()
        };
        assert_eq!(outcome(&effects, &[[12.0, 30.0, 0.0]]), Outcome::NotMoved);
        assert_eq!(outcome(&effects, &[[80.0, 30.0, 0.0]]), Outcome::Shown);
    }
}
