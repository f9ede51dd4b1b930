//! `friction-compensation`: the device's feed-forward against the gear's dry
//! friction. The law is the firmware's: `crepitus_model::render::friction_compensation`
//! has its equation, sources, and what it may give to the hand.

use crate::effect::{Effect, Need, Part};
use crepitus_model::render::friction_compensation::FrictionCompensationSettings;
use crepitus_model::parameters::Tabled;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "friction-compensation",
    adds: "the device's feed-forward against a share of the gear's dry friction",
    states: &[],
    parameters: FrictionCompensationSettings::TABLE,
    choices: &[],
    needs: &[Need {
        effect: "drivetrain",
        why: "without it there is no friction to compensate",
    }],
    part: Part::Stage("compensation_nm"),
};
