//! The stages of a device that a scene lists, built from its numbers.

use crate::scene::Scene;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::{EffectSettings, Effects, Timing};
use crepitus_model::{Real, SettingsError};

impl Scene {
    /// The laws of the effects that it lists, besides the joint.
    pub(crate) fn laws<F: Real>(
        &self,
        step_s: f64,
        delay_ticks: usize,
    ) -> Result<Effects<F>, SettingsError> {
        let numbers = |name: &str| {
            let listed = self.listed.iter().find(|l| l.effect.name == name)?;
            Some(listed.given.numbers.as_slice())
        };
        EffectSettings::given(numbers).laws(&Timing {
            step_s,
            delay_ticks,
        })
    }

    /// Rejects numbers that no stage can be built from.
    pub(super) fn check_stages(&self) -> Result<(), SettingsError> {
        self.laws::<f64>(self.step_s(), MOST_DELAY_TICKS)?;
        Ok(())
    }
}
