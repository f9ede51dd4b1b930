//! The effects that a scene can call for. What it does not list is not built,
//! not stepped, and absent from the outputs.

use super::Crepitus;
use crate::document::{Range, Section};
use crate::error::SceneError;
use crepitus_model::encoder::{ENCODER_PARAMETERS, EncoderSettings};
use crepitus_model::parameters::{PARAMETERS, ParameterSpec};
use crepitus_model::presets::{PRESETS, Preset};
use crepitus_model::{Convention, Restart, Settings};

/// An effect as lists and summaries name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effect {
    /// Name in scene files: the table `[effects.NAME]`.
    pub name: &'static str,
    /// Its state variables.
    pub states: &'static [&'static str],
    /// What it adds.
    pub adds: &'static str,
}

/// The stick-slip object.
pub(super) const CREPITUS: Effect = Effect {
    name: "crepitus",
    states: &["theta_rad", "theta_dot_rad_s"],
    adds: "the torque of the stick-slip object",
};

/// The motor's encoder.
pub(super) const ENCODER: Effect = Effect {
    name: "encoder",
    states: &["velocity estimate", "tracking lag"],
    adds: "whole counts instead of the true angle, and a velocity estimated from them",
};

/// All effects.
pub const EFFECTS: [Effect; 2] = [CREPITUS, ENCODER];

/// The effects of one scene.
#[derive(Default)]
pub(super) struct Effects {
    pub(super) crepitus: Option<Crepitus>,
    pub(super) encoder: Option<EncoderSettings>,
}

pub(super) fn read(section: Option<&Section<'_>>) -> Result<Effects, SceneError> {
    let Some(section) = section else {
        return Ok(Effects::default());
    };
    let effects = Effects {
        crepitus: section
            .optional_section(CREPITUS.name)?
            .map(|s| crepitus(&s))
            .transpose()?,
        encoder: section
            .optional_section(ENCODER.name)?
            .map(|s| encoder(&s))
            .transpose()?,
    };
    section.finish()?;
    Ok(effects)
}

fn crepitus(section: &Section<'_>) -> Result<Crepitus, SceneError> {
    let presets: Vec<(&str, &'static Preset)> = PRESETS.iter().map(|p| (p.name, p)).collect();
    let preset = section.optional_choice("preset", &presets)?;
    let conventions = Convention::ALL.map(|c| (c.name(), c));
    let restarts = Restart::ALL.map(|r| (r.name(), r));
    let mut settings = Settings {
        parameters: preset.map(|p| p.parameters).unwrap_or_default(),
        convention: section
            .optional_choice("convention", &conventions)?
            .unwrap_or_default(),
        restart: section
            .optional_choice("restart", &restarts)?
            .unwrap_or_default(),
    };
    numbers(section, &PARAMETERS, settings.parameters.values_mut())?;
    section.finish()?;
    Ok(Crepitus {
        preset: preset.map(|p| p.name),
        settings: settings
            .validate()
            .map_err(|e| section.error(e.to_string()))?,
    })
}

fn encoder(section: &Section<'_>) -> Result<EncoderSettings, SceneError> {
    let mut settings = EncoderSettings::default();
    numbers(section, &ENCODER_PARAMETERS, settings.values_mut())?;
    section.finish()?;
    Ok(settings)
}

/// Reads every number of a parameter table that the section gives.
fn numbers<const N: usize>(
    section: &Section<'_>,
    table: &[ParameterSpec; N],
    values: [&mut f64; N],
) -> Result<(), SceneError> {
    for (parameter, value) in table.iter().zip(values) {
        let range = Range::closed(parameter.min, parameter.max);
        if let Some(given) = section.optional_number(parameter.key, range)? {
            *value = given;
        }
    }
    Ok(())
}
