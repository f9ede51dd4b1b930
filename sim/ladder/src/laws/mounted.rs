//! The stepped object: a law that is fitted to a joint, on ground or on a body.

use super::{Contact, FrictionLaw};
use crepitus_model::joint::LONGEST_STEP_S;
use crepitus_model::{
    Convention, Parameters, Real, Restart, Settings, SettingsError, ShaftStep, StepCoefficients,
    StickSlip,
};

/// A law that is fitted to a joint, and stepped.
pub trait Mounted<F: Real>: Send + 'static {
    /// Another joint from the next step on; the state is kept.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError>;

    /// Moves through one step, and returns the torque that a hand feels at its end, N·m.
    fn step(&mut self, shaft: &ShaftStep<F>) -> F;

    /// Begins on a moving shaft: the body below moves at this velocity; only a law at rest is carried.
    ///
    /// Our joint is built so: in a stick, under a shaft that moves. Ground stays where it is.
    fn carry(&mut self, _omega_rad_s: F) {}

    /// Memory of state and coefficients, bytes.
    fn bytes(&self) -> usize {
        size_of_val(self)
    }
}

/// Rejects a joint or a step that no law is fitted to.
pub(super) fn check(joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
    let settings = Settings {
        parameters: *joint,
        convention: Convention::Physical,
        restart: Restart::Elastic,
    };
    settings.validate()?;
    if step_s > 0.0 && step_s <= LONGEST_STEP_S {
        Ok(())
    } else {
        Err(SettingsError::Step { step_s })
    }
}

/// A law between the shaft and ground.
#[derive(Clone, Copy, Debug)]
pub struct Direct<L>(L);

impl<L> Direct<L> {
    /// The law for this joint, at rest.
    pub fn fitted<F: Real>(joint: &Parameters, step_s: f64) -> Self
    where
        L: FrictionLaw<F>,
    {
        Self(L::new(&L::fitted(&Contact::direct(joint)), step_s))
    }
}

impl<F: Real, L: FrictionLaw<F>> Mounted<F> for Direct<L> {
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        check(joint, step_s)?;
        let parameters = L::fitted(&Contact::direct(joint));
        self.0.change(&parameters, step_s);
        Ok(())
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        self.0.step(shaft)
    }
}

/// Our joint: the law and its object in one, with located events.
#[derive(Clone, Copy, Debug)]
pub struct Joint<F, J> {
    law: J,
    settings: Settings,
    omega_rad_s: F,
}

impl<F: Real, J: StickSlip<F>> Joint<F, J> {
    /// The joint of these settings, on a shaft that moves with `omega_rad_s`.
    pub fn new(joint: J, settings: Settings, omega_rad_s: F) -> Self {
        Self {
            law: joint,
            settings,
            omega_rad_s,
        }
    }
}

impl<F: Real, J: StickSlip<F>> Mounted<F> for Joint<F, J> {
    /// A slip ends: the object is put in stick with the torque that it shows. (A device ramps
    /// its parameters instead.)
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        let settings = Settings {
            parameters: *joint,
            ..self.settings
        };
        let coefficients = StepCoefficients::new(&settings.validate()?, step_s)?;
        let torque_nm = self.law.torque_nm().within(coefficients.static_nm);
        self.law.change_step(coefficients);
        self.law.restart(torque_nm, self.omega_rad_s);
        self.settings = settings;
        Ok(())
    }

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>) -> F {
        self.omega_rad_s = shaft.omega_end_rad_s;
        self.law.step(shaft, |_| {});
        self.law.torque_nm()
    }

    /// Without the settings, which only a change of the parameters needs.
    fn bytes(&self) -> usize {
        size_of::<J>()
    }
}
