//! `crepitus`: the stick-slip object. The scene's solver renders it; its
//! equations, numbers and conventions are those of `crepitus_model`.

use crate::effect::{Effect, Part};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "crepitus",
    adds: "the torque of the stick-slip object",
    states: &["theta_rad", "theta_dot_rad_s"],
    parameters: Parameters::TABLE,
    choices: &[],
    needs: &[],
    part: Part::Joint,
};
