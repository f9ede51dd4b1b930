//! Parameter sets with a name and a source.

use crate::joint::Parameters;

/// Origin of a preset's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Taken from the cited publication.
    Sourced,
    /// An engineering estimate.
    Estimate,
}

/// A named parameter set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// How it feels to a hand.
    pub feels_like: &'static str,
    /// How well founded the numbers are.
    pub evidence: Evidence,
    /// The source.
    pub source: &'static str,
    /// The numbers.
    pub parameters: Parameters,
}

/// All presets. Each keeps Tk ≥ Ts/2: below that, the restart torque 2Tk − Ts
/// is negative and the friction would push the leg.
pub const PRESETS: [Preset; 3] = [
    Preset {
        name: "coarse",
        feels_like: "coarse grating at 31.8 Hz",
        evidence: Evidence::Sourced,
        source: "Ishikawa, Okamoto et al., wearable dummy joint: tuned with a physical therapist",
        parameters: Parameters {
            inertia_kg_m2: 0.01,
            stiffness_nm_per_rad: 400.0,
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: 0.2,
            static_torque_nm: 0.4,
        },
    },
    Preset {
        name: "fine",
        feels_like: "fine roughness at 101 Hz: minor wear of the cartilage",
        evidence: Evidence::Estimate,
        source: "no torque of fine crepitus is published; pitch from the vibroarthrographic band 50-250 Hz",
        parameters: Parameters {
            inertia_kg_m2: 0.0008,
            stiffness_nm_per_rad: 320.0,
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: 0.08,
            static_torque_nm: 0.14,
        },
    },
    Preset {
        name: "bone-on-bone",
        feels_like: "heavy creaking at 20.5 Hz: bare bone on bone",
        evidence: Evidence::Estimate,
        source: "no torque of bone-on-bone contact is published; chosen to stay below a tenth of the gear's limit",
        parameters: Parameters {
            inertia_kg_m2: 0.03,
            stiffness_nm_per_rad: 500.0,
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: 0.6,
            static_torque_nm: 1.1,
        },
    },
];

impl Preset {
    /// The preset of this name.
    pub fn find(name: &str) -> Option<&'static Preset> {
        PRESETS.iter().find(|p| p.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::Settings;

    #[test]
    fn every_preset_is_valid_and_never_pushes_the_leg() {
        for preset in &PRESETS {
            let settings = Settings {
                parameters: preset.parameters,
                ..Settings::default()
            };
            assert!(settings.validate().is_ok(), "{}", preset.name);
            assert!(
                preset.parameters.restart_torque_nm() >= 0.0,
                "{}",
                preset.name
            );
            assert_eq!(Preset::find(preset.name), Some(preset));
        }
    }
}
