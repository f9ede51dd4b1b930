//! The variants of a scene: each effect left out, each absent one added.

use crepitus_plant::effect::{Effect, Part};
use crepitus_plant::effects::EFFECTS;
use crepitus_scene::Scene;
use serde::Serialize;

crepitus_model::named! {
    /// Kind of change from the scene to a variant.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Change {
        /// The scene itself.
        Scene => "scene",
        /// An effect is left out.
        Without => "without",
        /// An effect is added, at its defaults.
        With => "with",
    }
}

/// A variant of a scene.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Kind of change to the scene.
    pub change: Change,
    /// The effect.
    pub effect: &'static str,
    /// Effects dropped with it because they need it, or added because it needs
    /// them.
    pub along: Vec<&'static str>,
    /// The changed scene; `None` if it would be invalid.
    pub scene: Option<Scene>,
}

/// All variants of a scene: first its effects left out, then the others added,
/// each in the order of the table.
pub fn variants(scene: &Scene) -> Vec<Variant> {
    let present = scene.effects().into_iter().map(|effect| {
        let left = scene.without(effect);
        Variant {
            change: Change::Without,
            effect: effect.name,
            along: left
                .as_ref()
                .map_or_else(Vec::new, |left| more(scene, left, effect)),
            scene: left,
        }
    });
    let absent = EFFECTS.iter().filter(|e| !scene.has(e.name)).map(|effect| {
        let grown = scene.with(effect);
        Variant {
            change: Change::With,
            effect: effect.name,
            along: grown
                .as_ref()
                .map_or_else(Vec::new, |grown| more(grown, scene, effect)),
            scene: grown,
        }
    });
    present.chain(absent).collect()
}

/// Effects of `large` missing in `small`, except `effect`.
fn more(large: &Scene, small: &Scene, effect: &Effect) -> Vec<&'static str> {
    large
        .effects()
        .into_iter()
        .map(|e| e.name)
        .filter(|name| *name != effect.name && !small.has(name))
        .collect()
}

/// Number of state variables of a scene; one that parts of the mechanics share counts
/// once. Effects of the device share none, though two may call theirs the same.
pub fn states(scene: &Scene) -> usize {
    let mut names: Vec<_> = scene
        .effects()
        .into_iter()
        .flat_map(|effect| {
            let owner = match effect.part {
                Part::Stage(_) => effect.name,
                _ => "",
            };
            effect.states.iter().map(move |state| (owner, *state))
        })
        .collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}

#[cfg(test)]
mod tests {
    use super::super::study::tests::scene;
    use super::*;

    fn variant_names(effects: &[&str]) -> Vec<(&'static str, &'static str, Vec<&'static str>)> {
        variants(&scene(effects, 0.1))
            .into_iter()
            .map(|v| (v.change.name(), v.effect, v.along))
            .collect()
    }

    #[test]
    fn dependents_are_dropped_with_an_effect_and_its_needs_are_added_with_it() {
        let names = variant_names(&["crepitus", "drivetrain", "friction-compensation"]);
        assert_eq!(names.len(), EFFECTS.len());
        assert_eq!(
            names[..4],
            [
                ("without", "crepitus", vec![]),
                ("without", "drivetrain", vec!["friction-compensation"]),
                ("without", "friction-compensation", vec![]),
                ("with", "encoder", vec![]),
            ]
        );
        let alone = variant_names(&[]);
        assert!(alone.contains(&("with", "backlash", vec!["drivetrain"])));
        assert!(alone.contains(&("with", "bone-shaping", vec!["crepitus"])));
    }

    #[test]
    fn a_shared_state_counts_once() {
        let (limb, hand) = (
            states(&scene(&["limb"], 0.1)),
            states(&scene(&["hand"], 0.1)),
        );
        assert_eq!((limb, hand), (2, 2));
        assert_eq!(states(&scene(&["limb", "hand"], 0.1)), 2);
        assert_eq!(states(&scene(&[], 0.1)), 0);
        // The stretches of two plays are two.
        let alone = ["lead-pipe", "clasp-knife"].map(|effect| states(&scene(&[effect], 0.1)));
        let both = states(&scene(&["lead-pipe", "clasp-knife"], 0.1));
        assert_eq!(both, alone[0] + alone[1]);
    }
}
