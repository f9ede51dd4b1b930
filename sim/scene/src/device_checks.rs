//! Checks of what a device renders, for scenes and for presets.

use crate::static_limits::{Reach, largest_within_nm};
use crepitus_model::control::device_limits::{LimitSettings, RangeSettings};
use crepitus_model::render::effects::{EffectSettings, SYMPTOMS};
use crepitus_model::{Convention, Parameters, Settings};

/// Reason for which no device renders these settings, if none does.
pub(crate) fn convention_refusal(settings: &Settings) -> Option<String> {
    if settings.convention != Convention::Frozen {
        return Some(format!(
            "a device renders the convention \"frozen\" alone, not \"{}\"",
            settings.convention.name()
        ));
    }
    (settings.parameters.damping_nms_per_rad > 0.0).then(|| {
        "a device renders a joint without damping: leave damping_nms_per_rad out".to_owned()
    })
}

/// Warns of symptoms and a joint that can ask for more than a device with these limits shows,
/// anywhere in its range.
pub fn caps_warning(
    effects: &EffectSettings,
    joint: Option<&Parameters>,
    limits: &LimitSettings,
    range: &RangeSettings,
) -> Option<String> {
    let most_nm = limits.torque_nm;
    let asked_nm = largest_within_nm(effects, joint, &Reach::of(range, limits));
    if asked_nm <= most_nm {
        return None;
    }
    let is_on = |place: &usize| effects.only(*place) != EffectSettings::default();
    let symptoms = (0..SYMPTOMS.len()).filter(is_on).count();
    let shows = format!("and the device shows {most_nm} N·m at most");
    Some(if symptoms + usize::from(joint.is_some()) == 1 {
        format!("the symptom can ask for {asked_nm:.1} N·m, {shows}: beyond, it does not grow")
    } else {
        format!(
            "the symptoms can ask for {asked_nm:.1} N·m together, {shows}: beyond, one hides the other"
        )
    })
}
