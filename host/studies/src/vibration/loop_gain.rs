//! The loop that the actuator closes: it shakes the shell, through leg and cuff it
//! shakes the rotor, the encoder sees that, the stick answers with kr·Δφ, and the
//! actuator gets that torque, too.
//!
//! Linear, in the worst case for it: the joint sticks all the time, and the gear has no
//! friction (with its friction a rotor at rest does not move at all). Six bodies about
//! the knee's axis,
//!
//! ```text
//! rotor and brace ─ cuff ─ leg ─ seat ─ shell and palm ─ tissue ─ arm ─ intended motion
//!                                        └ flexure ─ moving mass
//! ```
//!
//! as complex dynamic stiffness, solved at each frequency. The motor's own loop,
//! T = kr·φ·e^(−iωτ), is part of the plant. What is left is
//!
//! ```text
//! L(iω) = kr·(φ/f)(iω)·(Bl/R)·C(iω)·e^(−iωd)         1 − L = 0 is an oscillation
//! ```
//!
//! with f the coil's force, C the command's filters and d its delay. Where L is
//! real and positive, 1/L is the gain up to which that frequency is stable.

use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use crepitus_plant::effect::Given;
use crepitus_plant::effects::{cuff, drivetrain, hand, limb, reaction_mass, shell};
use crepitus_plant::spectrum::Complex;
use crepitus_scene::Scene;
use serde::Serialize;
use std::f64::consts::TAU;

/// Tick of the device, s.
const TICK_S: f64 = 5e-5;

/// Mean lag of the motor's torque behind the shaft, s: half a tick of sampling, a tick and
/// a half until it acts, and the winding.
const MOTOR_LAG_S: f64 = 0.21e-3;

/// Delay of the voltage: it is held over the tick after the one that computed it.
const COIL_DELAY_TICKS: f64 = 1.5;

/// Soft cuffs that are tried, N·m/rad.
pub const CUFFS: [f64; 3] = [60.0, 120.0, 300.0];

/// Stiffness of the seat of the paper's brace, N·m/rad, and its damping, N·m·s/rad, as in the scene `fig8`.
pub const STIFF_NM_PER_RAD: f64 = 2e4;
const STIFF_DAMPING_NMS_PER_RAD: f64 = 10.0;

/// Ticks by which everything may be late besides.
pub const LATE_TICKS: [u32; 2] = [0, 4];

/// Hands that are tried: nobody, and the grips.
pub const HANDS: [&str; 4] = ["nobody", "light", "firm", "whole-arm"];

/// Margin of one loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Margin {
    /// Hand that holds the shell.
    pub hand: &'static str,
    /// Stiffness of the cuff, N·m/rad.
    pub cuff_nm_per_rad: f64,
    /// Ticks that the torque is late besides.
    pub late_ticks: u32,
    /// Largest |L| at gain 1.
    pub largest: f64,
    /// Gain up to which it is stable.
    pub stable_to: f64,
    /// Frequency at which it would oscillate beyond that gain, Hz.
    pub at_hz: f64,
}

/// The margins of a scene's device on all hands and cuffs.
pub fn margins(scene: &Scene) -> Vec<Margin> {
    let mut margins = Vec::new();
    for late_ticks in LATE_TICKS {
        for cuff_nm_per_rad in CUFFS.into_iter().chain([STIFF_NM_PER_RAD]) {
            for hand in HANDS {
                margins.push(margin(scene, hand, cuff_nm_per_rad, late_ticks));
            }
        }
    }
    margins
}

/// The margin of a scene's device on one cuff and in one hand.
pub fn margin(scene: &Scene, hand: &'static str, cuff_nm_per_rad: f64, late_ticks: u32) -> Margin {
    Linear::of(scene, hand, cuff_nm_per_rad).margin(hand, late_ticks)
}

/// Inertias, springs and dampers, all about the knee.
#[derive(Clone, Copy, Debug)]
struct Linear {
    rotor: f64,
    leg: f64,
    shell: f64,
    arm: f64,
    mass_kg: f64,
    lever_m: f64,
    cuff: (f64, f64),
    leg_damping: f64,
    seat: (f64, f64),
    tissue: (f64, f64),
    intent: (f64, f64),
    flexure: (f64, f64),
    stick: f64,
    actuator: VibrationActuatorSettings,
    /// The actuator's settings as the device believes them to be.
    believed: VibrationActuatorSettings,
}

/// A number of an effect in a scene, or its default.
fn number(scene: &Scene, effect: &crepitus_plant::effect::Effect, key: &str) -> f64 {
    let place = effect.parameters.iter().position(|p| p.key == key);
    let listed = scene.listed.iter().find(|l| l.effect.name == effect.name);
    let given = listed.map_or_else(|| Given::defaults(effect), |l| l.given.clone());
    place
        .and_then(|i| given.numbers.get(i).copied())
        .unwrap_or(f64::NAN)
}

/// Damping of a cuff of this stiffness, whatever the scene's is.
fn damping_nms_per_rad(stiffness_nm_per_rad: f64) -> f64 {
    if stiffness_nm_per_rad >= STIFF_NM_PER_RAD {
        return STIFF_DAMPING_NMS_PER_RAD;
    }
    let mut specs = cuff::EFFECT.parameters.iter();
    let spec = specs.find(|spec| spec.key == "damping_nms_per_rad");
    spec.map_or(f64::NAN, |spec| spec.default)
}

impl Linear {
    fn of(scene: &Scene, grip: &str, cuff_nm_per_rad: f64) -> Self {
        let of = |effect, key| number(scene, effect, key);
        let shell_lever = of(&shell::EFFECT, "lever_m");
        let hand_lever = of(&hand::EFFECT, "lever_m");
        let (square, hand_square) = (shell_lever * shell_lever, hand_lever * hand_lever);
        let leg_kg = 0.061 * of(&limb::EFFECT, "body_mass_kg");
        let leg_radius = 0.735 * 0.246 * of(&limb::EFFECT, "height_m");
        let (palm_kg, tissue) = match grip {
            "light" => (0.1, (300.0, 10.0)),
            "firm" => (0.2, (600.0, 20.0)),
            "whole-arm" => (0.5, (3_000.0, 60.0)),
            _ => (0.0, (0.0, 0.0)),
        };
        let moving = scene
            .listed
            .iter()
            .find(|l| l.effect.name == reaction_mass::EFFECT.name);
        let actuator = moving.map_or_else(VibrationActuatorSettings::default, |l| {
            reaction_mass::as_settings(&l.given)
        });
        let believed = scene.effect_settings().vibration_actuator;
        let mass_kg = actuator.moving_mass_g * 1e-3;
        let omega = actuator.resonance_rad_s();
        Self {
            rotor: of(&drivetrain::EFFECT, "inertia_kg_m2")
                + of(&cuff::EFFECT, "brace_inertia_kg_m2"),
            leg: leg_kg * leg_radius * leg_radius,
            shell: of(&shell::EFFECT, "mass_kg") * square + palm_kg * hand_square,
            arm: of(&hand::EFFECT, "mass_kg") * hand_square,
            mass_kg,
            lever_m: actuator.lever_m,
            cuff: (cuff_nm_per_rad, damping_nms_per_rad(cuff_nm_per_rad)),
            leg_damping: of(&limb::EFFECT, "damping_nms_per_rad"),
            seat: (
                of(&shell::EFFECT, "seat_stiffness_n_per_m") * square,
                of(&shell::EFFECT, "seat_damping_ns_per_m") * square,
            ),
            tissue: (tissue.0 * hand_square, tissue.1 * hand_square),
            intent: (
                of(&hand::EFFECT, "stiffness_n_per_m") * hand_square,
                of(&hand::EFFECT, "damping_ns_per_m") * hand_square,
            ),
            flexure: (
                actuator.stiffness_n_per_m(),
                2.0 * actuator.damping_ratio * mass_kg * omega,
            ),
            stick: scene
                .crepitus
                .map_or(0.0, |c| c.settings.parameters.stiffness_nm_per_rad),
            believed: believed.unwrap_or(actuator),
            actuator,
        }
    }

    /// Angle of the rotor for 1 N of the coil, rad/N.
    fn answer(&self, omega: f64, late_s: f64) -> Complex<f64> {
        let i = Complex::<f64>::i();
        let link = |(k, b): (f64, f64)| k + i * omega * b;
        let inertia = |j: f64| Complex::new(-omega * omega * j, 0.0);
        let delay = |s: f64| (-i * omega * s).exp();
        let (cuff, seat) = (link(self.cuff), link(self.seat));
        let (tissue, intent) = (link(self.tissue), link(self.intent));
        let flexure = link(self.flexure);
        let r = self.lever_m;
        // From the far ends to the shell: what each branch adds there.
        let arm = tissue * (inertia(self.arm) + intent) / (tissue + inertia(self.arm) + intent);
        let arm = if tissue.norm() > 0.0 {
            arm
        } else {
            Complex::default()
        };
        let mass = inertia(self.mass_kg);
        let carried = r * r * flexure * mass / (flexure + mass);
        // The force acts between mass and shell: so much of it is left at the shell.
        let force = r * mass / (flexure + mass);
        let shell = inertia(self.shell) + arm + carried;
        let stick = self.stick * delay(MOTOR_LAG_S + late_s);
        let rotor = inertia(self.rotor) + stick;
        let leg = inertia(self.leg) + i * omega * self.leg_damping;
        // Rotor, leg and shell in a row, by elimination from both ends.
        let from_rotor = cuff * rotor / (cuff + rotor);
        let beyond = leg + from_rotor;
        let from_leg = seat * beyond / (seat + beyond);
        let shell_rad = force / (shell + from_leg);
        let leg_rad = shell_rad * seat / (seat + beyond);
        leg_rad * cuff / (cuff + rotor)
    }

    /// L at gain 1.
    fn gain(&self, hz: f64, late_s: f64) -> Complex<f64> {
        let omega = TAU * hz;
        let s = Complex::new(0.0, omega);
        let corner = TAU * self.believed.corner_hz;
        let resonance = self.believed.resonance_rad_s();
        let [first, second] = [TAU / 16.0, 3.0 * TAU / 16.0]
            .map(|angle: f64| s * s + 2.0 * angle.sin() * corner * s + corner * corner);
        let equaliser =
            s * s + 2.0 * self.believed.damping_ratio * resonance * s + resonance * resonance;
        let command = self.believed.volts_per_nm() * (s * s / first) * (equaliser / second);
        let per_volt = self.actuator.force_constant_n_per_a / self.actuator.resistance_ohm;
        let delay = (-s * (COIL_DELAY_TICKS * TICK_S + late_s)).exp();
        self.stick * self.answer(omega, late_s) * per_volt * command * delay
    }

    fn margin(&self, hand: &'static str, late_ticks: u32) -> Margin {
        let late_s = f64::from(late_ticks) * TICK_S;
        let mut margin = Margin {
            hand,
            cuff_nm_per_rad: self.cuff.0,
            late_ticks,
            largest: 0.0,
            stable_to: f64::INFINITY,
            at_hz: f64::NAN,
        };
        let mut before: Option<(f64, Complex<f64>)> = None;
        // From 1 Hz to 1 kHz by a thousandth of an octave.
        let mut hz = 1.0;
        while hz < 1_000.0 {
            let gain = self.gain(hz, late_s);
            margin.largest = margin.largest.max(gain.norm());
            if let Some((_, last)) = before
                && last.im.signum() != gain.im.signum()
            {
                let share = last.im / (last.im - gain.im);
                let real = last.re + share * (gain.re - last.re);
                if real > 0.0 && 1.0 / real < margin.stable_to {
                    (margin.stable_to, margin.at_hz) = (1.0 / real, hz);
                }
            }
            before = Some((hz, gain));
            hz *= 1.000_7;
        }
        margin
    }
}
