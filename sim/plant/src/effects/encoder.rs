//! `encoder`: the shaft as the device measures it. Counts come from
//! [`crate::encoder`], the estimate from `crepitus_model::control::encoder`.

use crate::effect::{Effect, Part};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Tabled;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "encoder",
    adds: "whole counts instead of the true angle, and a velocity estimated from them",
    states: &["velocity estimate", "tracking lag"],
    parameters: EncoderSettings::TABLE,
    choices: &[],
    needs: &[],
    part: Part::Sensor,
};
