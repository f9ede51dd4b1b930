//! Strokes: the leg moves one way, and turns back.
//!
//! A stroke ends where the angle has come back by 3° from its extreme. Its speed is that of the middle
//! half of its travel, so that neither the turns nor a pause at an end count:
//!
//! ```text
//! speed = (travel/2) / (time at 3/4 of the travel − time at 1/4)
//! ```
//!
//! **Steadiness** is the coefficient of variation of the speed there, as of a force or a position that
//! is held (Enoka et al. 2003). **Smoothness** is the logarithm of the dimensionless jerk, from 5 to
//! 95 % of the travel (Balasubramanian et al., *On the analysis of movement smoothness*, J NeuroEng
//! Rehabil 12:112, 2015):
//!
//! ```text
//! smoothness = −ln(T³/v² · ∫ j² dt)      v the highest speed; of a minimum-jerk stroke −2.9
//! ```

use super::passages::Passages;
use core::f64::consts::PI;
use core::mem::swap;

/// Return from an extreme that is a turn: more than a trembling hand, less than a stroke.
const TURN_RAD: f64 = 3.0 * PI / 180.0;

/// Shorter movements are no strokes.
const SHORTEST_RAD: f64 = 10.0 * PI / 180.0;

/// No joint turns further: such an angle is an error.
pub(super) const MOST_RAD: f64 = 100.0;

/// A stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Time of the turn at its end, s.
    pub end_s: f64,
    /// Angle at which it began, rad.
    pub from_rad: f64,
    /// Angle at which it turned, rad.
    pub to_rad: f64,
    /// Speed in its middle half, rad/s.
    pub speed_rad_s: f64,
    /// Standard deviation of the speed in its middle half, as a share of its mean.
    pub unsteadiness: f64,
    /// −ln of its dimensionless jerk, as far as the jerk is known.
    pub smoothness: Option<f64>,
}

impl Stroke {
    /// Sense of the stroke: 1 in flexion, −1 in extension.
    pub fn sense(&self) -> f64 {
        (self.to_rad - self.from_rad).signum()
    }
}

/// Way of the leg since its last turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// 1 in flexion, −1 in extension.
    pub(super) sense: f64,
    /// Distance from the angle at which it began, rad.
    pub(super) along_rad: f64,
}

/// Finds strokes in angles.
#[derive(Clone, Debug)]
pub struct Strokes {
    forth: Passages,
    /// From the extreme back; before the first movement, the other way from the first angle.
    back: Passages,
    sense: Sense,
    /// Extreme since the last turn: time and angle, s and rad.
    extreme: (f64, f64),
}

/// Sense of the movement.
#[derive(Clone, Copy, Debug)]
enum Sense {
    /// There was no sample yet.
    None,
    /// The leg has not moved yet.
    Unknown,
    /// 1 in flexion, −1 in extension.
    Known(f64),
}

impl Default for Strokes {
    fn default() -> Self {
        Self {
            forth: Passages::new(),
            back: Passages::new(),
            sense: Sense::None,
            extreme: (0.0, 0.0),
        }
    }
}

impl Strokes {
    /// Takes an angle, rad, at a time, s; returns the stroke that it ends. Times grow.
    pub fn take(&mut self, time_s: f64, angle_rad: f64) -> Option<Stroke> {
        // NaN, too.
        if !(angle_rad.abs() <= MOST_RAD && time_s.is_finite()) {
            return None;
        }
        match self.sense {
            Sense::None => {
                self.sense = Sense::Unknown;
                self.forth.begin(time_s, angle_rad, 1.0);
                self.back.begin(time_s, angle_rad, -1.0);
                None
            }
            Sense::Unknown => {
                self.look_for_movement(time_s, angle_rad);
                None
            }
            Sense::Known(sense) => self.follow(sense, time_s, angle_rad),
        }
    }

    /// Forgets the stroke under way.
    pub(super) fn restart(&mut self) {
        self.sense = Sense::None;
    }

    /// Takes the square of a jerk that lasted at an angle, rad²/s⁵.
    pub(super) fn add_jerk(&mut self, angle_rad: f64, squared: f64) {
        self.forth.add_jerk(angle_rad, squared);
        self.back.add_jerk(angle_rad, squared);
    }

    /// Way since the last turn, once there is a movement.
    pub(super) fn way(&self) -> Option<Way> {
        match self.sense {
            Sense::Known(sense) => Some(Way {
                sense,
                along_rad: self.forth.along_rad(),
            }),
            _ => None,
        }
    }

    fn look_for_movement(&mut self, time_s: f64, angle_rad: f64) {
        self.forth.take(time_s, angle_rad);
        self.back.take(time_s, angle_rad);
        let sense = if self.forth.along_rad() >= TURN_RAD {
            1.0
        } else if self.back.along_rad() >= TURN_RAD {
            swap(&mut self.forth, &mut self.back);
            -1.0
        } else {
            return;
        };
        self.sense = Sense::Known(sense);
        self.reach(sense, time_s, angle_rad);
    }

    fn follow(&mut self, sense: f64, time_s: f64, angle_rad: f64) -> Option<Stroke> {
        self.forth.take(time_s, angle_rad);
        if sense * (angle_rad - self.extreme.1) > 0.0 {
            self.reach(sense, time_s, angle_rad);
            return None;
        }
        self.back.take(time_s, angle_rad);
        if self.back.along_rad() < TURN_RAD {
            return None;
        }
        let stroke = self.stroke();
        // The next one has begun at the extreme.
        swap(&mut self.forth, &mut self.back);
        self.sense = Sense::Known(-sense);
        self.reach(-sense, time_s, angle_rad);
        stroke
    }

    /// A new extreme.
    fn reach(&mut self, sense: f64, time_s: f64, angle_rad: f64) {
        self.extreme = (time_s, angle_rad);
        self.back.begin(time_s, angle_rad, -sense);
    }

    /// Stroke from the last turn to the extreme.
    fn stroke(&self) -> Option<Stroke> {
        let (end_s, to_rad) = self.extreme;
        let from_rad = self.forth.start_rad();
        let travel_rad = (to_rad - from_rad).abs();
        if travel_rad < SHORTEST_RAD {
            return None;
        }
        let shape = self.forth.shape(travel_rad)?;
        Some(Stroke {
            end_s,
            from_rad,
            to_rad,
            speed_rad_s: shape.speed_rad_s,
            unsteadiness: shape.unsteadiness,
            smoothness: shape.smoothness,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn strokes(seconds: f64, angle_deg: impl Fn(f64) -> f64) -> Vec<Stroke> {
        let mut strokes = Strokes::default();
        let ticks = (0..).map(|tick| f64::from(tick) * 5e-5);
        ticks
            .take_while(|time| *time < seconds)
            .filter_map(|time| strokes.take(time, angle_deg(time).to_radians()))
            .collect()
    }

    /// The middle half of a sine of amplitude A and angular frequency w: from −A/2 to A/2,
    /// in 2·asin(1/2)/w.
    #[test]
    fn a_sine_has_the_speed_of_its_middle() {
        let found = strokes(10.0, |t| 45.0 - 40.0 * (PI * t).cos());
        assert!(found.len() >= 8, "{}", found.len());
        let expected = 40.0_f64.to_radians() / (PI / 3.0 / PI);
        for (stroke, turn) in found.iter().zip(1..) {
            let error = stroke.speed_rad_s / expected - 1.0;
            assert!(error.abs() < 0.002, "{error}");
            assert!((stroke.end_s - f64::from(turn)).abs() < 0.001);
            assert!((stroke.from_rad - stroke.to_rad).abs() > 79.9_f64.to_radians());
        }
    }

    /// There and back at 30 °/s with a pause of half a second at each end.
    fn with_pauses(t: f64) -> f64 {
        let t = t % 5.0;
        match t {
            t if t < 2.0 => 30.0 * t,
            t if t < 2.5 => 60.0,
            t if t < 4.5 => 60.0 - 30.0 * (t - 2.5),
            _ => 0.0,
        }
    }

    #[test]
    fn a_pause_at_an_end_does_not_count() {
        let found = strokes(11.0, with_pauses);
        assert!(found.len() >= 3);
        for stroke in found {
            assert!((stroke.speed_rad_s.to_degrees() / 30.0 - 1.0).abs() < 0.001);
            assert!(stroke.unsteadiness < 0.01, "{}", stroke.unsteadiness);
        }
    }

    #[test]
    fn trembling_is_no_stroke() {
        assert_eq!(strokes(5.0, |t| 2.0 * (50.0 * t).sin()), []);
        assert_eq!(strokes(5.0, |t| 4.0 * (5.0 * t).sin()), []);
        // On a stroke it does not end it.
        let found = strokes(11.0, |t| with_pauses(t) + (80.0 * t).sin());
        assert!((3..=4).contains(&found.len()), "{}", found.len());
        assert!(found.iter().all(|stroke| stroke.unsteadiness > 0.1));
    }

    /// The speed of a knee that a hand stops halfway.
    #[test]
    fn a_stop_in_the_middle_is_slow_and_unsteady() {
        let stopped = |t: f64| match t {
            t if t < 1.0 => 30.0 * t,
            t if t < 2.0 => 30.0,
            t if t < 3.0 => 30.0 * (t - 1.0),
            t => 60.0 - 30.0 * (t - 3.0),
        };
        let found = strokes(4.0, stopped);
        assert_eq!(found.len(), 1);
        assert!((found[0].speed_rad_s.to_degrees() - 15.0).abs() < 0.1);
        let unsteadiness = found[0].unsteadiness;
        assert!((unsteadiness - 1.0).abs() < 0.05, "{unsteadiness}");
    }

    #[test]
    fn a_long_rest_and_angles_that_are_none_leave_no_trace() {
        let mut strokes = Strokes::default();
        for n in 0..200_000 {
            assert_eq!(strokes.take(f64::from(n) * 0.0011, 0.5), None);
        }
        for angle_rad in [f64::NAN, f64::INFINITY, 1e9] {
            assert_eq!(strokes.take(230.0, angle_rad), None);
        }
        let stroke = (0..2_000).find_map(|n| {
            let time_s = f64::from(n) * 1e-3;
            let angle_rad = if n < 1_000 { time_s } else { 2.0 - time_s };
            strokes.take(231.0 + time_s, 0.5 + angle_rad)
        });
        assert!((stroke.unwrap().speed_rad_s - 1.0).abs() < 1e-3);
    }
}
