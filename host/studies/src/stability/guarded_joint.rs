//! A joint with an input check, stepped like any other: a step of NaN is a
//! missing sample.

use crepitus_model::render::input_check::{InputLimits, Sample};
use crepitus_model::{Event, Guarded, Phase, Real, ShaftStep, StepCoefficients, StickSlip};

/// The step of a missing sample.
pub(super) fn missing_step<F: Real>() -> ShaftStep<F> {
    let nan = F::from_f64(f64::NAN);
    ShaftStep {
        delta_phi_rad: nan,
        omega_start_rad_s: nan,
        omega_end_rad_s: nan,
    }
}

/// A joint with an input check with the limits of the device.
pub(super) struct GuardedJoint<F, J>(Guarded<F, J>);

impl<F: Real, J: StickSlip<F>> GuardedJoint<F, J> {
    pub(super) fn new(joint: J, step_s: f64, omega_rad_s: F) -> Self {
        Self(Guarded::new(
            joint,
            InputLimits::device(step_s),
            omega_rad_s,
        ))
    }
}

impl<F: Real, J: StickSlip<F>> StickSlip<F> for GuardedJoint<F, J> {
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>)) {
        self.0.tick(&Sample::Taken(*shaft), on_event);
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        self.0.joint_mut().restart(torque_nm, omega_rad_s);
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        self.0.joint_mut().change_step(coefficients);
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        self.0.joint().coefficients()
    }

    fn phase(&self) -> Phase {
        self.0.joint().phase()
    }

    fn torque_nm(&self) -> F {
        self.0.torque_nm()
    }

    fn theta_rad(&self) -> F {
        self.0.joint().theta_rad()
    }

    fn theta_dot_rad_s(&self) -> F {
        self.0.joint().theta_dot_rad_s()
    }
}
