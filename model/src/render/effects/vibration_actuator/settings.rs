//! Settings of the actuator, and the rules that they keep.

use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};

settings! {
    /// The actuator as it was measured, and what it is to do.
    pub struct VibrationActuatorSettings, group "vibration-actuator" {
        render (126 always) ["off", "on"], 0, "whether an actuator on the shell vibrates with the joint";
    } {
        gain (127 always) "g" "1", 0.0..=2.0, 1.0,
            "force at the shell per torque over lever: 1 as at a shell that is held, 0.09 as of a bare knee";
        corner_hz (128 always) "fc" "Hz", 8.0..=30.0, 10.0, "frequency above which the actuator takes over";
        resonance_hz (129 always) "f0" "Hz", 10.0..=200.0, 35.0, "resonance of the moving mass on its flexure";
        damping_ratio (130 always) "ζ" "1", 0.02..=1.0, 0.13,
            "damping ratio of that resonance, with the coil connected";
        moving_mass_g (131 always) "m" "g", 2.0..=300.0, 60.0, "mass that the coil moves";
        force_constant_n_per_a (132 always) "Bl" "N/A", 0.1..=20.0, 1.1, "force of the coil for one ampere";
        resistance_ohm (133 always) "R" "Ω", 1.0..=20.0, 1.8, "resistance of the coil and of what feeds it";
        stroke_mm (134 always) "X" "mm", 0.2..=8.0, 1.6, "way of the mass from its middle to a stop";
        continuous_current_a (135 always) "Ic" "A", 0.05..=3.0, 1.45, "current that the coil bears for ever";
        supply_v (136 always) "U" "V", 3.0..=12.0, 5.0, "supply of the coil's bridge";
        lever_m (137 always) "r" "m", 0.1..=0.5, 0.3, "distance of the actuator from the knee's axis";
    }
}

/// The share of the stroke that is not left to the motion of what carries the mass.
const STROKE_SHARE: f64 = 0.8;

/// The most of the stroke that the mass's weight may take: a fifth is left to the command.
const SAG_SHARE: f64 = 0.6;

/// m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;

impl VibrationActuatorSettings {
    /// ω₀, rad/s.
    pub fn resonance_rad_s(&self) -> f64 {
        core::f64::consts::TAU * self.resonance_hz
    }

    /// Stiffness of the flexure, N/m.
    pub fn stiffness_n_per_m(&self) -> f64 {
        let omega = self.resonance_rad_s();
        self.moving_mass_g * 1e-3 * omega * omega
    }

    /// The excursion that the command may use, m: four fifths of the stroke, without what
    /// the mass sags when the leg is turned.
    pub fn usable_stroke_m(&self) -> f64 {
        STROKE_SHARE * self.stroke_mm * 1e-3 - self.sag_m()
    }

    /// Largest displacement of the mass by its weight, m.
    fn sag_m(&self) -> f64 {
        let omega = self.resonance_rad_s();
        STANDARD_GRAVITY / (omega * omega)
    }

    /// Damping ratio of the back-EMF alone.
    pub fn electric_damping_ratio(&self) -> f64 {
        let constant = self.force_constant_n_per_a;
        let mass_kg = self.moving_mass_g * 1e-3;
        constant * constant / (2.0 * self.resistance_ohm * mass_kg * self.resonance_rad_s())
    }

    /// Checks the ranges, and what such an actuator cannot be.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), SettingsError> {
        self.validate()?;
        if self.damping_ratio < self.electric_damping_ratio() {
            return Err(SettingsError::Contradiction {
                reason: "vibration-actuator: a coil with this force constant and resistance damps such a mass more \
                         than damping_ratio, Bl²/(2·R·m·ω₀)",
            });
        }
        if self.sag_m() > SAG_SHARE * self.stroke_mm * 1e-3 {
            return Err(SettingsError::Contradiction {
                reason: "vibration-actuator: on so soft a flexure the weight of the mass takes more than 0.6 of \
                         stroke_mm, g/ω₀²",
            });
        }
        Ok(())
    }

    /// Voltage for a torque far above the corner at gain 1, V per N·m.
    pub fn volts_per_nm(&self) -> f64 {
        -self.resistance_ohm / (self.force_constant_n_per_a * self.lever_m)
    }
}
