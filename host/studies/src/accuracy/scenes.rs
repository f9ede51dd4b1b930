//! Scenes of the study: a motion of the shaft and the settings of the object.
//!
//! The standard set has four constant speeds, from dominant to hardly any
//! sticking, and one hand-like sine. Of the constant speeds only at 0.5 and
//! 2 rad/s the first stick lasts a whole number of device ticks; 0.12 and 0.988
//! are incommensurate with every step, so that no rung looks good by luck.

use crate::true_events::{TrueEvent, true_events, true_events_while};
use crepitus_model::{Convention, Settings, SettingsError, Validated};
use crepitus_plant::Motion;
use crepitus_scene::Scene;

/// Constant speeds of the standard set: name and rad/s.
const SPEEDS: [(&str, f64); 4] = [
    ("constant-0.12", 0.12),
    ("constant-0.5", 0.5),
    ("constant-0.988", 0.988),
    ("constant-2", 2.0),
];

/// Duration at a constant speed, s.
const CONSTANT_S: f64 = 10.0;

/// The hand-like sine: amplitude, degrees.
const SINE_DEG: f64 = 45.0;
/// Frequency of the sine, Hz.
const SINE_HZ: f64 = 0.25;
/// Duration of the sine, s: there and back once.
const SINE_S: f64 = 4.0;

/// One motion under one convention.
#[derive(Clone, Debug)]
pub struct StudyScene {
    /// Name in points, such as `constant-0.988`.
    pub name: String,
    /// Description.
    pub title: String,
    /// The shaft's motion.
    pub motion: Motion,
    /// Duration, s.
    pub duration_s: f64,
    /// The stick-slip object.
    pub settings: Validated<Settings>,
}

impl StudyScene {
    /// The events of the reference, in the order of time.
    pub fn true_events(&self) -> Vec<TrueEvent> {
        true_events(&self.settings, &self.motion, self.duration_s)
    }

    /// [`Self::true_events`] with calls of `poll` now and then.
    ///
    /// # Errors
    /// Error of `poll`.
    pub fn true_events_while<E>(
        &self,
        poll: impl FnMut() -> Result<(), E>,
    ) -> Result<Vec<TrueEvent>, E> {
        true_events_while(&self.settings, &self.motion, self.duration_s, poll)
    }

    /// The convention's name.
    pub fn convention(&self) -> &'static str {
        self.settings.convention.name()
    }

    /// Motion and object of a scene file; `None` if it has no crepitus. Its
    /// sensor and its solver are ignored.
    pub fn of(scene: &Scene) -> Option<Self> {
        let crepitus = scene.crepitus.as_ref()?;
        let name = scene.file.file_stem().unwrap_or_default();
        Some(Self {
            // A comma or a quote would break the rows of `points.csv`.
            name: name.to_string_lossy().replace([',', '"', '\n', '\r'], "_"),
            title: scene.title.clone(),
            motion: scene.motion.clone(),
            duration_s: scene.duration_s,
            settings: crepitus.settings,
        })
    }
}

/// The standard set, with the paper's parameters: each speed and the sine
/// under `frozen` and `physical`, the sine under `paper` too. (At a constant
/// speed `paper` is `physical`: J·Ω̇ is zero and so is c.)
///
/// # Errors
/// None in practice: the paper's settings are valid under every convention.
pub fn standard() -> Result<Vec<StudyScene>, SettingsError> {
    let mut scenes = Vec::new();
    for (name, speed) in SPEEDS {
        for convention in [Convention::Frozen, Convention::Physical] {
            scenes.push(StudyScene {
                name: name.to_owned(),
                title: format!("{speed} rad/s for {CONSTANT_S} s"),
                motion: Motion::constant(speed),
                duration_s: CONSTANT_S,
                settings: paper(convention)?,
            });
        }
    }
    for convention in Convention::ALL {
        scenes.push(StudyScene {
            name: "hand-sine".to_owned(),
            title: format!("sine of {SINE_DEG}° at {SINE_HZ} Hz from rest for {SINE_S} s"),
            motion: Motion::sine(SINE_DEG.to_radians(), SINE_HZ, -90.0),
            duration_s: SINE_S,
            settings: paper(convention)?,
        });
    }
    Ok(scenes)
}

/// The paper's parameters under a convention.
pub(super) fn paper(convention: Convention) -> Result<Validated<Settings>, SettingsError> {
    Settings {
        convention,
        ..Settings::default()
    }
    .validate()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_set_is_what_the_study_promises() {
        let scenes = standard().unwrap();
        let count = |convention| {
            scenes
                .iter()
                .filter(|s| s.settings.convention == convention)
                .count()
        };
        assert_eq!(count(Convention::Frozen), 5);
        assert_eq!(count(Convention::Physical), 5);
        assert_eq!(count(Convention::Paper), 1);
        let sine = scenes.last().unwrap();
        assert_eq!(sine.motion.at(0.0).omega_rad_s, 0.0);
        let peak = 45_f64.to_radians() * std::f64::consts::TAU * 0.25;
        assert!((sine.motion.at(1.0).omega_rad_s - peak).abs() < 1e-12);
    }
}
