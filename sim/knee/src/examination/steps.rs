//! Steps of an examination, and their ticks.
//!
//! | step | what the examiner does | ticked |
//! |---|---|---|
//! | slow | moves slowly to both ends | a stroke of 40° or more each way, below 65 °/s |
//! | fast | stretches fast | the leg came to 90 °/s |
//! | hold | stretches fast, and holds | then it stayed within 5° for a second |
//! | drop | lets the leg fall, and catches it | a stroke in flexion from the first 50°, at 95 to 180 °/s, as V2 of Tardieu |
//!
//! Sources: V1, V2 and V3 of the modified Tardieu scale (Boyd and Graham 1999); the limits are estimates.

use super::FAST_RAD_S;
use super::means::Motion;
use super::strokes::Stroke;
use core::f64::consts::PI;

crepitus_model::named! {
    /// A step of an examination.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Step {
        /// Slowly to both ends.
        Slow => "slow",
        /// Fast.
        Fast => "fast",
        /// Fast, and held.
        Hold => "hold",
        /// Let fall, and caught.
        Drop => "drop",
    }
}

/// Travel of a slow stroke, rad.
const SLOW_TRAVEL_RAD: f64 = 40.0 * PI / 180.0;

/// Speed of the step `fast`, rad/s.
const STRETCH_RAD_S: f64 = 90.0 * PI / 180.0;

/// Angle within which a leg is held, rad, and the time, s.
const HELD_RAD: f64 = 5.0 * PI / 180.0;
const HELD_S: f64 = 1.0;

/// Speed at which a fast stretch has come to its hold, rad/s.
const STILL_RAD_S: f64 = 20.0 * PI / 180.0;

/// Speeds of a fall, °/s, and the angle from which it begins at the latest, °.
const FALL_DEG_S: core::ops::RangeInclusive<f64> = 95.0..=180.0;
const FALL_FROM_DEG: f64 = 50.0;

/// Ticks of the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    /// Slow to the end: extension, flexion.
    slow: [bool; 2],
    fast: bool,
    hold: bool,
    drop: bool,
    holding: Holding,
}

/// Course of the step `hold`.
#[derive(Clone, Copy, Debug, Default)]
enum Holding {
    /// No fast stretch before.
    #[default]
    Not,
    /// The leg is being stretched.
    Stretched,
    /// Angle at which the leg is held, and time since when, rad and s.
    Held(f64, f64),
}

impl Steps {
    /// Returns whether a step was done.
    pub(super) fn has(&self, step: Step) -> bool {
        match step {
            Step::Slow => self.slow == [true; 2],
            Step::Fast => self.fast,
            Step::Hold => self.hold,
            Step::Drop => self.drop,
        }
    }

    /// Samples are missing.
    pub(super) fn pause(&mut self) {
        self.holding = Holding::Not;
    }

    /// Takes a stroke that has ended.
    pub(super) fn stroke(&mut self, stroke: &Stroke) {
        let is_flexion = stroke.sense() > 0.0;
        let travel_rad = (stroke.to_rad - stroke.from_rad).abs();
        if travel_rad >= SLOW_TRAVEL_RAD && stroke.speed_rad_s < FAST_RAD_S {
            let [extension, flexion] = &mut self.slow;
            *(if is_flexion { flexion } else { extension }) = true;
        }
        let falls = FALL_DEG_S.contains(&stroke.speed_rad_s.to_degrees());
        let is_straight = stroke.from_rad.to_degrees() <= FALL_FROM_DEG;
        self.drop |= is_flexion && falls && is_straight;
    }

    /// Takes the motion of the last 20 ms.
    pub(super) fn motion(&mut self, motion: &Motion) {
        let speed_rad_s = motion.speed_rad_s.abs();
        self.fast |= speed_rad_s >= STRETCH_RAD_S;
        self.holding = match self.holding {
            _ if speed_rad_s >= FAST_RAD_S => Holding::Stretched,
            Holding::Stretched if speed_rad_s < STILL_RAD_S => {
                Holding::Held(motion.angle_rad, motion.time_s)
            }
            Holding::Held(at_rad, since_s) => {
                if (motion.angle_rad - at_rad).abs() > HELD_RAD {
                    Holding::Not
                } else {
                    self.hold |= motion.time_s - since_s >= HELD_S;
                    Holding::Held(at_rad, since_s)
                }
            }
            other => other,
        };
    }
}
