//! Scenes that cannot be studied.

use crepitus_scene::Scene;
use crepitus_scene::run::step_count;
use crepitus_scene::scene::SolverChoice;
use std::fmt;

/// The most ticks of a scene: the torque at each is stored, 8 bytes a tick.
pub const MOST_TICKS: u64 = 40_000_000;

/// Reason why a scene cannot be studied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// The leg is free.
    Released,
    /// The scene's solver has no step.
    Reference,
    /// The scene has too many ticks.
    TooLong {
        /// Their number.
        ticks: u64,
    },
}

impl Refusal {
    /// The key of the scene that prevents it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Released => "motion.kind",
            Self::Reference => "solver.kind",
            Self::TooLong { .. } => "duration_s",
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Released => f.write_str(
                "\"released\" means that nobody holds the leg: there is no torque at the hand to compare",
            ),
            Self::Reference => f.write_str(
                "\"reference\" has no step, so its cost has no measure, and it knows the stick-slip object alone: \
                 choose another solver",
            ),
            Self::TooLong { ticks } => write!(
                f,
                "the scene has {ticks} ticks, and the torque of each is kept for the comparison: up to {MOST_TICKS} \
                 are allowed; a shorter scene shows as much"
            ),
        }
    }
}

/// Reason why a scene cannot be studied, or `None`.
pub fn refusal(scene: &Scene) -> Option<Refusal> {
    let ticks = step_count(scene);
    if scene.solver == SolverChoice::Reference {
        Some(Refusal::Reference)
    } else if !scene.is_held() {
        Some(Refusal::Released)
    } else if ticks > MOST_TICKS {
        Some(Refusal::TooLong { ticks })
    } else {
        None
    }
}
