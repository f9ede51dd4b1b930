//! The stages of a device that a scene lists, built from its numbers.

use crate::document::Section;
use crate::effects::effect_settings;
use crate::error::SceneError;
use crate::scene::Scene;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::{EffectSettings, Effects, Timing};
use crepitus_model::render::position::Sensing;
use crepitus_model::{Real, SettingsError};
use crepitus_plant::assembly::Listed;

impl Scene {
    /// The laws of the effects that it lists, besides the joint.
    pub(crate) fn laws<F: Real>(
        &self,
        step_s: f64,
        delay_ticks: usize,
    ) -> Result<Effects<F>, SettingsError> {
        self.effect_settings()
            .laws(&self.timing(step_s, delay_ticks))
    }

    /// Settings of the device's effects that it lists.
    #[must_use]
    pub fn effect_settings(&self) -> EffectSettings {
        effect_settings(&self.listed)
    }

    /// Returns whether a symptom of the scene gives energy, for which a tank pays.
    pub(crate) fn gives_energy(&self) -> bool {
        let timing = self.timing(crepitus_model::joint::LONGEST_STEP_S, 1);
        self.effect_settings().gives_energy(&timing) == Ok(true)
    }

    /// Timing of its device, with its measurement of the shaft.
    pub(crate) fn timing(&self, step_s: f64, delay_ticks: usize) -> Timing {
        Timing {
            step_s,
            delay_ticks,
            sensing: self.sensing(),
        }
    }

    /// Measurement of the joint by its device.
    pub(crate) fn sensing(&self) -> Sensing {
        match &self.encoder {
            Some(encoder) => Sensing::of_encoder(encoder),
            None => Sensing::IDEAL,
        }
    }

    /// Rejects numbers that no stage can be built from.
    pub(super) fn check_stages(&self) -> Result<(), SettingsError> {
        let joint = self.crepitus.as_ref().map(|c| &c.settings.parameters);
        self.effect_settings().check(joint)?;
        self.laws::<f64>(self.step_s(), MOST_DELAY_TICKS)?;
        Ok(())
    }
}

/// Rejects numbers that contradict each other in an effect of a device, where they stand.
pub(super) fn check_each(root: &Section<'_>, listed: &[Listed]) -> Result<(), SceneError> {
    for one in listed {
        if let Err(error) = effect_settings(std::slice::from_ref(one)).check_knee(None) {
            let own = root.section("effects")?.section(one.effect.name)?;
            return Err(own.error(error.to_string()));
        }
    }
    Ok(())
}
