//! Continuation of a motion beyond its end.

use super::Motion;
use crate::piece::{Curve, Piece};

/// Time in which a motion that ends comes to rest, s.
pub const STOP_S: f64 = 0.1;

impl Motion {
    /// This motion for ever. One that is given as pieces (velocity knots, a
    /// recording) is followed up to `end_s`, slows down evenly over [`STOP_S`],
    /// and rests from there: a recording's last piece says nothing of what
    /// comes after it. A constant velocity, a sine and strokes have no end.
    #[must_use]
    pub fn resting_after(self, end_s: f64) -> Self {
        let end = self.piece(end_s);
        let Self::Sequence(mut pieces) = self else {
            return self;
        };
        let (angle_rad, omega_rad_s) = end.angle_and_velocity(end_s);
        pieces.retain(|p| p.start_s < end_s);
        if let Some(last) = pieces.last_mut() {
            last.end_s = end_s;
        }
        let stop = Piece {
            start_s: end_s,
            end_s: end_s + STOP_S,
            jump: end.jump && end.start_s == end_s,
            curve: Curve::Polynomial([
                angle_rad,
                omega_rad_s,
                -omega_rad_s / (2.0 * STOP_S),
                0.0,
                0.0,
                0.0,
            ]),
        };
        let (rests_at_rad, _) = stop.angle_and_velocity(stop.end_s);
        pieces.push(stop);
        pieces.push(Piece {
            start_s: stop.end_s,
            end_s: f64::INFINITY,
            jump: false,
            curve: Curve::Polynomial([rests_at_rad, 0.0, 0.0, 0.0, 0.0, 0.0]),
        });
        Self::Sequence(pieces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::VelocityKnot;
    use crate::recording::CubicSegment;

    fn knot(time_s: f64, left: f64, right: f64) -> VelocityKnot {
        VelocityKnot {
            time_s,
            omega_left_rad_s: left,
            omega_right_rad_s: right,
        }
    }

    /// Angle and velocity have one value on both sides of every boundary.
    fn is_smooth(motion: &Motion) {
        let Motion::Sequence(pieces) = motion else {
            panic!("pieces were given");
        };
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].end_s, pair[1].start_s);
            let (a, b) = (pair[0].at(pair[0].end_s), pair[1].at(pair[1].start_s));
            assert!((a.phi_rad - b.phi_rad).abs() < 1e-15);
            assert!(pair[1].jump || (a.omega_rad_s - b.omega_rad_s).abs() < 1e-13);
        }
    }

    #[test]
    fn a_recording_rests_after_its_end() {
        let segments = [
            CubicSegment {
                start_s: 0.0,
                end_s: 1.0,
                c: [0.1, 0.0, 0.3, 0.0],
            },
            CubicSegment {
                start_s: 1.0,
                end_s: 2.0,
                c: [0.4, 0.6, 0.0, -0.1],
            },
        ];
        for end_s in [2.0, 1.5, 1.0, 0.3] {
            let motion = Motion::recording(&segments);
            let before = motion.at(end_s);
            let resting = motion.clone().resting_after(end_s);
            is_smooth(&resting);
            assert_eq!(resting.at(0.2), motion.at(0.2));
            assert_eq!(resting.at(end_s).omega_rad_s, before.omega_rad_s);
            let rest = resting.at(1e6);
            assert_eq!(rest.omega_rad_s, 0.0);
            let travel = 0.5 * STOP_S * before.omega_rad_s;
            assert!((rest.phi_rad - before.phi_rad - travel).abs() < 1e-15);
        }
    }

    #[test]
    fn knots_rest_even_where_they_would_go_on() {
        let motion = Motion::velocity_knots(&[knot(0.0, 0.0, 1.0), knot(1.0, 1.0, -2.0)]);
        // In the last piece, and at the jump itself.
        for (end_s, omega) in [(3.0, -2.0), (1.0, -2.0), (0.5, 1.0)] {
            let resting = motion.clone().resting_after(end_s);
            is_smooth(&resting);
            assert_eq!(resting.at(end_s).omega_rad_s, omega);
            assert!((resting.at(end_s + 0.5 * STOP_S).omega_rad_s - omega / 2.0).abs() < 1e-12);
            assert_eq!(resting.at(end_s + 1.0).omega_rad_s, 0.0);
        }
        let at_rest = Motion::velocity_knots(&[knot(0.0, 0.0, 1.0), knot(1.0, 1.0, 0.0)]);
        assert_eq!(at_rest.resting_after(1.0).at(9.0).phi_rad, 1.0);
    }

    #[test]
    fn what_has_no_end_goes_on() {
        for motion in [Motion::constant(0.3), Motion::sine(0.2, 1.0, 0.0)] {
            assert_eq!(motion.clone().resting_after(1.0), motion);
        }
    }
}
