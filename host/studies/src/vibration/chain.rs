//! The steps of the chain from a bare knee to the device.

use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::Part;
use crepitus_scene::Scene;
use serde::Serialize;

crepitus_model::named! {
    /// A step.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Step {
        /// A diseased knee without a device: joint, leg and hand.
        BareKnee => "a bare diseased knee",
        /// The device, its actuator silent.
        MotorAlone => "the motor alone",
        /// The device, its actuator silent, with the hand on the leg beside the shell: as the paper's was.
        MotorOnLeg => "the motor alone, the hand on the leg",
        /// The motor and the actuator, with the ringing of a bone on the motor if the scene has one.
        Actuator => "and the actuator",
        /// The motor and the actuator, with the ringing of a bone on the actuator.
        Ringing => "and a bone's ringing on it",
        /// The actuator on the brace instead.
        OnBrace => "the actuator on the brace",
        /// The hand on the leg beside the shell instead.
        HandOnLeg => "the hand on the leg beside it",
    }
}

impl Step {
    /// The scene of this step, with the hand.
    pub(super) fn free(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self {
            Self::BareKnee => {
                scene.encoder = None;
                scene.is_device = false;
                scene.listed.retain(is_of_bare_knee);
            }
            Self::MotorAlone => {
                drop_effect(&mut scene, "vibration-actuator");
                choose(&mut scene, "bone-shaping", 0);
            }
            Self::MotorOnLeg => {
                scene = Self::MotorAlone.free(&scene);
                choose(&mut scene, "shell", 1);
            }
            Self::Actuator => choose(&mut scene, "bone-shaping", 0),
            Self::Ringing => {
                if let Some(bone) = crepitus_plant::effects::find("bone-shaping") {
                    scene = scene.with(bone).unwrap_or(scene);
                }
                choose(&mut scene, "bone-shaping", 1);
            }
            Self::OnBrace => choose(&mut scene, "reaction-mass", 1),
            Self::HandOnLeg => choose(&mut scene, "shell", 1),
        }
        scene
    }

    /// Scene with a fixture instead of the hand, which moves as the hand intends; none
    /// for a bare knee, which has no shell to hold, and for the ringing, which is no
    /// part of T.
    pub(super) fn held(self, scene: &Scene) -> Option<Scene> {
        if matches!(self, Self::BareKnee | Self::Ringing) {
            return None;
        }
        let mut held = self.free(scene);
        drop_effect(&mut held, "hand");
        drop_effect(&mut held, "bone-shaping");
        Some(held)
    }
}

/// Returns whether a knee without a device has this.
fn is_of_bare_knee(listed: &Listed) -> bool {
    let name = listed.effect.name;
    match listed.effect.part {
        Part::Stage(_) => !matches!(
            name,
            "friction-compensation" | "bone-shaping" | "vibration-actuator"
        ),
        _ => matches!(name, "limb" | "limb-stretch" | "hand"),
    }
}

fn drop_effect(scene: &mut Scene, name: &str) {
    scene.listed.retain(|listed| listed.effect.name != name);
}

/// Chooses an option of an effect's first choice, where the scene has the effect.
fn choose(scene: &mut Scene, effect: &str, option: u8) {
    let found = scene.listed.iter_mut().find(|l| l.effect.name == effect);
    if let Some(choice) = found.and_then(|listed| listed.given.choices.first_mut()) {
        *choice = option;
    }
}
