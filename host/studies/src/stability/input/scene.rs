//! A scene as the input of a trial.

use crate::stability::subject::{Rung, Subject};

/// A scene: what no other input can say, as a plant, or a motion that breaks within a step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SceneRun {
    /// The scene in words.
    pub(crate) what: &'static str,
    /// The scene, without its duration, its solver and its outputs.
    pub(crate) text: String,
    /// Column of the judged torque.
    pub(crate) column: &'static str,
    /// Whether the reference solves it, too.
    pub(crate) is_compared: bool,
}

impl SceneRun {
    /// Returns the scene file for a subject.
    pub(crate) fn scene(&self, subject: Subject, duration_s: f64, step_s: f64) -> String {
        let (text, name) = (&self.text, subject.solver.name());
        let solver = match subject.solver {
            Rung::Reference => format!("kind = \"{name}\""),
            Rung::Ladder(_) => format!(
                "kind = \"{name}\"\nstep_s = {step_s:?}\nprecision = \"{}\"",
                subject.precision.name()
            ),
        };
        format!(
            "version = 1\ntitle = \"case\"\nduration_s = {duration_s:?}\n{text}\n\
             [solver]\n{solver}\n[output]\ntrace_step_s = {step_s:?}\n"
        )
    }
}
