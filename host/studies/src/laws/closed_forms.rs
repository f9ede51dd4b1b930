//! Closed forms of our joint.
//!
//! Dragged with a constant velocity Ω and without damping, with Δ = Ts − Tk:
//!
//! ```text
//! stick   T from 2Tk − Ts to Ts with the slope kr·Ω         lasts 2Δ/(kr·Ω)
//! slip    T = Tk; x = θ − Tk/kr swings from Δ/kr, θ̇ = Ω     lasts (2/ωn)·(π − atan(Δ·ωn/(kr·Ω)))
//!         to −Δ/kr, where θ̇ = Ω again
//! mean of T²   Tk² + stick/(stick + slip)·Δ²/3
//! ```

use crepitus_model::Parameters;
use std::f64::consts::PI;

/// Steady stick and slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grating {
    /// Duration of a stick, s.
    pub stick_s: f64,
    /// Duration of a slip, s.
    pub slip_s: f64,
    /// Lowest torque: 2Tk − Ts, N·m.
    pub low_nm: f64,
    /// Highest torque: Ts, N·m.
    pub high_nm: f64,
    /// Root mean square of the torque, N·m.
    pub rms_nm: f64,
}

impl Grating {
    /// Of this joint, dragged with this velocity.
    pub fn new(joint: &Parameters, omega_rad_s: f64) -> Self {
        let drop_nm = joint.static_torque_nm - joint.kinetic_torque_nm;
        let rate = joint.stiffness_nm_per_rad * omega_rad_s;
        let natural = joint.natural_rad_s();
        let stick_s = 2.0 * drop_nm / rate;
        let slip_s = 2.0 / natural * (PI - (drop_nm * natural / rate).atan());
        let share = stick_s / (stick_s + slip_s);
        let mean_square = joint.kinetic_torque_nm.powi(2) + share * drop_nm * drop_nm / 3.0;
        Self {
            stick_s,
            slip_s,
            low_nm: joint.restart_torque_nm(),
            high_nm: joint.static_torque_nm,
            rms_nm: mean_square.sqrt(),
        }
    }

    /// Duration of a cycle, s.
    pub fn period_s(&self) -> f64 {
        self.stick_s + self.slip_s
    }

    /// Cycles in a second.
    pub fn hz(&self) -> f64 {
        1.0 / self.period_s()
    }
}

/// Stiffness at which a spring on a leg with a hand begins to oscillate, N·m/rad, if its torque
/// acts `delay_s` late:
///
/// ```text
/// I·ẍ + B·ẋ + K·x + k·x(t − τ) = 0,  x = e^(iωt):   k·sin ωτ = B·ω,  k·cos ωτ = I·ω² − K
/// ```
pub fn onset_nm_per_rad(leg: &Leg, delay_s: f64) -> f64 {
    // tan(ωτ)·(I·ω² − K) − B·ω grows from below zero where the bracket begins.
    let beyond = |omega: f64| {
        (omega * delay_s).tan() * (leg.inertia_kg_m2 * omega * omega - leg.stiffness_nm_per_rad)
            - leg.damping_nms_per_rad * omega
    };
    let mut low = (leg.stiffness_nm_per_rad / leg.inertia_kg_m2).sqrt();
    let mut high = 0.5 * PI / delay_s * (1.0 - 1e-9);
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if beyond(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    leg.damping_nms_per_rad * low / (low * delay_s).sin()
}

/// A leg held by a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Inertia, kg·m².
    pub inertia_kg_m2: f64,
    /// Damping toward where the hand rests, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Stiffness toward it, N·m/rad.
    pub stiffness_nm_per_rad: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::reference::{demanded, torques};
    use crepitus_plant::Motion;
    use crepitus_scene::preset::joints;

    #[test]
    fn they_are_those_of_the_event_driven_reference() {
        for joint in joints() {
            let form = Grating::new(&joint.parameters, 0.988);
            let settings = demanded(&joint.parameters).unwrap();
            let motion = Motion::constant(0.988);
            let begin = form.period_s() * 20.0;
            let (mut cycles, mut hz) = (
                crate::laws::cycles::Cycles::of(&joint.parameters),
                crate::laws::cycles::Frequency::default(),
            );
            let (mut squares, mut count) = (0.0, 0.0);
            torques(&settings, &motion, begin * 3.0, 200e3, |t, nm| {
                if let Some(at) = cycles.see(t, nm)
                    && t > begin
                {
                    hz.add(at);
                }
                if t > begin {
                    squares += nm * nm;
                    count += 1.0;
                }
            });
            assert!((hz.hz() / form.hz() - 1.0).abs() < 1e-9, "{}", joint.name);
            let rms: f64 = f64::sqrt(squares / count);
            assert!((rms / form.rms_nm - 1.0).abs() < 1e-3, "{rms} {form:?}");
        }
    }

    #[test]
    fn the_onset_is_that_of_a_simulated_delay() {
        let leg = Leg {
            inertia_kg_m2: 0.07,
            damping_nms_per_rad: 0.8,
            stiffness_nm_per_rad: 16.0,
        };
        let (step_s, late) = (1e-6, 75_usize);
        let onset = onset_nm_per_rad(&leg, step_s * 75.5);
        let growth = |k: f64| {
            let mut past = std::collections::VecDeque::from(vec![0.0; late]);
            let (mut x, mut v, mut first, mut last) = (1.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
            for n in 0..1_500_000 {
                let pull = k * past.pop_front().unwrap_or(0.0);
                past.push_back(x);
                let torque = -leg.damping_nms_per_rad * v - leg.stiffness_nm_per_rad * x - pull;
                v += step_s * torque / leg.inertia_kg_m2;
                x += step_s * v;
                if (300_000..600_000).contains(&n) {
                    first = first.max(x.abs());
                } else if n >= 1_200_000 {
                    last = last.max(x.abs());
                }
            }
            last / first
        };
        assert!(growth(onset * 0.98) < 1.0 && growth(onset * 1.02) > 1.0);
        // Small delays: B/τ.
        assert!((onset * 75e-6 / leg.damping_nms_per_rad - 1.0).abs() < 0.05);
    }
}
