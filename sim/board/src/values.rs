//! The device's parameters of a scene.

use crepitus_model::{Convention, Restart};
use crepitus_plant::effects::EFFECTS;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{Kind, PARAMETERS, id};
use crepitus_scene::Scene;

/// Why a scene cannot be rendered by a device.
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
    for parameter in &PARAMETERS {
        let Some(effect) = EFFECTS.iter().find(|e| e.name == parameter.group) else {
            continue;
        };
        match parameter.kind {
            Kind::Choice(choice) if choice.key == "render" => {
                values.set(parameter.id, f64::from(u8::from(scene.has(effect.name))));
            }
            Kind::Choice(choice) => {
                let given = scene.given(effect);
                let at = effect.choices.iter().position(|c| c.key == choice.key);
                if let Some(option) = at.and_then(|at| given.choices.get(at)) {
                    values.set(parameter.id, f64::from(*option));
                }
            }
            Kind::Number(spec) => {
                let given = scene.given(effect);
                let at = effect.parameters.iter().position(|p| p.key == spec.key);
                if let Some(value) = at.and_then(|at| given.numbers.get(at)) {
                    values.set(parameter.id, *value);
                }
            }
        }
    }
    if let Some(crepitus) = &scene.crepitus {
        let settings = &crepitus.settings;
        if settings.convention != Convention::Frozen {
            return Err(NotRendered::Convention(settings.convention.name()));
        }
        if settings.parameters.damping_nms_per_rad > 0.0 {
            return Err(NotRendered::Damping);
        }
        values = values.with_crepitus(&settings.parameters);
        let from_kinetic = settings.restart == Restart::FromKinetic;
        values.set(id::RESTART, f64::from(u8::from(from_kinetic)));
    }
    Ok(values)
}
