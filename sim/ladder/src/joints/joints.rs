//! Joints, their state and its copies.

use crate::joints::each::{StepPart, Work};
use crate::joints::many::{Lanes, Many};
use crate::joints::motion::{Columns, Counts, Motion, State, StepEvent};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError, Validated};
use thiserror::Error;

/// Joints that differ in their parameters, and have convention, solver and step in common.
///
/// A clone is a snapshot: it has all states, and goes on as its original does.
pub struct Joints<F> {
    many: Box<dyn Many<F>>,
    convention: Convention,
    solver: Solver,
    step_s: f64,
}

/// Error of joints that cannot be made, or not be stepped.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JointError {
    /// The solver has no meaning for a joint, or the step is invalid.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No joint.
    #[error("expected at least one joint, got none")]
    Empty,
    /// Joints of different conventions.
    #[error("joint {joint}: expected convention \"{}\" as of joint 0, got \"{}\"", expected.name(), found.name())]
    Mixed {
        /// Its number.
        joint: usize,
        /// Convention of the first.
        expected: Convention,
        /// Its convention.
        found: Convention,
    },
    /// Numbers of turns, speeds and rows do not belong together.
    #[error(
        "expected as many speeds as turns, and as many numbers for each of {joints} joints, got {turns} turns, {speeds} speeds"
    )]
    Shape {
        /// Number of joints.
        joints: usize,
        /// Number of turns.
        turns: usize,
        /// Number of speeds.
        speeds: usize,
    },
    /// The caller ended the steps; joints are where they had got to.
    #[error("the steps were interrupted")]
    Interrupted,
}

impl<F: Lanes> Joints<F> {
    /// Joints in stick at θ = 0, each with the speed of its shaft, rad/s.
    ///
    /// # Errors
    /// [`JointError::Empty`], [`JointError::Mixed`]; [`JointError::Settings`] as of
    /// [`with_joint`](crepitus_model::solver::with_joint).
    pub fn new(
        joints: impl IntoIterator<Item = (Validated<Settings>, F)>,
        solver: Solver,
        step_s: f64,
    ) -> Result<Self, JointError> {
        let mut all: Option<(Box<dyn Many<F>>, Convention)> = None;
        for (joint, (settings, omega_rad_s)) in joints.into_iter().enumerate() {
            let found = settings.convention;
            if let Some((_, expected)) = all
                && found != expected
            {
                return Err(JointError::Mixed {
                    joint,
                    expected,
                    found,
                });
            }
            let many = all.take().map(|(many, _)| many);
            let many = F::push(many, &settings, solver, step_s, omega_rad_s)?;
            all = Some((many, found));
        }
        let (many, convention) = all.ok_or(JointError::Empty)?;
        Ok(Self {
            many,
            convention,
            solver,
            step_s,
        })
    }

    /// Number of joints, at least one.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.many.phases().len()
    }

    /// Convention of all of them.
    pub fn convention(&self) -> Convention {
        self.convention
    }

    /// Solver of all of them.
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Steps all joints through their motions, each by itself, with as many threads as asked for. `goes_on` is
    /// asked every few milliseconds.
    ///
    /// # Errors
    /// [`JointError::Shape`]: nothing is done. [`JointError::Interrupted`].
    pub fn steps(
        &mut self,
        motion: Motion<'_, F>,
        columns: Columns<'_, F>,
        threads: usize,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<(), JointError> {
        let joints = self.len();
        let steps = motion
            .steps(joints)
            .filter(|steps| columns.fit(joints * steps))
            .ok_or(self.misfit(motion))?;
        let mut is_interrupted = false;
        let work = Work {
            turns_rad: motion.turns_rad,
            speeds_rad_s: motion.speeds_rad_s,
            is_of_each: motion.is_of_each,
            steps,
            columns,
        };
        self.many.steps(work, threads, &mut || {
            is_interrupted = !goes_on();
            !is_interrupted
        });
        if is_interrupted {
            Err(JointError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Steps all joints by one step, on one motion or each on its own.
    ///
    /// # Errors
    /// [`JointError::Shape`]: nothing is done.
    pub fn step(&mut self, motion: Motion<'_, F>) -> Result<(), JointError> {
        if motion.steps(self.len()) != Some(1) {
            return Err(self.misfit(motion));
        }
        self.many
            .step(motion.turns_rad, motion.speeds_rad_s, motion.is_of_each);
        Ok(())
    }

    /// Makes a step of a joint in parts, where its motion breaks within the step; `after` gets the events of each
    /// part, all as of step 0, and the state at its end. A joint that is not there is ignored.
    pub fn step_in_parts(
        &mut self,
        joint: usize,
        parts: &[StepPart<F>],
        mut after: impl FnMut(&[StepEvent<F>], &State<F>),
    ) {
        if joint < self.len() {
            self.many.step_in_parts(joint, parts, &mut after);
        }
    }

    /// Lets the speed of all shafts jump to this one, rad/s, between two steps.
    pub fn jump(&mut self, omega_rad_s: F) {
        self.many.jump(omega_rad_s);
    }

    /// Records events from now on, until [`take_events`](Self::take_events).
    pub fn record_events(&mut self) {
        self.many.record_events();
    }

    /// Takes the recorded events of a joint, in the order of time; steps are numbered within the call that made
    /// them.
    pub fn take_events(&mut self, joint: usize) -> impl Iterator<Item = StepEvent<F>> + '_ {
        let recorded = if joint < self.len() {
            self.many.events(joint)
        } else {
            None
        };
        let taken = recorded.map(|events| events.drain(..));
        taken.into_iter().flatten()
    }

    /// Puts a joint in stick where its shaft is, with this torque (N·m, at most ±Ts) and speed (rad/s); one
    /// that is not there is ignored.
    pub fn restart(&mut self, joint: usize, torque_nm: F, omega_rad_s: F) {
        if joint < self.len() {
            self.many.restart(joint, torque_nm, omega_rad_s);
        }
    }

    /// Torques, N·m.
    pub fn torques_nm(&self) -> &[F] {
        self.many.torques_nm()
    }

    /// Phases: 0 in stick, −1 or +1 in slip.
    pub fn phases(&self) -> &[i8] {
        self.many.phases()
    }

    /// Speeds of the shafts after the last step, rad/s.
    pub fn omegas_rad_s(&self) -> &[F] {
        self.many.omegas_rad_s()
    }

    /// Angle, rad, and velocity, rad/s, of the object of each joint.
    pub fn motions(&mut self) -> impl Iterator<Item = (F, F)> + '_ {
        (0..self.len()).map(|n| self.many.motion(n))
    }

    /// Events of each joint since it was made.
    pub fn counts(&self) -> impl Iterator<Item = Counts> + '_ {
        (0..self.len()).map(|n| self.many.counts(n))
    }

    fn misfit(&self, motion: Motion<'_, F>) -> JointError {
        JointError::Shape {
            joints: self.len(),
            turns: motion.turns_rad.len(),
            speeds: motion.speeds_rad_s.len(),
        }
    }
}

impl<F: Lanes> Clone for Joints<F> {
    fn clone(&self) -> Self {
        Self {
            many: self.many.copied(),
            ..*self
        }
    }
}

impl<F: Lanes> std::fmt::Debug for Joints<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Joints")
            .field("len", &self.len())
            .field("convention", &self.convention)
            .field("solver", &self.solver)
            .field("step_s", &self.step_s)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(convention: Convention) -> Validated<Settings> {
        let settings = Settings {
            convention,
            ..Settings::default()
        };
        settings.validate().unwrap()
    }

    #[test]
    fn what_does_not_belong_together_is_refused() {
        let (frozen, physical) = (settings(Convention::Frozen), settings(Convention::Physical));
        let made = |joints: Vec<Validated<Settings>>, solver| {
            let joints = joints.into_iter().map(|settings| (settings, 0.0_f64));
            Joints::new(joints, solver, 5e-5)
        };
        let events = Solver::ExactEvents;
        assert!(matches!(made(vec![], events), Err(JointError::Empty)));
        assert!(matches!(
            made(vec![frozen, physical], events),
            Err(JointError::Mixed { joint: 1, .. })
        ));
        assert!(matches!(
            made(vec![frozen], Solver::Rk4),
            Err(JointError::Settings(_))
        ));
        let mut joints = made(vec![frozen, frozen], events).unwrap();
        let few = [1e-5; 3];
        for motion in [Motion::of_each(&few, &few), Motion::of_all(&few, &few[..2])] {
            let columns = Columns::default();
            assert!(matches!(
                joints.steps(motion, columns, 1, || true),
                Err(JointError::Shape { joints: 2, .. })
            ));
            assert!(joints.step(motion).is_err());
        }
        let mut torque_nm = [0.0; 5];
        let columns = Columns {
            torque_nm: &mut torque_nm,
            ..Columns::default()
        };
        let motion = Motion::of_all(&few, &few);
        assert!(joints.steps(motion, columns, 1, || true).is_err());
        assert_eq!(joints.torques_nm(), [0.0; 2]);
    }
}
