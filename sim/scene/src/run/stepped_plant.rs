//! The plant of a scene, tick by tick in a loop of the caller.
//!
//! ```text
//! torque of the motor, or None: the scene's device ─> tick ─> row of the trace
//! torque of a hand, or the scene's motion          ──────┘
//! ```
//!
//! Its tick is that of a [run](super::run): without torques of the caller it makes the run's trace, to the bit. The device
//! sees the shaft in every tick, also while the motor has the torque of somebody else.

use super::any_device::Device;
use super::coupled::{Run, first_felt_nm, walk};
use super::device::device;
use super::reached::Reached;
use super::{Diverged, columns_with, steps};
use crate::any_joint::Precise;
use crate::scene::{Precision, Scene, SolverChoice};
use crate::trace::Column;
use crate::walk::Walk;
use crepitus_model::SettingsError;
use crepitus_model::solver::Solver;
use crepitus_plant::boundary::Pushed;
use crepitus_plant::effects::limb;
use crepitus_plant::{Motion, Plant};
use std::borrow::Borrow;
use std::sync::Arc;

/// The largest torque of a caller, N·m: several times that of the strongest knee.
pub const MOST_TORQUE_NM: f64 = 1_000.0;

/// Holder of the leg of a plant that is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holder {
    /// The scene's motion, its hand, or nobody where the leg is released.
    Scene,
    /// A torque of the caller, instead of those; the arm's mass goes with the hand.
    Torque,
}

/// Reason for which a scene has no plant that can be stepped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotStepped {
    /// The motion prescribes the shaft, or there is no step.
    #[error(
        "the scene has no plant to step: list an effect of one, such as [effects.limb] or [effects.motor], with a solver \
         that has a step; of a joint alone step crepitus.Joint"
    )]
    NoPlant,
    /// There is no leg that a hand could push.
    #[error(
        "a torque of the hand needs [effects.limb]: without a leg there is no inertia that it could push"
    )]
    NoLeg,
    /// Settings that do not go together.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// Motion of the plant's hand.
#[derive(Clone)]
enum Moved {
    /// That of the scene.
    Scene(Arc<Scene>),
    /// None: a torque moves the leg.
    Rest(Motion),
}

impl Borrow<Motion> for Moved {
    fn borrow(&self) -> &Motion {
        match self {
            Self::Scene(scene) => &scene.motion,
            Self::Rest(rest) => rest,
        }
    }
}

/// A plant that the caller steps; a clone goes on from the same state.
#[derive(Clone)]
pub struct SteppedPlant {
    scene: Arc<Scene>,
    holder: Holder,
    run: Run<Plant, Box<dyn Device>>,
    walk: Walk<Moved>,
    at: Reached,
}

impl SteppedPlant {
    /// Creates the plant of a scene, at the start of its motion.
    ///
    /// # Errors
    /// [`NotStepped`].
    pub fn new(scene: &Arc<Scene>, holder: Holder) -> Result<Self, NotStepped> {
        let SolverChoice::Ladder {
            solver, precision, ..
        } = scene.solver
        else {
            return Err(NotStepped::NoPlant);
        };
        if !scene.is_coupled() {
            return Err(NotStepped::NoPlant);
        }
        let has_leg = || {
            scene
                .listed
                .iter()
                .any(|l| l.effect.name == limb::EFFECT.name)
        };
        if holder == Holder::Torque && !has_leg() {
            return Err(NotStepped::NoLeg);
        }
        Ok(match precision {
            Precision::F32 => Self::of::<f32>(scene, holder, solver)?,
            Precision::F64 => Self::of::<f64>(scene, holder, solver)?,
        })
    }

    fn of<F: Precise>(
        scene: &Arc<Scene>,
        holder: Holder,
        solver: Solver,
    ) -> Result<Self, SettingsError> {
        let mut plant = scene.assemble()?;
        let (first_nm, moved) = match holder {
            Holder::Scene => (first_felt_nm(scene)?, Moved::Scene(scene.clone())),
            Holder::Torque => {
                plant.hold_by(|_| Box::new(Pushed::default()));
                (0.0, Moved::Rest(Motion::rest(scene.start().angle_rad)))
            }
        };
        let device = device::<F>(scene, solver, scene.step_s(), &plant.shaft())?;
        let mut run = Run::new(scene, plant, device, first_nm);
        let at = run.begun();
        Ok(Self {
            walk: walk::<_, F>(scene, moved),
            scene: scene.clone(),
            holder,
            run,
            at,
        })
    }

    /// Makes a tick, with torques that the caller has checked: finite, at most [`MOST_TORQUE_NM`]. `hand_nm` pushes toward
    /// growing angle, if a [torque](Holder::Torque) holds the leg; `motor_nm` is the motor's setpoint, which opposes growing
    /// angle, instead of that of the scene's device.
    pub fn tick(&mut self, hand_nm: f64, motor_nm: Option<f64>) {
        self.run.plant.push(hand_nm);
        if let Some(motor_nm) = motor_nm {
            self.at.command.torque_nm = motor_nm;
        }
        let mut events = Vec::new();
        let parts = self.scene.substeps;
        self.run
            .tick(&mut self.at, &mut self.walk, parts, &mut events);
        self.at.end_tick(self.walk.time_s());
    }

    /// Ticks until the end of the scene's motion; `None` where a torque moves the leg, without end.
    pub fn ticks_left(&self) -> Option<u64> {
        let (steps, _) = steps(&self.scene);
        (self.holder == Holder::Scene).then(|| steps.saturating_sub(self.at.n))
    }

    /// Checks that the state is still numbers.
    ///
    /// # Errors
    /// [`Diverged`].
    pub fn check(&self) -> Result<(), Diverged> {
        let diverged = self.run.diverged(&self.scene, self.at.time_s);
        diverged.map_or(Ok(()), Err)
    }

    /// Columns of its rows: those of the scene's trace, without the motion's where a torque moves the leg.
    pub fn columns(&self) -> Vec<Column> {
        columns_with(&self.scene, Some(&self.run.plant), self.is_held())
    }

    /// Writes the present state as a row.
    pub fn row(&self, row: &mut Vec<f64>) {
        self.run.row(&self.scene, &self.at, self.is_held(), row);
    }

    /// Time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.at.time_s
    }

    fn is_held(&self) -> bool {
        self.holder == Holder::Torque || self.scene.is_held()
    }
}

#[cfg(test)]
mod tests;
