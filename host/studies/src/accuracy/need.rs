//! A need: limits on a solver's errors, written `torque=1e-2,interval=5e-4`.
//!
//! `torque` is that of a device, which holds each torque for a step;
//! `torque-at-tick` compares at the ends of steps alone, as if the torque were
//! continuous.

use crate::accuracy::point::Point;
use crate::limits::{self, Limited};
use serde::Serialize;

/// Limits on a solver's errors.
pub type Need = limits::Limits<Criterion>;

/// One limit.
pub type Limit = limits::Limit<Criterion>;

crepitus_model::named! {
    /// An error that can be limited.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Criterion {
        /// Root mean square error of the torque as it is held for a step.
        Torque => "torque",
        /// Largest error of the held torque.
        PeakTorque => "peak-torque",
        /// Root mean square torque error at the ends of steps alone.
        TorqueAtTick => "torque-at-tick",
        /// Largest torque error at the end of a step.
        PeakTorqueAtTick => "peak-torque-at-tick",
        /// Worst error of an event's time.
        Event => "event",
        /// Worst error of the time between neighbouring events.
        Interval => "interval",
        /// Relative error of the cycle frequency.
        Frequency => "frequency",
    }
}

impl Limited for Criterion {
    const ALL: &'static [Self] = &Self::ALL;
    const LIMITS: &'static str = "need";
    const EXAMPLE: &'static str = "torque=1e-2,interval=5e-4";

    fn key(self) -> &'static str {
        self.name()
    }

    fn meaning(self) -> &'static str {
        match self {
            Self::Torque => "rms error of the held torque",
            Self::PeakTorque => "largest error of the held torque",
            Self::TorqueAtTick => "rms torque error at the tick",
            Self::PeakTorqueAtTick => "largest torque error at the tick",
            Self::Event => "worst event-time error",
            Self::Interval => "worst interval error",
            Self::Frequency => "relative error of the cycle frequency",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Torque | Self::PeakTorque | Self::TorqueAtTick | Self::PeakTorqueAtTick => "N·m",
            Self::Event | Self::Interval => "s",
            Self::Frequency => "",
        }
    }
}

impl Criterion {
    /// The error of a point.
    pub fn error(self, point: &Point) -> f64 {
        match self {
            Self::Torque => point.rms_held_torque_error_nm,
            Self::PeakTorque => point.max_held_torque_error_nm,
            Self::TorqueAtTick => point.rms_tick_torque_error_nm,
            Self::PeakTorqueAtTick => point.max_tick_torque_error_nm,
            Self::Event => point.max_event_error_s,
            Self::Interval => point.max_interval_error_s,
            Self::Frequency => point.frequency_error_rel,
        }
    }

    /// The error for comparison with a limit. An unknown torque error fails;
    /// without events there is no event error.
    pub(crate) fn judged(self, point: &Point) -> f64 {
        let error = self.error(point);
        match self {
            Self::Torque | Self::PeakTorque | Self::TorqueAtTick | Self::PeakTorqueAtTick
                if error.is_nan() =>
            {
                f64::INFINITY
            }
            Self::Event | Self::Interval | Self::Frequency if error.is_nan() => 0.0,
            _ => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_needs_are_refused_with_what_is_allowed() {
        for (text, part) in [
            ("", "empty"),
            ("torque", "KEY=VALUE"),
            ("torque=1e-3,", "KEY=VALUE"),
            (
                "speed=1",
                "torque-at-tick (rms torque error at the tick, N·m)",
            ),
            ("torque=0", "above 0, in N·m"),
            ("torque=-1", "above 0"),
            ("event=NaN", "above 0, in s"),
            ("frequency=inf", "number above 0"),
            ("torque=1,torque=2", "twice"),
        ] {
            let error = text.parse::<Need>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
        let need: Need = " torque = 5e-3 , peak-torque=1".parse().unwrap();
        assert_eq!(need.limits().len(), 2);
        assert_eq!(need.limits()[0].at_most, 5e-3);
    }
}
