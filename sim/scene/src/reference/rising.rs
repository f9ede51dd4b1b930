//! Break of a stick while the shaft surely goes one way: the root of a cubic.
//!
//! A time u after the start, the shaft has travelled, in its own sense,
//!
//! ```text
//! d(u) = v·u + a·u²/2 + b·u³/6 + R     |R| ≤ M·u⁴/24,  M ≥ |d³Ω/dt³|
//! ```
//!
//! Two bounds of it decide most sticks. Where the sizes of the terms do not add up to the nearer
//! limit, none is reached. Where v is larger than all that the other terms can take from it, d
//! grows: it has one root at most, and Halley's rule finds it from that of the parabola in one or
//! two looks at the motion. What is left, at a turn of the shaft or within rounding of a limit, is for
//! the search that cannot miss a root (`first_root`).

use super::Reference;
use crepitus_model::Sense;
use crepitus_plant::ShaftState;

/// The most looks at the motion; nearly always it is one.
const MOST_LOOKS: u32 = 4;

/// Share of the velocity at the start that has to be left where the travel counts as growing.
const LEAST_SPEED: f64 = 1.0 / 64.0;

/// Error of a root that may be left, relative to its time.
const RESOLUTION: f64 = 0.25 * f64::EPSILON;

/// Answer about the break of a stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// No break.
    None,
    /// Time of the break, s, and its sense.
    Break(f64, Sense),
    /// The bounds do not tell.
    Unknown,
}

/// Terms of the travel from the start of a search on.
#[derive(Clone, Copy, Debug)]
struct Travel {
    sense: Sense,
    /// v = |Ω|, rad/s.
    speed: f64,
    /// a = s·Ω̇, rad/s².
    acceleration: f64,
    /// b = s·Ω̈, rad/s³.
    jerk: f64,
    /// M, rad/s⁴.
    snap: f64,
}

impl Travel {
    fn new(shaft: &ShaftState, snap: f64) -> Self {
        let sense = if shaft.omega_rad_s < 0.0 {
            Sense::Negative
        } else {
            Sense::Positive
        };
        Self {
            sense,
            speed: shaft.omega_rad_s.abs(),
            acceleration: sense.of_signed(shaft.omega_dot),
            jerk: sense.of_signed(shaft.omega_ddot),
            snap,
        }
    }

    /// A bound of |d| up to `u`, rad.
    fn reach(&self, u: f64) -> f64 {
        let curved = 0.5 * self.acceleration.abs()
            + u * (self.jerk.abs() * (1.0 / 6.0) + u * (self.snap * (1.0 / 24.0)));
        u * (self.speed + u * curved)
    }

    /// A bound of the velocity from below up to `u`, rad/s.
    fn least_speed(&self, u: f64) -> f64 {
        let taken = self.acceleration.min(0.0)
            + u * (0.5 * self.jerk.min(0.0) - u * (self.snap * (1.0 / 6.0)));
        self.speed + u * taken
    }

    /// The u at which the parabola has travelled `way`; no number where it never has.
    fn of_parabola(&self, way: f64) -> f64 {
        let square = self.speed * self.speed + 2.0 * self.acceleration * way;
        2.0 * way / (self.speed + square.sqrt())
    }
}

impl Reference<'_> {
    /// The break of a stick between two times of the piece, where the torque of the spring alone
    /// decides on it; `shaft` and `torque_nm` are those at the first time.
    pub(super) fn surely_breaks(
        &self,
        (theta, phi): (f64, f64),
        (from_s, to_s): (f64, f64),
        shaft: &ShaftState,
        torque_nm: f64,
    ) -> Answer {
        let p = &self.settings.parameters;
        let (kr, limit_nm) = (p.stiffness_nm_per_rad, p.static_torque_nm);
        let slack_nm = self.limit_slack_nm(shaft);
        let room_nm = limit_nm - torque_nm.abs() - slack_nm;
        if room_nm.is_nan() || room_nm <= 0.0 {
            return Answer::Unknown;
        }
        let travel = Travel::new(shaft, self.snap_bound);
        let span_s = to_s - from_s;
        if kr * travel.reach(span_s) < room_nm {
            return Answer::None;
        }
        let sense = travel.sense;
        let left_nm =
            |at: &ShaftState| limit_nm - sense.of_signed(kr * (theta + (at.phi_rad - phi)));
        let u = travel.of_parabola((limit_nm - sense.of_signed(torque_nm)) / kr);
        if u >= span_s {
            let is_below = left_nm(&self.piece.at(to_s)) > 2.0 * slack_nm;
            return if is_below && travel.least_speed(span_s) > LEAST_SPEED * travel.speed {
                Answer::None
            } else {
                Answer::Unknown
            };
        }
        let mut time_s = from_s + u;
        let mut farthest_s = u;
        for _ in 0..MOST_LOOKS {
            let at = self.piece.at(time_s);
            let way = left_nm(&at) / kr;
            let (v, a) = (sense.of_signed(at.omega_rad_s), at.omega_dot);
            let a = sense.of_signed(a);
            let step_s = way * v / (v * v + 0.5 * way * a);
            time_s += step_s;
            farthest_s = farthest_s.max(time_s - from_s);
            // Halley's rule leaves step³·(a²/4v² − b/6v).
            let error = step_s.abs().powi(3) * (3.0 * a * a + 2.0 * v * at.omega_ddot.abs());
            if error <= 12.0 * v * v * RESOLUTION * time_s {
                let is_within = time_s > from_s && time_s < to_s;
                let grows = travel.least_speed(farthest_s) > LEAST_SPEED * travel.speed;
                return if is_within && grows {
                    Answer::Break(time_s, sense)
                } else {
                    Answer::Unknown
                };
            }
        }
        Answer::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::{Convention, Settings};
    use crepitus_plant::Motion;
    use crepitus_plant::piece::{Curve, Piece};
    use fastrand::Rng;
    use std::ops::ControlFlow;

    /// A piece whose velocity may turn within it.
    fn piece(random: &mut Rng) -> Piece {
        let mut number = |size: f64| size * (2.0 * random.f64() - 1.0);
        let [c1, c2, c3, c4, c5] = [2.0, 4.0, 10.0, 30.0, 60.0].map(&mut number);
        let (amplitude_rad, phase_turns) = (number(0.8), number(1.0));
        let frequency_hz = 0.1 + number(1.0).abs();
        let curve = match random.usize(..3) {
            0 => Curve::Sine {
                centre_rad: 0.4,
                amplitude_rad,
                frequency_hz,
                phase_turns,
            },
            1 => Curve::Polynomial([0.3, c1, c2, c3, 0.0, 0.0]),
            _ => Curve::Polynomial([0.3, c1, c2, c3, c4, c5]),
        };
        Piece {
            start_s: 0.0,
            end_s: 0.02 + random.f64(),
            jump: false,
            curve,
        }
    }

    #[test]
    fn the_least_speed_is_below_that_of_every_motion_within_the_bounds() {
        let mut random = Rng::with_seed(581);
        for _ in 0..2_000 {
            let mut signed = |size: f64| size * (2.0 * random.f64() - 1.0);
            let travel = Travel {
                sense: Sense::Positive,
                speed: signed(1.0).abs(),
                acceleration: signed(20.0),
                jerk: signed(400.0),
                snap: signed(4e4).abs(),
            };
            let (end, third) = (signed(0.1).abs(), signed(travel.snap));
            for n in 0..=50 {
                let u = end * f64::from(n) / 50.0;
                let speed = travel.speed
                    + u * (travel.acceleration + u * (0.5 * travel.jerk + u * third / 6.0));
                let least = travel.least_speed(end);
                assert!(
                    least <= speed + 1e-12,
                    "{travel:?} at {u}: {least} > {speed}"
                );
            }
        }
    }

    #[test]
    fn a_sure_answer_is_that_of_the_search() {
        let mut random = Rng::with_seed(58);
        let settings = Settings {
            convention: Convention::Frozen,
            ..Settings::default()
        };
        let settings = settings.validate().unwrap();
        let limit_rad =
            settings.parameters.static_torque_nm / settings.parameters.stiffness_nm_per_rad;
        // Of sticks that break, that do not, and that the bounds do not tell.
        let mut counts = [0; 3];
        for case in 0..20_000 {
            let motion = Motion::Single(piece(&mut random));
            let reference = Reference::new(&settings, &motion);
            let piece = reference.piece;
            let from_s = piece.end_s * random.f64() * random.f64();
            let shaft: ShaftState = piece.at(from_s);
            let share = (2.0 * random.f64() - 1.0) * [1.0, 1.0 - 1e-9, 1.0][random.usize(..3)];
            let anchor = (share * limit_rad, shaft.phi_rad);
            let torque_nm = settings.parameters.stiffness_nm_per_rad * anchor.0;
            // Some are too short for a break.
            let span_s = (
                from_s,
                from_s + (piece.end_s - from_s) * random.f64().powi(4),
            );
            let answer = reference.surely_breaks(anchor, span_s, &shaft, torque_nm);
            let ahead = Travel::new(&shaft, 0.0).sense;
            let mut proceed = || ControlFlow::<()>::Continue(());
            let searched =
                match reference.search_limit(anchor, span_s, (ahead, false), &mut proceed) {
                    ControlFlow::Continue(found) => found,
                    ControlFlow::Break(()) => None,
                };
            match answer {
                Answer::Unknown => counts[2] += 1,
                Answer::None => {
                    counts[1] += 1;
                    assert_eq!(searched, None, "{case}: {piece:?} from {from_s}");
                }
                Answer::Break(time_s, sense) => {
                    counts[0] += 1;
                    let (found_s, found) = searched.expect("a break");
                    // What rounding of the angle makes of the time.
                    let slow = piece.at(time_s).omega_rad_s.abs();
                    let apart_s = (found_s - time_s).abs();
                    assert!(
                        found == sense && apart_s <= 1e-14 + 2e-15 / slow,
                        "{case}: {time_s} {found_s} {apart_s:e}, {piece:?} from {from_s}"
                    );
                }
            }
        }
        assert!(
            counts[0] > 5000 && counts[1] > 500 && counts[2] < 5000,
            "{counts:?}"
        );
    }
}
