//! CPU time of a scene's step: its first steps, timed a few times in CPU
//! time. What is compared takes turns, so that a drift of the machine's speed
//! hits all alike.

use super::watch::watched;
use super::{Blind, simulate};
use crate::cpu_time;
use crate::scene::{Scene, SolverChoice};
use serde::Serialize;
use std::convert::Infallible;

/// The most steps of one timing: a few tenths of a millisecond of a joint
/// alone.
const STEPS: f64 = 20_000.0;
/// Timings of which the fastest counts, for the summary of a run.
const TIMINGS: u32 = 5;

/// A difference of two times below this share of the longer one cannot be
/// distinguished from zero, however quiet the machine.
const LEAST_RESOLUTION: f64 = 0.01;

/// Cost of one effect.
pub(super) struct Cost {
    pub(super) effect: &'static str,
    pub(super) added: AddedTime,
}

/// The CPU time of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// Time of a step in the fastest timing, ns; infinite for a scene that cannot run.
    pub ns: f64,
    /// Excess of the longest timing in the fastest quarter over the fastest timing, as a share
    /// of the latter: large where the machine was busy.
    pub spread: f64,
}

impl StepTime {
    /// An unknown time of a step.
    pub const UNKNOWN: Self = Self {
        ns: f64::NAN,
        spread: f64::NAN,
    };
}

/// Time that something adds to a step: the time with it less the time without it,
/// as far as the timings can tell.
///
/// Both times have a spread, so the difference has the resolution
/// √(Δ₁² + Δ₂²), at least 1 % of the longer time. A smaller difference, and
/// one below zero, is not a cost that was measured: only its bound is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AddedTime {
    /// CPU time, ns a step; none where it is below the resolution or not
    /// known. Never zero or less.
    pub ns_per_step: Option<f64>,
    /// The smallest difference that these timings can tell, ns a step; NaN
    /// where one of the times is not known.
    pub ns_resolution: f64,
}

impl AddedTime {
    /// Excess of `with` over `without`.
    pub fn between(with: StepTime, without: StepTime) -> Self {
        let difference = with.ns - without.ns;
        if !difference.is_finite() {
            return Self {
                ns_per_step: None,
                ns_resolution: f64::NAN,
            };
        }
        let noise = |time: StepTime| time.ns * time.spread;
        let resolution = noise(with)
            .hypot(noise(without))
            .max(LEAST_RESOLUTION * with.ns.max(without.ns));
        Self {
            ns_per_step: (difference > resolution).then_some(difference),
            ns_resolution: resolution,
        }
    }

    /// Returns whether both times are known, and their difference is too small to be
    /// distinguished from zero.
    pub fn is_below_resolution(&self) -> bool {
        self.ns_per_step.is_none() && self.ns_resolution.is_finite()
    }
}

/// The CPU time of a step of each scene, without outputs, from so many
/// `timings` in which the scenes take turns. `after_each` is called after each
/// timing and may end it all.
///
/// # Errors
/// The error that `after_each` returns.
pub fn step_times<E>(
    scenes: &[Scene],
    timings: u32,
    mut after_each: impl FnMut() -> Result<(), E>,
) -> Result<Vec<StepTime>, E> {
    let mut short = scenes.to_vec();
    for scene in &mut short {
        scene.duration_s = scene.duration_s.min(STEPS * scene.step_s());
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
            let mut times = times.into_iter();
            let mut next = || times.next().unwrap_or(StepTime::UNKNOWN);
            Some(Cost {
                effect: effect.name,
                added: AddedTime::between(next(), next()),
            })
        })
        .collect()
}

#[expect(clippy::cast_precision_loss, reason = "a few thousand")]
fn time(scene: &Scene) -> f64 {
    let begun = cpu_time::now();
    let steps = match watched(&mut Blind, |watch| simulate(scene, watch)) {
        Ok(totals) => totals.steps,
        Err(_) => return f64::INFINITY,
    };
    cpu_time::since(begun).as_secs_f64() * 1e9 / steps as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(ns: f64, spread: f64) -> StepTime {
        StepTime { ns, spread }
    }

    #[test]
    fn a_cost_is_a_difference_that_the_timings_can_tell() {
        let added = AddedTime::between(time(100.0, 0.03), time(90.0, 0.05));
        assert_eq!(added.ns_per_step, Some(10.0));
        assert!((added.ns_resolution - 3.0_f64.hypot(4.5)).abs() < 1e-12);
        assert!(!added.is_below_resolution());
    }

    #[test]
    fn below_that_and_below_zero_only_the_bound_is_known() {
        for (with, without) in [(100.0, 99.5), (100.0, 100.0), (90.0, 100.0), (1.0, 1e6)] {
            let added = AddedTime::between(time(with, 0.0), time(without, 0.0));
            assert_eq!(added.ns_per_step, None, "{with} {without}");
            assert!(added.is_below_resolution());
            assert_eq!(added.ns_resolution, 0.01 * with.max(without));
        }
    }

    #[test]
    fn a_scene_that_does_not_run_has_no_cost_and_no_bound() {
        for unknown in [f64::NAN, f64::INFINITY] {
            let added = AddedTime::between(time(10.0, 0.0), time(unknown, f64::NAN));
            assert_eq!(added.ns_per_step, None);
            assert!(added.ns_resolution.is_nan() && !added.is_below_resolution());
        }
    }
}
