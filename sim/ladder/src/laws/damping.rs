//! Damping of the elastic motion of bristles, less the faster they move.
//!
//! ```text
//! σ1(v) = σ1/(1 + (v/vd)²)          vd = 2·Tk/σ1, so that σ1(v)·|v| ≤ Tk, its value at vd
//! ```
//!
//! A constant σ1 in T = σ0·z + σ1·ż is a known trap: at high velocities σ1·|v| is larger than the
//! friction itself, and the law can return energy. Sufficient against that is
//! σ1(v)·|v| ≤ 4·g(v) (H. Olsson, "Control systems with friction", Lund 1996, for the LuGre law;
//! the elasto-plastic one has the same bound). Olsson lets σ1 fall by an exponential of v². A
//! rational function needs no second exponential, and the bound is met fourfold.
//!
//! **The limit Tk.** With λ = σ1(v)·|v|/g ≤ 1, LuGre shows T = (1 − λ)·u + λ·sgn(v)·g: never above
//! Ts. Where a bristle is elastic, ż = v, and T is above its own torque u by λ·g ≤ Tk: no law
//! shows more than Ts + Tk. With a quarter of Tk the contact on an object vibrates until the next
//! break. σ1(v) = min(σ1, g/|v|) is bounded as well, but does not fall at vd: elastic bristles then
//! show 2.2·Ts on an object where they reverse, and grate at twice the joint's frequency.

use super::Contact;
use super::stribeck::divisible;
use crepitus_model::Real;

/// The largest damping torque beside Tk.
const LARGEST: f64 = 1.0;

/// σ1 over the velocity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Damping<F> {
    at_rest: F,
    /// 1/vd, s/rad.
    per_velocity: F,
}

impl<F: Real> Damping<F> {
    /// The damping of a contact.
    pub(super) fn new(contact: &Contact) -> Self {
        let damping = contact.damping_nms_per_rad;
        let largest_nm = LARGEST * divisible(contact).kinetic_torque_nm;
        Self {
            at_rest: F::from_f64(damping),
            per_velocity: F::from_f64(damping / (2.0 * largest_nm)),
        }
    }

    /// True where there is none.
    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.at_rest == F::ZERO
    }

    /// σ1(v), N·m·s/rad.
    #[inline]
    pub(super) fn at(&self, omega_rad_s: F) -> F {
        let ratio = omega_rad_s * self.per_velocity;
        self.at_rest / (F::ONE + ratio * ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::Parameters;

    #[test]
    fn its_torque_has_the_stated_bound_and_at_rest_it_is_that_of_the_contact() {
        let (contact, _) = Contact::on_object(&Parameters::default());
        let damping = Damping::<f64>::new(&contact);
        let torque_nm = |omega: f64| damping.at(omega) * omega;
        let vd = 2.0 * 0.2 / contact.damping_nms_per_rad;
        assert!((torque_nm(vd) - 0.2).abs() < 1e-15);
        for n in 0..4000 {
            let omega = vd * 1e-2 * f64::from(n);
            assert!(torque_nm(omega) <= 0.2 + 1e-15, "{omega}");
        }
        assert_eq!(damping.at(0.0), contact.damping_nms_per_rad);
        assert!(!damping.is_none());
        let direct = Contact::direct(&Parameters::default());
        assert!(Damping::<f64>::new(&direct).is_none());
    }

    #[test]
    fn a_contact_without_kinetic_torque_has_no_damping_worth_mention() {
        let contact = Contact {
            static_torque_nm: 0.0,
            kinetic_torque_nm: 0.0,
            damping_nms_per_rad: 1.0,
            ..Contact::direct(&Parameters::default())
        };
        let damping = Damping::<f32>::new(&contact);
        for omega in [0.0, 1e-6, 1e-3, 20.0] {
            let torque_nm = damping.at(omega) * omega;
            assert!((0.0..2e-18).contains(&torque_nm), "{omega}: {torque_nm}");
        }
    }
}
