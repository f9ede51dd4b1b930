//! The `[effects]` table. An effect that is not listed is not built, not stepped, and
//! absent from the outputs.

use crate::document::{Range, Section};
use crate::error::SceneError;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::{Chosen, ParameterSpec, Tabled};
use crepitus_model::render::effects::{EffectSettings, EffectSpec, IS_SYMPTOM, SPECS};
use crepitus_model::{Convention, Restart, Settings, Validated};
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Given, Part};
use crepitus_plant::effects::EFFECTS;

/// The effects of one scene.
#[derive(Default)]
pub(crate) struct Effects {
    pub(crate) crepitus: Option<Crepitus>,
    pub(crate) encoder: Option<EncoderSettings>,
    /// All others, in the order of the table.
    pub(crate) listed: Vec<Listed>,
}

/// The `crepitus` effect of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Crepitus {
    /// The preset whose numbers it has, if it started from one and none was changed.
    pub preset: Option<&'static str>,
    /// The active settings.
    pub settings: Validated<Settings>,
}

/// A preset, as effects start from it.
#[derive(Clone, Copy)]
pub(crate) struct Start<'p> {
    pub(crate) name: &'static str,
    pub(crate) crepitus: Option<&'p Crepitus>,
    /// All other effects, in the order of the table.
    pub(crate) listed: &'p [Listed],
}

impl Start<'_> {
    fn has(&self, effect: &Effect) -> bool {
        match effect.part {
            Part::Joint => self.crepitus.is_some(),
            _ => self.listed.iter().any(|l| l.effect.name == effect.name),
        }
    }
}

/// List of the presets that effects may start from.
pub(crate) type Starts<'f, 'p> = &'f dyn Fn() -> Vec<Start<'p>>;

/// The effects of a scene: each with those that it needs.
pub(crate) fn read(
    section: Option<&Section<'_>>,
    presets: Starts<'_, '_>,
) -> Result<Effects, SceneError> {
    let Some(section) = section else {
        return Ok(Effects::default());
    };
    let effects = read_alone(section, presets)?;
    for effect in EFFECTS {
        let Some(own) = section.optional_section(effect.name)? else {
            continue;
        };
        for need in effect.needs {
            if !section.has(need.effect) {
                return Err(own.error(format!(
                    "\"{}\" needs [effects.{}] too: {}",
                    effect.name, need.effect, need.why
                )));
            }
        }
    }
    Ok(effects)
}

/// Effects that may start from these presets, without those that they need.
pub(crate) fn read_alone(
    section: &Section<'_>,
    presets: Starts<'_, '_>,
) -> Result<Effects, SceneError> {
    let mut effects = Effects::default();
    for effect in EFFECTS {
        let Some(own) = section.optional_section(effect.name)? else {
            continue;
        };
        match effect.part {
            Part::Joint => effects.crepitus = Some(crepitus(&own, effect, presets)?),
            Part::Sensor => effects.encoder = Some(encoder(&own, effect)?),
            _ => effects.listed.push(Listed {
                effect,
                given: given(&own, effect, presets)?,
            }),
        }
    }
    section.finish()?;
    Ok(effects)
}

/// The preset that a section starts from, if any: of those that have its effect.
/// Presets are read where one is named, so that a scene without is as quick as ever.
fn base<'p>(
    section: &Section<'_>,
    effect: &Effect,
    presets: Starts<'_, 'p>,
) -> Result<Option<Start<'p>>, SceneError> {
    if !is_disorder(effect) || section.optional_text("preset")?.is_none() {
        return Ok(None);
    }
    let choices: Vec<_> = presets()
        .into_iter()
        .filter(|preset| preset.has(effect))
        .map(|preset| (preset.name, preset))
        .collect();
    let named = section.optional_choice("preset", &choices);
    named.map_err(|error| SceneError {
        message: format!(
            "{}; your own presets cannot be named here, but you can copy the values from the file of one",
            error.message
        ),
        ..error
    })
}

/// The key with which a section gives a parameter or a choice, if it does: its own,
/// or the one for all sides.
pub(crate) fn written_as<'k>(
    section: &Section<'_>,
    effect: &Effect,
    key: &'k str,
) -> Option<&'k str> {
    let sides: &[&str] = match effect.part {
        Part::Stage(spec) => spec.sides,
        _ => &[],
    };
    let of_all = sides.iter().find_map(|side| key.strip_prefix(side));
    [Some(key), of_all]
        .into_iter()
        .flatten()
        .find(|key| section.has(key))
}

fn crepitus(
    section: &Section<'_>,
    effect: &Effect,
    presets: Starts<'_, '_>,
) -> Result<Crepitus, SceneError> {
    let preset = base(section, effect, presets)?;
    let start = preset.and_then(|preset| preset.crepitus);
    let start = start.map_or_else(Settings::default, |crepitus| *crepitus.settings);
    let conventions = Convention::ALL.map(|c| (c.name(), c));
    let restarts = Restart::ALL.map(|r| (r.name(), r));
    let mut settings = Settings {
        parameters: start.parameters,
        convention: section.choice_or("convention", &conventions, start.convention)?,
        restart: section.choice_or("restart", &restarts, start.restart)?,
    };
    numbers(section, effect.parameters, settings.parameters.values_mut())?;
    section.finish()?;
    // With other numbers it is not that knee any more.
    let preset = preset.filter(|_| settings.parameters == start.parameters);
    Ok(Crepitus {
        preset: preset.map(|preset| preset.name),
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
fn given(
    section: &Section<'_>,
    effect: &Effect,
    presets: Starts<'_, '_>,
) -> Result<Given, SceneError> {
    let start = base(section, effect, presets)?.and_then(|preset| {
        let of_it = |listed: &&Listed| listed.effect.name == effect.name;
        preset.listed.iter().find(of_it)
    });
    let mut given = start.map_or_else(|| Given::defaults(effect), |l| l.given.clone());
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

/// Returns whether an effect renders a disorder.
pub fn is_disorder(effect: &Effect) -> bool {
    let mut symptoms = SPECS.iter().zip(IS_SYMPTOM);
    matches!(effect.part, Part::Joint)
        || symptoms.any(|(spec, is_symptom)| *is_symptom && spec.name == effect.name)
}

/// Settings of the device's effects among those that are listed.
pub(crate) fn effect_settings(listed: &[Listed]) -> EffectSettings {
    EffectSettings::given(|name| {
        let listed = listed.iter().find(|l| l.effect.name == name)?;
        Some(Chosen {
            numbers: &listed.given.numbers,
            options: &listed.given.choices,
        })
    })
}
