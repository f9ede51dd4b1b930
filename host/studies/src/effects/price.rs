//! Costs in instructions: scenes that a counted program runs, and their counts in the rows.

use super::results::EffectsStudy;
use super::row::Outcome;
use super::variant::{Change, variants};
use crepitus_scene::Scene;

/// Steps of the shorter of the two runs that are counted of each scene.
pub const STEPS: u32 = 1_000;

/// Scenes to be counted, in the order that [`EffectsStudy::price`] takes: the scene, its variants
/// that are valid, and the motion alone, if it can be.
pub fn to_count(scene: &Scene) -> Vec<Scene> {
    let variants = variants(scene).into_iter().filter_map(|v| v.scene);
    let own = std::iter::once(scene.clone()).chain(variants);
    own.chain(motion_alone(scene)).collect()
}

/// The scene without any effect; `None` if its motion needs one.
fn motion_alone(scene: &Scene) -> Option<Scene> {
    let mut bare = scene.clone();
    while let Some(effect) = bare.effects().first().copied() {
        bare = bare.without(effect)?;
    }
    Some(bare)
}

impl EffectsStudy {
    /// Enters what was counted of the scenes of [`to_count`].
    pub fn price(&mut self, scene: &Scene, counts: &[f64]) {
        let mut counts = counts.iter().copied();
        let mut next = || counts.next().unwrap_or(f64::NAN);
        let whole = next();
        let variants: Vec<f64> = variants(scene)
            .iter()
            .map(|v| v.scene.as_ref().map_or(f64::NAN, |_| next()))
            .collect();
        self.loop_instructions = next();
        for (row, count) in self
            .rows
            .iter_mut()
            .zip(std::iter::once(whole).chain(variants))
        {
            let Outcome::Ran(ran) = &mut row.outcome else {
                continue;
            };
            row.instructions_per_step = count;
            if let Some(added) = &mut ran.added {
                let sign = if row.change == Change::With {
                    1.0
                } else {
                    -1.0
                };
                added.instructions = sign * (count - whole);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::study::tests::scene;
    use super::super::{Plan, run};
    use super::*;
    use crate::watcher::{Cancelled, Watcher};

    struct Patient;

    impl Watcher for Patient {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            Ok(())
        }
    }

    #[test]
    fn counts_are_entered_where_they_belong() {
        let scene = scene(&["crepitus", "lead-pipe"], 0.05);
        let scenes = to_count(&scene);
        assert!(scenes.last().is_some_and(|bare| bare.effects().is_empty()));
        let plan = Plan {
            scene: scene.clone(),
            tolerance: None,
        };
        let mut study = run(&plan, &mut Patient).unwrap();
        let mut counts = vec![100.0; scenes.len()];
        counts[0] = 350.0;
        if let Some(last) = counts.last_mut() {
            *last = 70.0;
        }
        study.price(&scene, &counts);
        assert_eq!(study.loop_instructions, 70.0);
        assert_eq!(study.rows[0].instructions_per_step, 350.0);
        let without = study.rows[1].added().expect("it ran");
        assert_eq!(
            (study.rows[1].effect, without.instructions),
            ("crepitus", 250.0)
        );
        let with = study.rows.iter().find(|row| row.change == Change::With);
        assert_eq!(
            with.and_then(|row| row.added()).map(|a| a.instructions),
            Some(-250.0)
        );
        study.price(&scene, &[]);
        assert!(
            study
                .rows
                .iter()
                .all(|row| row.instructions_per_step.is_nan())
        );
    }
}
