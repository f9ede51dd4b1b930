//! What each effect costs: the scene's first steps with the effect and
//! without it, timed a few times in turn.

use super::{Blind, simulate};
use crate::scene::{Scene, SolverChoice};
use std::time::Instant;

/// Steps of one timing: a few tenths of a millisecond.
const STEPS: f64 = 20_000.0;
/// Timings of which the fastest counts.
const REPEATS: u32 = 5;

/// Cost of one effect, ns per step.
pub(super) struct Cost {
    pub(super) effect: &'static str,
    pub(super) ns_per_step: f64,
}

/// The costs of the scene's effects in the order of its list; of `reference`,
/// which has no step, none.
pub(super) fn costs(scene: &Scene) -> Vec<Cost> {
    let SolverChoice::Ladder { step_s, .. } = scene.solver else {
        return Vec::new();
    };
    let mut short = scene.clone();
    short.duration_s = scene.duration_s.min(STEPS * step_s);
    scene
        .effects()
        .into_iter()
        .filter_map(|effect| {
            // An effect's cost is that on top of all that stand without it.
            let mut with = short.clone();
            for other in short.effects() {
                if with.has(other.name) && other.needs.iter().any(|n| n.effect == effect.name) {
                    with = with.without(other)?;
                }
            }
            let without = with.without(effect)?;
            let (mut with_ns, mut without_ns) = (f64::INFINITY, f64::INFINITY);
            // In turn, so that a drift of the machine's speed hits both alike.
            for _ in 0..REPEATS {
                with_ns = with_ns.min(ns_per_step(&with));
                without_ns = without_ns.min(ns_per_step(&without));
            }
            Some(Cost {
                effect: effect.name,
                ns_per_step: (with_ns - without_ns).max(0.0),
            })
        })
        .collect()
}

#[expect(clippy::cast_precision_loss, reason = "a few thousand")]
fn ns_per_step(scene: &Scene) -> f64 {
    let begun = Instant::now();
    let steps = match simulate(scene, &mut Blind) {
        Ok(totals) => totals.steps,
        // The scene has just run with these settings.
        Err(_) => return f64::INFINITY,
    };
    begun.elapsed().as_secs_f64() * 1e9 / steps as f64
}
