//! Variants of a scene, with fewer or more effects.

use super::{Crepitus, MotionKind, Scene, SolverChoice};
use crepitus_model::Settings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Given, Part};
use crepitus_plant::effects::EFFECTS;

impl Scene {
    /// The effects that the scene calls for, in the order of the table.
    pub fn effects(&self) -> Vec<&'static Effect> {
        EFFECTS
            .iter()
            .copied()
            .filter(|e| self.has(e.name))
            .collect()
    }

    /// Returns whether it calls for an effect.
    pub fn has(&self, effect: &str) -> bool {
        EFFECTS
            .iter()
            .find(|e| e.name == effect)
            .is_some_and(|e| match e.part {
                Part::Joint => self.crepitus.is_some(),
                Part::Sensor => self.encoder.is_some(),
                _ => self.listed.iter().any(|l| l.effect.name == effect),
            })
    }

    /// The scene with only the first `count` effects of its plant, which need
    /// none of the later ones.
    pub fn first(&self, count: usize) -> Self {
        let mut scene = self.clone();
        scene.listed.truncate(count);
        if scene.listed.is_empty() {
            scene.substeps = 1;
        }
        scene
    }

    /// The scene without an effect and without those that need it; none if
    /// its motion needs the effect.
    pub fn without(&self, effect: &Effect) -> Option<Self> {
        if effect.name == "limb" && self.motion_kind == MotionKind::Released {
            return None;
        }
        let mut scene = self.clone();
        match effect.part {
            Part::Joint => scene.crepitus = None,
            Part::Sensor => scene.encoder = None,
            _ => scene.listed.retain(|l| l.effect.name != effect.name),
        }
        scene.warnings.clear();
        if scene.listed.is_empty() {
            scene.substeps = 1;
        }
        let dependent = scene
            .effects()
            .into_iter()
            .find(|other| other.needs.iter().any(|n| n.effect == effect.name));
        match dependent {
            None => Some(scene),
            Some(other) => scene.without(other)?.without(effect),
        }
    }

    /// The scene with an effect at its defaults, and with those that it needs;
    /// none if the motion or the solver does not allow it.
    pub fn with(&self, effect: &'static Effect) -> Option<Self> {
        if self.has(effect.name) {
            return Some(self.clone());
        }
        if self.solver == SolverChoice::Reference || (!self.is_held() && effect.name == "hand") {
            return None;
        }
        let mut scene = self.clone();
        for need in effect.needs {
            scene = scene.with(crepitus_plant::effects::find(need.effect)?)?;
        }
        match effect.part {
            Part::Joint => {
                scene.crepitus = Some(Crepitus {
                    preset: None,
                    settings: Settings::default().validate().ok()?,
                });
            }
            Part::Sensor => scene.encoder = Some(EncoderSettings::default()),
            _ => {
                scene.listed.push(Listed {
                    effect,
                    given: Given::defaults(effect),
                });
                let place = |name| EFFECTS.iter().position(|e| e.name == name);
                scene.listed.sort_by_key(|l| place(l.effect.name));
            }
        }
        scene.assemble().is_ok().then_some(scene)
    }
}
