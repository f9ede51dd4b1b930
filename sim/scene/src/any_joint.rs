//! A joint of any rung behind one type: a loop is compiled once and not for every rung, for a
//! virtual call a step.

use crepitus_model::Validated;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Event, Phase, Real, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip,
};

/// A joint whose rung was chosen while the program runs.
pub struct AnyJoint<F>(Box<dyn Erased<F> + Send>);

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

    fn visit<J: StickSlip<F>>(self, joint: J) -> AnyJoint<F> {
        AnyJoint(Box::new(joint))
    }
}

/// [`StickSlip`] without type parameters.
trait Erased<F: Real> {
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: &mut dyn FnMut(Event<F>));
    fn restart(&mut self, torque_nm: F, omega_rad_s: F);
    fn change_step(&mut self, coefficients: StepCoefficients<F>);
    fn coefficients(&self) -> &StepCoefficients<F>;
    fn phase(&self) -> Phase;
    fn torque_nm(&self) -> F;
    fn theta_rad(&self) -> F;
    fn theta_dot_rad_s(&self) -> F;
}

impl<F: Real, J: StickSlip<F>> Erased<F> for J {
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: &mut dyn FnMut(Event<F>)) {
        StickSlip::step(self, shaft, on_event);
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        StickSlip::restart(self, torque_nm, omega_rad_s);
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        StickSlip::change_step(self, coefficients);
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        StickSlip::coefficients(self)
    }

    fn phase(&self) -> Phase {
        StickSlip::phase(self)
    }

    fn torque_nm(&self) -> F {
        StickSlip::torque_nm(self)
    }

    fn theta_rad(&self) -> F {
        StickSlip::theta_rad(self)
    }

    fn theta_dot_rad_s(&self) -> F {
        StickSlip::theta_dot_rad_s(self)
    }
}

impl<F: Real> StickSlip<F> for AnyJoint<F> {
    fn step(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        self.0.step(shaft, &mut on_event);
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        self.0.restart(torque_nm, omega_rad_s);
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        self.0.change_step(coefficients);
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        self.0.coefficients()
    }

    fn phase(&self) -> Phase {
        self.0.phase()
    }

    fn torque_nm(&self) -> F {
        self.0.torque_nm()
    }

    fn theta_rad(&self) -> F {
        self.0.theta_rad()
    }

    fn theta_dot_rad_s(&self) -> F {
        self.0.theta_dot_rad_s()
    }
}
