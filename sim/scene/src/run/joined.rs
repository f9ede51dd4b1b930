//! Runs of scenes that differ in the parameters of their joint only: one walk along the motion, and the joints
//! side by side.
//!
//! ```text
//! Walk ── a block of steps ──> Joints ── states, events ──> accounts of each ──> Totals
//! ```
//!
//! What a step has in common for all joints is computed once. Everything else is done with the numbers, and in
//! the order, of a run by itself: so totals are the same to the bit. What is not worth a second way (a state that
//! is no number, a part of a step that a joint refuses) is left to a run by itself.

mod accounts;
mod path;

use super::stepping::CHECK_STEPS;
use super::summary::{Summary, summarise};
use super::untraced::is_stepless;
use super::{Totals, steps};
use crate::scene::{Precision, Scene, SolverChoice};
use accounts::{Runs, ShaftTotals};
use crepitus_ladder::joints::Lanes;
use crepitus_model::solver::Solver;
use path::{Block, Path};
use std::time::Instant;

/// Scenes that are run together.
#[derive(Debug, Default)]
pub struct Joined {
    scenes: Vec<Scene>,
}

impl Joined {
    /// Returns whether a scene is crepitus alone on a prescribed shaft, with a solver that has steps.
    pub fn is_alone(scene: &Scene) -> bool {
        matches!(scene.solver, SolverChoice::Ladder { .. })
            && scene.crepitus.is_some()
            && scene.encoder.is_none()
            && !scene.is_coupled()
    }

    /// Adds a scene, or gives it back: one that is not [alone](Self::is_alone); one whose run needs no
    /// steps; or one that differs from the others in more than the parameters of the joint.
    pub fn add(&mut self, scene: Scene) -> Option<Scene> {
        let fits = match self.scenes.first() {
            Some(first) => is_alike(first, &scene),
            None => is_stepped_alone(&scene),
        };
        if !fits {
            return Some(scene);
        }
        self.scenes.push(scene);
        None
    }

    /// The scenes so far.
    pub fn scenes(&self) -> &[Scene] {
        &self.scenes
    }

    /// Runs the scenes to their end without a trace: a summary of each in their order, to the bit that of its
    /// run by itself but for the time it took. `None` for one that has to be run by itself. `goes_on` is
    /// called now and then with the time reached, and ends the runs by its error.
    ///
    /// # Errors
    /// That of `goes_on`.
    pub fn run<E>(
        &self,
        mut goes_on: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<Vec<Option<Summary>>, E> {
        let begun = Instant::now();
        let Some(SolverChoice::Ladder {
            solver,
            step_s,
            precision,
        }) = self.scenes.first().map(|scene| scene.solver)
        else {
            return Ok(Vec::new());
        };
        let mut result = Ok(());
        let mut goes_on = |time_s: f64| {
            result = goes_on(time_s);
            result.is_ok()
        };
        let totals = match precision {
            Precision::F32 => simulate::<f32>(&self.scenes, solver, step_s, &mut goes_on),
            Precision::F64 => simulate::<f64>(&self.scenes, solver, step_s, &mut goes_on),
        };
        result?;
        // Each has its share of the time.
        let shares = u32::try_from(self.scenes.len()).unwrap_or(u32::MAX).max(1);
        let wall_s = begun.elapsed().as_secs_f64() / f64::from(shares);
        let runs = self.scenes.iter().zip(totals.unwrap_or_default());
        Ok(runs
            .map(|(scene, totals)| Some(summarise(scene, &totals?, wall_s)))
            .collect())
    }
}

/// Returns whether a scene is crepitus alone, and its run needs steps.
fn is_stepped_alone(scene: &Scene) -> bool {
    Joined::is_alone(scene) && !is_stepless(scene)
}

/// Returns whether a scene differs from one that is stepped alone in the parameters of the joint only.
fn is_alike(first: &Scene, scene: &Scene) -> bool {
    let convention = |scene: &Scene| scene.crepitus.map(|c| c.settings.convention);
    is_stepped_alone(scene)
        && scene.solver == first.solver
        && scene.duration_s == first.duration_s
        && convention(scene) == convention(first)
        && scene.motion == first.motion
}

/// Runs joints through the motion of the first scene; `None` for one that has to be run by itself.
fn simulate<F: Lanes>(
    scenes: &[Scene],
    solver: Solver,
    step_s: f64,
    goes_on: &mut dyn FnMut(f64) -> bool,
) -> Option<Vec<Option<Totals>>> {
    let first = scenes.first()?;
    let (steps, _) = steps(first);
    let mut path = Path::<F>::new(&first.motion, step_s, steps);
    let settings: Vec<_> = (scenes.iter())
        .filter_map(|scene| Some(scene.crepitus?.settings))
        .collect();
    let omega_rad_s = first.start().omega_rad_s;
    let Ok(mut runs) = Runs::<F>::new(settings, (solver, step_s), omega_rad_s) else {
        return Some(scenes.iter().map(|_| None).collect());
    };
    let mut block = Block::default();
    while !path.is_at_end() {
        if !goes_on(path.time_s()) {
            return None;
        }
        let has_parts = path.next_block(&mut block);
        runs.step_through(&block);
        if has_parts {
            runs.step_in_parts(&path.split_step());
        }
        if path.steps_made().is_multiple_of(CHECK_STEPS) || path.is_at_end() {
            runs.leave_diverged();
        }
    }
    let shaft = ShaftTotals {
        steps,
        end_s: path.time_s(),
        fastest_rad_s: path.fastest_rad_s(),
    };
    Some(runs.finish(&shaft))
}
