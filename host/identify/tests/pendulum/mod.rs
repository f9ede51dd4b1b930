//! A second simulation that shares nothing with the first: a textbook pendulum with Coulomb and
//! viscous friction, a rotor behind a gap, and cuffs, with springs for teeth, friction that
//! sticks by the rule of Karnopp, and semi-implicit Euler of a microsecond.
//!
//! On purpose it has what the estimator's model has not: teeth that give way, a friction that is
//! greater at rest, and noise of the current sensor.

#![allow(
    clippy::cast_possible_truncation,
    reason = "counts and milliamperes are small"
)]

use crepitus_identify::brace::{Recording, Sample};

/// A pendulum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pendulum {
    pub(crate) friction_nm: f64,
    /// Static over Coulomb friction.
    pub(crate) stiction: f64,
    pub(crate) load_loss: f64,
    pub(crate) viscous_nms: f64,
    pub(crate) rotor_kg_m2: f64,
    pub(crate) brace_kg_m2: f64,
    pub(crate) gap_rad: f64,
    pub(crate) stiffness_nm: f64,
    pub(crate) damping_nms: f64,
    pub(crate) moment_nm: f64,
    pub(crate) weight_kg_m2: f64,
    pub(crate) release_rad: f64,
    /// Stiffness and brake of a motor that acts as a spring about the hang, or none.
    pub(crate) spring_nm: f64,
    pub(crate) brake_nm: f64,
}

const NM_PER_A: f64 = 3.3;
const TICK_S: f64 = 5e-5;
const RAD_PER_COUNT: f64 = 35.67e-6;

impl Pendulum {
    /// Returns the swing as a device would record it: counts, and current in whole milliamperes with noise.
    pub(crate) fn recorded(&self, random: &mut fastrand::Rng) -> Recording {
        // Stiff teeth: 20 kN·m/rad at the joint, so damped that they hardly bounce.
        const TEETH_NM: f64 = 2e4;
        const TEETH_NMS: f64 = 12.0;
        const STEPS: u32 = 50;
        const H: f64 = TICK_S / STEPS as f64;
        let held_ticks = 8_000;
        // Rotor, brace, weight; the weight is held at the release.
        let mut angle = [-self.release_rad; 3];
        let mut omega = [0.0_f64; 3];
        let mut samples = Vec::new();
        let mut still = 0;
        for tick in 0..400_000_u64 {
            let spring = -self.spring_nm * angle[0];
            let brake = -self.brake_nm * (omega[0] / 0.05).clamp(-1.0, 1.0);
            let torque = if tick > held_ticks {
                spring + brake
            } else {
                0.0
            };
            let ma = (1e3 * torque / NM_PER_A + 3.0 * (random.f64() - 0.5)).round();
            samples.push(Sample {
                tick: 77 + tick,
                count: (angle[0] / RAD_PER_COUNT).floor() as i32,
                current_a: (self.spring_nm > 0.0 || self.brake_nm > 0.0)
                    .then_some((1e-3 * ma) as f32),
                is_lost: false,
            });
            for _ in 0..STEPS {
                let gap = angle[0] - angle[1];
                let beyond = gap - gap.clamp(-0.5 * self.gap_rad, 0.5 * self.gap_rad);
                let teeth = if beyond == 0.0 {
                    0.0
                } else {
                    let force = TEETH_NM * beyond + TEETH_NMS * (omega[0] - omega[1]);
                    // They do not pull.
                    if force * beyond > 0.0 { force } else { 0.0 }
                };
                let cuffs = self.stiffness_nm * (angle[1] - angle[2])
                    + self.damping_nms * (omega[1] - omega[2]);
                let coulomb = self.friction_nm + self.load_loss * torque.abs();
                let driven = torque - teeth;
                // Karnopp: in a band about zero it sticks as long as friction can hold it.
                if omega[0].abs() < 1e-5 && driven.abs() <= self.stiction * coulomb {
                    omega[0] = 0.0;
                } else {
                    let sense = if omega[0].abs() < 1e-5 {
                        driven.signum()
                    } else {
                        omega[0].signum()
                    };
                    let next = omega[0] + H * (driven - sense * coulomb) / self.rotor_kg_m2;
                    // Friction does not turn the motion round.
                    omega[0] = if next * omega[0] < 0.0 && driven.abs() <= coulomb {
                        0.0
                    } else {
                        next
                    };
                }
                omega[1] += H * (teeth - cuffs) / self.brace_kg_m2;
                if tick > held_ticks {
                    let fall = -self.moment_nm * angle[2].sin() - self.viscous_nms * omega[2];
                    omega[2] += H * (fall + cuffs) / self.weight_kg_m2;
                }
                for (angle, omega) in angle.iter_mut().zip(&omega) {
                    *angle += H * omega;
                }
            }
            still = if omega[0].abs() < 1e-4 { still + 1 } else { 0 };
            if tick > 2 * held_ticks && still > 16_000 {
                break;
            }
        }
        Recording {
            samples,
            tick_s: TICK_S,
            rad_per_count: RAD_PER_COUNT,
            torque_constant_nm_per_a: NM_PER_A / 86.0,
            gear_ratio: 86.0,
        }
    }
}
