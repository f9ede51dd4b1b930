//! Signs of a knee: what an examiner has to do for each to appear, from the knee's own parameters.
//!
//! ```text
//!  parameters of the knee ── signs ──> Sign { effect, step, sense, rule } ──┬─> Guide: was it done, what was missed
//!                                                                           └─> the simulated examiner's motion
//! ```
//!
//! | effect | rule |
//! |---|---|
//! | range limit | the angle of each end that the brace reaches, and a little more |
//! | spasticity | s(φ − λ + μΩ) ≥ 0 with s·Ω ≥ Ωth, as in the law; of a catch, b·Ω has to be felt, too; of a reflex, λ is where it is felt |
//! | clonus | φh is crossed with Ωon, and held |
//! | clasp-knife | the angle of its collapse |
//! | rigidity, roughness, crepitus | any movement; of a cogwheel in time, one in which a tooth reaches its height |

use super::Step;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;

/// A torque that a hand tells from none, N·m: an estimate.
const FELT_NM: f64 = 0.3;

/// Angles that the brace reaches with all its torque, °.
const REACHED_DEG: core::ops::RangeInclusive<f64> = 0.0..=118.0;

/// Angle by which an end is passed at least, °.
const PASSED_DEG: f64 = 1.0;

/// Time for which clonus is held, s: three beats.
const HELD_S: f64 = 0.7;

/// Angles at which a stretch is still fast, °: it slows down towards its end.
const FAST_UNTIL_DEG: [f64; 2] = [30.0, 90.0];

/// Number of signs that a knee can have.
pub(super) const MOST: usize = 9;

/// A sign of a knee.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sign {
    /// Effect that it is of: the name of a group of parameters.
    pub effect: &'static str,
    /// Step that shows it.
    pub step: Step,
    /// Sense of the movement: 1 in flexion, −1 in extension.
    pub sense: f64,
    /// Condition on the movement.
    pub rule: Rule,
}

/// Condition on a movement, for a sign to appear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// A movement in either sense, of this speed or more.
    Move {
        /// Speed, °/s.
        least_deg_s: f64,
    },
    /// The leg comes to an angle.
    Reach {
        /// Angle, °.
        angle_deg: f64,
    },
    /// The leg passes a threshold that the speed shifts.
    Stretch {
        /// λ, °.
        threshold_deg: f64,
        /// μ, s.
        shift_s: f64,
        /// Ωth, °/s.
        least_deg_s: f64,
    },
    /// The leg passes an angle fast, and is held beyond.
    Hold {
        /// Angle, °.
        angle_deg: f64,
        /// Return from it that ends the hold, °.
        back_deg: f64,
        /// Speed, °/s.
        least_deg_s: f64,
        /// Time, s.
        time_s: f64,
    },
}

impl Sign {
    /// Least speed from which it appears, °/s; 0 if the speed does not matter. That of a threshold is
    /// where a stretch is still fast: at 90°, of flexors at 30°.
    pub fn appears_from_deg_s(&self) -> f64 {
        match self.rule {
            Rule::Move { least_deg_s } | Rule::Hold { least_deg_s, .. } => least_deg_s,
            Rule::Reach { .. } => 0.0,
            Rule::Stretch { least_deg_s, .. } => {
                let [extended_deg, bent_deg] = FAST_UNTIL_DEG;
                let is_flexion = self.sense > 0.0;
                let at_deg = if is_flexion { bent_deg } else { extended_deg };
                self.threshold_speed_deg_s(at_deg).max(least_deg_s)
            }
        }
    }

    /// Speed that passes the threshold of a stretch at an angle, °/s; of other rules, and where the angle
    /// alone passes it, 0.
    fn threshold_speed_deg_s(&self, angle_deg: f64) -> f64 {
        let Rule::Stretch {
            threshold_deg,
            shift_s,
            ..
        } = self.rule
        else {
            return 0.0;
        };
        let missing_deg = self.sense * (threshold_deg - angle_deg);
        if missing_deg > 0.0 {
            missing_deg / shift_s
        } else {
            0.0
        }
    }
}

/// The signs of a knee with these effects; `grates` where the imaginary object is on, too.
pub fn signs(effects: &EffectSettings, grates: bool) -> impl Iterator<Item = Sign> + use<> {
    let moved = |effect, least_deg_s| Sign {
        effect,
        step: Step::Slow,
        sense: 1.0,
        rule: Rule::Move { least_deg_s },
    };
    let [extension, flexion] = effects.range_limit.as_ref().map_or([None; 2], ends);
    [
        extension,
        flexion,
        effects.lead_pipe.map(|_| moved("lead-pipe", 0.0)),
        (effects.cogwheel.as_ref()).map(|wheel| moved("cogwheel", full_height_deg_s(wheel))),
        effects.spasticity.as_ref().map(stretched),
        effects.clasp_knife.as_ref().map(collapsing),
        effects.clonus.as_ref().map(held),
        effects.texture.map(|_| moved("texture", 0.0)),
        grates.then(|| moved("crepitus", 0.0)),
    ]
    .into_iter()
    .flatten()
}

/// The ends of the range that the brace reaches, in extension and in flexion.
fn ends(limit: &RangeLimitSettings) -> [Option<Sign>; 2] {
    let end = |sense: f64, limit_deg: f64, stiffness_nm_per_rad: f64| {
        let felt_deg = (FELT_NM / stiffness_nm_per_rad).to_degrees();
        let angle_deg = limit_deg + sense * felt_deg.max(PASSED_DEG);
        REACHED_DEG.contains(&angle_deg).then_some(Sign {
            effect: "range-limit",
            step: Step::Slow,
            sense,
            rule: Rule::Reach { angle_deg },
        })
    };
    [
        end(
            -1.0,
            limit.extension_limit_deg,
            limit.extension_stiffness_nm_per_rad,
        ),
        end(
            1.0,
            limit.flexion_limit_deg,
            limit.flexion_stiffness_nm_per_rad,
        ),
    ]
}

/// Speed from which a cogwheel's tooth reaches its height: (1 − ρ)·δ·f/D, °/s.
fn full_height_deg_s(wheel: &CogwheelSettings) -> f64 {
    if wheel.mode == 0 {
        (1.0 - wheel.low_share) * wheel.presliding_deg * wheel.frequency_hz / wheel.duty
    } else {
        0.0
    }
}

fn stretched(muscle: &SpasticitySettings) -> Sign {
    let sense = sense(muscle.muscles);
    let (threshold_deg, least_deg_s) = if muscle.catches() {
        let felt_deg_s = (FELT_NM / muscle.velocity_torque_nms_per_rad).to_degrees();
        let least_deg_s = muscle.threshold_velocity_deg_s.max(felt_deg_s);
        (muscle.threshold_deg, least_deg_s)
    } else {
        let felt_deg = (FELT_NM / muscle.gain_nm_per_rad).to_degrees();
        (muscle.threshold_deg + sense * felt_deg, 0.0)
    };
    Sign {
        effect: "spasticity",
        step: Step::Fast,
        sense,
        rule: Rule::Stretch {
            threshold_deg,
            shift_s: muscle.velocity_shift_s,
            least_deg_s,
        },
    }
}

fn collapsing(blade: &ClaspKnifeSettings) -> Sign {
    // The angle at which a torque makes it collapse is not known: it builds up from its onset on.
    let angle_deg = if blade.trigger == 0 {
        blade.release_deg
    } else {
        blade.onset_deg
    };
    Sign {
        effect: "clasp-knife",
        step: Step::Slow,
        sense: sense(blade.muscles),
        rule: Rule::Reach { angle_deg },
    }
}

fn held(muscle: &ClonusSettings) -> Sign {
    Sign {
        effect: "clonus",
        step: Step::Hold,
        sense: sense(muscle.muscles),
        rule: Rule::Hold {
            angle_deg: muscle.hold_deg,
            back_deg: muscle.hysteresis_deg,
            least_deg_s: muscle.start_velocity_deg_s,
            time_s: HELD_S,
        },
    }
}

/// Sense in which muscles are stretched: extensors in flexion.
fn sense(muscles: u8) -> f64 {
    if muscles == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
    use crepitus_model::render::effects::texture::TextureSettings;
    use std::vec::Vec;

    fn sign(effects: EffectSettings) -> Sign {
        let all: Vec<_> = signs(&effects, false).collect();
        assert_eq!(all.len(), 1, "{all:?}");
        all[0]
    }

    fn spastic(muscle: SpasticitySettings) -> Sign {
        sign(EffectSettings {
            spasticity: Some(muscle),
            ..EffectSettings::default()
        })
    }

    #[test]
    fn a_catch_appears_from_the_speed_of_its_threshold_on() {
        let of = |threshold_deg, velocity_torque_nms_per_rad| {
            let muscle = SpasticitySettings {
                threshold_deg,
                velocity_torque_nms_per_rad,
                ..SpasticitySettings::default()
            };
            spastic(muscle).appears_from_deg_s()
        };
        // (110 − 90)/0.25; the law's own least; what is felt of it.
        assert!((of(110.0, 0.67) - 80.0).abs() < 1e-9);
        assert!((of(75.0, 0.67) - 40.0).abs() < 1e-9);
        assert!((of(75.0, 0.1) - 3.0_f64.to_degrees()).abs() < 1e-9);
        let flexors = SpasticitySettings {
            muscles: 1,
            threshold_deg: 10.0,
            ..SpasticitySettings::default()
        };
        // (30 − 10)/0.25.
        assert!((spastic(flexors).appears_from_deg_s() - 80.0).abs() < 1e-9);
    }

    #[test]
    fn a_reflex_beyond_its_threshold_needs_no_speed() {
        let of = |threshold_deg, gain_nm_per_rad| {
            let muscle = SpasticitySettings {
                form: 1,
                threshold_deg,
                gain_nm_per_rad,
                ..SpasticitySettings::default()
            };
            spastic(muscle).appears_from_deg_s()
        };
        assert_eq!(of(50.0, 3.32), 0.0);
        assert!((of(110.0, 1.54) - 124.6).abs() < 0.1);
    }

    #[test]
    fn ends_out_of_reach_are_no_signs() {
        let of = |extension_limit_deg, flexion_limit_deg| {
            let limits = RangeLimitSettings {
                extension_limit_deg,
                flexion_limit_deg,
                ..RangeLimitSettings::default()
            };
            let effects = EffectSettings {
                range_limit: Some(limits),
                ..EffectSettings::default()
            };
            signs(&effects, false)
                .map(|sign| sign.sense)
                .collect::<Vec<_>>()
        };
        assert_eq!(of(10.0, 105.0), [-1.0, 1.0]);
        assert_eq!(of(10.0, 135.0), [-1.0]);
        assert_eq!(of(-5.0, 115.0), [1.0]);
    }

    #[test]
    fn a_knee_has_all_its_signs_and_a_healthy_one_has_none() {
        assert_eq!(signs(&EffectSettings::default(), false).count(), 0);
        let all = EffectSettings {
            range_limit: Some(RangeLimitSettings::default()),
            lead_pipe: Some(LeadPipeSettings::default()),
            cogwheel: Some(CogwheelSettings::default()),
            spasticity: Some(SpasticitySettings::default()),
            clasp_knife: Some(ClaspKnifeSettings::default()),
            clonus: Some(ClonusSettings::default()),
            texture: Some(TextureSettings::default()),
            ..EffectSettings::default()
        };
        // The default end in flexion is out of reach.
        let found: Vec<_> = signs(&all, true).collect();
        assert_eq!(found.len(), MOST - 1);
        let wheel = found.iter().find(|sign| sign.effect == "cogwheel").unwrap();
        assert!((wheel.appears_from_deg_s() - 11.25).abs() < 1e-9);
    }

    #[test]
    fn a_clasp_knife_collapses_where_its_trigger_says() {
        let of = |trigger| {
            let blade = ClaspKnifeSettings {
                trigger,
                ..ClaspKnifeSettings::default()
            };
            let effects = EffectSettings {
                clasp_knife: Some(blade),
                ..EffectSettings::default()
            };
            sign(effects).rule
        };
        assert_eq!(of(0), Rule::Reach { angle_deg: 75.0 });
        // By torque: somewhere behind its onset.
        assert_eq!(of(1), Rule::Reach { angle_deg: 30.0 });
    }
}
