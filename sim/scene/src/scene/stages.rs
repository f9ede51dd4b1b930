//! The stages of a device that a scene lists, built from its numbers.

use crate::scene::Scene;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::bone_shaping::BoneShapingSettings;
use crepitus_model::render::friction_compensation::FrictionCompensationSettings;
use crepitus_model::{BoneShaping, FrictionCompensation, Real, SettingsError};
use crepitus_plant::effect::{Effect, numbers};
use crepitus_plant::effects::{bone_shaping, friction_compensation};

impl Scene {
    /// The feed-forward against gear friction, if listed.
    pub(crate) fn compensation<F: Real>(
        &self,
    ) -> Result<Option<FrictionCompensation<F>>, SettingsError> {
        self.numbers_of(&friction_compensation::EFFECT)
            .map(|numbers| FrictionCompensation::new(&FrictionCompensationSettings::of(numbers)))
            .transpose()
    }

    /// The ringing of the bone, if listed.
    pub(crate) fn bone<F: Real>(
        &self,
        step_s: f64,
        delay_ticks: usize,
    ) -> Result<Option<BoneShaping<F>>, SettingsError> {
        self.numbers_of(&bone_shaping::EFFECT)
            .map(|numbers| BoneShaping::new(&BoneShapingSettings::of(numbers), step_s, delay_ticks))
            .transpose()
    }

    /// Rejects numbers that no stage can be built from.
    pub(super) fn check_stages(&self) -> Result<(), SettingsError> {
        self.compensation::<f64>()?;
        self.bone::<f64>(self.step_s(), MOST_DELAY_TICKS)?;
        Ok(())
    }

    fn numbers_of<const N: usize>(&self, effect: &Effect) -> Option<[f64; N]> {
        let listed = self.listed.iter().find(|l| l.effect.name == effect.name)?;
        Some(numbers(&listed.given))
    }
}
