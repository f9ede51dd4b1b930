//! `bone-shaping`: the ringing of a bone, struck by the model's events. The
//! law, its limits and its budget of energy are the firmware's:
//! `crepitus_model::render::bone_shaping`.

use crate::effect::{Effect, Need, Part};
use crepitus_model::render::bone_shaping::BoneShapingSettings;
use crepitus_model::parameters::Tabled;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "bone-shaping",
    adds: "a ringing of the rendered torque where cuff and tissue swallow that of the bone",
    states: &["ringing", "its rate"],
    parameters: BoneShapingSettings::TABLE,
    choices: &[],
    needs: &[Need {
        effect: "crepitus",
        why: "it rings where the model's torque jumps",
    }],
    part: Part::Stage("shaping_nm"),
};
