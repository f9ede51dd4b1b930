//! Output of a device, as its plant's tick needs it: of the few effects that a scene lists, and
//! not of all that there could be.

use super::stages;
use crate::scene::Scene;
use crepitus_model::Real;
use crepitus_model::render::Shown;
use crepitus_model::render::effects::{EffectSpec, IS_SYMPTOM, SPECS};

/// An effect of the device, its present torque, and its work.
#[derive(Clone)]
pub(super) struct Stage {
    pub(super) spec: &'static EffectSpec,
    /// Place of the effect in the model's table.
    pub(super) place: usize,
    /// True if its contribution is part of the model's torque.
    is_symptom: bool,
    /// True if its contribution is part of the motor's torque.
    pub(super) acts_on_joint: bool,
    added_nm: f64,
    pub(super) work_j: f64,
}

impl Stage {
    /// The stages of a scene, in the order in which they act.
    pub(super) fn listed(scene: &Scene) -> Vec<Self> {
        let settings = scene.effect_settings();
        stages::listed(scene)
            .map(|spec| {
                let place = SPECS.iter().take_while(|s| s.name != spec.name).count();
                Self {
                    spec,
                    place,
                    is_symptom: IS_SYMPTOM.get(place).is_some_and(|is| *is),
                    acts_on_joint: settings.acts_on_joint(place),
                    added_nm: 0.0,
                    work_j: 0.0,
                }
            })
            .collect()
    }
}

impl Stage {
    /// Accounts for the tick before, in which the shaft turned by `turned_rad`, and notes the torque
    /// that a symptom adds from now on, N·m.
    #[inline]
    pub(super) fn goes_on(&mut self, added_nm: f64, turned_rad: f64) {
        self.work_j += self.added_nm * turned_rad;
        self.added_nm = added_nm;
    }
}

/// Command of a device for a tick of its plant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Command {
    /// Torque setpoint of the actuator, N·m.
    pub(super) torque_nm: f64,
    /// Voltage for the coil, V.
    pub(super) coil_v: f64,
    /// The joint's torque, N·m.
    pub(super) joint_nm: f64,
    /// Addition of guards and limits, N·m.
    pub(super) taken_nm: f64,
    /// Torque before the limits of a device, N·m; without one the setpoint.
    pub(super) asked_nm: f64,
}

impl Command {
    /// Goes on with another torque, of which that is the symptoms', N·m, of a device without limits
    /// and without a coil.
    #[inline]
    pub(super) fn goes_on(&mut self, torque_nm: f64, symptoms_nm: f64) {
        self.torque_nm = torque_nm;
        self.joint_nm = torque_nm - symptoms_nm;
        self.asked_nm = torque_nm;
    }

    /// Command of what is shown. Accounts in each stage for the tick before, in which the shaft
    /// turned by `turned_rad`, and notes its torque.
    #[inline]
    pub(super) fn of<F: Real>(
        shown: &Shown<F>,
        asked_nm: Option<F>,
        turned_rad: f64,
        stages: &mut [Stage],
    ) -> Self {
        let (mut symptoms_nm, mut all_nm) = (0.0, 0.0);
        let added = shown.added.each();
        for stage in stages {
            stage.work_j += stage.added_nm * turned_rad;
            let added_nm = added.get(stage.place).map_or(0.0, |nm| nm.to_f64());
            if stage.is_symptom {
                symptoms_nm += added_nm;
            }
            if stage.acts_on_joint {
                stage.added_nm = added_nm;
                all_nm += added_nm;
            }
        }
        let torque_nm = shown.torque_nm.to_f64();
        let joint_nm = shown.model_torque_nm.to_f64() - symptoms_nm;
        Self {
            torque_nm,
            coil_v: shown.coil_v.to_f64(),
            joint_nm,
            // Without a device there is nothing that could.
            taken_nm: asked_nm.map_or(0.0, |_| torque_nm - joint_nm - all_nm),
            asked_nm: asked_nm.map_or(torque_nm, F::to_f64),
        }
    }
}
