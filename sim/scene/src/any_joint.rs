//! A joint of any rung behind one type: a loop is compiled once and not for every rung, for a
//! virtual call a step.

use crepitus_model::Validated;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    EVENTS_PER_STEP, Event, Phase, Real, Settings, SettingsError, ShaftStep, StepCoefficients,
    StickSlip,
};

/// A joint whose rung was chosen while the program runs.
pub struct AnyJoint<F> {
    joint: Box<dyn Erased<F> + Send>,
    /// Phase and torque, which every step is asked for: they come with it.
    output: Output<F>,
    /// Events of the last step: there are hardly ever any.
    events: Vec<Event<F>>,
}

/// Phase of a joint and its torque, N·m.
type Output<F> = (Phase, F);

impl<F: Precise> AnyJoint<F> {
    /// The joint that `settings` and `solver` describe; see [`with_joint`].
    ///
    /// # Errors
    /// As [`with_joint`].
    pub fn new(
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: F,
    ) -> Result<Self, SettingsError> {
        F::any_joint(settings, solver, step_s, omega_rad_s)
    }
}

impl<F: Real> Clone for AnyJoint<F> {
    fn clone(&self) -> Self {
        Self {
            joint: self.joint.boxed(),
            output: self.output,
            events: self.events.clone(),
        }
    }
}

/// A precision whose rungs are compiled in this crate.
pub trait Precise: Real {
    /// See [`AnyJoint::new`].
    ///
    /// # Errors
    /// As [`with_joint`].
    fn any_joint(
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<AnyJoint<Self>, SettingsError>;
}

impl Precise for f32 {
    fn any_joint(
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<AnyJoint<Self>, SettingsError> {
        with_joint(settings, solver, step_s, omega_rad_s, Boxed)
    }
}

impl Precise for f64 {
    fn any_joint(
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
    ) -> Result<AnyJoint<Self>, SettingsError> {
        with_joint(settings, solver, step_s, omega_rad_s, Boxed)
    }
}

struct Boxed;

impl<F: Real> JointVisitor<F> for Boxed {
    type Output = AnyJoint<F>;

    fn visit<J: StickSlip<F> + Clone>(self, joint: J) -> AnyJoint<F> {
        AnyJoint {
            output: output(&joint),
            joint: Box::new(joint),
            events: Vec::with_capacity(EVENTS_PER_STEP),
        }
    }
}

/// [`StickSlip`] without type parameters.
trait Erased<F: Real> {
    fn boxed(&self) -> Box<dyn Erased<F> + Send>;
    fn step(&mut self, shaft: &ShaftStep<F>, events: &mut Vec<Event<F>>) -> Output<F>;
    fn restart(&mut self, torque_nm: F, omega_rad_s: F) -> Output<F>;
    fn change_step(&mut self, coefficients: StepCoefficients<F>) -> Output<F>;
    fn coefficients(&self) -> &StepCoefficients<F>;
    fn theta_rad(&self) -> F;
    fn theta_dot_rad_s(&self) -> F;
}

#[inline]
fn output<F: Real, J: StickSlip<F>>(joint: &J) -> Output<F> {
    (joint.phase(), joint.torque_nm())
}

impl<F: Real, J: StickSlip<F> + Clone> Erased<F> for J {
    fn boxed(&self) -> Box<dyn Erased<F> + Send> {
        Box::new(self.clone())
    }

    fn step(&mut self, shaft: &ShaftStep<F>, events: &mut Vec<Event<F>>) -> Output<F> {
        StickSlip::step(self, shaft, |event| events.push(event));
        output(self)
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) -> Output<F> {
        StickSlip::restart(self, torque_nm, omega_rad_s);
        output(self)
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) -> Output<F> {
        StickSlip::change_step(self, coefficients);
        output(self)
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        StickSlip::coefficients(self)
    }

    fn theta_rad(&self) -> F {
        StickSlip::theta_rad(self)
    }

    fn theta_dot_rad_s(&self) -> F {
        StickSlip::theta_dot_rad_s(self)
    }
}

impl<F: Real> StickSlip<F> for AnyJoint<F> {
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>)) {
        self.output = self.joint.step(shaft, &mut self.events);
        if !self.events.is_empty() {
            self.events.drain(..).for_each(on_event);
        }
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        self.output = self.joint.restart(torque_nm, omega_rad_s);
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        self.output = self.joint.change_step(coefficients);
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        self.joint.coefficients()
    }

    #[inline]
    fn phase(&self) -> Phase {
        self.output.0
    }

    #[inline]
    fn torque_nm(&self) -> F {
        self.output.1
    }

    fn theta_rad(&self) -> F {
        self.joint.theta_rad()
    }

    fn theta_dot_rad_s(&self) -> F {
        self.joint.theta_dot_rad_s()
    }
}
