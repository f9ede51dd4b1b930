//! The torque of steady sliding over velocity, as a controller evaluates it.
//!
//! ```text
//! g(Ω) = Tk + (Ts − Tk)·exp(−(Ω/vs)²)
//! ```
//!
//! Source: R. Stribeck 1902 for the drop; the Gaussian form is that of B. Armstrong-Hélouvry,
//! Control of Machines with Friction, Kluwer 1991.
//!
//! The exponential is the costly part. Where the second term is below half a unit in the last
//! place of Tk, it changes nothing and is not evaluated: in f32 beyond 4.2 vs, in f64 beyond
//! 6.1 vs, where Ts ≤ 2·Tk.

use super::Contact;
use crepitus_model::Real;

/// Exponents z from which exp(−z) may be left out, in ascending order: 4.2², 6.1², the
/// underflow of f32 and that of f64.
const CUTS: [f64; 4] = [17.5, 37.5, 87.0, 745.5];

/// The smallest torque of sliding beside Ts, where something is divided by it.
const SMALLEST_SHARE: f64 = 1e-6;

/// The smallest torque at all, N·m, where something is divided by it.
const SMALLEST_NM: f64 = 1e-12;

/// The contact with a millionth of Ts, and of 10⁻⁶ N·m, for a Tk of zero: the deflection of a
/// bristle in sliding, g/σ0, is divided by.
pub(super) fn divisible(contact: &Contact) -> Contact {
    let static_torque_nm = contact.static_torque_nm.max(SMALLEST_NM);
    let smallest_nm = SMALLEST_SHARE * static_torque_nm;
    Contact {
        static_torque_nm,
        kinetic_torque_nm: contact.kinetic_torque_nm.max(smallest_nm),
        ..*contact
    }
}

/// The Stribeck curve of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck<F> {
    kinetic_nm: F,
    /// Ts − Tk, N·m.
    drop_nm: F,
    /// 1/vs, s/rad.
    per_velocity: F,
    /// Velocity from which on the curve is Tk, rad/s; 0 where Ts = Tk.
    reach_rad_s: F,
}

impl<F: Real> Stribeck<F> {
    /// The curve of `contact`; computed in f64 and rounded once.
    pub fn new(contact: &Contact) -> Self {
        let drop_nm = (contact.static_torque_nm - contact.kinetic_torque_nm).max(0.0);
        let invisible_nm = 0.25 * F::EPSILON.to_f64() * contact.kinetic_torque_nm;
        let cut = CUTS
            .into_iter()
            .find(|z| drop_nm * Real::exp(-z) <= invisible_nm)
            .unwrap_or(745.5);
        let is_flat = drop_nm <= 0.0 || contact.stribeck_rad_s <= 0.0;
        let (per_velocity, reach_rad_s) = if is_flat {
            (0.0, 0.0)
        } else {
            let reach_rad_s = contact.stribeck_rad_s * Real::sqrt(cut);
            (1.0 / contact.stribeck_rad_s, reach_rad_s)
        };
        Self {
            kinetic_nm: F::from_f64(contact.kinetic_torque_nm),
            drop_nm: F::from_f64(drop_nm),
            per_velocity: F::from_f64(per_velocity),
            reach_rad_s: F::from_f64(reach_rad_s),
        }
    }

    /// Ts, N·m.
    pub(super) fn static_nm(&self) -> F {
        self.kinetic_nm + self.drop_nm
    }

    /// g at a speed ≥ 0, N·m.
    #[inline]
    pub fn at(&self, speed_rad_s: F) -> F {
        if speed_rad_s < self.reach_rad_s {
            let ratio = speed_rad_s * self.per_velocity;
            self.kinetic_nm + self.drop_nm * (-(ratio * ratio)).exp()
        } else {
            self.kinetic_nm
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::Parameters;

    /// Largest relative difference from the contact's own curve, over five decades.
    fn worst<F: Real>(contact: &Contact) -> f64 {
        let curve = Stribeck::<F>::new(contact);
        (0..5000)
            .map(|n| contact.stribeck_rad_s * Real::exp(f64::from(n - 2500) * 0.002))
            .map(|omega| {
                // At the velocity as the precision has it.
                let omega = F::from_f64(omega);
                curve.at(omega).to_f64() / contact.sliding_nm(omega.to_f64()) - 1.0
            })
            .fold(0.0, |worst, off| worst.max(off.abs()))
    }

    #[test]
    fn it_is_the_curve_of_the_contact() {
        let contact = Contact::direct(&Parameters::default());
        assert!(worst::<f64>(&contact) < 4e-16, "{}", worst::<f64>(&contact));
        assert!(worst::<f32>(&contact) < 5e-7, "{}", worst::<f32>(&contact));
        let steep = Contact {
            kinetic_torque_nm: 1e-3,
            ..contact
        };
        assert!(worst::<f64>(&steep) < 1e-14, "{}", worst::<f64>(&steep));
        assert!(worst::<f32>(&steep) < 5e-6, "{}", worst::<f32>(&steep));
    }

    #[test]
    fn what_is_left_out_is_invisible_and_no_more_than_needed_is_evaluated() {
        let contact = Contact::direct(&Parameters::default());
        let vs = contact.stribeck_rad_s;
        let single = Stribeck::<f32>::new(&contact).reach_rad_s.to_f64();
        let double = Stribeck::<f64>::new(&contact).reach_rad_s;
        assert!((single / vs - 4.183).abs() < 1e-3 && (double / vs - 6.124).abs() < 1e-3);
        assert!(Real::exp(-17.5) < 0.25 * f64::from(f32::EPSILON));
        assert!(Real::exp(-37.5) < 0.25 * f64::EPSILON);
    }

    #[test]
    fn a_curve_to_divide_by_is_never_zero() {
        for (static_torque_nm, kinetic_torque_nm) in [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3)] {
            let contact = Contact {
                static_torque_nm,
                kinetic_torque_nm,
                ..Contact::direct(&Parameters::default())
            };
            let curve = Stribeck::<f32>::new(&divisible(&contact));
            for omega in [0.0, 1e-4, 20.0] {
                let known = contact.sliding_nm(omega);
                let torque = f64::from(curve.at(f32::from_f64(omega)));
                assert!(torque > 0.0 && (torque - known).abs() < 4e-7, "{torque}");
            }
        }
    }

    #[test]
    fn without_a_drop_it_is_flat_at_any_stribeck_velocity() {
        for stribeck_rad_s in [0.0, 1e-3] {
            let flat = Contact {
                static_torque_nm: 0.2,
                stribeck_rad_s,
                ..Contact::direct(&Parameters::default())
            };
            for omega in [0.0, 1e-9, 1.0] {
                assert_eq!(Stribeck::<f64>::new(&flat).at(omega), 0.2);
            }
        }
    }
}
