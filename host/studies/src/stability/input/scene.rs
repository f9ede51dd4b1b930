//! A scene as the input of a trial.

use crate::stability::subject::{Rung, Subject};
use std::fmt;

/// A scene: what no other input can say, as a plant, or a motion that breaks within a step.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRun {
    /// The scene in words.
    pub what: &'static str,
    /// The scene, without its duration, its solver and its outputs.
    pub text: String,
    /// Column of the judged torque.
    pub column: &'static str,
    /// Whether the reference solves it, too.
    pub is_compared: bool,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

impl SceneRun {
    /// Returns the scene file for a subject.
    pub(in crate::stability) fn scene(&self, subject: Subject) -> String {
        let Self {
            text,
            duration_s,
            step_s,
            ..
        } = self;
        let name = subject.solver.name();
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

impl fmt::Display for SceneRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.what)
    }
}
