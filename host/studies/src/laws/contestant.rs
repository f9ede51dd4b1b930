//! Laws that the study judges.
//!
//! An entry of the ladder is a contestant; so is anything that can be stepped from travel and
//! velocities: implement [`Contestant`] and give it to [`study::run_with`](super::study::run_with).

use crepitus_ladder::laws::Entry;
use crepitus_ladder::laws::stepped::Stepped;
use crepitus_model::{Parameters, SettingsError};
use crepitus_scene::scene::Precision;

/// A law that can be started for any joint.
pub trait Contestant: Sync {
    /// Name in tables.
    fn name(&self) -> &'static str;

    /// Description in a few words.
    fn title(&self) -> &'static str;

    /// The law at rest, in steps of `step_s`, under a shaft that moves with `omega_rad_s`.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    fn start(
        &self,
        joint: &Parameters,
        step_s: f64,
        precision: Precision,
        omega_rad_s: f64,
    ) -> Result<Box<dyn Stepped>, SettingsError>;
}

impl Contestant for Entry {
    fn name(&self) -> &'static str {
        self.name
    }

    fn title(&self) -> &'static str {
        self.title
    }

    fn start(
        &self,
        joint: &Parameters,
        step_s: f64,
        precision: Precision,
        omega_rad_s: f64,
    ) -> Result<Box<dyn Stepped>, SettingsError> {
        match precision {
            Precision::F32 => self.single(joint, step_s, omega_rad_s),
            Precision::F64 => self.double(joint, step_s, omega_rad_s),
        }
    }
}
