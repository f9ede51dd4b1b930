//! The device's parameters of a scene or a preset.

use crate::Scene;
use crate::preset::Preset;
use crate::scene::Crepitus;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::{Owner, SPECS};
use crepitus_model::{Convention, Restart};
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Given};
use crepitus_plant::effects::{EFFECTS, crepitus};
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{Kind, PARAMETERS, find, id};
use crepitus_protocol::{DeviceSettings, ValueError};

/// The choice that switches an effect.
pub const RENDER: &str = "render";

/// Reason why a scene cannot be rendered by a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotRendered {
    /// The firmware renders one convention.
    #[error("a device renders the convention \"frozen\" only; the scene has \"{0}\"")]
    Convention(&'static str),
    /// The convention has no damping.
    #[error("a device renders a joint without damping only; set damping_nms_per_rad to 0")]
    Damping,
}

/// The values of a scene: its effects are enabled, others disabled, and
/// unspecified parameters have their defaults.
///
/// # Errors
/// [`NotRendered`] if no device can render it.
pub fn values(scene: &Scene) -> Result<Values, NotRendered> {
    let mut values = Values::default();
    for effect in EFFECTS {
        set(
            &mut values,
            effect,
            scene.has(effect.name),
            &scene.given(effect),
        );
    }
    if let Some(joint) = &scene.crepitus {
        values = with_joint(values, joint)?;
    }
    Ok(values)
}

/// The values of a device that gets the effects of a scene: those that it does not
/// list go off, those of the knee to their defaults. What the hardware is and may do stays:
/// encoder, motor, limits, range, sensor, and the numbers of friction and actuator.
///
/// # Errors
/// [`NotRendered`] if no device can render it.
pub fn with_scene(now: &Values, scene: &Scene) -> Result<Values, NotRendered> {
    let of_scene = values(scene)?;
    let mut values = *now;
    for parameter in &PARAMETERS {
        // Of the brace's that the scene leaves out, the numbers stay.
        let is_set =
            is_of_knee(parameter.group) || scene.has(parameter.group) || parameter.key() == RENDER;
        if is_effect(parameter.group)
            && is_set
            && let Some(value) = of_scene.get(parameter.id)
        {
            values.set(parameter.id, value);
        }
    }
    Ok(values)
}

/// The values of a device that gets the knee of a preset: its effects at the preset's
/// values, or at their defaults where it gives none. `keeps_others` decides over other
/// effects of [a knee](is_of_knee): they stay, or go off and to their defaults. All else
/// stays.
pub fn with_preset(now: &Values, preset: &Preset, keeps_others: bool) -> Values {
    let mut values = *now;
    for effect in EFFECTS {
        let listed = preset.listed.iter().find(|l| l.effect.name == effect.name);
        if let Some(listed) = listed {
            set(&mut values, effect, true, &listed.given);
        } else if is_of_knee(effect.name) && !keeps_others {
            set(&mut values, effect, false, &Given::defaults(effect));
        }
    }
    match &preset.crepitus {
        // A preset was read with what a device renders.
        Some(joint) => with_joint(values, joint).unwrap_or(values),
        None => values,
    }
}

/// Error of a value that is given by a parameter's name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NamedError {
    /// There is no such parameter.
    #[error("no parameter {name:?}{}; `crepitus params list` lists them", crate::similar::question(.similar.as_deref()))]
    Unknown {
        /// The name.
        name: String,
        /// The name that is meant, probably.
        similar: Option<String>,
    },
    /// The parameter is not one of a knee.
    #[error("{0} is the brace's own; expected a parameter of an effect of the knee")]
    NotOfKnee(String),
    /// The value is not allowed.
    #[error("{name} = {value}: expected {allowed}")]
    Value {
        /// The name.
        name: String,
        /// The value.
        value: f64,
        /// Valid values.
        allowed: String,
    },
    /// The values contradict each other.
    #[error("a device refuses these values together: {0:?}")]
    Together(ValueError),
}

/// Finds a parameter of the knee that may have this value.
///
/// # Errors
/// [`NamedError`].
pub fn find_of_knee(name: &str, value: f64) -> Result<u8, NamedError> {
    let Some((id, parameter)) = find(name) else {
        let keys = PARAMETERS
            .iter()
            .map(|p| format!("{}.{}", p.group, p.key()));
        let keys: Vec<_> = keys.collect();
        let meant = crate::similar::similar(keys.iter().map(String::as_str), name);
        return Err(NamedError::Unknown {
            name: name.to_owned(),
            similar: meant.map(str::to_owned),
        });
    };
    if !is_of_knee(parameter.group) {
        return Err(NamedError::NotOfKnee(name.to_owned()));
    }
    if parameter.allows(value) {
        return Ok(id);
    }
    let allowed = match parameter.kind {
        Kind::Number(spec) => format!("{} to {}", spec.min, spec.max),
        Kind::Choice(choice) => format!("0 to {}", choice.names.len().saturating_sub(1)),
    };
    Err(NamedError::Value {
        name: name.to_owned(),
        value,
        allowed,
    })
}

/// The values of a device that gets the knee of a preset, with these parameters of it.
///
/// # Errors
/// [`NamedError`] for the first name or value that is invalid.
pub fn with_named<'n>(
    now: &Values,
    preset: &Preset,
    named: impl IntoIterator<Item = (&'n str, f64)>,
) -> Result<Values, NamedError> {
    let mut values = with_preset(now, preset, false);
    for (name, value) in named {
        values.set(find_of_knee(name, value)?, value);
    }
    DeviceSettings::of(&values).map_err(NamedError::Together)?;
    Ok(values)
}

/// Checks parameters of a preset's knee, by themselves and together.
///
/// # Errors
/// As [`with_named`].
pub fn check_named<'n>(
    preset: &Preset,
    named: impl IntoIterator<Item = (&'n str, f64)>,
) -> Result<(), NamedError> {
    with_named(&Values::default(), preset, named).map(drop)
}

/// Returns whether a group of parameters is an effect that a device renders.
pub fn is_effect(group: &str) -> bool {
    group == crepitus::EFFECT.name || SPECS.iter().any(|spec| spec.name == group)
}

/// Returns whether an effect is of the knee and not of the brace.
pub fn is_of_knee(group: &str) -> bool {
    let spec = SPECS.iter().find(|spec| spec.name == group);
    spec.map_or(group == crepitus::EFFECT.name, |spec| {
        spec.of == Owner::Knee
    })
}

/// The knee of a device as a preset without a name or texts: its effects that are on.
///
/// # Errors
/// [`ValueError`] if no device has these values.
pub fn knee(values: &Values) -> Result<Preset, ValueError> {
    let settings = DeviceSettings::of(values)?;
    let is_on = |effect: &&Effect| {
        let switch = find(&format!("{}.{RENDER}", effect.name));
        is_of_knee(effect.name) && switch.is_some_and(|(id, _)| values.is_on(id))
    };
    let listed = EFFECTS.into_iter().filter(is_on);
    Ok(Preset {
        crepitus: settings.crepitus.map(|settings| Crepitus {
            preset: None,
            settings,
        }),
        listed: listed
            .filter(|effect| effect.name != crepitus::EFFECT.name)
            .map(|effect| Listed {
                effect,
                given: given(values, effect),
            })
            .collect(),
        ..Preset::default()
    })
}

/// The first of these presets whose knee a device has: the same effects are on, with the same numbers.
pub fn preset_of<'p>(
    values: &Values,
    presets: impl IntoIterator<Item = &'p Preset>,
) -> Option<&'p Preset> {
    let alone = |preset: &Preset| with_preset(&Values::default(), preset, false);
    let own = alone(&knee(values).ok()?);
    presets.into_iter().find(|preset| alone(preset) == own)
}

/// An effect's numbers and choices on a device.
fn given(values: &Values, effect: &Effect) -> Given {
    let value = |key: &str| {
        let (id, _) = find(&format!("{}.{key}", effect.name))?;
        Some((values.get(id)?, values.option(id)))
    };
    let mut given = Given::defaults(effect);
    for (number, spec) in given.numbers.iter_mut().zip(effect.parameters) {
        *number = value(spec.key).map_or(*number, |(number, _)| number);
    }
    for (option, choice) in given.choices.iter_mut().zip(effect.choices) {
        *option = value(choice.key).map_or(*option, |(_, option)| option);
    }
    given
}

/// Switches an effect, with these numbers and choices.
fn set(values: &mut Values, effect: &Effect, is_on: bool, given: &Given) {
    for parameter in PARAMETERS.iter().filter(|p| p.group == effect.name) {
        let value = match parameter.kind {
            Kind::Choice(choice) if choice.key == RENDER => Some(f64::from(u8::from(is_on))),
            Kind::Choice(choice) => {
                let at = effect.choices.iter().position(|c| c.key == choice.key);
                at.and_then(|at| given.choices.get(at))
                    .map(|option| f64::from(*option))
            }
            Kind::Number(spec) => {
                let at = effect.parameters.iter().position(|p| p.key == spec.key);
                at.and_then(|at| given.numbers.get(at)).copied()
            }
        };
        values.set(parameter.id, value.unwrap_or(parameter.default()));
    }
}

/// The values with this joint.
fn with_joint(values: Values, joint: &Crepitus) -> Result<Values, NotRendered> {
    let settings = &joint.settings;
    if settings.convention != Convention::Frozen {
        return Err(NotRendered::Convention(settings.convention.name()));
    }
    if settings.parameters.damping_nms_per_rad > 0.0 {
        return Err(NotRendered::Damping);
    }
    let mut values = values.with_crepitus(&settings.parameters);
    let from_kinetic = settings.restart == Restart::FromKinetic;
    values.set(id::RESTART, f64::from(u8::from(from_kinetic)));
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Overrides, preset};
    use std::path::Path;

    fn value(values: &Values, name: &str) -> f64 {
        values.get(find(name).unwrap().0).unwrap()
    }

    /// A device that has been used: everything on, nothing at its default that a
    /// disorder or the hardware has.
    fn used() -> Values {
        let mut values = Values::default();
        for (name, value) in [
            ("clonus.render", 1.0),
            ("clonus.beats", 8.0),
            ("crepitus.restart", 1.0),
            ("crepitus.static_torque_nm", 0.5),
            ("bone-shaping.render", 1.0),
            ("friction-compensation.render", 1.0),
            ("friction-compensation.share", 0.7),
            ("vibration-actuator.render", 1.0),
            ("vibration-actuator.resistance_ohm", 2.4),
            ("vibration-actuator.supply_v", 4.5),
            ("encoder.lines", 1000.0),
            ("limits.torque_nm", 4.0),
            ("range.most_deg", 100.0),
        ] {
            values.set(find(name).unwrap().0, value);
        }
        values
    }

    #[test]
    fn a_device_takes_every_preset() {
        for preset in preset::shipped() {
            let values = with_preset(&Values::default(), preset, false);
            let settings = DeviceSettings::of(&values);
            assert!(settings.is_ok(), "{}: {settings:?}", preset.name);
            let settings = settings.unwrap();
            assert_eq!(
                settings.effects,
                preset.effect_settings(),
                "{}",
                preset.name
            );
            let joint = settings.crepitus.map(|joint| joint.parameters);
            assert_eq!(joint.as_ref(), preset.joint(), "{}", preset.name);
        }
    }

    #[test]
    fn a_preset_is_a_whole_knee_and_leaves_the_device_alone() {
        let preset = preset::find("texture-bone-on-bone").unwrap();
        let now = used();
        let values = with_preset(&now, preset, false);
        for (name, expected) in [
            ("texture.render", 1.0),
            ("texture.peak_nm", 1.1),
            ("range-limit.render", 1.0),
            ("range-limit.flexion_limit_deg", 130.0),
            // Others are off, and as never set.
            ("crepitus.render", 0.0),
            ("crepitus.restart", 0.0),
            ("crepitus.static_torque_nm", 0.4),
            ("clonus.render", 0.0),
            ("clonus.beats", 0.0),
            ("bone-shaping.render", 0.0),
            ("friction-compensation.render", 1.0),
            ("friction-compensation.share", 0.7),
            ("vibration-actuator.render", 1.0),
            ("vibration-actuator.resistance_ohm", 2.4),
            ("vibration-actuator.supply_v", 4.5),
            ("encoder.lines", 1000.0),
            ("limits.torque_nm", 4.0),
            ("range.most_deg", 100.0),
        ] {
            assert_eq!(value(&values, name), expected, "{name}");
        }
        let added = with_preset(&now, preset, true);
        for (name, expected) in [
            ("texture.peak_nm", 1.1),
            ("clonus.render", 1.0),
            ("clonus.beats", 8.0),
            ("crepitus.render", 1.0),
            ("crepitus.restart", 1.0),
        ] {
            assert_eq!(value(&added, name), expected, "{name}");
        }
        // The result does not depend on which disorders there were.
        let mut fresh = used();
        for effect in EFFECTS.into_iter().filter(|e| is_of_knee(e.name)) {
            set(&mut fresh, effect, false, &Given::defaults(effect));
        }
        assert_eq!(with_preset(&fresh, preset, false), values);
    }

    /// Any values that a device takes, saved, reset and applied, are the same bits.
    #[test]
    fn a_knee_that_is_saved_comes_back() {
        let mut rng = fastrand::Rng::with_seed(117);
        let mut taken = 0;
        for _ in 0..2_000 {
            let mut values = Values::default();
            for parameter in PARAMETERS.iter().filter(|p| is_of_knee(p.group)) {
                let value = match parameter.kind {
                    Kind::Number(spec) if parameter.group == "crepitus" => {
                        spec.default * (0.9 + 0.2 * rng.f64())
                    }
                    Kind::Number(spec) => {
                        let far = spec.min + (spec.max - spec.min) * rng.f64();
                        spec.default + (far - spec.default) * 0.3 * rng.f64()
                    }
                    Kind::Choice(_) => f64::from(rng.u8(0..2)),
                };
                values.set(parameter.id, value);
            }
            if DeviceSettings::of(&values).is_err() {
                continue;
            }
            taken += 1;
            let mut saved = knee(&values).unwrap();
            saved.feel = Some("a \"quoted\" \\ é".to_owned());
            let text = saved.to_toml();
            let none = saved.effects().next().is_none();
            let file = Path::new("mine.toml");
            let read = match Preset::parse(file, &text) {
                Ok(read) => read,
                Err(error) => {
                    assert!(none, "{error}\n{text}");
                    continue;
                }
            };
            assert_eq!(
                (read.feel.as_ref(), &read.to_toml()),
                (saved.feel.as_ref(), &text)
            );
            let back = with_preset(&Values::default(), &read, false);
            for (parameter, value) in back.iter() {
                let was_on = saved.has(parameter.group);
                let expected = if was_on {
                    values.get(parameter.id).unwrap()
                } else if parameter.group == "crepitus" && parameter.key() == RENDER {
                    0.0
                } else {
                    parameter.default()
                };
                assert_eq!(
                    value.to_bits(),
                    expected.to_bits(),
                    "{}.{}",
                    parameter.group,
                    parameter.key()
                );
            }
        }
        assert!(taken > 200, "{taken}");
    }

    #[test]
    fn a_knee_is_named_by_its_preset_whatever_else_the_device_has() {
        let shipped = preset::shipped;
        let alone = |preset: &Preset| with_preset(&Values::default(), preset, false);
        let mut device = Values::default();
        device.set(find("friction-compensation.share").unwrap().0, 0.7);
        for preset in shipped() {
            let mut values = with_preset(&device, preset, false);
            if !preset.has("clonus") {
                // Of an effect that is off.
                values.set(find("clonus.beats").unwrap().0, 8.0);
            }
            let found = preset_of(&values, shipped()).unwrap();
            // Another one may have the same numbers.
            assert_eq!(alone(found), alone(preset), "{}", preset.name);
        }
        let name = |values: &Values| preset_of(values, shipped()).map(|p| p.name.as_str());
        // A device as it is built.
        assert_eq!(name(&device), Some("coarse"));
        device.set(find("crepitus.static_torque_nm").unwrap().0, 0.45);
        assert_eq!(name(&device), None);
        device.set(find("crepitus.render").unwrap().0, 0.0);
        assert_eq!(name(&device), None);
        assert!(preset_of(&device, [&Preset::default()]).is_some());
    }

    #[test]
    fn a_scene_has_all_effects_and_leaves_the_hardware_alone() {
        let toml = "version = 1\ntitle = \"x\"\nduration_s = 1\n\
                    [motion]\nkind = \"constant\"\nvelocity_rad_s = 1\n\
                    [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n\
                    [effects.lead-pipe]\n[effects.motor]\nbandwidth_hz = 900\n[effects.encoder]\nlines = 500\n";
        let scene = Scene::parse(Path::new("x.toml"), toml, &Overrides::default()).unwrap();
        let now = used();
        let values = with_scene(&now, &scene).unwrap();
        for (name, expected) in [
            ("lead-pipe.render", 1.0),
            ("crepitus.render", 0.0),
            ("clonus.render", 0.0),
            ("friction-compensation.render", 0.0),
            // The numbers of the brace's stay.
            ("friction-compensation.share", 0.7),
            ("vibration-actuator.render", 0.0),
            ("vibration-actuator.resistance_ohm", 2.4),
            ("encoder.lines", 1000.0),
            ("motor.bandwidth_hz", value(&now, "motor.bandwidth_hz")),
            ("limits.torque_nm", 4.0),
            ("range.most_deg", 100.0),
        ] {
            assert_eq!(value(&values, name), expected, "{name}");
        }
    }
}
