//! Speeds at which a knee is examined.

use serde::Serialize;

/// Task of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Aim {
    /// Keep the speed of each stroke in a band, °/s; without an upper end: as fast as possible.
    Speed {
        /// Lower end.
        low_deg_per_s: f64,
        /// Upper end.
        high_deg_per_s: Option<f64>,
    },
    /// Turn back at every beat.
    Metronome {
        /// Beats a minute.
        beats_per_min: f64,
    },
}

/// An aim with a name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// Name; `own` if a person has set it.
    pub name: &'static str,
    /// Task of the hand.
    #[serde(flatten)]
    pub aim: Aim,
}

/// Reason for the rejection of an aim.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// Invalid band of speeds.
    #[error(
        "invalid target: expected a speed from 1 to 600 °/s, the lower end below the upper one"
    )]
    Band,
    /// Invalid beat of a metronome.
    #[error("invalid metronome: expected 10 to 240 beats a minute")]
    Beat,
}

const fn speed(name: &'static str, low: f64, high: Option<f64>) -> Target {
    Target {
        name,
        aim: Aim::Speed {
            low_deg_per_s: low,
            high_deg_per_s: high,
        },
    }
}

/// Targets by name. Examinations are at about 30 °/s (slow), 90 (medium), 130 (modified
/// Ashworth scale) and 350 (as fast as possible); Tardieu's V1 is slower than a leg falls,
/// V2 as fast as it falls, V3 as fast as possible. The bands around these are estimates.
pub const NAMED: [Target; 8] = [
    speed("slow", 20.0, Some(45.0)),
    speed("medium", 65.0, Some(120.0)),
    speed("ashworth", 95.0, Some(170.0)),
    speed("fast", 250.0, None),
    speed("tardieu-v1", 5.0, Some(45.0)),
    speed("tardieu-v2", 95.0, Some(180.0)),
    speed("tardieu-v3", 250.0, None),
    Target {
        name: "metronome",
        aim: Aim::Metronome {
            beats_per_min: 40.0,
        },
    },
];

impl Target {
    /// The target of this name.
    pub fn find(name: &str) -> Option<Self> {
        NAMED.into_iter().find(|target| target.name == name)
    }

    /// A person's own.
    ///
    /// # Errors
    /// [`TargetError`] if nobody can do that.
    pub fn own(aim: Aim) -> Result<Self, TargetError> {
        const SPEEDS: std::ops::RangeInclusive<f64> = 1.0..=600.0;
        let target = Self { name: "own", aim };
        match aim {
            Aim::Speed {
                low_deg_per_s: low,
                high_deg_per_s: high,
            } => {
                let is_right = SPEEDS.contains(&low)
                    && high.is_none_or(|high| SPEEDS.contains(&high) && low < high);
                is_right.then_some(target).ok_or(TargetError::Band)
            }
            Aim::Metronome { beats_per_min } => {
                let is_right = (10.0..=240.0).contains(&beats_per_min);
                is_right.then_some(target).ok_or(TargetError::Beat)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_different_and_aims_possible() {
        for target in NAMED {
            assert_eq!(Target::find(target.name), Some(target));
            assert!(Target::own(target.aim).is_ok(), "{}", target.name);
        }
    }

    #[test]
    fn what_nobody_can_do_is_rejected() {
        let band = |low_deg_per_s, high_deg_per_s| {
            Target::own(Aim::Speed {
                low_deg_per_s,
                high_deg_per_s,
            })
        };
        for bad in [
            band(0.0, None),
            band(50.0, Some(40.0)),
            band(f64::NAN, None),
            band(10.0, Some(f64::INFINITY)),
        ] {
            assert_eq!(bad, Err(TargetError::Band));
        }
        let beat = |beats_per_min| Target::own(Aim::Metronome { beats_per_min });
        assert_eq!(beat(0.0), Err(TargetError::Beat));
        assert_eq!(beat(f64::NAN), Err(TargetError::Beat));
        assert!(beat(60.0).is_ok());
    }
}
