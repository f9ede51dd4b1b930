//! The whole study: every rung × precision × step on every scene.

use crate::accuracy::held_torque::HeldTorque;
use crate::accuracy::input::Input;
use crate::accuracy::measure::{Accuracy, ReferenceRun, measure};
use crate::accuracy::orders::orders;
use crate::accuracy::point::Point;
use crate::accuracy::reference_torque::ReferenceTorque;
use crate::accuracy::results::{Refused, Skipped, StudiedScene, Study};
use crate::accuracy::scenes::StudyScene;
use crate::accuracy::steps::falling;
use crate::accuracy::timing::{Contestant, Cost, time};
use crate::sampling::Sampling;
use crate::true_events::{TimedEvent, TrueEvent};
use crate::watcher::{StudyError, Watcher};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Real};
use crepitus_scene::run::Lead;
use crepitus_scene::scene::Precision;
use std::time::Instant;

/// Repeats of a timing in a full study.
pub const FULL_REPEATS: usize = 7;

/// Repeats of a timing in a quick one.
pub const QUICK_REPEATS: usize = 5;

/// The most steps of one run: the reference's torque at each is stored.
const MOST_STEPS: u64 = 20_000_000;

/// Cost of a step of the reference, in steps of a rung.
const REFERENCE_WEIGHT: f64 = 10.0;

/// Plan of a study.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scenes, each under its convention.
    pub scenes: Vec<StudyScene>,
    /// The steps, s.
    pub steps_s: Vec<f64>,
    /// The precisions.
    pub precisions: Vec<Precision>,
    /// Repeats of each timing.
    pub repeats: usize,
}

/// Runs a plan.
///
/// # Errors
/// Error of the watcher, or settings that cannot work together.
pub fn run(plan: &Plan, watcher: &mut dyn Watcher) -> Result<Study, StudyError> {
    let begun = Instant::now();
    let mut study = Study {
        steps_s: plan.steps_s.clone(),
        timing_repeats: plan.repeats,
        refused: refused(&plan.scenes),
        ..Study::default()
    };
    let mut work = Work {
        watcher,
        total: total_work(plan),
        done: 0.0,
    };
    for scene in &plan.scenes {
        let truth = scene.true_events_while(|| work.add(0.0))?;
        let contestants = contestants(plan, scene);
        let mut studied = StudiedScene {
            name: scene.name.clone(),
            title: scene.title.clone(),
            convention: scene.convention(),
            input: scene.input.name(),
            duration_s: scene.duration_s,
            events_true: truth.len(),
            reference_behind_s: 0.0,
        };
        // By contestant, so that a curve's points are together.
        let mut curves = vec![Vec::new(); contestants.len()];
        for &step_s in &falling(&plan.steps_s) {
            let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
            if let Some(reason) = not_studied(&sampling) {
                study.skipped.push(Skipped {
                    scene: scene.name.clone(),
                    convention: scene.convention(),
                    step_s,
                    reason,
                });
                continue;
            }
            let (points, lead) = at_step(scene, &truth, &sampling, &contestants, plan, &mut work)?;
            studied.reference_behind_s = lead.behind_s;
            for (curve, point) in curves.iter_mut().zip(points) {
                curve.push(point);
            }
        }
        study.scenes.push(studied);
        study.points.extend(curves.into_iter().flatten());
    }
    study.orders = orders(&study.points);
    study.wall_s = begun.elapsed().as_secs_f64();
    Ok(study)
}

/// All contestants on one scene at one step, in their order, and the lead in
/// the reference's slips.
fn at_step(
    scene: &StudyScene,
    truth: &[TrueEvent],
    sampling: &Sampling<'_>,
    contestants: &[Contestant],
    plan: &Plan,
    work: &mut Work<'_>,
) -> Result<(Vec<Point>, Lead), StudyError> {
    let steps = f64::from_whole(sampling.steps());
    let torque = ReferenceTorque::new(scene, sampling, truth, || work.add(0.0))?;
    let held = HeldTorque::new(scene, sampling, truth);
    let held_floor_nm = held.floor_nm();
    work.add(REFERENCE_WEIGHT * steps)?;
    let end_s = sampling.end_s();
    let events: Vec<TimedEvent> = truth
        .iter()
        .map(|e| e.event)
        .filter(|e| e.time_s <= end_s)
        .collect();
    let target = ReferenceRun {
        scene,
        sampling,
        events: &events,
        torque: &torque,
        held: &held,
    };
    let mut accuracies = Vec::with_capacity(contestants.len());
    for &(solver, precision) in contestants {
        accuracies.push(measure(&target, solver, precision)?);
        work.add(steps)?;
    }
    let turn = timed_work(sampling);
    let costs = time(scene, sampling, contestants, plan.repeats, || {
        work.add(turn)
    })?;
    let events_true = u64::try_from(events.len()).unwrap_or(u64::MAX);
    let points = contestants
        .iter()
        .zip(accuracies.into_iter().zip(costs))
        .map(|(&contestant, (accuracy, cost))| Point {
            held_floor_nm,
            ..point(
                scene,
                sampling.step_s(),
                contestant,
                &accuracy,
                cost,
                events_true,
            )
        })
        .collect();
    Ok((points, torque.lead))
}

fn point(
    scene: &StudyScene,
    step_s: f64,
    (solver, precision): Contestant,
    accuracy: &Accuracy,
    cost: Cost,
    events_true: u64,
) -> Point {
    Point {
        scene: scene.name.clone(),
        convention: scene.convention(),
        input: scene.input.name(),
        solver: solver.name(),
        precision: precision.name(),
        step_s,
        events: accuracy.events,
        events_true,
        unmatched: accuracy.unmatched,
        max_event_error_s: accuracy.event_errors.max_s,
        rms_event_error_s: accuracy.event_errors.rms_s,
        max_interval_error_s: accuracy.event_errors.max_interval_s,
        frequency_error_rel: accuracy.event_errors.frequency_rel,
        rms_held_torque_error_nm: accuracy.rms_held_torque_error_nm,
        max_held_torque_error_nm: accuracy.max_held_torque_error_nm,
        held_floor_nm: f64::NAN,
        rms_tick_torque_error_nm: accuracy.rms_tick_torque_error_nm,
        max_tick_torque_error_nm: accuracy.max_tick_torque_error_nm,
        behind_s: accuracy.behind_s,
        behind_j: accuracy.behind_j,
        ns_per_step: cost.ns_per_step,
        ns_per_step_q1: cost.quartiles_ns[0],
        ns_per_step_q3: cost.quartiles_ns[1],
        us_per_simulated_s: cost.ns_per_step * 1e-3 / step_s,
        time_spread: cost.spread,
        cycles_per_step: f64::NAN,
        worst_cycles: f64::NAN,
        instructions_per_step: f64::NAN,
        host_instructions_per_step: f64::NAN,
    }
}

/// The rungs with a meaning, in each precision; behind the encoder in the device's, if that is
/// studied.
pub(super) fn contestants(plan: &Plan, scene: &StudyScene) -> Vec<Contestant> {
    let is_device = |p: &Precision| scene.input == Input::Exact || *p == Precision::F32;
    Solver::ALL
        .into_iter()
        .filter(|s| s.refusal(scene.settings.convention).is_none())
        .flat_map(|solver| plan.precisions.iter().map(move |p| (solver, *p)))
        .filter(|(_, p)| is_device(p))
        .filter(|(s, p)| *p == Precision::F64 || s.single_refusal().is_none())
        .collect()
}

/// The rungs without a meaning under one of the scenes' conventions.
fn refused(scenes: &[StudyScene]) -> Vec<Refused> {
    Convention::ALL
        .into_iter()
        .filter(|c| scenes.iter().any(|s| s.settings.convention == *c))
        .flat_map(|convention| {
            Solver::ALL.into_iter().filter_map(move |solver| {
                Some(Refused {
                    solver: solver.name(),
                    convention: convention.name(),
                    reason: solver.refusal(convention)?,
                })
            })
        })
        .collect()
}

/// Reason why a scene is not studied at a step.
fn not_studied(sampling: &Sampling<'_>) -> Option<&'static str> {
    if sampling.steps() == 0 {
        Some("the step is longer than the scene")
    } else if sampling.steps() > MOST_STEPS {
        Some("the scene has more than 20 million steps of this length")
    } else {
        None
    }
}

/// Work of one turn of a timing, in steps: the motion is sampled once for all,
/// which hardly counts.
fn timed_work(sampling: &Sampling<'_>) -> f64 {
    f64::from_whole(sampling.steps().min(40_000))
}

/// All work of a plan, in steps of a rung.
fn total_work(plan: &Plan) -> f64 {
    let mut total = 0.0;
    for scene in &plan.scenes {
        let rungs = f64::from_whole(u64::try_from(contestants(plan, scene).len()).unwrap_or(0));
        let repeats = f64::from_whole(u64::try_from(plan.repeats).unwrap_or(0));
        for &step_s in &falling(&plan.steps_s) {
            let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
            if not_studied(&sampling).is_none() {
                let steps = f64::from_whole(sampling.steps());
                total +=
                    REFERENCE_WEIGHT * steps + rungs * (steps + repeats * timed_work(&sampling));
            }
        }
    }
    total
}

/// Reports progress to the watcher.
struct Work<'a> {
    watcher: &'a mut dyn Watcher,
    total: f64,
    done: f64,
}

impl Work<'_> {
    fn add(&mut self, amount: f64) -> Result<(), StudyError> {
        self.done += amount;
        Ok(self.watcher.progress((self.done / self.total).min(1.0))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;
    use crate::watcher::Cancelled;

    /// Ends a study after this many calls.
    struct EndsAfter {
        calls: u32,
        most: u32,
        last: f64,
    }

    impl Watcher for EndsAfter {
        fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
            assert!(fraction >= self.last && fraction <= 1.0);
            self.last = fraction;
            self.calls += 1;
            if self.calls > self.most {
                Err(Cancelled)
            } else {
                Ok(())
            }
        }
    }

    fn plan() -> Plan {
        Plan {
            scenes: standard()
                .unwrap()
                .into_iter()
                .filter(|s| s.name == "constant-2")
                .map(|s| StudyScene {
                    duration_s: 0.2,
                    ..s
                })
                .collect(),
            steps_s: vec![1e-4, 1.0, 1e-3, 1e-4],
            precisions: vec![Precision::F32, Precision::F64],
            repeats: 1,
        }
    }

    fn ends_after(most: u32) -> EndsAfter {
        EndsAfter {
            calls: 0,
            most,
            last: 0.0,
        }
    }

    #[test]
    fn a_day_of_a_moving_hand_can_be_ended_before_its_first_step() {
        let hand = standard()
            .unwrap()
            .into_iter()
            .find(|s| s.name == "hand-sine");
        let plan = Plan {
            scenes: vec![StudyScene {
                duration_s: 86_400.0,
                ..hand.unwrap()
            }],
            ..plan()
        };
        let mut watcher = ends_after(3);
        assert!(matches!(
            run(&plan, &mut watcher),
            Err(StudyError::Cancelled(_))
        ));
        assert_eq!((watcher.calls, watcher.last), (4, 0.0));
    }

    #[test]
    fn every_combination_has_a_point_in_order() {
        let mut watcher = ends_after(u32::MAX);
        let study = run(&plan(), &mut watcher).unwrap();
        assert!((watcher.last - 1.0).abs() < 1e-12, "{}", watcher.last);
        let mut expected = Vec::new();
        for convention in [Convention::Frozen, Convention::Physical] {
            for solver in Solver::ALL {
                if solver.refusal(convention).is_none() {
                    for precision in ["f32", "f64"] {
                        if precision == "f32" && solver.single_refusal().is_some() {
                            continue;
                        }
                        for step_s in [1e-3, 1e-4] {
                            expected.push((convention.name(), solver.name(), precision, step_s));
                        }
                    }
                }
            }
        }
        let got: Vec<_> = study
            .points
            .iter()
            .map(|p| (p.convention, p.solver, p.precision, p.step_s))
            .collect();
        assert_eq!(got, expected);
        assert_eq!(study.skipped.len(), 2);
        assert!(study.skipped.iter().all(|s| s.step_s == 1.0));
        let refusals = |c: Convention| {
            Solver::ALL
                .iter()
                .filter(|s| s.refusal(c).is_some())
                .count()
        };
        assert_eq!(
            study.refused.len(),
            refusals(Convention::Frozen) + refusals(Convention::Physical)
        );
        for p in study.points.iter().filter(|p| p.solver == "exact-events") {
            assert_eq!((p.unmatched, p.events), (0, p.events_true), "{p:?}");
        }
    }

    #[test]
    fn a_watcher_ends_it_at_any_time() {
        for most in [0, 3, 40] {
            assert!(matches!(
                run(&plan(), &mut ends_after(most)),
                Err(StudyError::Cancelled(_))
            ));
        }
    }
}
