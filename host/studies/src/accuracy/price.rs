//! Costs in instructions: rungs that a counted program steps, and their counts in the points.
//!
//! Counted at the studied step nearest to the device's tick, on the first scene of each convention
//! whose true motion the rungs know: the loops are those of [`timing`](super::timing).

use crate::accuracy::Study;
use crate::accuracy::input::Input;
use crate::accuracy::scenes::StudyScene;
use crate::accuracy::study::{Plan, contestants};
use crate::accuracy::timing::{Contestant, Track};
use crate::accuracy::words::nearest_to_the_tick;
use crate::sampling::Sampling;
use crepitus_model::{Convention, SettingsError};

/// Steps of the shorter of the two runs that are counted of each rung.
pub const STEPS: u32 = 1_000;

/// A rung on a scene.
type Subject<'p> = (&'p StudyScene, Contestant);

fn subjects(plan: &Plan) -> impl Iterator<Item = Subject<'_>> {
    let of = move |convention: Convention| {
        let mut scenes = plan.scenes.iter();
        scenes.find(|s| s.input == Input::Exact && s.settings.convention == convention)
    };
    let firsts = Convention::ALL.into_iter().filter_map(of);
    firsts.flat_map(|scene| {
        contestants(plan, scene)
            .into_iter()
            .map(move |c| (scene, c))
    })
}

/// Number of rungs that are counted.
pub fn count(plan: &Plan) -> usize {
    subjects(plan).count()
}

/// Steps each of them for so many steps and for twice as many, with the loop alone counted.
///
/// # Errors
/// [`SettingsError`] if settings, rung and step do not go together.
pub fn run_counted(plan: &Plan) -> Result<(), SettingsError> {
    let Some(step_s) = nearest_to_the_tick(plan.steps_s.iter().copied()) else {
        return Ok(());
    };
    let mut track: Option<(&StudyScene, Track<'_>)> = None;
    for (scene, contestant) in subjects(plan) {
        let known = track.take().filter(|(of, _)| std::ptr::eq(*of, scene));
        let (_, track) = track.insert(if let Some(known) = known {
            known
        } else {
            let sampling = Sampling::new(&scene.motion, scene.duration_s, step_s);
            (scene, Track::untimed(scene, &sampling)?)
        });
        for times in [1, 2] {
            track.count(contestant, times * STEPS)?;
        }
    }
    Ok(())
}

impl Study {
    /// Enters what was counted of the rungs of this plan.
    pub fn price(&mut self, plan: &Plan, counts: &[f64]) {
        let step_s = nearest_to_the_tick(plan.steps_s.iter().copied());
        for ((scene, (solver, precision)), count) in subjects(plan).zip(counts) {
            let points = self.points.iter_mut().filter(|p| {
                Some(p.step_s) == step_s
                    && p.is_exact()
                    && (p.scene.as_str(), p.convention) == (scene.name.as_str(), scene.convention())
                    && (p.solver, p.precision) == (solver.name(), precision.name())
            });
            for point in points {
                point.host_instructions_per_step = *count;
            }
        }
    }

    /// Returns whether anything was counted.
    pub fn is_priced(&self) -> bool {
        let mut points = self.points.iter();
        points.any(|p| p.host_instructions_per_step.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;
    use crate::accuracy::study::run;
    use crate::watcher::{Cancelled, Watcher};
    use crepitus_scene::scene::Precision;

    struct Patient;

    impl Watcher for Patient {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            Ok(())
        }
    }

    #[test]
    fn counts_are_entered_at_the_tick_on_one_scene_of_each_convention() {
        let mut scenes = standard().unwrap();
        for scene in &mut scenes {
            scene.duration_s = 0.02;
        }
        let plan = Plan {
            scenes,
            steps_s: vec![1e-3, 5e-5],
            precisions: vec![Precision::F32, Precision::F64],
            repeats: 1,
        };
        run_counted(&plan).unwrap();
        let mut study = run(&plan, &mut Patient).unwrap();
        assert!(!study.is_priced());
        study.price(&plan, &[]);
        assert!(!study.is_priced());
        let rungs = count(&plan);
        let counts: Vec<f64> = (1..=u32::try_from(rungs).unwrap()).map(f64::from).collect();
        study.price(&plan, &counts);
        let priced = study.points.iter();
        let priced: Vec<_> = priced
            .filter(|p| p.host_instructions_per_step.is_finite())
            .collect();
        assert_eq!(priced.len(), rungs);
        assert!(priced.iter().all(|p| p.step_s == 5e-5 && p.is_exact()));
        let mut found: Vec<_> = priced
            .iter()
            .map(|p| p.host_instructions_per_step)
            .collect();
        found.sort_by(f64::total_cmp);
        assert_eq!(found, counts);
        let rows = crate::accuracy::words::instructions_at_the_tick(&study);
        assert_eq!(rows.len(), rungs);
        assert!(rows.iter().all(|count| count.is_finite()));
    }
}
