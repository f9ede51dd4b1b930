//! The whole study: the scene, its variants, their times, the answer.

use super::answer::{Answer, Question, answer, set_count};
use super::build_up::build_up;
use super::hand::{Ended, WholeRun, hand_torque, ticks};
use super::influence::{Size, TorqueStatistics};
use super::refusal::{Refusal, refusal};
use super::results::EffectsStudy;
use super::row::{Added, Outcome, Ran, Row};
use super::tolerance::Tolerance;
use super::variant::{Change, Variant, states, variants};
use super::window::{Candidate, Profile, SHOWN, shown_torques};
use crate::parallel::{Meter, each};
use crate::watcher::{Cancelled, Watcher};
use crepitus_model::Real;
use crepitus_scene::Scene;
use crepitus_scene::run::{AddedTime, StepTime, step_count, step_times};
use std::time::Instant;

/// Number of timings, of which the fastest counts: enough for a quiet moment
/// of a busy machine.
const TIMINGS: u32 = 25;

/// Plan of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scene.
    pub scene: Scene,
    /// Tolerance for the search of the smallest set, if any.
    pub tolerance: Option<Tolerance>,
}

/// Reason why a study has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EffectsError {
    /// The watcher cancelled it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The scene cannot be studied.
    #[error("{0}")]
    Refused(Refusal),
    /// The run of the scene itself failed.
    #[error("{0}")]
    Scene(String),
}

/// Runs a plan.
///
/// # Errors
/// Error of the watcher, or the reason why the scene cannot be studied. A failed
/// variant is a row with the reason.
pub fn run(plan: &Plan, watcher: &mut dyn Watcher) -> Result<EffectsStudy, EffectsError> {
    let begun = Instant::now();
    let scene = &plan.scene;
    if let Some(refusal) = refusal(scene) {
        return Err(EffectsError::Refused(refusal));
    }
    let variants = variants(scene);
    let meter = Meter::new(work(plan, variants.len()));
    let (whole, own, warnings) = whole(scene, &meter, watcher)?;
    let variant_runs = each(&variants, &meter, watcher, |variant| {
        run_variant(variant, &whole, &meter)
    })?;
    let (scene_time, times) = times(scene, &variants, &meter, watcher)?;
    let mut rows = vec![Row {
        change: Change::Scene,
        effect: "",
        along: Vec::new(),
        states: states(scene),
        ns_per_step: scene_time.ns,
        time_spread: scene_time.spread,
        instructions_per_step: f64::NAN,
        outcome: Outcome::Ran(own),
    }];
    for ((variant, variant_run), time) in variants.iter().zip(&variant_runs).zip(times) {
        rows.push(row(
            variant,
            variant_run,
            (time, scene_time),
            &whole,
            &rows[0],
        ));
    }
    let answer = find(plan, &whole, &meter, watcher)?;
    let candidates = candidates(&variants, &variant_runs, &rows[1..]);
    let hand_torque = shown_torques(&whole, scene, candidates, &meter, watcher)?;
    let built = build_up(scene, &meter, watcher)?;
    let (build_up, build_up_torques) =
        built.map_or_else(Default::default, |b| (b.rungs, b.torques));
    Ok(EffectsStudy {
        scene: scene.file.display().to_string(),
        title: scene.title.clone(),
        effects: scene.effects().iter().map(|e| e.name).collect(),
        tick_s: scene.step_s(),
        ticks: step_count(scene),
        warnings,
        rows,
        timings: TIMINGS,
        loop_instructions: f64::NAN,
        answer,
        build_up,
        build_up_torques,
        wall_s: begun.elapsed().as_secs_f64(),
        hand_torque,
    })
}

/// All work, in ticks; the search for sets may take less.
fn work(plan: &Plan, variants: usize) -> f64 {
    let sets = if plan.tolerance.is_some() {
        set_count(&plan.scene) + plan.scene.effects().len()
    } else {
        0
    };
    let runs = 1 + variants + sets + SHOWN + super::build_up::runs(&plan.scene);
    ticks(&plan.scene) * f64::from_whole(u64::try_from(runs).unwrap_or(u64::MAX))
}

/// The scene's own run.
fn whole(
    scene: &Scene,
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<(WholeRun, Ran, Vec<String>), EffectsError> {
    let runs = each(std::slice::from_ref(scene), meter, watcher, |scene| {
        let count = step_count(scene);
        let mut signal = Vec::with_capacity(usize::try_from(count).unwrap_or(0));
        let mut statistics = TorqueStatistics::new(scene.step_s(), count);
        let felt = hand_torque(scene, meter, |torque_nm| {
            signal.push(torque_nm);
            statistics.push(torque_nm);
            true
        })?;
        Ok((signal, statistics.finish(), felt))
    })?;
    match runs.into_iter().next() {
        Some(Ok((signal, torque, felt))) => {
            let events = felt.events;
            let ran = Ran {
                torque,
                events,
                added: None,
            };
            Ok((WholeRun { signal, events }, ran, felt.summary.warnings))
        }
        Some(Err(Ended::Failed(why))) => Err(EffectsError::Scene(why)),
        _ => Err(EffectsError::Scene("the run ended early".to_owned())),
    }
}

/// The completed run of a variant.
struct VariantRun {
    ran: Ran,
    difference: Size,
    profile: Profile,
}

fn run_variant(variant: &Variant, whole: &WholeRun, meter: &Meter) -> Result<VariantRun, String> {
    let Some(scene) = &variant.scene else {
        return Err(match variant.change {
            Change::With => "the scene's motion, solver or step does not allow it".to_owned(),
            _ => "the scene's motion needs it".to_owned(),
        });
    };
    let count = step_count(scene);
    let mut statistics = TorqueStatistics::new(scene.step_s(), count);
    let mut difference = Size::default();
    let mut profile = Profile::new(count);
    let mut own = whole.signal.iter();
    let felt = hand_torque(scene, meter, |torque_nm| {
        let apart = torque_nm - own.next().copied().unwrap_or(f64::NAN);
        statistics.push(torque_nm);
        difference.push(apart);
        profile.push(apart);
        true
    })
    .map_err(|ended| ended.to_string())?;
    Ok(VariantRun {
        ran: Ran {
            torque: statistics.finish(),
            events: felt.events,
            added: None,
        },
        difference,
        profile,
    })
}

/// The times of the scene and of its variants; unknown for an impossible variant.
fn times(
    scene: &Scene,
    variants: &[Variant],
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<(StepTime, Vec<StepTime>), Cancelled> {
    let mut scenes = vec![scene.clone()];
    scenes.extend(variants.iter().filter_map(|v| v.scene.clone()));
    let mut times = step_times(&scenes, TIMINGS, || meter.report(watcher))?.into_iter();
    let scene = times.next().unwrap_or(StepTime::UNKNOWN);
    let variants = variants
        .iter()
        .map(|v| v.scene.as_ref().and_then(|_| times.next()))
        .map(|time| time.unwrap_or(StepTime::UNKNOWN))
        .collect();
    Ok((scene, variants))
}

fn row(
    variant: &Variant,
    variant_run: &Result<VariantRun, String>,
    (time, scene_time): (StepTime, StepTime),
    whole: &WholeRun,
    scene: &Row,
) -> Row {
    let time = if variant_run.is_ok() {
        time
    } else {
        StepTime::UNKNOWN
    };
    let states = variant.scene.as_ref().map_or(0, states);
    // With the effect minus without it.
    let (sign, added_time) = if variant.change == Change::With {
        (1, AddedTime::between(time, scene_time))
    } else {
        (-1, AddedTime::between(scene_time, time))
    };
    let outcome = match variant_run {
        Ok(variant_run) => Outcome::Ran(Ran {
            added: Some(Added {
                rms_nm: variant_run.difference.rms(),
                peak_nm: variant_run.difference.peak,
                events: sign * signed(variant_run.ran.events, whole.events),
                states: sign * signed(count(states), count(scene.states)),
                time: added_time,
                instructions: f64::NAN,
            }),
            ..variant_run.ran
        }),
        Err(failure) => Outcome::Failed {
            failure: failure.clone(),
        },
    };
    Row {
        change: variant.change,
        effect: variant.effect,
        along: variant.along.clone(),
        states,
        ns_per_step: time.ns,
        time_spread: time.spread,
        instructions_per_step: f64::NAN,
        outcome,
    }
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}

/// `a` − `b`.
fn signed(a: u64, b: u64) -> i64 {
    let size = i64::try_from(a.abs_diff(b)).unwrap_or(i64::MAX);
    if a < b { -size } else { size }
}

fn find(
    plan: &Plan,
    whole: &WholeRun,
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<Option<Answer>, Cancelled> {
    match &plan.tolerance {
        None => Ok(None),
        Some(tolerance) => answer(
            &Question {
                scene: &plan.scene,
                whole,
                tolerance,
                timings: TIMINGS,
            },
            meter,
            watcher,
        ),
    }
}

fn candidates<'a>(
    variants: &'a [Variant],
    variant_runs: &'a [Result<VariantRun, String>],
    rows: &[Row],
) -> Vec<Candidate<'a>> {
    variants
        .iter()
        .zip(variant_runs)
        .zip(rows)
        .filter_map(|((variant, variant_run), row)| {
            let variant_run = variant_run.as_ref().ok()?;
            Some(Candidate {
                scene: variant.scene.as_ref()?,
                change: variant.change,
                name: row.name(),
                rms_nm: variant_run.difference.rms(),
                profile: &variant_run.profile,
            })
        })
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crepitus_scene::Overrides;
    use std::path::Path;

    /// A scene of strokes with these effects at their defaults.
    pub(in super::super) fn scene(effects: &[&str], duration_s: f64) -> Scene {
        let mut text = format!(
            "version = 1\ntitle = \"small\"\nduration_s = {duration_s:?}\n[motion]\nkind = \"sine\"\n\
             amplitude_deg = 20\nfrequency_hz = 0.7\n[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n"
        );
        text.extend(effects.iter().map(|e| format!("[effects.{e}]\n")));
        Scene::parse(Path::new("small.toml"), &text, &Overrides::default()).unwrap()
    }
}
