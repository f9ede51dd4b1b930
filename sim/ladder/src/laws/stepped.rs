//! A law whose type and precision are erased, for studies on a host.
//!
//! ```text
//! shaft in f64 ──round──> law in f32 or f64 ──> torque in f64
//! ```
//!
//! It is compiled here, with the steps: in another crate a step would be built by the rules of that
//! crate, and cost up to twice as much.

use super::{Entry, LawVisitor, Mounted};
use crate::loops::Stepper;
use alloc::boxed::Box;
use core::hint::black_box;
use core::marker::PhantomData;
use crepitus_model::{Parameters, Real, SettingsError, ShaftStep};

/// A law of any precision, stepped in f64.
pub trait Stepped {
    /// Another joint from the next step on; the state is kept.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError>;

    /// Moves through one step, which is rounded once to the law's precision, and returns the
    /// torque at its end, N·m.
    fn step(&mut self, shaft: &ShaftStep<f64>) -> f64;

    /// Memory of state and coefficients, bytes.
    fn bytes(&self) -> usize;
}

struct Erased<F, M>(M, PhantomData<F>);

impl<F: Real, M: Mounted<F>> Stepped for Erased<F, M> {
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        self.0.change(joint, step_s)
    }

    fn step(&mut self, shaft: &ShaftStep<f64>) -> f64 {
        let rounded = ShaftStep {
            delta_phi_rad: F::from_f64(shaft.delta_phi_rad),
            omega_start_rad_s: F::from_f64(shaft.omega_start_rad_s),
            omega_end_rad_s: F::from_f64(shaft.omega_end_rad_s),
        };
        self.0.step(&rounded).to_f64()
    }

    fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

struct Boxing<F>(F);

impl<F: Real> LawVisitor<F> for Boxing<F> {
    type Output = Box<dyn Stepped>;

    fn visit<M: Mounted<F>>(self, mut law: M) -> Self::Output {
        law.carry(self.0);
        Box::new(Erased(law, PhantomData))
    }
}

struct Timed<'a>(f32, &'a mut dyn FnMut(Stepper<'_, ShaftStep<f32>>));

impl LawVisitor<f32> for Timed<'_> {
    type Output = ();

    fn visit<M: Mounted<f32>>(self, mut law: M) {
        law.carry(self.0);
        (self.1)(&mut |steps| {
            for shaft in steps {
                black_box(law.step(shaft));
            }
        });
    }
}

impl Entry {
    /// The law in f32, as on the controller; at the start the shaft moves with `omega_rad_s`, and so
    /// does the object.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    pub fn single(
        &self,
        joint: &Parameters,
        step_s: f64,
        omega_rad_s: f64,
    ) -> Result<Box<dyn Stepped>, SettingsError> {
        let omega_rad_s = f32::from_f64(omega_rad_s);
        self.with(joint, step_s, omega_rad_s, Boxing(omega_rad_s))
    }

    /// The law in f64, likewise.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    pub fn double(
        &self,
        joint: &Parameters,
        step_s: f64,
        omega_rad_s: f64,
    ) -> Result<Box<dyn Stepped>, SettingsError> {
        self.with(joint, step_s, omega_rad_s, Boxing(omega_rad_s))
    }

    /// Calls `clock` with the loop of the law in f32, likewise.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    pub fn timed(
        &self,
        joint: &Parameters,
        step_s: f64,
        omega_rad_s: f32,
        clock: &mut dyn FnMut(Stepper<'_, ShaftStep<f32>>),
    ) -> Result<(), SettingsError> {
        self.with(joint, step_s, omega_rad_s, Timed(omega_rad_s, clock))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::ENTRIES;

    #[test]
    fn an_erased_law_is_the_law_in_either_precision() {
        struct Last(ShaftStep<f32>);
        impl LawVisitor<f32> for Last {
            type Output = f32;
            fn visit<M: Mounted<f32>>(self, mut law: M) -> f32 {
                law.carry(self.0.omega_start_rad_s);
                (0..50).fold(0.0, |_, _| law.step(&self.0))
            }
        }
        let (joint, step_s) = (Parameters::default(), 5e-5);
        let shaft = ShaftStep {
            delta_phi_rad: 5e-6,
            omega_start_rad_s: 0.1,
            omega_end_rad_s: 0.1,
        };
        let single = ShaftStep {
            delta_phi_rad: 5e-6,
            omega_start_rad_s: 0.1,
            omega_end_rad_s: 0.1,
        };
        for entry in ENTRIES {
            let plain = entry.with(&joint, step_s, 0.1_f32, Last(single)).unwrap();
            let mut erased = entry.single(&joint, step_s, 0.1).unwrap();
            let mut double = entry.double(&joint, step_s, 0.1).unwrap();
            let (mut found, mut finer) = (0.0, 0.0);
            for _ in 0..50 {
                found = erased.step(&shaft);
                finer = double.step(&shaft);
            }
            assert_eq!(found, f64::from(plain), "{}", entry.name);
            assert!((finer - found).abs() < 1e-4, "{}", entry.name);
            assert!(erased.bytes() > 0 && erased.bytes() <= double.bytes());
        }
    }
}
