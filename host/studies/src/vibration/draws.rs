//! Everything off at once: actuator, shell, seat, cuff and hand, each by up to 30 %.

use super::signals::SettledSignals;
use super::{BAND_HZ, MOST_LAG_S};
use crepitus_model::Real;
use crepitus_plant::effect::Part;
use crepitus_plant::spectrum::cross::Cross;
use crepitus_scene::Scene;
use fastrand::Rng;
use serde::Serialize;
use std::fmt;

/// Largest relative deviation of each number.
pub const SPREAD: f64 = 0.3;

/// Levels that are asked for, over the nominal one.
pub const WITHIN: (f64, f64) = (0.6, 1.7);

/// Parameters that vary, by effect.
const VARIES: [(&str, &[&str]); 4] = [
    ("cuff", &["stiffness_nm_per_rad", "damping_nms_per_rad"]),
    (
        "shell",
        &["mass_kg", "seat_stiffness_n_per_m", "seat_damping_ns_per_m"],
    ),
    (
        "reaction-mass",
        &[
            "resonance_hz",
            "damping_ratio",
            "moving_mass_g",
            "force_constant_n_per_a",
            "resistance_ohm",
        ],
    ),
    ("hand", &["palm_factor"]),
];

/// Result of the draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Draws {
    /// Number of draws.
    pub count: usize,
    /// Number of draws that could not be run to the end; they are not within.
    pub failed: usize,
    /// Level over that of the nominal device: the 5 % quantile, the median, the 95 % quantile.
    pub level: [f64; 3],
    /// Share of them with a level within [`WITHIN`] of the nominal one.
    pub within: f64,
    /// Correlation with the bare knee that 95 % exceed.
    pub least_correlation: f64,
}

impl fmt::Display for Draws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, middle, high] = self.level;
        write!(
            f,
            "everything up to 30 % off at once, {} draws: level {low:.2} to {high:.2} times the nominal one in 90 % \
             (median {middle:.2}), within {} to {} times in {:.0} %, correlation above {:.2} in 95 %",
            self.count,
            WITHIN.0,
            WITHIN.1,
            100.0 * self.within,
            self.least_correlation
        )?;
        match self.failed {
            0 => Ok(()),
            failed => write!(f, "; {failed} of them could not be run, and are not within"),
        }
    }
}

/// The device as it may be, while its parameters stay those of the nominal one.
pub(super) fn scenes(scene: &Scene, count: usize) -> Vec<Scene> {
    let mut random = Rng::with_seed(20);
    (0..count)
        .map(|_| {
            let mut scene = super::Step::Actuator.free(scene);
            for listed in &mut scene.listed {
                if matches!(listed.effect.part, Part::Stage(_)) {
                    continue;
                }
                let names = VARIES.iter().find(|(name, _)| *name == listed.effect.name);
                for key in names.map_or(&[][..], |(_, keys)| keys) {
                    let place = listed.effect.parameters.iter().position(|p| p.key == *key);
                    if let Some(number) = place.and_then(|i| listed.given.numbers.get_mut(i)) {
                        *number *= 1.0 + SPREAD * (2.0 * random.f64() - 1.0);
                    }
                }
            }
            scene
        })
        .collect()
}

/// Compares the draws with the nominal device, and each with a bare knee that shows its
/// torque.
pub(super) fn judge(
    drawn: &[Result<SettledSignals, String>],
    device: Option<&SettledSignals>,
) -> Option<Draws> {
    let device = device?;
    let (low, high) = BAND_HZ;
    let mut levels = Vec::new();
    let mut correlations = Vec::new();
    for kept in drawn.iter().flatten() {
        let cross = Cross::new(&device.acceleration, &kept.acceleration, kept.step_s)?;
        let (nominal, drawn) = cross.rms(low, high, |_| 1.0);
        levels.push(drawn / nominal);
        let with_bare = Cross::new(&kept.of_bare_knee, &kept.acceleration, kept.step_s)?;
        correlations.push(with_bare.likeness(low, high, MOST_LAG_S).correlation);
    }
    let (least, most) = WITHIN;
    let is_within = |level: &&f64| (least..=most).contains(*level);
    let within = whole(levels.iter().filter(is_within).count()) / whole(drawn.len());
    levels.sort_by(f64::total_cmp);
    correlations.sort_by(f64::total_cmp);
    Some(Draws {
        count: drawn.len(),
        failed: drawn.len() - levels.len(),
        within,
        level: [
            quantile(&levels, 5)?,
            quantile(&levels, 50)?,
            quantile(&levels, 95)?,
        ],
        least_correlation: quantile(&correlations, 5)?,
    })
}

fn whole(n: usize) -> f64 {
    f64::from_whole(u64::try_from(n).unwrap_or(u64::MAX))
}

fn quantile(sorted: &[f64], percent: usize) -> Option<f64> {
    let place = (sorted.len().saturating_sub(1) * percent + 50) / 100;
    sorted.get(place).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(level: f64) -> SettledSignals {
        let mut random = Rng::with_seed(1);
        let acceleration: Vec<f64> = (0..40_000).map(|_| level * (random.f64() - 0.5)).collect();
        SettledSignals {
            step_s: 5e-5,
            torque: Vec::new(),
            felt: Vec::new(),
            of_bare_knee: acceleration.clone(),
            acceleration,
            coil: None,
        }
    }

    #[test]
    fn a_draw_that_cannot_be_run_is_not_within() {
        let drawn = [
            Ok(kept(1.1)),
            Ok(kept(0.9)),
            Err("diverged".to_owned()),
            Ok(kept(3.0)),
        ];
        let draws = judge(&drawn, Some(&kept(1.0))).expect("spectra");
        assert_eq!((draws.count, draws.failed), (4, 1));
        assert!((draws.within - 0.5).abs() < 1e-12, "{draws:?}");
        assert!(
            draws
                .to_string()
                .ends_with("1 of them could not be run, and are not within")
        );
    }
}
