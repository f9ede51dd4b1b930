//! A tolerance: limits on the difference of the torque at the hand, and of the
//! events, from the whole scene, written `torque=5e-3,events=0.01`.

use super::influence::Difference;
use crate::limits::{self, Limited};
use serde::Serialize;

/// Limits on a reduced scene.
pub type Tolerance = limits::Limits<Criterion>;

/// One limit.
pub type Limit = limits::Limit<Criterion>;

crepitus_model::named! {
    /// A difference that can be limited.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Criterion {
        /// Root mean square of the torque's difference.
        Torque => "torque",
        /// Largest magnitude of the torque's difference.
        Peak => "peak",
        /// Relative difference of the numbers of events.
        Events => "events",
    }
}

impl Limited for Criterion {
    const ALL: &'static [Self] = &Self::ALL;
    const LIMITS: &'static str = "tolerance";
    const EXAMPLE: &'static str = "torque=5e-3,events=0.01";

    fn key(self) -> &'static str {
        self.name()
    }

    fn meaning(self) -> &'static str {
        match self {
            Self::Torque => "rms difference of the torque at the hand",
            Self::Peak => "largest difference of the torque at the hand",
            Self::Events => "relative difference of the number of events",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Torque | Self::Peak => "N·m",
            Self::Events => "",
        }
    }
}

impl Criterion {
    /// Value of the criterion in a difference.
    pub fn of(self, difference: &Difference) -> f64 {
        match self {
            Self::Torque => difference.rms_nm,
            Self::Peak => difference.peak_nm,
            Self::Events => difference.events_relative,
        }
    }
}

impl Tolerance {
    /// Returns whether a difference is within every limit.
    pub fn holds(&self, difference: &Difference) -> bool {
        self.limits()
            .iter()
            .all(|limit| limit.criterion.of(difference) <= limit.at_most)
    }

    /// The limit of a criterion; infinite without one.
    pub fn at_most(&self, criterion: Criterion) -> f64 {
        self.limits()
            .iter()
            .find(|limit| limit.criterion == criterion)
            .map_or(f64::INFINITY, |limit| limit.at_most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_and_held() {
        let tolerance: Tolerance = "torque=5e-3, events=0.1".parse().unwrap();
        let difference = Difference {
            rms_nm: 5e-3,
            peak_nm: 9.0,
            events_relative: 0.1,
        };
        assert!(tolerance.holds(&difference));
        assert!(!tolerance.holds(&Difference {
            events_relative: f64::INFINITY,
            ..difference
        }));
        assert!(!tolerance.holds(&Difference {
            rms_nm: f64::NAN,
            ..difference
        }));
        assert_eq!(tolerance.at_most(Criterion::Peak), f64::INFINITY);
    }
}
