//! `encoder`: what the device knows of the shaft. Counts come from
//! [`crate::encoder`], the estimate from `crepitus_model::encoder`.

use crate::effect::{Effect, Part};
use crepitus_model::encoder::ENCODER_PARAMETERS;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "encoder",
    adds: "whole counts instead of the true angle, and a velocity estimated from them",
    states: &["velocity estimate", "tracking lag"],
    parameters: &ENCODER_PARAMETERS,
    choices: &[],
    needs: &[],
    part: Part::Sensor,
};
