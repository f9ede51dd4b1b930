//! Pendulums with what the estimator's model leaves out: a third simulation, which shares no code with the
//! other two. Friction is a bristle (Dahl 1968; LuGre: Canudas de Wit et al. 1995) or a sign function with a
//! breakaway band, the teeth are springs of any stiffness, the weight may be fastened without cuffs, and the
//! encoder's scale may be wrong. Semi-implicit Euler of 2.5 µs.

use crepitus_identify::brace::{Recording, Sample};

/// Dry friction of motor and gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Friction {
    /// Coulomb's, with a band about zero in which it holds.
    Dry,
    /// A bristle of this stiffness, N·m/rad (Dahl).
    Microslip(f64),
    /// Greater at rest by this share, falling with velocity over this scale, rad/s (Stribeck).
    Stribeck(f64, f64),
    /// Varies with the angle: by this share, with so many periods a turn, at this phase.
    ByAngle(f64, f64, f64),
}

/// A brace with a weight in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Imperfect {
    pub(crate) friction_nm: f64,
    pub(crate) friction: Friction,
    pub(crate) load_loss: f64,
    pub(crate) viscous_nms: f64,
    pub(crate) rotor_kg_m2: f64,
    pub(crate) brace_kg_m2: f64,
    pub(crate) gap_rad: f64,
    /// Stiffness of gear and links, N·m/rad, and their damping ratio with the brace on the rotor.
    pub(crate) teeth_nm: f64,
    pub(crate) teeth_ratio: f64,
    /// Stiffness and damping of the cuffs; none: the weight is bolted to the brace.
    pub(crate) cuffs: Option<(f64, f64)>,
    pub(crate) moment_nm: f64,
    pub(crate) weight_kg_m2: f64,
    pub(crate) release_rad: f64,
    /// Angle that the device states over the true one.
    pub(crate) encoder_scale: f64,
    /// Stiffness and brake of a motor that acts as a spring about the hang, or none.
    pub(crate) spring_nm: f64,
    pub(crate) brake_nm: f64,
}

const NM_PER_A: f64 = 3.3;
const TICK_S: f64 = 5e-5;
const RAD_PER_COUNT: f64 = 35.67e-6;
const STEPS: u32 = 20;
const H: f64 = TICK_S / STEPS as f64;

impl Imperfect {
    /// Coulomb friction at an angle from the hang and a velocity, N·m, with the motor's torque.
    fn coulomb_nm(&self, angle: f64, omega: f64, torque: f64) -> f64 {
        let shape = match self.friction {
            Friction::Dry | Friction::Microslip(_) => 1.0,
            Friction::Stribeck(share, scale) => 1.0 + share * (-(omega / scale).powi(2)).exp(),
            Friction::ByAngle(share, periods, phase) => {
                1.0 + share * (periods * angle + phase).sin()
            }
        };
        self.friction_nm * shape + self.load_loss * torque.abs()
    }

    /// Friction of a fast motion, mean over the swing's range of angles, N·m.
    pub(crate) fn mean_friction_nm(&self) -> f64 {
        let Friction::ByAngle(share, periods, phase) = self.friction else {
            return self.friction_nm;
        };
        let sine = |x: f64| (periods * x * self.release_rad + phase).sin();
        let mean: f64 = (-50..=50).map(|i| sine(f64::from(i) / 50.0)).sum::<f64>() / 101.0;
        self.friction_nm * (1.0 + share * mean)
    }

    /// Returns stiffness and damping of cuffs with teeth and links in series, well below the resonance of the brace.
    pub(crate) fn in_series(&self, (stiffness, damping): (f64, f64)) -> (f64, f64) {
        let both = stiffness * self.teeth_nm / (stiffness + self.teeth_nm);
        (both, damping * (both / stiffness).powi(2))
    }

    /// Returns the swing as a device would record it.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "counts and milliamperes are small"
    )]
    pub(crate) fn recorded(&self, random: &mut fastrand::Rng) -> Recording {
        let held_ticks = 8_000;
        let is_armed = self.spring_nm > 0.0 || self.brake_nm > 0.0;
        let reduced = self.rotor_kg_m2 * self.brace_kg_m2 / (self.rotor_kg_m2 + self.brace_kg_m2);
        let teeth_nms = 2.0 * self.teeth_ratio * (self.teeth_nm * reduced).sqrt();
        let (mut angle, mut omega) = ([-self.release_rad; 3], [0.0_f64; 3]);
        let mut bristle = 0.0_f64;
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
                count: (self.encoder_scale * angle[0] / RAD_PER_COUNT).floor() as i32,
                current_a: is_armed.then_some((1e-3 * ma) as f32),
                is_lost: false,
            });
            for _ in 0..STEPS {
                let gap = angle[0] - angle[1];
                let beyond = gap - gap.clamp(-0.5 * self.gap_rad, 0.5 * self.gap_rad);
                let force = self.teeth_nm * beyond + teeth_nms * (omega[0] - omega[1]);
                let teeth = if force * beyond > 0.0 { force } else { 0.0 };
                let fall = -self.moment_nm * angle[2].sin() - self.viscous_nms * omega[2];
                let is_free = tick > held_ticks;
                if let Some((stiffness, damping)) = self.cuffs {
                    let cuffs = stiffness * (angle[1] - angle[2]) + damping * (omega[1] - omega[2]);
                    omega[1] += H * (teeth - cuffs) / self.brace_kg_m2;
                    if is_free {
                        omega[2] += H * (fall + cuffs) / self.weight_kg_m2;
                    }
                } else if is_free {
                    omega[2] += H * (teeth + fall) / (self.brace_kg_m2 + self.weight_kg_m2);
                    omega[1] = omega[2];
                }
                let driven = torque - teeth;
                let coulomb = self.coulomb_nm(angle[0], omega[0], torque);
                if let Friction::Microslip(stiffness) = self.friction {
                    // ż = Ω − σ·|Ω|·z/F, implicit in z: it never passes F/σ.
                    bristle =
                        (bristle + H * omega[0]) / (1.0 + H * stiffness * omega[0].abs() / coulomb);
                    let damping = 0.6 * (stiffness * self.rotor_kg_m2).sqrt();
                    let rate = omega[0] * (1.0 - stiffness * bristle * omega[0].signum() / coulomb);
                    omega[0] +=
                        H * (driven - stiffness * bristle - damping * rate) / self.rotor_kg_m2;
                } else if omega[0].abs() < 1e-5 && driven.abs() <= coulomb {
                    omega[0] = 0.0;
                } else {
                    let sense = if omega[0].abs() < 1e-5 {
                        driven.signum()
                    } else {
                        omega[0].signum()
                    };
                    let next = omega[0] + H * (driven - sense * coulomb) / self.rotor_kg_m2;
                    let turns = next * omega[0] < 0.0 && driven.abs() <= coulomb;
                    omega[0] = if turns { 0.0 } else { next };
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

    /// A brace within a factor of 2 of the data sheet, with a weight that swings in it.
    pub(crate) fn drawn(random: &mut fastrand::Rng) -> Self {
        let mut factor = |nominal: f64| nominal * 2_f64.powf(2.0 * random.f64() - 1.0);
        let friction_nm = factor(0.5);
        let (rotor_kg_m2, brace_kg_m2) = (factor(0.051), factor(0.01));
        let gap_rad = factor(0.0175);
        let cuffs = Some((factor(120.0), factor(1.0)));
        let moment_nm = friction_nm * (9.0 + 5.0 * random.f64());
        Self {
            friction_nm,
            friction: Friction::Dry,
            load_loss: 0.15 + 0.3 * random.f64(),
            viscous_nms: 0.2 * random.f64(),
            rotor_kg_m2,
            brace_kg_m2,
            gap_rad,
            teeth_nm: 2e4,
            teeth_ratio: 0.5,
            cuffs,
            moment_nm,
            weight_kg_m2: 0.035 * moment_nm,
            release_rad: 0.8 + 0.3 * random.f64(),
            encoder_scale: 1.0,
            spring_nm: 0.0,
            brake_nm: 0.0,
        }
    }

    /// The same brace while its motor is a spring about the hang that also brakes.
    pub(crate) fn armed(self) -> Self {
        Self {
            spring_nm: 3.0,
            brake_nm: 0.3,
            ..self
        }
    }
}
