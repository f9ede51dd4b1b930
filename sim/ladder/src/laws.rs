//! Friction laws that haptic devices render, each fitted to the same joint.
//!
//! A law turns the motion of the shaft into a torque, one step at a time. It is
//! given what a controller has: the change of the angle and the velocities at
//! both ends of the step.
//!
//! ```text
//!  Δφ, Ω₀, Ω₁ ──> law ──> torque                       shown as it is
//!
//!  Δφ − Δθ, Ω − θ̇ ──> law ──> torque ──┐               on an object:
//!          ▲                           ▼               it can grate
//!          └───── θ, θ̇ ──── J·θ̈ = T − k·θ
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the contract, what a law is fitted to | [`FrictionLaw`], [`Contact`] |
//! | a law, with its source and its discretisation | the file of its name |
//! | the Stribeck curve, the damping of bristles | [`stribeck`], `damping` |
//! | the object between a law and ground | [`object`] |
//! | what is stepped: a law on ground, our joint | [`mounted`] |
//! | every law by name | [`entry`] |
//! | a law behind a pointer, and its timed loop, on a host | `stepped` |

pub mod bliman_sorine;
pub mod contact;
pub mod coulomb;
pub mod dahl;
mod damping;
pub mod elasto_plastic;
pub mod entry;
#[cfg(test)]
mod grating;
pub mod hayward_armstrong;
pub mod karnopp;
pub mod kikuuwe;
pub mod lugre;
pub mod maxwell_slip;
#[cfg(test)]
mod motion;
pub mod mounted;
pub mod object;
mod relaxation;
#[cfg(feature = "loops")]
pub mod stepped;
pub mod stribeck;

pub use contact::Contact;
pub use entry::{ENTRIES, Entry, LawVisitor};
pub use mounted::Mounted;

use core::fmt::Debug;
use crepitus_model::{Real, ShaftStep};

/// A friction law between the shaft and what it rubs on.
///
/// Torque T > 0 opposes growing angle, as everywhere in the product. A law
/// starts at rest and without torque. Nothing in a step allocates, blocks or
/// loops without a bound.
///
/// A law that diverges, as explicit LuGre does on an object, returns ever larger torques, and then
/// a NaN that stays; so does one that is given a NaN. Nothing hides that: a study shows it. A
/// device rejects invalid samples before its law, and clamps the torque after it.
///
/// A law of one's own is a type that implements this, a file beside the others, and a line in
/// [`entry`]. The simplest there is, viscous friction and Coulomb's with a velocity band:
///
/// ```
/// use crepitus_ladder::laws::mounted::{Direct, Mounted};
/// use crepitus_ladder::laws::{Contact, FrictionLaw};
/// use crepitus_model::{Parameters, Real, ShaftStep};
///
/// /// T = d·Ω + Tk·Ω/v, the second term within ±Tk.
/// #[derive(Clone, Copy, Debug)]
/// struct Viscous<F> {
///     damping: F,
///     slope: F,
///     kinetic_nm: F,
/// }
///
/// impl<F: Real> FrictionLaw<F> for Viscous<F> {
///     /// Tk in N·m, v in rad/s, d in N·m·s/rad.
///     type Parameters = [f64; 3];
///
///     /// Rule: v is the Stribeck velocity, d a tenth of Tk at 1 rad/s.
///     fn fitted(contact: &Contact) -> [f64; 3] {
///         let kinetic_nm = contact.kinetic_torque_nm;
///         [kinetic_nm, contact.stribeck_rad_s, 0.1 * kinetic_nm]
///     }
///
///     fn new(&[kinetic_nm, width_rad_s, damping]: &[f64; 3], _step_s: f64) -> Self {
///         Self {
///             damping: F::from_f64(damping),
///             slope: F::from_f64(kinetic_nm / width_rad_s),
///             kinetic_nm: F::from_f64(kinetic_nm),
///         }
///     }
///
///     /// There is no state to keep.
///     fn change(&mut self, parameters: &[f64; 3], step_s: f64) {
///         *self = Self::new(parameters, step_s);
///     }
///
///     fn step(&mut self, shaft: &ShaftStep<F>) -> F {
///         let omega = shaft.omega_end_rad_s;
///         self.damping * omega + (self.slope * omega).within(self.kinetic_nm)
///     }
/// }
///
/// // On ground, in steps of 50 µs, as a controller runs it.
/// let mut law = Direct::<Viscous<f32>>::fitted(&Parameters::default(), 5e-5);
/// let torque_nm = law.step(&ShaftStep {
///     delta_phi_rad: 5e-5,
///     omega_start_rad_s: 1.0,
///     omega_end_rad_s: 1.0,
/// });
/// assert!((torque_nm - 0.22).abs() < 1e-7);
/// ```
pub trait FrictionLaw<F: Real>: Copy + Debug + Send + 'static {
    /// Parameters of the law, in SI units.
    type Parameters: Copy + Debug + PartialEq;

    /// Parameters for a contact, by the rule that the law's file states.
    fn fitted(contact: &Contact) -> Self::Parameters;

    /// The law at rest, in steps of `step_s`. Coefficients are computed in f64
    /// and rounded once.
    fn new(parameters: &Self::Parameters, step_s: f64) -> Self;

    /// Other parameters from the next step on; the state is kept, so that the
    /// torque goes on from where it is.
    fn change(&mut self, parameters: &Self::Parameters, step_s: f64);

    /// Moves through one step, and returns the torque at its end, N·m.
    fn step(&mut self, shaft: &ShaftStep<F>) -> F;
}
