//! The `[effects]` table. An effect that is not listed is not built, not stepped, and
//! absent from the outputs.

use super::Crepitus;
use crate::document::{Range, Section};
use crate::error::SceneError;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::joint::presets::{PRESETS, Preset};
use crepitus_model::parameters::ParameterSpec;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::EffectSpec;
use crepitus_model::{Convention, Restart, Settings};
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Given, Part};
use crepitus_plant::effects::EFFECTS;

/// The effects of one scene.
#[derive(Default)]
pub(super) struct Effects {
    pub(super) crepitus: Option<Crepitus>,
    pub(super) encoder: Option<EncoderSettings>,
    /// All others, in the order of the table.
    pub(super) listed: Vec<Listed>,
}

pub(super) fn read(section: Option<&Section<'_>>) -> Result<Effects, SceneError> {
    let mut effects = Effects::default();
    let Some(section) = section else {
        return Ok(effects);
    };
    let mut present = Vec::new();
    for effect in EFFECTS {
        let Some(own) = section.optional_section(effect.name)? else {
            continue;
        };
        match effect.part {
            Part::Joint => effects.crepitus = Some(crepitus(&own, effect)?),
            Part::Sensor => effects.encoder = Some(encoder(&own, effect)?),
            _ => effects.listed.push(Listed {
                effect,
                given: given(&own, effect)?,
            }),
        }
        present.push((effect, own));
    }
    section.finish()?;
    for (effect, own) in &present {
        for need in effect.needs {
            if !present.iter().any(|(other, _)| other.name == need.effect) {
                return Err(own.error(format!(
                    "\"{}\" needs [effects.{}] too: {}",
                    effect.name, need.effect, need.why
                )));
            }
        }
    }
    Ok(effects)
}

fn crepitus(section: &Section<'_>, effect: &Effect) -> Result<Crepitus, SceneError> {
    let presets: Vec<(&str, &'static Preset)> = PRESETS.iter().map(|p| (p.name, p)).collect();
    let preset = section.optional_choice("preset", &presets)?;
    let conventions = Convention::ALL.map(|c| (c.name(), c));
    let restarts = Restart::ALL.map(|r| (r.name(), r));
    let mut settings = Settings {
        parameters: preset.map(|p| p.parameters).unwrap_or_default(),
        convention: section.choice_or("convention", &conventions, Convention::default())?,
        restart: section.choice_or("restart", &restarts, Restart::default())?,
    };
    numbers(section, effect.parameters, settings.parameters.values_mut())?;
    section.finish()?;
    Ok(Crepitus {
        preset: preset.map(|p| p.name),
        settings: settings
            .validate()
            .map_err(|e| section.error(e.to_string()))?,
    })
}

fn encoder(section: &Section<'_>, effect: &Effect) -> Result<EncoderSettings, SceneError> {
    let mut settings = EncoderSettings::default();
    numbers(section, effect.parameters, settings.values_mut())?;
    section.finish()?;
    Ok(settings)
}

/// The numbers and choices of any effect.
fn given(section: &Section<'_>, effect: &Effect) -> Result<Given, SceneError> {
    let mut given = Given::defaults(effect);
    if let Part::Stage(spec) = effect.part {
        both_sides(section, spec, &mut given.numbers)?;
    }
    numbers(section, effect.parameters, &mut given.numbers)?;
    for (choice, chosen) in effect.choices.iter().zip(&mut given.choices) {
        let names: Vec<(&str, u8)> = choice.names.iter().copied().zip(0..).collect();
        *chosen = section.choice_or(choice.key, &names, *chosen)?;
    }
    section.finish()?;
    Ok(given)
}

/// Numbers that a section gives for all sides at once.
fn both_sides(
    section: &Section<'_>,
    spec: &EffectSpec,
    values: &mut [f64],
) -> Result<(), SceneError> {
    for (parameter, value) in spec.parameters.iter().zip(values) {
        let of_side = |side: &&str| parameter.key.strip_prefix(*side);
        if let Some(key) = spec.sides.iter().find_map(of_side) {
            let range = Range::closed(parameter.min, parameter.max);
            *value = section.optional_number(key, range)?.unwrap_or(*value);
        }
    }
    Ok(())
}

/// Reads every number of a parameter table that the section gives.
fn numbers<'a>(
    section: &Section<'_>,
    table: &[ParameterSpec],
    values: impl IntoIterator<Item = &'a mut f64>,
) -> Result<(), SceneError> {
    for (parameter, value) in table.iter().zip(values) {
        let range = Range::closed(parameter.min, parameter.max);
        *value = section.number_or(parameter.key, range, *value)?;
    }
    Ok(())
}
