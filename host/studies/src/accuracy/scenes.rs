//! Scenes of the study: a motion of the shaft and the settings of the object.
//!
//! The standard set has four constant speeds, from dominant to hardly any
//! sticking, and one hand-like sine. Of the constant speeds only at 0.5 and
//! 2 rad/s the first stick lasts a whole number of device ticks; 0.12 and 0.988
//! are incommensurate with every step, so that no rung looks good by luck.
//!
//! The full set adds hands, strokes and knee bends, on the joint of every preset that
//! is crepitus alone (the paper's is `coarse`); and a speed and the paper's hands behind the
//! encoder of the device.

use crate::accuracy::hands::hands;
use crate::accuracy::input::Input;
use crate::true_events::{TrueEvent, true_events, true_events_while};
use crepitus_model::{Convention, Settings, SettingsError, Validated};
use crepitus_plant::Motion;
use crepitus_scene::Scene;
use crepitus_scene::preset::{Joint, joints};

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

/// Duration of strokes and knee bends, s: there and back at least once.
const HAND_S: f64 = 4.0;

/// The scenes that are studied behind the encoder, too.
const BEHIND_THE_ENCODER: [&str; 3] = ["constant-0.988", "hand-strokes", "knee-bends"];

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
    /// Knowledge that a rung has of the motion.
    pub input: Input,
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
            input: Input::Exact,
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
                input: Input::Exact,
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
            input: Input::Exact,
        });
    }
    Ok(scenes)
}

/// The full set; the standard one is its beginning.
///
/// # Errors
/// None in practice: the settings of presets are valid.
pub fn full() -> Result<Vec<StudyScene>, SettingsError> {
    let mut scenes = standard()?;
    for (place, joint) in joints().iter().enumerate() {
        for (name, title, motion) in hands() {
            for convention in [Convention::Frozen, Convention::Physical] {
                let settings = Settings {
                    parameters: joint.parameters,
                    ..*paper(convention)?
                };
                let (name, of) = match place {
                    0 => (name.to_owned(), String::new()),
                    _ => (format!("{name}-{}", joint.name), in_words(joint)),
                };
                scenes.push(StudyScene {
                    name,
                    title: format!("{title} for {HAND_S} s{of}"),
                    motion: motion.clone(),
                    duration_s: HAND_S,
                    settings: settings.validate()?,
                    input: Input::Exact,
                });
            }
        }
    }
    let mut behind = scenes.clone();
    behind.retain(|scene| BEHIND_THE_ENCODER.contains(&scene.name.as_str()));
    for scene in &mut behind {
        scene.input = Input::Encoder;
    }
    scenes.extend(behind);
    Ok(scenes)
}

/// A joint that is not the paper's.
fn in_words(joint: &Joint) -> String {
    let p = &joint.parameters;
    format!(
        ", preset {}: J {} kg·m², kr {} N·m/rad, Tk {} and Ts {} N·m",
        joint.name,
        p.inertia_kg_m2,
        p.stiffness_nm_per_rad,
        p.kinetic_torque_nm,
        p.static_torque_nm
    )
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

    #[test]
    fn the_full_set_has_every_joint_on_every_hand_and_the_device_s_view() {
        let scenes = full().unwrap();
        let joints = joints();
        assert!(joints.len() >= 3);
        assert_eq!(joints[0].parameters, Settings::default().parameters);
        let of = |joint: &Joint, name: &str, input| {
            let is_of = |s: &&StudyScene| {
                s.settings.parameters == joint.parameters
                    && s.name.starts_with(name)
                    && s.input == input
            };
            scenes.iter().filter(is_of).count()
        };
        for (place, joint) in joints.iter().enumerate() {
            let behind = if place == 0 { 2 } else { 0 };
            for name in ["hand-strokes", "knee-bends"] {
                assert_eq!(of(joint, name, Input::Exact), 2, "{name} {}", joint.name);
                assert_eq!(of(joint, name, Input::Encoder), behind);
            }
        }
        assert_eq!(of(&joints[0], "constant-0.988", Input::Encoder), 2);
        // A name, a convention and an input are one scene.
        let mut keys: Vec<_> = scenes
            .iter()
            .map(|s| (&s.name, s.convention(), s.input.name()))
            .collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), scenes.len());
        assert_eq!(scenes.len(), 11 + 4 * joints.len() + 6);
    }
}
