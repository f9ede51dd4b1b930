//! The ringing of a bone, which cuff and soft tissue swallow.
//!
//! A knee that clicks makes the tibia ring. Worn over cloth and muscle the
//! device can move no bone, but it can let the hand feel the ringing: every
//! jump ΔT of the rendered torque strikes a resonator, whose output is added.
//!
//! ```text
//!  T ────────┐                         z¨ + 2ζω·z˙ + ω²·z = ω·g·Σ ΔT·δ(t − t_jump)
//!            │ ΔT
//!            └──╮  ╭─╮  ╭─╮ ╭──        z = g·ΔT·(ω/ω_d)·e^(−ζωt)·sin(ω_d·t)
//!               │  │ ╰──╯ ╰─╯          ω_d = ω·√(1 − ζ²)
//!               ╰──╯   T + z
//! ```
//!
//! The ringing begins at zero, so a jump gets no larger, and dies away: no
//! change at constant torque. A jump is struck at the beginning of the tick
//! that it is in, up to h early: 2° of the ringing at 50 µs and 115 Hz.
//!
//! **What strikes it.** [`BoneShaping::ring`] takes jumps; which, its caller
//! decides. A linear filter of the whole torque would be `ring` with every
//! tick's change. It has no mean, but the ramps of the sticks undo in it what
//! the jumps do: at 1 rad/s the paper's stick rises by 0.4 N·m in 1 ms between
//! two drops of 0.2 N·m, and the bone rings with 0.04 N·m, at 2 rad/s with
//! 0.02 N·m. (And a torque that goes on rising would shift it by Ṫ/ω: 0.55 N·m
//! for 400 N·m/rad at 1 rad/s.) With the jumps of the events alone it rings
//! with 0.16 N·m at 0.05 rad/s and 0.3 N·m from 1 rad/s on. That is what a
//! click is for, so strike it with the events. The price: ∫z dt = g·ΔT/ω, so
//! jumps that all fall shift the mean torque by their sum a second over ω: for
//! the paper's crepitus −18 mN·m, 9 % of Tk and below what is just noticeable.
//!
//! **Energy.** What is added is no passive spring: a hand that moves with the
//! ringing gets work from it. So it is paid from a [tank](super::tank), and over
//! any time t and for any motion
//!
//! ```text
//! energy returned ≤ budget + refill·t
//! ```
//!
//! while the shaft moves at most budget/(16·limit) in a tick (1 mrad, 21 rad/s
//! with the defaults; the joint trips at 7.3 rad/s); what a faster one
//! overdraws is paid back before the next output. The torques are those asked
//! for: a current loop that lags τ behind lets the work differ by a share of
//! about ω·τ, 12 % at 1 kHz.
//!
//! The budget, 10 mJ: one ring exchanges at most 2·ΔT/ω a rad/s with a hand,
//! and its upper half, 5 mJ, holds that of the largest jump, 0.6 N·m, at
//! 3 rad/s, and of the paper's two that come at once, 0.4 N·m, at 4.5 rad/s.
//! The refill, 0.1 W, carries the mean above up to 5 rad/s. So the paper's
//! crepitus does not fade up to 4 rad/s (230 deg/s), and beyond only a little.
//! Both at the ends of their ranges return at most 0.5 J in 2 s.
//!
//! **On the actuator.** Of a ringing of the motor's torque a hand gets next to nothing,
//! so with `output = "actuator"` it goes to the [actuator on the
//! shell](super::vibration_actuator) instead. It is then no torque on the shaft and costs the motor no
//! energy: there is no account, and the actuator's own limits hold.
//!
//! Sources: 115 Hz with ζ 0.098 after a click of a healthy knee, 67 Hz with ζ
//! 0.036 with a meniscal tear (PMC8284919); gain, budget and refill are
//! engineering estimates; the limit is the step that the slew limit exempts.

use crate::joint::oscillator::{Oscillator, Transition};
use crate::joint::{LONGEST_STEP_S, Parameters, SettingsError};
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::Shown;
use crate::render::effects::tank::Tank;
use crate::render::effects::{
    DeviceEffect, EffectSpec, Faded, Need, Observe, Owner, Target, Tick, Timing,
};

settings! {
    /// The bone, and what its ringing may cost.
    pub struct BoneShapingSettings, group "bone-shaping" {
        render (13 always) ["off", "on"], 0, "whether the bone rings when the joint clicks";
    } chosen {
        output (138 always) ["motor", "actuator"], 0,
            "what the hand gets the ringing from: the motor, or the vibration-actuator alone";
    } {
        frequency_hz (14 always) "f" "Hz", 20.0..=1000.0, 115.0,
            "frequency of the bone: 115 Hz healthy, 67 Hz with a meniscal tear";
        damping_ratio (15 always) "ζ" "1", 0.005..=0.99, 0.098,
            "damping ratio of the bone: 0.098 healthy, 0.036 with a meniscal tear";
        gain (16 always) "g" "1", 0.0..=10.0, 1.0, "ringing per jump of the torque; 0 is none";
        // The slew limit exempts steps up to the largest.
        limit_nm (17 always) "Tb" "N·m", 0.0..=0.6, 0.6, "largest torque that is added";
        // The least keeps the energy account exact up to 10 rad/s at 20 kHz.
        budget_j (18 always) "E" "J", 5e-3..=0.1, 0.01, "energy that the ringing may return at once";
        refill_w (19 always) "P" "W", 0.0..=0.2, 0.1, "continuous power that the ringing may return";
    }
}

/// A bone that rings at one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneShaping<F> {
    /// The free motion over a tick.
    swing: Transition<F>,
    /// ω, rad/s.
    omega_n: F,
    gain: F,
    limit_nm: F,
    /// z, N·m.
    ringing_nm: F,
    /// ż, N·m/s.
    rate_nm_per_s: F,
    target: Target,
    tank: Tank<F>,
}

impl<F: Real> DeviceEffect<F> for BoneShaping<F> {
    type Settings = BoneShapingSettings;
    type Coefficients = Self;
    type Switched = Faded<F, Self>;

    const SPEC: EffectSpec = EffectSpec {
        name: "bone-shaping",
        adds: "a ringing of the rendered torque where cuff and tissue swallow that of the bone",
        states: &["ringing", "its rate"],
        column: "shaping_nm",
        unit: "N·m",
        title: "Bone shaping, added to the model’s torque",
        phases: None,
        needs: &[Need {
            effect: "crepitus",
            why: "it rings where the model's torque jumps",
        }],
        parameters: BoneShapingSettings::TABLE,
        choices: BoneShapingSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    /// A silent bone with a full tank.
    fn coefficients(
        settings: &BoneShapingSettings,
        timing: &Timing,
    ) -> Result<Self, SettingsError> {
        let Timing {
            step_s,
            delay_ticks,
            ..
        } = *timing;
        settings.validate()?;
        if !(step_s > 0.0 && step_s <= LONGEST_STEP_S) {
            return Err(SettingsError::Step { step_s });
        }
        let omega_n = core::f64::consts::TAU * settings.frequency_hz;
        // The oscillator of an object with one unit of inertia.
        let bone = Oscillator::<F>::of(&Parameters {
            inertia_kg_m2: 1.0,
            stiffness_nm_per_rad: omega_n * omega_n,
            damping_nms_per_rad: 2.0 * settings.damping_ratio * omega_n,
            kinetic_torque_nm: 0.0,
            static_torque_nm: 0.0,
        });
        Ok(Self {
            swing: bone.transition(F::from_f64(step_s)),
            omega_n: F::from_f64(omega_n),
            gain: F::from_f64(settings.gain),
            limit_nm: F::from_f64(settings.limit_nm),
            ringing_nm: F::ZERO,
            rate_nm_per_s: F::ZERO,
            target: Self::target_of(settings),
            tank: Tank::new(settings.budget_j, settings.refill_w, step_s, delay_ticks),
        })
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn added(&mut self, tick: &Tick<'_, F>, shown: &mut Shown<F>, _: &mut impl Observe<F>) -> F {
        self.ring(shown.jump_nm);
        self.tick(tick.travel_rad)
    }

    fn new(coefficients: Self) -> Self {
        coefficients
    }

    fn target_of(settings: &BoneShapingSettings) -> Target {
        match settings.output {
            0 => Target::Joint,
            _ => Target::Shell,
        }
    }

    #[inline]
    fn target(&self) -> Target {
        self.target
    }
}

impl<F: Real> BoneShaping<F> {
    /// The rendered torque has jumped by `jump_nm` in this tick, N·m; what is
    /// no finite number is ignored.
    #[inline]
    pub fn ring(&mut self, jump_nm: F) {
        if jump_nm.is_finite() {
            self.rate_nm_per_s += self.omega_n * self.limited(self.gain * jump_nm);
        }
    }

    /// One tick, in which the shaft has moved by `delta_phi_rad`: the torque to
    /// add from its end on, N·m.
    ///
    /// A travel that is NaN or infinite counts as zero and refills nothing.
    #[inline]
    pub fn tick(&mut self, delta_phi_rad: F) -> F {
        let (z, rate) = self.swing.apply(self.ringing_nm, self.rate_nm_per_s);
        (self.ringing_nm, self.rate_nm_per_s) = (z.settled(), rate.settled());
        if self.target == Target::Shell {
            return self.limited(self.ringing_nm);
        }
        self.tank.account(delta_phi_rad);
        let torque_nm = self.tank.share() * self.limited(self.ringing_nm);
        self.tank.give(torque_nm);
        torque_nm
    }

    /// Resets the state to that at the start but for the tank, for disarming.
    pub fn reset(&mut self) {
        self.ringing_nm = F::ZERO;
        self.rate_nm_per_s = F::ZERO;
        self.tank.forget();
    }

    /// Energy in the tank, J.
    pub fn level_j(&self) -> F {
        self.tank.level_j()
    }

    #[inline]
    fn limited(&self, torque_nm: F) -> F {
        torque_nm.within(self.limit_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::energy_observer::MOST_DELAY_TICKS;
    use std::vec::Vec;

    const TICK_S: f64 = 5e-5;

    fn timing(step_s: f64, delay_ticks: usize) -> Timing {
        Timing {
            step_s,
            delay_ticks,
            ..crate::render::effects::tests::TIMING
        }
    }

    fn bone<F: Real>(settings: &BoneShapingSettings) -> BoneShaping<F> {
        crate::render::effects::tests::law(settings)
    }

    /// The ringing after one jump, with the shaft at rest.
    fn after_a_jump<F: Real>(settings: &BoneShapingSettings, jump: f64, ticks: u32) -> Vec<f64> {
        let mut bone = bone::<F>(settings);
        bone.ring(F::from_f64(jump));
        (0..ticks).map(|_| bone.tick(F::ZERO).to_f64()).collect()
    }

    const TEAR: BoneShapingSettings = BoneShapingSettings {
        output: 0,
        frequency_hz: 67.0,
        damping_ratio: 0.036,
        gain: 0.7,
        limit_nm: 0.6,
        budget_j: 0.01,
        refill_w: 0.1,
    };

    #[test]
    fn settings_are_their_table_and_are_held_to_it() {
        crate::parameters::tests::is_its_table_and_is_held_to_it::<6, BoneShapingSettings>();
        let s = BoneShapingSettings::default();
        assert_eq!(
            (s.frequency_hz, s.damping_ratio, s.gain),
            (115.0, 0.098, 1.0)
        );
        assert_eq!((s.limit_nm, s.budget_j, s.refill_w), (0.6, 0.01, 0.1));
        for step_s in [0.0, f64::NAN, 1.1] {
            assert!(BoneShaping::<f32>::coefficients(&s, &timing(step_s, 0)).is_err());
        }
        assert_eq!(
            BoneShaping::<f32>::coefficients(&s, &timing(TICK_S, 9)),
            BoneShaping::coefficients(&s, &timing(TICK_S, MOST_DELAY_TICKS))
        );
    }

    #[test]
    fn a_jump_rings_as_the_closed_form() {
        for s in [BoneShapingSettings::default(), TEAR] {
            let omega = core::f64::consts::TAU * s.frequency_hz;
            let damped = omega * libm::sqrt(1.0 - s.damping_ratio * s.damping_ratio);
            let double = after_a_jump::<f64>(&s, -0.2, 4000);
            let single = after_a_jump::<f32>(&s, -0.2, 4000);
            for (n, (double, single)) in (1..).zip(double.iter().zip(single)) {
                let t = f64::from(n) * TICK_S;
                let exact = -0.2 * s.gain * omega / damped
                    * libm::exp(-s.damping_ratio * omega * t)
                    * libm::sin(damped * t);
                assert!((double - exact).abs() < 1e-14, "{n}: {double} {exact}");
                assert!((single - exact).abs() < 1e-6, "{n}: {single} {exact}");
            }
        }
    }

    #[test]
    fn it_keeps_its_pitch_and_its_decay() {
        // Between upward crossings of zero: one period, and e^(−ζωT) of it.
        let s = BoneShapingSettings::default();
        let ringing = after_a_jump::<f64>(&s, 0.5, 2000);
        let crossings: Vec<f64> = (1..)
            .zip(ringing.windows(2))
            .filter(|(_, z)| z[0] < 0.0 && z[1] >= 0.0)
            .map(|(n, z)| (f64::from(n) + z[0] / (z[0] - z[1])) * TICK_S)
            .collect();
        let period = 1.0 / (115.0 * libm::sqrt(1.0 - 0.098 * 0.098));
        for pair in crossings.windows(2).take(8) {
            assert!((pair[1] - pair[0] - period).abs() < 1e-6);
        }
        // A tick more or less is 4 % of the jump at most.
        assert!(ringing.windows(2).all(|z| (z[1] - z[0]).abs() < 0.04 * 0.5));
        let largest_after = |n: usize| ringing[n..].iter().fold(0.0, |most: f64, z| most.max(*z));
        let ticks_per_period = 175;
        let fallen = largest_after(ticks_per_period) / largest_after(0);
        let expected = libm::exp(-0.098 * core::f64::consts::TAU * 115.0 * period);
        assert!((fallen - expected).abs() < 2e-3, "{fallen} {expected}");
    }

    #[test]
    fn no_more_is_added_than_the_limit() {
        let s = BoneShapingSettings {
            gain: 10.0,
            ..BoneShapingSettings::default()
        };
        let mut bone = bone::<f32>(&s);
        let mut largest = 0.0_f32;
        for n in 0..2000 {
            // In step with the bone, so that it would grow and grow.
            if n % 174 == 0 {
                bone.ring(1e30);
            }
            largest = largest.max(bone.tick(0.0).abs());
        }
        assert_eq!(largest, 0.6);
    }

    #[test]
    fn nan_is_ignored_and_silence_stays_silent() {
        let s = BoneShapingSettings::default();
        let mut deaf = bone::<f32>(&s);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            deaf.ring(bad);
            assert_eq!(deaf.tick(bad), 0.0);
        }
        assert_eq!(deaf, bone(&s));
        // A travel that cannot be overdraws once, and is paid back.
        deaf.ring(0.5);
        for _ in 0..20 {
            deaf.tick(0.0);
        }
        deaf.tick(-3e38);
        assert_eq!(deaf.level_j(), -0.01);
        assert_eq!(deaf.tick(0.0), 0.0);
        for _ in 0..5000 {
            deaf.tick(0.0);
        }
        assert_eq!(deaf.level_j(), 0.01);
        for _ in 0..20_000 {
            deaf.tick(0.0);
        }
        assert_eq!((deaf.ringing_nm, deaf.rate_nm_per_s), (0.0, 0.0));
        deaf.ring(0.5);
        deaf.tick(-1e-3);
        deaf.tick(-1e-3);
        let level = deaf.level_j();
        deaf.reset();
        assert!(level < 0.01 && deaf.level_j() == level);
        assert_eq!(deaf.tick(-1e-3), 0.0);
    }

    #[test]
    fn the_account_is_the_work_of_the_worst_of_the_acting_torques() {
        let s = BoneShapingSettings {
            refill_w: 0.0,
            ..BoneShapingSettings::default()
        };
        for delay in 0..=MOST_DELAY_TICKS {
            let mut bone = BoneShaping::<f64>::coefficients(&s, &timing(TICK_S, delay)).unwrap();
            bone.ring(0.5);
            let torques: Vec<f64> = (0..10).map(|_| bone.tick(0.0)).collect();
            assert_eq!(bone.level_j(), 0.01);
            // The torque still rises: the latest returns the most.
            bone.tick(-2e-3);
            assert!((0.01 - bone.level_j() - torques[9] * 2e-3).abs() < 1e-16);
            // Against the hand it is the earliest that takes the least.
            let (before, acting) = (bone.level_j(), bone.tank.given_nm[delay]);
            bone.tick(1e-3);
            assert!((bone.level_j() - before - acting * 1e-3).abs() < 1e-16);
        }
    }

    #[test]
    fn below_half_a_tank_it_fades_and_with_none_it_is_silent() {
        let s = BoneShapingSettings {
            refill_w: 0.0,
            ..BoneShapingSettings::default()
        };
        let at = |level: f64| {
            let mut bone = bone::<f64>(&s);
            bone.ring(0.5);
            bone.tank.level_j = level;
            bone.tick(0.0)
        };
        let full = at(0.01);
        assert!(full > 0.01);
        assert_eq!((at(0.005), at(0.0), at(-0.001)), (full, 0.0, 0.0));
        assert!((at(0.001) - 0.2 * full).abs() < 1e-15);
    }

    #[test]
    fn on_the_actuator_it_rings_alike_and_keeps_no_account() {
        let on_actuator = BoneShapingSettings {
            output: 1,
            ..BoneShapingSettings::default()
        };
        let mut motor = bone::<f32>(&BoneShapingSettings::default());
        let mut actuator = bone::<f32>(&on_actuator);
        assert_eq!(motor.target(), Target::Joint);
        assert_eq!(actuator.target(), Target::Shell);
        for n in 0..400 {
            if n % 150 == 0 {
                motor.ring(-0.2);
                actuator.ring(-0.2);
            }
            assert_eq!(motor.tick(0.0), actuator.tick(1e-3));
        }
        assert_eq!(actuator.level_j(), 0.01);
    }
}
