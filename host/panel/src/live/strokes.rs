//! Strokes: the leg moves one way, and turns back.
//!
//! A stroke ends where the angle has come back by [`TURN_RAD`] from its extreme. Its speed
//! is that of the middle half of its travel, so that neither the turns nor a pause at an
//! end count:
//!
//! ```text
//! speed = (travel/2) / (time at 3/4 of the travel − time at 1/4)
//! ```

/// Return from an extreme that is a turn: more than a trembling hand, less than a stroke.
const TURN_RAD: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// Shorter movements are no strokes.
const SHORTEST_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Distance of the points that are kept, s.
const POINT_S: f64 = 0.001;

/// A movement of a minute or more is no stroke.
const MOST_POINTS: usize = 60_000;

/// A stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Time of the turn at its end, s.
    pub(crate) end_s: f64,
    /// Speed in its middle half, rad/s.
    pub(crate) speed_rad_s: f64,
}

/// Finds strokes in angles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Strokes {
    /// Time and angle since the last turn.
    points: Vec<(f64, f64)>,
    /// The extreme since the last turn: its place in `points`.
    extreme: usize,
    /// Towards growing angles; unknown before the first movement.
    is_rising: Option<bool>,
}

impl Strokes {
    /// Takes an angle, rad, at a time, s; returns the stroke that it ends.
    pub(crate) fn take(&mut self, time_s: f64, angle_rad: f64) -> Option<Stroke> {
        let is_due = (self.points.last()).is_none_or(|(last_s, _)| time_s - last_s >= POINT_S);
        if !is_due || !angle_rad.is_finite() {
            return None;
        }
        if self.points.len() >= MOST_POINTS {
            *self = Self::default();
        }
        self.points.push((time_s, angle_rad));
        let (_, first_rad) = *self.points.first()?;
        let is_rising = match self.is_rising {
            Some(is_rising) => is_rising,
            None if (angle_rad - first_rad).abs() < TURN_RAD => return None,
            None => *self.is_rising.insert(angle_rad > first_rad),
        };
        let (_, extreme_rad) = *self.points.get(self.extreme)?;
        let beyond = if is_rising {
            angle_rad - extreme_rad
        } else {
            extreme_rad - angle_rad
        };
        if beyond > 0.0 {
            self.extreme = self.points.len() - 1;
        }
        if beyond > -TURN_RAD {
            return None;
        }
        let stroke = self.stroke();
        // The next one begins at the extreme.
        self.points.drain(..self.extreme);
        self.extreme = self.points.len() - 1;
        self.is_rising = Some(!is_rising);
        stroke
    }

    /// Stroke from the last turn to the extreme.
    fn stroke(&self) -> Option<Stroke> {
        let points = self.points.get(..=self.extreme)?;
        let (&(_, from), &(end_s, to)) = (points.first()?, points.last()?);
        let travel = to - from;
        if travel.abs() < SHORTEST_RAD {
            return None;
        }
        let reached = |share: f64| {
            let done = |angle: f64| (angle - from) / travel;
            points.iter().find(|(_, angle)| done(*angle) >= share)
        };
        let (&(quarter_s, quarter), &(three_s, three)) = (reached(0.25)?, reached(0.75)?);
        let speed_rad_s = ((three - quarter) / (three_s - quarter_s)).abs();
        Some(Stroke { end_s, speed_rad_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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
            assert!(error.abs() < 0.01, "{error}");
            assert!((stroke.end_s - f64::from(turn)).abs() < 0.01);
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
            assert!((stroke.speed_rad_s.to_degrees() / 30.0 - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn trembling_is_no_stroke() {
        assert_eq!(strokes(5.0, |t| 2.0 * (50.0 * t).sin()), []);
        assert_eq!(strokes(5.0, |t| 4.0 * (5.0 * t).sin()), []);
        // On a stroke it does not end it.
        let found = strokes(11.0, |t| with_pauses(t) + (80.0 * t).sin());
        assert!((3..=4).contains(&found.len()), "{}", found.len());
    }

    #[test]
    fn an_hour_of_rest_takes_no_memory() {
        let mut strokes = Strokes::default();
        for n in 0..200_000 {
            strokes.take(f64::from(n) * 0.0011, 0.5);
        }
        assert!(strokes.points.len() <= MOST_POINTS);
    }
}
