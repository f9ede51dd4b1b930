//! Joints of one rung, without its type.

use crate::joints::each::{AfterStep, StepPart, Work};
use crate::joints::motion::{Counts, StepEvent};
use crepitus_model::solver::Solver;
use crepitus_model::{Real, Settings, SettingsError, Validated};
use std::any::Any;

/// Joints of one rung, without its type.
pub trait Many<F: Lanes>: Send {
    /// A copy with all states.
    fn copied(&self) -> Box<dyn Many<F>>;

    fn as_any(&mut self) -> &mut dyn Any;

    /// Steps each joint through its motion, by this number of threads; ends early if `goes_on` says no,
    /// which the calling thread asks now and then.
    fn steps(&mut self, work: Work<'_, F>, threads: usize, goes_on: &mut dyn FnMut() -> bool);

    /// Steps all joints by one step: a turn and a speed of all, or of each.
    fn step(&mut self, turns_rad: &[F], speeds_rad_s: &[F], is_of_each: bool);

    /// Makes a step of a joint in parts.
    fn step_in_parts(&mut self, n: usize, parts: &[StepPart<F>], after: &mut AfterStep<'_, F>);

    /// Lets the speed of all shafts jump.
    fn jump(&mut self, omega_rad_s: F);

    /// Records events from now on.
    fn record_events(&mut self);

    /// Events of a joint that are recorded and not taken yet.
    fn events(&mut self, n: usize) -> Option<&mut Vec<StepEvent<F>>>;

    /// Puts a joint in stick where the shaft is.
    fn restart(&mut self, n: usize, torque_nm: F, omega_rad_s: F);

    /// Torque of each, N·m.
    fn torques_nm(&self) -> &[F];

    /// Sign of the phase of each.
    fn phases(&self) -> &[i8];

    /// Speed of the shaft of each after its last step, rad/s.
    fn omegas_rad_s(&self) -> &[F];

    /// (θ, θ̇) of a joint, rad and rad/s.
    fn motion(&mut self, n: usize) -> (F, F);

    /// Events of a joint.
    fn counts(&self, n: usize) -> Counts;
}

/// A precision whose rungs are compiled in this crate.
pub trait Lanes: Real {
    /// Adds a joint to those of its rung.
    #[doc(hidden)]
    fn push(
        many: Option<Box<dyn Many<Self>>>,
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<Box<dyn Many<Self>>, SettingsError>;
}
