//! The smallest set of a scene's effects within a tolerance, the effects that
//! were dropped, and why the rest is kept.

use super::hand::{Ended, WholeRun, hand_torque};
use super::influence::{Difference, Size, relative};
use super::smallest::{Set, sets, smallest, without};
use super::tolerance::{Criterion, Tolerance};
use super::variant::states;
use crate::parallel::{Meter, each};
use crate::watcher::{Cancelled, Watcher};
use crepitus_model::Real;
use crepitus_plant::effect::Effect;
use crepitus_scene::Scene;
use crepitus_scene::run::step_times;
use serde::Serialize;

/// Relative difference below which costs are equal.
const SAME_COST: f64 = 0.05;

/// The smallest set of effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The tolerance.
    pub tolerance: Tolerance,
    /// The set.
    pub chosen: Subset,
    /// Effects of the set, and the result of dropping each one, too.
    pub kept: Vec<Dropped>,
    /// The other effects, and the result of dropping each one alone.
    pub dropped: Vec<Dropped>,
    /// Other sets of this size within the tolerance, costlier or less accurate.
    pub others: Vec<Subset>,
    /// Time of a step of the whole scene, ns, in the same timings.
    pub scene_ns_per_step: f64,
    /// State variables of the whole scene.
    pub scene_states: usize,
    /// Number of sets tried.
    pub tried: usize,
    /// Number of all sets.
    pub sets: usize,
}

/// Some of a scene's effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Subset {
    /// Their names.
    pub effects: Vec<&'static str>,
    /// Difference of the torque from that of the whole scene.
    pub difference: Difference,
    /// State variables.
    pub states: usize,
    /// Time of a step, ns.
    pub ns_per_step: f64,
}

/// Result of dropping an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dropped {
    /// The effect.
    pub effect: &'static str,
    /// Dropped with it, because they need it.
    pub along: Vec<&'static str>,
    /// Difference of the torque from that of the whole scene; `None` if the
    /// run failed.
    pub difference: Option<Difference>,
    /// Reason why the run failed.
    pub failure: Option<String>,
}

/// Input of the search for an answer.
pub(super) struct Question<'a> {
    pub(super) scene: &'a Scene,
    pub(super) whole: &'a WholeRun,
    pub(super) tolerance: &'a Tolerance,
    /// Number of timings, of which the fastest counts.
    pub(super) timings: u32,
}

/// Number of valid sets of a scene's effects.
pub(super) fn set_count(scene: &Scene) -> usize {
    sets(&needs(&scene.effects())).count()
}

/// Indices of the effects that each effect needs.
fn needs(effects: &[&'static Effect]) -> Vec<Set> {
    effects
        .iter()
        .map(|effect| {
            effects
                .iter()
                .enumerate()
                .filter(|(_, other)| effect.needs.iter().any(|n| n.effect == other.name))
                .fold(0, |set, (i, _)| set | (1 << i))
        })
        .collect()
}

/// The answer; `None` if not even the whole scene is within, which only a scene
/// with irreproducible runs could cause.
pub(super) fn answer(
    question: &Question<'_>,
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<Option<Answer>, Cancelled> {
    let Question {
        scene, tolerance, ..
    } = *question;
    let effects = scene.effects();
    let needs = needs(&effects);
    let everything = (1 << effects.len()) - 1;
    let found = smallest(&needs, |sets| {
        each(sets, meter, watcher, |set| {
            let tried = part(scene, &effects, *set)?;
            let difference = question.difference(&tried, meter, true).ok()?;
            tolerance.holds(&difference).then_some(difference)
        })
    })?;
    let subsets = question.timed(&effects, &found.sets, meter, watcher)?;
    let Some((scene_ns_per_step, mut subsets)) = subsets else {
        return Ok(None);
    };
    let (chosen_set, chosen) = subsets.remove(cheapest(&subsets));
    // Each effect is dropped: a kept one from the chosen set, the others from
    // the whole.
    let places: Vec<usize> = (0..effects.len()).collect();
    let dropped = each(&places, meter, watcher, |place| {
        let from = if chosen_set & (1 << place) == 0 {
            everything
        } else {
            chosen_set
        };
        question.dropped(&effects, from, without(from, *place, &needs), *place, meter)
    })?;
    let (kept, dropped) = dropped
        .into_iter()
        .partition(|d| chosen.effects.contains(&d.effect));
    Ok(Some(Answer {
        tolerance: tolerance.clone(),
        chosen,
        kept,
        dropped,
        others: subsets.into_iter().map(|(_, subset)| subset).collect(),
        scene_ns_per_step,
        scene_states: states(scene),
        tried: found.tried,
        sets: sets(&needs).count(),
    }))
}

/// The cheapest, of equal ones that with the smallest difference.
fn cheapest(subsets: &[(Set, Subset)]) -> usize {
    let least = subsets
        .iter()
        .map(|(_, s)| s.ns_per_step)
        .fold(f64::INFINITY, f64::min);
    subsets
        .iter()
        .enumerate()
        .filter(|(_, (_, s))| s.ns_per_step <= least * (1.0 + SAME_COST))
        .min_by(|(_, (_, a)), (_, (_, b))| a.difference.rms_nm.total_cmp(&b.difference.rms_nm))
        .map_or(0, |(place, _)| place)
}

/// The scene with these of its effects.
fn part(scene: &Scene, effects: &[&'static Effect], set: Set) -> Option<Scene> {
    effects
        .iter()
        .enumerate()
        .filter(|(i, _)| set & (1 << i) == 0)
        .try_fold(scene.clone(), |scene, (_, effect)| scene.without(effect))
}

fn names(effects: &[&'static Effect], set: Set) -> Vec<&'static str> {
    effects
        .iter()
        .enumerate()
        .filter(|(i, _)| set & (1 << i) != 0)
        .map(|(_, effect)| effect.name)
        .collect()
}

impl Question<'_> {
    /// Difference of a scene's torque from that of the whole one. If
    /// `stop_early`, the run ends once it exceeds the tolerance.
    fn difference(
        &self,
        scene: &Scene,
        meter: &Meter,
        stop_early: bool,
    ) -> Result<Difference, Ended> {
        let limit = |criterion| {
            if stop_early {
                self.tolerance.at_most(criterion)
            } else {
                f64::INFINITY
            }
        };
        let (rms_nm, peak_nm) = (limit(Criterion::Torque), limit(Criterion::Peak));
        let ticks = f64::from_whole(crepitus_scene::run::step_count(scene));
        // With some margin for rounding; in the end the limits decide.
        let most = rms_nm * rms_nm * ticks * (1.0 + 1e-9);
        let mut size = Size::default();
        let mut whole = self.whole.signal.iter();
        let felt = hand_torque(scene, meter, |torque_nm| {
            size.push(torque_nm - whole.next().copied().unwrap_or(f64::NAN));
            size.squares <= most && size.peak <= peak_nm
        })?;
        Ok(Difference {
            rms_nm: size.rms(),
            peak_nm: size.peak,
            events_relative: relative(felt.events, self.whole.events),
        })
    }

    /// The time of a step of the scene, and the sets with theirs; `None`
    /// without sets.
    #[expect(clippy::type_complexity, reason = "used once")]
    fn timed(
        &self,
        effects: &[&'static Effect],
        found: &[(Set, Difference)],
        meter: &Meter,
        watcher: &mut dyn Watcher,
    ) -> Result<Option<(f64, Vec<(Set, Subset)>)>, Cancelled> {
        let mut scenes = vec![self.scene.clone()];
        scenes.extend(
            found
                .iter()
                .filter_map(|(set, _)| part(self.scene, effects, *set)),
        );
        let times = step_times(&scenes, self.timings, || meter.report(watcher))?;
        let mut timed = scenes.iter().zip(times);
        let Some((_, whole)) = timed.next() else {
            return Ok(None);
        };
        let subsets: Vec<_> = found
            .iter()
            .zip(timed)
            .map(|((set, difference), (scene, time))| {
                let subset = Subset {
                    effects: names(effects, *set),
                    difference: *difference,
                    states: states(scene),
                    ns_per_step: time.ns,
                };
                (*set, subset)
            })
            .collect();
        Ok((!subsets.is_empty()).then_some((whole.ns, subsets)))
    }

    /// Result of `left`, which is `from` without the effect at `place`.
    fn dropped(
        &self,
        effects: &[&'static Effect],
        from: Set,
        left: Set,
        place: usize,
        meter: &Meter,
    ) -> Dropped {
        let effect = effects.get(place).map_or("", |e| e.name);
        let along = names(effects, from & !left & !(1 << place));
        let outcome = match part(self.scene, effects, left) {
            Some(scene) => self.difference(&scene, meter, false),
            None => Err(Ended::Failed("the motion needs it".to_owned())),
        };
        let (difference, failure) = match outcome {
            Ok(difference) => (Some(difference), None),
            Err(Ended::Failed(why)) => (None, Some(why)),
            Err(_) => (None, None),
        };
        Dropped {
            effect,
            along,
            difference,
            failure,
        }
    }
}
