//! Rejects settings that the drive cannot render, in a scene with a device.

use super::{Crepitus, Scene, SolverChoice};
use crate::device_checks::{caps_warning, convention_refusal};
use crate::document::Section;
use crate::effects::Effects;
use crate::error::SceneError;
use crepitus_model::Convention;
use crepitus_model::control::device_limits::{LimitSettings, RangeSettings};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_model::render::turn_back::most_rad_per_count;
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::numbers;
use crepitus_plant::effects::drivetrain;

/// Refuses a scene that no device can render.
pub(super) fn check(
    root: &Section<'_>,
    effects: &Effects,
    solver: SolverChoice,
) -> Result<(), SceneError> {
    let refuse = |why: String| Err(root.key_error("device", why));
    if solver == SolverChoice::Reference {
        return refuse(
            "\"reference\" has no step, and a device has: choose another solver".to_owned(),
        );
    }
    let Some(crepitus) = &effects.crepitus else {
        return Ok(());
    };
    let settings = &crepitus.settings;
    if let Some(why) = convention_refusal(settings) {
        return refuse(why);
    }
    let (static_nm, most_nm) = (
        settings.parameters.static_torque_nm,
        LimitSettings::default().torque_nm,
    );
    if static_nm > most_nm {
        return refuse(format!(
            "the device refuses static_torque_nm = {static_nm}: it shows {most_nm} N·m at most"
        ));
    }
    match guard_refusal(crepitus, &effects.encoder.unwrap_or_default()) {
        Some(why) => refuse(why),
        None => Ok(()),
    }
}

/// That a scene's device compensates all the friction that its gear has, or
/// more, if it does.
pub(super) fn compensation_warning(listed: &[Listed]) -> Option<String> {
    let given = |name: &str| Some(&listed.iter().find(|l| l.effect.name == name)?.given);
    let settings = FrictionCompensationSettings::of(numbers(given("friction-compensation")?));
    let [_, friction_nm, _] = numbers(given(drivetrain::EFFECT.name)?);
    let compensated_nm = settings.share * settings.friction_nm;
    (compensated_nm >= friction_nm).then(|| {
        format!(
            "the device compensates {compensated_nm} N·m, and the gear has {friction_nm} N·m: nothing is left to keep a \
             moving shaft quiet, and what is beyond pushes the leg; give friction-compensation the least friction that \
             is ever measured"
        )
    })
}

/// The warning of `caps_warning` for a scene, if it has a device.
pub(super) fn caps_warning_of(scene: &Scene) -> Option<String> {
    let joint = scene.crepitus.as_ref().map(|c| &c.settings.parameters);
    let (limits, range) = (LimitSettings::default(), RangeSettings::default());
    let warning = caps_warning(&scene.effect_settings(), joint, &limits, &range);
    warning.filter(|_| scene.is_device)
}

/// Reason for which a device with this encoder would refuse a joint, if it would.
pub(super) fn guard_refusal(crepitus: &Crepitus, encoder: &EncoderSettings) -> Option<String> {
    let settings = &crepitus.settings;
    let (count_rad, most_rad) = (encoder.rad_per_count(), most_rad_per_count(settings));
    (settings.convention == Convention::Frozen && count_rad > most_rad).then(|| {
        let p = &settings.parameters;
        format!(
            "the device refuses kinetic_torque_nm = {} with static_torque_nm = {}, stiffness_nm_per_rad = {} and \
             an encoder of {} lines: a hand that turns back inside a slip would get more energy than the slip takes \
             out of the spring; one count is {:.1} µrad, and may be {:.1} µrad",
            p.kinetic_torque_nm,
            p.static_torque_nm,
            p.stiffness_nm_per_rad,
            encoder.lines,
            count_rad * 1e6,
            most_rad * 1e6
        )
    })
}
