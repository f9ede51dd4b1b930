//! The set-valued backward-Euler friction step of the haptics literature
//! (Kikuuwe et al. 2005, 2006), for `physical`.
//!
//! Unknown are the velocity v⁺ and the torque T⁺ at the end of the step:
//!
//! ```text
//! J·(v⁺ − v)/h + c·v⁺ + kr·θ⁺ = T⁺          θ⁺ = θ + h·v⁺
//! T⁺ = Tk·sgn(Ω⁺ − v⁺)  if v⁺ ≠ Ω⁺,         |T⁺| ≤ Ts  if v⁺ = Ω⁺
//! ```
//!
//! The torque T* that stick would need decides in closed form: a slip of sense
//! s is consistent if s·T* > Tk, a stick if |T*| ≤ Ts, and where both are, the
//! phase stays as it is. The step never chatters and never overshoots,
//! whatever its length. It also damps the swing by ωn·h/2, and above
//! λ²/4π, the damping at which stick-slip ceases, it shows no crepitus at all:
//! stable and wrong.

use crate::joint::compensated::Compensated;
use crate::joint::{Event, EventKind, Phase, Sense, ShaftStep, StepCoefficients, StickSlip};
use crate::real::Real;

/// The stick-slip object in backward-Euler steps.
#[derive(Clone, Debug)]
pub struct ImplicitEuler<F> {
    coefficients: StepCoefficients<F>,
    /// J/h, N·m·s/rad.
    inertia_per_step: F,
    /// 1/(J/h + c + h·kr).
    mobility: F,
    phase: Phase,
    theta: Compensated<F>,
    v: F,
    torque_nm: F,
}

impl<F: Real> ImplicitEuler<F> {
    /// An object in stick at θ = 0 on a shaft that moves with `omega_rad_s`.
    pub fn new(coefficients: StepCoefficients<F>, omega_rad_s: F) -> Self {
        let inertia_per_step = coefficients.inertia * coefficients.per_step;
        let stiffness_step = coefficients.step_s * coefficients.stiffness;
        Self {
            inertia_per_step,
            mobility: F::ONE / (inertia_per_step + coefficients.damping + stiffness_step),
            phase: Phase::Stick,
            theta: Compensated::new(F::ZERO),
            v: omega_rad_s,
            torque_nm: coefficients.limited(coefficients.damping * omega_rad_s),
            coefficients,
        }
    }

    /// The phase at the end of a step for which stick would need `torque_nm`.
    #[inline]
    fn phase_for(&self, torque_nm: F) -> Phase {
        if let Phase::Slip(sense) = self.phase
            && sense.of_signed(torque_nm) > self.coefficients.kinetic_nm
        {
            return self.phase;
        }
        if torque_nm.abs() <= self.coefficients.static_nm {
            return Phase::Stick;
        }
        Sense::of(torque_nm).map_or(Phase::Stick, Phase::Slip)
    }
}

impl<F: Real> StickSlip<F> for ImplicitEuler<F> {
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let a = &self.coefficients;
        let omega = shaft.omega_end_rad_s;
        let theta = self.theta.value();
        let needed = self.inertia_per_step * (omega - self.v)
            + a.damping * omega
            + a.stiffness * (theta + shaft.delta_phi_rad);
        let (before, torque_before_nm) = (self.phase, self.torque_nm);
        self.phase = self.phase_for(needed);
        match self.phase {
            Phase::Stick => {
                self.theta.add(shaft.delta_phi_rad);
                self.v = omega;
                self.torque_nm = a.limited(needed);
            }
            Phase::Slip(sense) => {
                self.torque_nm = sense.of_signed(a.kinetic_nm);
                let push = self.inertia_per_step * self.v + self.torque_nm - a.stiffness * theta;
                self.v = (self.mobility * push).settled();
                self.theta.add(a.step_s * self.v);
            }
        }
        if self.phase != before {
            on_event(Event {
                kind: match (before, self.phase) {
                    (_, Phase::Stick) => EventKind::Stick,
                    (Phase::Stick, _) => EventKind::Break,
                    _ => EventKind::Reverse,
                },
                fraction: F::ONE,
                from: before,
                to: self.phase,
                theta_rad: self.theta.value(),
                theta_dot_rad_s: self.v,
                omega_rad_s: omega,
                torque_before_nm,
                torque_after_nm: self.torque_nm,
            });
        }
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        let a = &self.coefficients;
        self.phase = Phase::Stick;
        self.torque_nm = a.limited(torque_nm);
        let theta = (self.torque_nm - a.damping * omega_rad_s) / a.stiffness;
        self.theta = Compensated::new(theta);
        self.v = omega_rad_s;
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        let of_step = Self::new(coefficients, self.v);
        self.inertia_per_step = of_step.inertia_per_step;
        self.mobility = of_step.mobility;
        self.coefficients = of_step.coefficients;
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        &self.coefficients
    }

    #[inline]
    fn phase(&self) -> Phase {
        self.phase
    }

    #[inline]
    fn torque_nm(&self) -> F {
        self.coefficients.limited(self.torque_nm)
    }

    fn theta_rad(&self) -> F {
        self.theta.value()
    }

    fn theta_dot_rad_s(&self) -> F {
        self.v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Convention, Settings};
    use std::vec::Vec;

    const TICK_S: f64 = 5e-5;

    fn joint(kinetic_nm: f64) -> ImplicitEuler<f64> {
        let mut settings = Settings {
            convention: Convention::Physical,
            ..Settings::default()
        };
        settings.parameters.kinetic_torque_nm = kinetic_nm;
        settings.parameters.damping_nms_per_rad = 0.0;
        ImplicitEuler::new(
            StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap(),
            1.0,
        )
    }

    /// The step on which stick would need `torque_nm` at the object's own
    /// velocity.
    fn asks_for(joint: &ImplicitEuler<f64>, torque_nm: f64) -> ShaftStep<f64> {
        let v = joint.theta_dot_rad_s();
        ShaftStep {
            delta_phi_rad: torque_nm / joint.coefficients().stiffness - joint.theta_rad(),
            omega_start_rad_s: v,
            omega_end_rad_s: v,
        }
    }

    #[test]
    fn where_stick_and_slip_are_both_consistent_the_phase_stays() {
        // Tk = 0.2, Ts = 0.4.
        for s in [1.0, -1.0] {
            for (torque, from_stick, from_slip) in [
                (0.1, Phase::Stick, Phase::Stick),
                (0.3, Phase::Stick, SLIPS),
                (0.5, SLIPS, SLIPS),
                (-0.3, Phase::Stick, Phase::Stick),
            ] {
                let mirrored = |phase| match phase {
                    Phase::Slip(sense) if s < 0.0 => Phase::Slip(Sense::opposite(sense)),
                    phase => phase,
                };
                let mut stick = joint(0.2);
                let step = asks_for(&stick, s * torque);
                stick.step(&step, |_| {});
                assert_eq!(stick.phase(), mirrored(from_stick), "stick, {torque}");
                let mut slip = joint(0.2);
                let step = asks_for(&slip, s * 0.5);
                slip.step(&step, |_| {});
                assert_eq!(slip.phase(), mirrored(SLIPS));
                let step = asks_for(&slip, s * torque);
                slip.step(&step, |_| {});
                assert_eq!(slip.phase(), mirrored(from_slip), "slip, {torque}");
            }
        }
    }

    const SLIPS: Phase = Phase::Slip(Sense::Positive);

    #[test]
    fn what_needs_no_torque_sticks_without_friction_too() {
        let mut joint = joint(0.0);
        let step = asks_for(&joint, 0.5);
        joint.step(&step, |_| {});
        assert_eq!(joint.phase(), SLIPS);
        let step = asks_for(&joint, 0.0);
        let mut kinds = Vec::new();
        joint.step(&step, |e| kinds.push(e.kind));
        assert_eq!(
            (joint.phase(), &kinds[..]),
            (Phase::Stick, &[EventKind::Stick][..])
        );
        assert_eq!(joint.torque_nm(), 0.0);
    }
}
