//! Results of a study.

use crate::accuracy::actuator::ActuatorPoint;
use crate::accuracy::orders::Orders;
use crate::accuracy::point::Point;
use crate::accuracy::symptoms::SymptomPoint;
use crate::accuracy::target::OnTarget;
use serde::Serialize;

/// A study's results.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Study {
    /// The studied scenes.
    pub scenes: Vec<StudiedScene>,
    /// The steps, s.
    pub steps_s: Vec<f64>,
    /// Repeats of each timing.
    pub timing_repeats: usize,
    /// Rungs without a meaning under a convention.
    pub refused: Vec<Refused>,
    /// Steps for which a scene is too long or too short.
    pub skipped: Vec<Skipped>,
    /// Measured orders of convergence.
    pub orders: Vec<Orders>,
    /// Duration of the study, s.
    pub wall_s: f64,
    /// Costs of the ladder on the target, if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<OnTarget>,
    /// The other symptoms, by symptom, form, precision and falling step; empty if
    /// they were not studied.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub symptoms: Vec<SymptomPoint>,
    /// The stage of the vibration actuator, by falling rate and precision; empty if it was
    /// not studied.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub actuator: Vec<ActuatorPoint>,
    /// The points, by scene, convention, rung, precision and falling step.
    #[serde(skip)]
    pub points: Vec<Point>,
}

/// A scene of the study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudiedScene {
    /// Name of the scene.
    pub name: String,
    /// Title of the scene.
    pub title: String,
    /// Convention of the scene.
    pub convention: &'static str,
    /// Knowledge that the rungs had of the shaft.
    pub input: &'static str,
    /// Duration of the scene, s.
    pub duration_s: f64,
    /// Events of the reference.
    pub events_true: usize,
    /// Time in slips of the reference in which the shaft was behind the object,
    /// s, at the shortest step: 0 under `paper` and `physical`, where it would
    /// be a missed event.
    pub reference_behind_s: f64,
}

/// A rung without a meaning under a convention.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// The rung.
    pub solver: &'static str,
    /// The convention.
    pub convention: &'static str,
    /// Reason for the refusal.
    pub reason: &'static str,
}

/// A step at which a scene was not studied.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Skipped {
    /// The scene.
    pub scene: String,
    /// Convention of the scene.
    pub convention: &'static str,
    /// The step, s.
    pub step_s: f64,
    /// Reason why it was not studied.
    pub reason: &'static str,
}
