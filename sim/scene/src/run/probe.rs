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

/// The time of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// Of the fastest timing, ns; infinite for a scene that cannot run.
    pub ns: f64,
    /// How much longer a quarter of the timings took at most, the fastest
    /// quarter, as a share of that: large where the machine was busy.
    pub spread: f64,
}

/// The time of a step of each scene, without outputs, from so many `timings`
/// in which the scenes take turns. `after_each` is called after each timing and
/// may end it all.
///
/// # Errors
/// What `after_each` returns.
pub fn step_times<E>(
    scenes: &[Scene],
    timings: u32,
    mut after_each: impl FnMut() -> Result<(), E>,
) -> Result<Vec<StepTime>, E> {
    let mut short = scenes.to_vec();
    for scene in &mut short {
        scene.duration_s = scene.duration_s.min(STEPS * step_s(scene));
    }
    let mut times = vec![Vec::new(); short.len()];
    for _ in 0..timings {
        for (scene, times) in short.iter().zip(&mut times) {
            times.push(time(scene));
            after_each()?;
        }
    }
    Ok(times.into_iter().map(StepTime::of).collect())
}

impl StepTime {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let ns = times.first().copied().unwrap_or(f64::INFINITY);
        let quartile = times.get(times.len() / 4).copied().unwrap_or(ns);
        Self {
            ns,
            spread: quartile / ns - 1.0,
        }
    }
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
            let Ok(times) = step_times(&[with, without], TIMINGS, || Ok::<(), Infallible>(()));
            Some(Cost {
                effect: effect.name,
                ns_per_step: (times[0].ns - times[1].ns).max(0.0),
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
