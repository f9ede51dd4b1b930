//! Lead of the shaft over the object in a slip: s·(Ω − θ̇).
//!
//! Friction opposes the sliding, so in a slip of sense s the shaft has to be
//! the faster one in that sense. What the energy balance cannot see is a slip
//! that continues after the velocities have met: torque and motion still agree
//! with each other, and the friction term is booked with the wrong sign. Under
//! `paper` and `physical` that is a missed event. A `frozen` slip lasts as long
//! as it lasts and may do so by design, when the hand slows down meanwhile.

use crepitus_model::{Convention, Real, Settings};
use std::f64::consts::TAU;

/// Looks at a `frozen` slip in a swing of the object: its velocity there is
/// no state but a sine that is computed to be looked at.
const LOOKS_PER_SWING: f64 = 32.0;

/// Part of the lead that may be rounding, as a share of |Ω| + |θ̇|.
const ROUNDING_F64: f64 = 1e-12;

/// Part of the lead that may be rounding in single precision, likewise.
const ROUNDING_F32: f64 = 1e-4;

/// Velocity below which a body is at rest, as a share of the rounding of the velocity of a swing over Ts/kr.
const REST: f64 = 1e-6;

/// Duration and extent of the shaft's lag behind the object.
#[derive(Clone, Copy, Debug)]
pub struct Lead {
    kinetic_nm: f64,
    rounding: f64,
    /// A velocity that is none: so much less than that of the object's swing, rad/s.
    rest_rad_s: f64,
    step_s: f64,
    /// Number of steps from one look to the next.
    stride: u32,
    left: u32,
    /// Time in slips with the shaft behind, s.
    pub behind_s: f64,
    /// Energy that friction gave in that time, J.
    pub behind_j: f64,
    /// Worst Ω − θ̇ against the sense, rad/s.
    pub worst_rad_s: f64,
}

impl Lead {
    /// Empty record for looks `step_s` apart at a joint in single precision or double.
    pub fn new(settings: &Settings, step_s: f64, is_single: bool) -> Self {
        let stride = match settings.convention {
            Convention::Frozen => {
                let swing_s = TAU / settings.parameters.natural_rad_s();
                whole(swing_s / (LOOKS_PER_SWING * step_s))
            }
            Convention::Paper | Convention::Physical => 1,
        };
        let rounding = if is_single {
            ROUNDING_F32
        } else {
            ROUNDING_F64
        };
        let p = &settings.parameters;
        let swing_rad_s = p.natural_rad_s() * p.static_torque_nm / p.stiffness_nm_per_rad;
        Self {
            kinetic_nm: p.kinetic_torque_nm,
            rounding,
            rest_rad_s: REST * rounding * swing_rad_s,
            step_s,
            stride,
            left: stride,
            behind_s: 0.0,
            behind_j: 0.0,
            worst_rad_s: 0.0,
        }
    }

    /// Counts a step in a slip, at its end; returns whether it is time for a look.
    #[inline]
    pub fn is_due(&mut self) -> bool {
        self.left -= 1;
        let due = self.left == 0;
        if due {
            self.left = self.stride;
        }
        due
    }

    /// Counts steps in a slip; returns those, from 1 on, at whose end it is time for a look.
    pub(super) fn looks_in(&mut self, steps: u64) -> impl Iterator<Item = u64> + use<> {
        let (first, stride) = (u64::from(self.left), u64::from(self.stride));
        let left = if steps < first {
            first - steps
        } else {
            stride - (steps - first) % stride
        };
        // No more than the stride.
        self.left = u32::try_from(left).unwrap_or(self.stride);
        let stride = usize::try_from(stride).unwrap_or(usize::MAX);
        (first..=steps).step_by(stride)
    }

    /// Counts steps in a slip of sense `sign`, with these velocities of shaft and object at their ends, and
    /// looks where it is time.
    pub(super) fn look_along<F: Real>(
        &mut self,
        sign: f64,
        omega_rad_s: &[f64],
        theta_dot_rad_s: &[F],
    ) {
        for step in self.looks_in(omega_rad_s.len() as u64) {
            let place = usize::try_from(step - 1).unwrap_or(usize::MAX);
            if let Some(omega) = omega_rad_s.get(place)
                && let Some(theta_dot) = theta_dot_rad_s.get(place)
            {
                self.look(sign, *omega, theta_dot.to_f64());
            }
        }
    }

    /// A look at a slip of sense `sign`.
    #[inline]
    pub fn look(&mut self, sign: f64, omega_rad_s: f64, theta_dot_rad_s: f64) {
        let dt_s = self.step_s * f64::from(self.stride);
        self.look_for(dt_s, sign, omega_rad_s, theta_dot_rad_s);
    }

    /// A look that stands for `dt_s`.
    pub fn look_for(&mut self, dt_s: f64, sign: f64, omega_rad_s: f64, theta_dot_rad_s: f64) {
        let behind_rad_s = -sign * (omega_rad_s - theta_dot_rad_s);
        let rounding_rad_s = self.rounding * (omega_rad_s.abs() + theta_dot_rad_s.abs());
        if behind_rad_s > rounding_rad_s + self.rest_rad_s {
            self.behind_s += dt_s;
            self.behind_j += self.kinetic_nm * behind_rad_s * dt_s;
            self.worst_rad_s = self.worst_rad_s.max(behind_rad_s);
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates, and the least is 1"
)]
fn whole(x: f64) -> u32 {
    (x as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shaft_that_is_behind_is_booked_in_its_sense() {
        let settings = Settings {
            convention: Convention::Physical,
            ..Settings::default()
        };
        let mut lead = Lead::new(&settings, 1e-3, false);
        assert!(lead.is_due() && lead.is_due());
        lead.look(1.0, 1.0, 0.9);
        lead.look(-1.0, -1.0, -0.9);
        lead.look(1.0, 1.0, 1.0 + 1e-14);
        // An object that has died away on a shaft at rest.
        lead.look(1.0, 0.0, 4.3e-42);
        assert_eq!((lead.behind_s, lead.behind_j), (0.0, 0.0));
        lead.look(1.0, 0.5, 0.75);
        lead.look(-1.0, -0.5, -1.0);
        assert!((lead.behind_s - 2e-3).abs() < 1e-15);
        assert!((lead.behind_j - 0.2 * 0.75 * 1e-3).abs() < 1e-15);
        assert_eq!(lead.worst_rad_s, 0.5);
    }

    #[test]
    fn looks_at_many_steps_are_those_at_each() {
        let [mut each, mut many] = [(); 2].map(|()| Lead::new(&Settings::default(), 5e-5, true));
        for steps in [0, 1, 18, 1, 0, 19, 20, 38, 500, 7, 3] {
            let one_by_one = (1..=steps).filter(|_| each.is_due());
            let expected: Vec<u64> = one_by_one.collect();
            assert_eq!(
                many.looks_in(steps).collect::<Vec<_>>(),
                expected,
                "{steps}"
            );
        }
    }

    #[test]
    fn a_frozen_slip_is_looked_at_about_32_times_in_a_swing() {
        let mut lead = Lead::new(&Settings::default(), 5e-5, true);
        // 31.4 ms of 50 µs are 628 steps.
        let looks = (0..628).filter(|_| lead.is_due()).count();
        assert!((32..=34).contains(&looks), "{looks}");
    }
}
