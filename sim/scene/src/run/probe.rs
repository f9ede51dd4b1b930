//! What a step of a scene costs: its first steps, timed a few times. What
//! is compared takes turns, so that a drift of the machine's speed hits all
//! alike.

use super::{Blind, simulate, step_s};
use crate::scene::{Scene, SolverChoice};
use std::convert::Infallible;
use std::time::Instant;

/// The most steps of one timing: a few tenths of a millisecond of a joint
/// alone.
const STEPS: f64 = 20_000.0;
/// Timings of which the fastest counts, for the summary of a run.
const TIMINGS: u32 = 5;

/// Cost of one effect, ns per step.
pub(super) struct Cost {
    pub(super) effect: &'static str,
    pub(super) ns_per_step: f64,
}

/// The time of a step of each scene, ns, without outputs: the fastest of so
/// many `timings` in which the scenes take turns, infinite for one that cannot
/// run. `after_each` is called after each timing and may end it all.
///
/// # Errors
/// What `after_each` returns.
pub fn ns_per_step<E>(
    scenes: &[Scene],
    timings: u32,
    mut after_each: impl FnMut() -> Result<(), E>,
) -> Result<Vec<f64>, E> {
    let mut short = scenes.to_vec();
    for scene in &mut short {
        scene.duration_s = scene.duration_s.min(STEPS * step_s(scene));
    }
    let mut fastest = vec![f64::INFINITY; short.len()];
    for _ in 0..timings {
        for (scene, fastest) in short.iter().zip(&mut fastest) {
            *fastest = fastest.min(time(scene));
            after_each()?;
        }
    }
    Ok(fastest)
}

/// The costs of the scene's effects in the order of its list; of `reference`,
/// which has no step, none.
pub(super) fn costs(scene: &Scene) -> Vec<Cost> {
    if scene.solver == SolverChoice::Reference {
        return Vec::new();
    }
    scene
        .effects()
        .into_iter()
        .filter_map(|effect| {
            // An effect's cost is that on top of all that stand without it.
            let mut with = scene.clone();
            for other in scene.effects() {
                if with.has(other.name) && other.needs.iter().any(|n| n.effect == effect.name) {
                    with = with.without(other)?;
                }
            }
            let without = with.without(effect)?;
            let Ok(times) = ns_per_step(&[with, without], TIMINGS, || Ok::<(), Infallible>(()));
            Some(Cost {
                effect: effect.name,
                ns_per_step: (times[0] - times[1]).max(0.0),
            })
        })
        .collect()
}

#[expect(clippy::cast_precision_loss, reason = "a few thousand")]
fn time(scene: &Scene) -> f64 {
    let begun = Instant::now();
    let steps = match simulate(scene, &mut Blind) {
        Ok(totals) => totals.steps,
        Err(_) => return f64::INFINITY,
    };
    begun.elapsed().as_secs_f64() * 1e9 / steps as f64
}
