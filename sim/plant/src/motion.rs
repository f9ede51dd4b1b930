//! The kinds of motion that a scene can prescribe.
//!
//! Every motion is a sequence of analytic [pieces](crate::piece), so angle,
//! velocity and acceleration are exact at any time and on either side of a
//! jump. Periodic motions are computed where they are asked for: no motion
//! grows with the length of the run, but a recording with its file.

mod cycle;
mod rest;

pub use cycle::Cycle;
pub use rest::STOP_S;

use crate::piece::{Curve, Piece, ShaftState};
use crate::recording::CubicSegment;

/// A peak speed of a minimum-jerk stroke is 15/8 of its mean speed.
const MINIMUM_JERK_PEAK: f64 = 1.875;

/// A prescribed motion of the shaft.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// One analytic curve for all time: a constant velocity or a sine.
    Single(Piece),
    /// Pieces one after the other; the first holds before, the last after.
    Sequence(Vec<Piece>),
    /// Minimum-jerk strokes there and back with a pause after each, repeated.
    Strokes(Strokes),
    /// Pieces that are repeated for ever.
    Cycle(Cycle),
}

/// A passive examination: from one angle to another and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strokes {
    /// Angle where it starts, rad.
    pub from_rad: f64,
    /// Angle where it turns, rad.
    pub to_rad: f64,
    /// Highest speed of each stroke, rad/s.
    pub peak_speed_rad_s: f64,
    /// Rest after each stroke, s.
    pub pause_s: f64,
}

/// A knot of a piecewise linear velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityKnot {
    /// Time, s.
    pub time_s: f64,
    /// Velocity just before, rad/s.
    pub omega_left_rad_s: f64,
    /// Velocity just after, rad/s.
    pub omega_right_rad_s: f64,
}

impl Motion {
    /// φ = Ω·t.
    pub fn constant(velocity_rad_s: f64) -> Self {
        Self::constant_from(0.0, velocity_rad_s)
    }

    /// φ = φ₀ + Ω·t.
    pub fn constant_from(angle_rad: f64, velocity_rad_s: f64) -> Self {
        Self::Single(Piece {
            start_s: 0.0,
            end_s: f64::INFINITY,
            jump: false,
            curve: Curve::Polynomial([angle_rad, velocity_rad_s, 0.0, 0.0, 0.0, 0.0]),
        })
    }

    /// φ stays where it is.
    pub fn rest(angle_rad: f64) -> Self {
        Self::constant_from(angle_rad, 0.0)
    }

    /// φ = A·sin(2π·f·t + phase).
    pub fn sine(amplitude_rad: f64, frequency_hz: f64, phase_deg: f64) -> Self {
        Self::Single(Piece {
            start_s: 0.0,
            end_s: f64::INFINITY,
            jump: false,
            curve: Curve::Sine {
                centre_rad: 0.0,
                amplitude_rad,
                frequency_hz,
                phase_turns: phase_deg / 360.0,
            },
        })
    }

    /// Velocity linear between knots, constant after the last. Knots are in
    /// the order of their times and begin at 0; see the scene reader for the
    /// checks.
    pub fn velocity_knots(knots: &[VelocityKnot]) -> Self {
        let mut phi_rad = 0.0;
        let mut pieces = Vec::with_capacity(knots.len());
        for (i, knot) in knots.iter().enumerate() {
            let (end_s, slope) = match knots.get(i + 1) {
                Some(next) => (
                    next.time_s,
                    (next.omega_left_rad_s - knot.omega_right_rad_s) / (next.time_s - knot.time_s),
                ),
                None => (f64::INFINITY, 0.0),
            };
            let piece = Piece {
                start_s: knot.time_s,
                end_s,
                jump: knot.omega_left_rad_s != knot.omega_right_rad_s,
                curve: Curve::Polynomial([
                    phi_rad,
                    knot.omega_right_rad_s,
                    slope / 2.0,
                    0.0,
                    0.0,
                    0.0,
                ]),
            };
            if end_s.is_finite() {
                phi_rad = piece.at(end_s).phi_rad;
            }
            pieces.push(piece);
        }
        Self::Sequence(pieces)
    }

    /// A smoothed recording, which goes straight on where it ends, as the
    /// spline does.
    pub fn recording(segments: &[CubicSegment]) -> Self {
        let straight_on = segments.last().map(|last| Piece {
            start_s: last.end_s,
            end_s: f64::INFINITY,
            jump: false,
            curve: Curve::Polynomial([
                last.angle_rad(last.end_s),
                last.omega_rad_s(last.end_s),
                0.0,
                0.0,
                0.0,
                0.0,
            ]),
        });
        Self::Sequence(segments.iter().map(of_segment).chain(straight_on).collect())
    }

    /// A smoothed cycle of a recording, repeated for ever.
    pub fn repeated(segments: &[CubicSegment]) -> Self {
        Self::Cycle(Cycle::new(segments.iter().map(of_segment).collect()))
    }

    /// Returns the motion about another angle: every angle is `by_rad` further.
    #[must_use]
    pub fn shifted(mut self, by_rad: f64) -> Self {
        let shift = |piece: &mut Piece| match &mut piece.curve {
            Curve::Polynomial([c0, ..]) => *c0 += by_rad,
            Curve::Sine { centre_rad, .. } => *centre_rad += by_rad,
        };
        match &mut self {
            Self::Single(piece) => shift(piece),
            Self::Sequence(pieces) => pieces.iter_mut().for_each(shift),
            Self::Strokes(strokes) => {
                strokes.from_rad += by_rad;
                strokes.to_rad += by_rad;
            }
            Self::Cycle(cycle) => cycle.pieces_mut().iter_mut().for_each(shift),
        }
        self
    }

    /// Returns whether the velocity is linear in time between the knots.
    pub fn is_parabolic(&self) -> bool {
        match self {
            Self::Single(piece) => piece.is_parabolic(),
            Self::Sequence(pieces) => pieces.iter().all(Piece::is_parabolic),
            Self::Strokes(_) | Self::Cycle(_) => false,
        }
    }

    /// The piece in which `time_s` lies; a piece begins at its first instant,
    /// so at a knot this is the piece after it. It always ends after `time_s`:
    /// who goes from piece to piece comes to every time.
    pub fn piece(&self, time_s: f64) -> Piece {
        match self {
            Self::Single(piece) => *piece,
            Self::Sequence(pieces) => {
                let after = pieces.partition_point(|p| p.start_s <= time_s);
                pieces
                    .get(after.saturating_sub(1))
                    .copied()
                    .unwrap_or(Piece {
                        start_s: 0.0,
                        end_s: f64::INFINITY,
                        jump: false,
                        curve: Curve::Polynomial([0.0; 6]),
                    })
            }
            Self::Strokes(strokes) => strokes.piece(time_s),
            Self::Cycle(cycle) => cycle.piece(time_s),
        }
    }

    /// [`Self::piece`] for a caller that goes on from piece to piece: `place` is
    /// where the last one was found, 0 to begin with, and is kept.
    pub fn piece_from(&self, time_s: f64, place: &mut usize) -> Piece {
        if let Self::Sequence(pieces) = self
            && let Some([next, after @ ..]) = pieces.get(*place + 1..)
            && next.start_s <= time_s
            && after.first().is_none_or(|after| time_s < after.start_s)
        {
            *place += 1;
            return *next;
        }
        let piece = self.piece(time_s);
        if let Self::Sequence(pieces) = self {
            *place = pieces
                .partition_point(|p| p.start_s <= time_s)
                .saturating_sub(1);
        }
        piece
    }

    /// The shaft just after `time_s`.
    pub fn at(&self, time_s: f64) -> ShaftState {
        self.piece(time_s).at(time_s)
    }
}

fn of_segment(s: &CubicSegment) -> Piece {
    Piece {
        start_s: s.start_s,
        end_s: s.end_s,
        jump: false,
        curve: Curve::Polynomial([s.c[0], s.c[1], s.c[2], s.c[3], 0.0, 0.0]),
    }
}

impl Strokes {
    /// Duration of one stroke, s.
    pub fn stroke_s(&self) -> f64 {
        MINIMUM_JERK_PEAK * (self.to_rad - self.from_rad).abs() / self.peak_speed_rad_s
    }

    fn piece(&self, time_s: f64) -> Piece {
        let stroke_s = self.stroke_s();
        let half_s = stroke_s + self.pause_s;
        let mut half = (time_s / half_s).floor().max(0.0);
        // The quotient may round across a boundary; the boundary decides.
        if time_s < half * half_s {
            half -= 1.0;
        } else if time_s >= (half + 1.0) * half_s {
            half += 1.0;
        }
        let forth = half % 2.0 == 0.0;
        let (from, to) = if forth {
            (self.from_rad, self.to_rad)
        } else {
            (self.to_rad, self.from_rad)
        };
        let (start_s, turn_s) = (half * half_s, half * half_s + stroke_s);
        let end_s = (half + 1.0) * half_s;
        if self.pause_s > 0.0 && time_s >= turn_s {
            return Piece {
                start_s: turn_s,
                end_s,
                jump: false,
                curve: Curve::Polynomial([to, 0.0, 0.0, 0.0, 0.0, 0.0]),
            };
        }
        // φ = from + Δ·(10σ³ − 15σ⁴ + 6σ⁵), σ = τ/T (Flash and Hogan 1985).
        let (d, t) = (to - from, stroke_s);
        let t3 = t * t * t;
        Piece {
            start_s,
            end_s: if self.pause_s > 0.0 { turn_s } else { end_s },
            jump: false,
            curve: Curve::Polynomial([
                from,
                0.0,
                0.0,
                10.0 * d / t3,
                -15.0 * d / (t3 * t),
                6.0 * d / (t3 * t * t),
            ]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_finds_the_same_pieces_from_anywhere() {
        let piece = |start_s: f64, end_s: f64| Piece {
            start_s,
            end_s,
            jump: false,
            curve: Curve::Polynomial([start_s, 0.0, 0.0, 0.0, 0.0, 0.0]),
        };
        let knots = [0.0, 0.0, 1.0, 1.5, 1.5, 4.0, f64::INFINITY];
        let pieces = knots.windows(2).map(|w| piece(w[0], w[1]));
        let motion = Motion::Sequence(pieces.collect());
        for from in 0..8 {
            for time_s in [0.0, 0.5, 1.0, 1.5, 2.0, 4.0, 9.0, -1.0] {
                let mut place = from;
                let found = motion.piece_from(time_s, &mut place);
                assert_eq!(found, motion.piece(time_s), "{from}, {time_s}");
                // And again, from where it was found.
                assert_eq!(motion.piece_from(time_s, &mut place), found);
            }
        }
    }

    #[test]
    fn strokes_reach_their_ends_and_their_peak_speed() {
        let motion = Motion::Strokes(Strokes {
            from_rad: 0.2,
            to_rad: 1.2,
            peak_speed_rad_s: 0.5,
            pause_s: 0.25,
        });
        let stroke_s = 3.75;
        assert!((motion.at(stroke_s / 2.0).omega_rad_s - 0.5).abs() < 1e-12);
        assert!((motion.at(stroke_s + 0.1).phi_rad - 1.2).abs() < 1e-12);
        assert!((motion.at(4.0 + stroke_s / 2.0).omega_rad_s + 0.5).abs() < 1e-12);
        assert!((motion.at(8.0).phi_rad - 0.2).abs() < 1e-12);
        for i in 0..100_000 {
            let t = f64::from(i) * 1.7e-3;
            let piece = motion.piece(t);
            assert!(piece.start_s <= t && t < piece.end_s, "{t}: {piece:?}");
            let next = motion.piece(piece.end_s);
            assert_eq!(next.start_s, piece.end_s);
            let (left, right) = (piece.at(piece.end_s), next.at(piece.end_s));
            assert!((left.phi_rad - right.phi_rad).abs() < 1e-14);
            assert!((left.omega_rad_s - right.omega_rad_s).abs() < 1e-13);
            assert!((left.omega_dot - right.omega_dot).abs() < 1e-12);
        }
    }

    #[test]
    fn strokes_without_a_pause_turn_at_once() {
        let motion = Motion::Strokes(Strokes {
            from_rad: 0.0,
            to_rad: 1.0,
            peak_speed_rad_s: 1.0,
            pause_s: 0.0,
        });
        assert_eq!(motion.piece(1.875).start_s, 1.875);
        assert!((motion.at(1.875 * 1.5).omega_rad_s + 1.0).abs() < 1e-12);
    }

    #[test]
    fn knots_keep_the_angle_and_jump_in_velocity() {
        let knot = |time_s, left, right| VelocityKnot {
            time_s,
            omega_left_rad_s: left,
            omega_right_rad_s: right,
        };
        let motion = Motion::velocity_knots(&[
            knot(0.0, 0.0, 1.0),
            knot(1.0, 2.0, -1.0),
            knot(2.0, -1.0, -1.0),
        ]);
        let before = motion.piece(0.5).at(1.0);
        let after = motion.at(1.0);
        assert_eq!((before.phi_rad, before.omega_rad_s), (1.5, 2.0));
        assert_eq!((after.phi_rad, after.omega_rad_s), (1.5, -1.0));
        assert_eq!(motion.at(5.0).phi_rad, -2.5);
    }
}
