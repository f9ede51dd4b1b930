//! The paper's two rules for the end of a slip, on one movement of a knee: two
//! different products.

use super::Line;
use super::trace::Run;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError};
use crepitus_plant::Motion;

/// Amplitude of the knee's sine, degrees.
const AMPLITUDE_DEG: f64 = 45.0;
/// Frequency of the knee's sine, Hz.
const FREQUENCY_HZ: f64 = 0.25;
/// There and back once, s.
const DURATION_S: f64 = 4.0;
/// The device's tick, s.
const STEP_S: f64 = 5e-5;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct RestickRules {
    /// Amplitude of the knee's sine, degrees.
    pub amplitude_deg: f64,
    /// Frequency of the knee's sine, Hz.
    pub frequency_hz: f64,
    /// Duration that is shown, s.
    pub duration_s: f64,
    /// Ts, N·m.
    pub static_torque_nm: f64,
    /// Frozen, then physical.
    pub rules: Vec<Rule>,
    /// Speed of the shaft, rad/s, against time, s.
    pub omega_rad_s: Line,
}

/// One of the two.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Convention with this rule.
    pub convention: Convention,
    /// Torque, N·m, against time, s.
    pub torque_nm: Line,
    /// Times at which the object broke loose, s.
    pub breaks_s: Vec<f64>,
}

/// See the module.
pub(super) fn restick_rules() -> Result<RestickRules, SettingsError> {
    let motion = Motion::sine(AMPLITUDE_DEG.to_radians(), FREQUENCY_HZ, -90.0);
    let rule = |convention| {
        let settings = Settings {
            convention,
            ..Settings::default()
        }
        .validate()?;
        let trace = Run {
            settings: &settings,
            solver: Solver::ExactEvents,
            motion: &motion,
            duration_s: DURATION_S,
            step_s: STEP_S,
        }
        .trace()?;
        Ok(Rule {
            convention,
            torque_nm: trace.torque_nm,
            breaks_s: trace.breaks_s,
        })
    };
    Ok(RestickRules {
        amplitude_deg: AMPLITUDE_DEG,
        frequency_hz: FREQUENCY_HZ,
        duration_s: DURATION_S,
        static_torque_nm: Settings::default().parameters.static_torque_nm,
        rules: [Convention::Frozen, Convention::Physical]
            .into_iter()
            .map(rule)
            .collect::<Result<_, SettingsError>>()?,
        omega_rad_s: speed(&motion),
    })
}

/// Ω against time.
fn speed(motion: &Motion) -> Vec<(f64, f64)> {
    (0..=400)
        .map(|i| DURATION_S * f64::from(i) / 400.0)
        .map(|time_s| (time_s, motion.at(time_s).omega_rad_s))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_differ_as_the_reference_does() {
        let story = restick_rules().unwrap();
        let breaks: Vec<usize> = story.rules.iter().map(|rule| rule.breaks_s.len()).collect();
        assert_eq!(breaks, [124, 3]);
        let lowest = story.rules[0].torque_nm.iter();
        assert!(lowest.map(|p| p.1).fold(0.0, f64::min) >= -0.4);
    }
}
