//! Movements of a leg that end at rest, for whole ticks.

use super::TICK_S;
use crepitus_plant::Motion;
use crepitus_plant::chain::Body;
use crepitus_plant::motion::{STOP_S, Strokes};
use crepitus_plant::piece::{Curve, Piece};

/// A minimum-jerk movement to an angle, and a rest there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Movement {
    /// Angle at its end, rad.
    pub(super) to_rad: f64,
    /// Highest speed, rad/s.
    pub(super) peak_rad_s: f64,
    /// Rest after it, s.
    pub(super) rest_s: f64,
}

impl Movement {
    /// A movement of these degrees.
    pub(super) fn new(to_deg: f64, peak_deg_s: f64, rest_s: f64) -> Self {
        Self {
            to_rad: to_deg.to_radians(),
            peak_rad_s: peak_deg_s.to_radians(),
            rest_s,
        }
    }

    /// The motion from an angle at which the leg rests, and the ticks in which it is over.
    pub(super) fn motion(&self, from_rad: f64) -> (Motion, u32) {
        let rest_ticks = whole_ticks(self.rest_s);
        if from_rad == self.to_rad {
            return (Motion::rest(from_rad), rest_ticks);
        }
        let (piece, ticks) = stroke(from_rad, self.to_rad, self.peak_rad_s);
        let motion = Motion::Sequence(vec![piece, rest(piece.end_s, self.to_rad)]);
        (motion, ticks + rest_ticks)
    }
}

/// Rest at an angle from a time on.
pub(super) fn rest(start_s: f64, angle_rad: f64) -> Piece {
    Piece {
        start_s,
        end_s: f64::INFINITY,
        jump: false,
        curve: Curve::Polynomial([angle_rad, 0.0, 0.0, 0.0, 0.0, 0.0]),
    }
}

/// A piece in which a leg slows down evenly to rest, its length in ticks, and the angle at which it rests, rad.
pub(super) fn stop(now: Body) -> (Piece, u32, f64) {
    let [angle_rad, omega_rad_s] = [now.angle_rad, now.omega_rad_s];
    let ticks = whole_ticks(STOP_S);
    let end_s = f64::from(ticks) * TICK_S;
    let half_slope = -omega_rad_s / (2.0 * end_s);
    let piece = Piece {
        start_s: 0.0,
        end_s,
        jump: false,
        curve: Curve::Polynomial([angle_rad, omega_rad_s, half_slope, 0.0, 0.0, 0.0]),
    };
    let (rests_at_rad, _) = piece.angle_and_velocity(end_s);
    (piece, ticks, rests_at_rad)
}

/// A minimum-jerk stroke from one angle to another, which are different, and its length in ticks.
pub(super) fn stroke(from_rad: f64, to_rad: f64, peak_speed_rad_s: f64) -> (Piece, u32) {
    let stroke = Strokes {
        from_rad,
        to_rad,
        peak_speed_rad_s,
        pause_s: 0.0,
    };
    let ticks = whole_ticks(stroke.stroke_s());
    let stroke_s = f64::from(ticks) * TICK_S;
    // φ = Δ·(10σ³ − 15σ⁴ + 6σ⁵), as a stroke of a scene, but for whole ticks.
    let (travel, cube) = (to_rad - from_rad, stroke_s * stroke_s * stroke_s);
    let piece = Piece {
        start_s: 0.0,
        end_s: stroke_s,
        jump: false,
        curve: Curve::Polynomial([
            from_rad,
            0.0,
            0.0,
            10.0 * travel / cube,
            -15.0 * travel / (cube * stroke_s),
            6.0 * travel / (cube * stroke_s * stroke_s),
        ]),
    };
    (piece, ticks)
}

/// The ticks in which a time is over, at least one.
pub(super) fn whole_ticks(seconds: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast from float saturates, and no time is negative"
    )]
    let ticks = (seconds / TICK_S - 1e-6).ceil() as u32;
    ticks.max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_movement_begins_and_ends_at_rest_and_keeps_its_speed() {
        for (from_deg, to_deg) in [(10.0, 112.0), (112.0, 10.0), (30.0, 28.5)] {
            let from_rad = f64::to_radians(from_deg);
            let movement = Movement::new(to_deg, 90.0, 0.2);
            let (motion, ticks) = movement.motion(from_rad);
            let at = |tick: u32| motion.at(f64::from(tick) * TICK_S);
            assert_eq!((at(0).phi_rad, at(0).omega_rad_s), (from_rad, 0.0));
            let end = at(ticks);
            assert_eq!((end.phi_rad, end.omega_rad_s), (movement.to_rad, 0.0));
            assert_eq!(at(ticks - 3_990).omega_rad_s, 0.0, "it rests for 0.2 s");
            let fastest = (0..ticks).map(|tick| at(tick).omega_rad_s.abs());
            let fastest = fastest.fold(0.0, f64::max).to_degrees();
            assert!((fastest - 90.0).abs() < 0.1, "{fastest}");
        }
        let (motion, ticks) = Movement::new(10.0, 60.0, 0.3).motion(10_f64.to_radians());
        assert_eq!((motion, ticks), (Motion::rest(10_f64.to_radians()), 6_000));
    }
}
