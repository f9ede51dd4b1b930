//! A motion of the hand, in degrees of the joint.

use crate::stability::text::{Knots, Plain, Time};
use crepitus_plant::Motion;
use crepitus_plant::motion::{Strokes, VelocityKnot};
use crepitus_plant::piece::{Curve, Piece};
use fastrand::Rng;
use std::fmt;

/// A prescribed motion of the joint.
#[derive(Clone, Debug, PartialEq)]
pub enum Hand {
    /// Motion at one velocity.
    Constant {
        /// Angle at the start, deg.
        from_deg: f64,
        /// Velocity, deg/s.
        deg_s: f64,
    },
    /// Velocity linear between knots: time s, Ω just before and just after it,
    /// deg/s.
    Knots {
        /// Angle at the start, deg.
        from_deg: f64,
        /// The knots.
        knots: Vec<(f64, f64, f64)>,
    },
    /// φ = φ₀ + A·sin(2π·f·t).
    Sine {
        /// φ₀, deg.
        centre_deg: f64,
        /// A, deg.
        amplitude_deg: f64,
        /// f, Hz.
        frequency_hz: f64,
    },
    /// Motion at one velocity to an angle, and from then on trembling about it.
    Tremble {
        /// Angle at the start, deg.
        from_deg: f64,
        /// Velocity, deg/s.
        deg_s: f64,
        /// Angle about which it trembles, deg.
        at_deg: f64,
        /// Amplitude of the tremor to either side, deg.
        by_deg: f64,
        /// Frequency of the tremor, Hz.
        frequency_hz: f64,
    },
    /// Wandering about an angle, at velocities that are linear between random ones.
    Wander {
        /// The angle, deg.
        about_deg: f64,
        /// The largest of the random velocities, deg/s.
        deg_s: f64,
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Minimum-jerk strokes there and back, with a pause after each.
    Strokes {
        /// Angle where it starts, deg.
        from_deg: f64,
        /// Angle where it turns, deg.
        to_deg: f64,
        /// Highest speed, deg/s.
        deg_s: f64,
        /// Rest after each stroke, s.
        pause_s: f64,
    },
}

impl Hand {
    /// A velocity that jumps at each of these times: s, deg/s from then on.
    pub fn jumps(from_deg: f64, speeds: &[(f64, f64)]) -> Self {
        let mut last = speeds.first().map_or(0.0, |(_, deg_s)| *deg_s);
        let knots = speeds
            .iter()
            .map(|&(time_s, deg_s)| (time_s, std::mem::replace(&mut last, deg_s), deg_s))
            .collect();
        Self::Knots { from_deg, knots }
    }

    /// A velocity that is linear between these: s, deg/s.
    pub fn ramps(from_deg: f64, speeds: &[(f64, f64)]) -> Self {
        Self::Knots {
            from_deg,
            knots: speeds.iter().map(|&(t, deg_s)| (t, deg_s, deg_s)).collect(),
        }
    }

    /// The motion itself.
    pub fn motion(&self) -> Motion {
        match self {
            Self::Constant { from_deg, deg_s } => {
                Motion::constant_from(from_deg.to_radians(), deg_s.to_radians())
            }
            Self::Knots { from_deg, knots } => {
                let knots: Vec<_> = knots
                    .iter()
                    .map(|&(time_s, left, right)| VelocityKnot {
                        time_s,
                        omega_left_rad_s: left.to_radians(),
                        omega_right_rad_s: right.to_radians(),
                    })
                    .collect();
                Motion::velocity_knots(&knots).shifted(from_deg.to_radians())
            }
            Self::Sine {
                centre_deg,
                amplitude_deg,
                frequency_hz,
            } => Motion::sine(amplitude_deg.to_radians(), *frequency_hz, 0.0)
                .shifted(centre_deg.to_radians()),
            Self::Tremble {
                from_deg,
                deg_s,
                at_deg,
                by_deg,
                frequency_hz,
            } => {
                let until_s = (at_deg - from_deg) / deg_s;
                let (from, at) = (from_deg.to_radians(), at_deg.to_radians());
                let approach = [from, deg_s.to_radians(), 0.0, 0.0, 0.0, 0.0];
                Motion::Sequence(vec![
                    Piece {
                        start_s: 0.0,
                        end_s: until_s,
                        jump: false,
                        curve: Curve::Polynomial(approach),
                    },
                    Piece {
                        start_s: until_s,
                        end_s: f64::INFINITY,
                        jump: true,
                        curve: Curve::Sine {
                            centre_rad: at,
                            amplitude_rad: by_deg.to_radians(),
                            frequency_hz: *frequency_hz,
                            phase_turns: -frequency_hz * until_s,
                        },
                    },
                ])
            }
            Self::Wander {
                about_deg,
                deg_s,
                seed,
            } => wander(*about_deg, *deg_s, *seed),
            Self::Strokes {
                from_deg,
                to_deg,
                deg_s,
                pause_s,
            } => Motion::Strokes(Strokes {
                from_rad: from_deg.to_radians(),
                to_rad: to_deg.to_radians(),
                peak_speed_rad_s: deg_s.to_radians(),
                pause_s: *pause_s,
            }),
        }
    }
}

/// Motion that wanders for four seconds and then rests.
fn wander(about_deg: f64, deg_s: f64, seed: u64) -> Motion {
    const END_S: f64 = 4.0;
    /// Rate at which it comes back to the middle, 1/s.
    const RETURN_HZ: f64 = 3.0;
    let mut random = Rng::with_seed(seed);
    let (mut time_s, mut angle_deg, mut speed) = (0.0, about_deg, 0.0);
    let mut knots = vec![(0.0, 0.0, 0.0)];
    while time_s < END_S {
        let length_s = 0.01 + 0.1 * random.f64();
        let next = deg_s * (2.0 * random.f64() - 1.0) - RETURN_HZ * (angle_deg - about_deg);
        angle_deg += 0.5 * (speed + next) * length_s;
        time_s += length_s;
        speed = next;
        knots.push((time_s, speed, speed));
    }
    knots.push((time_s + 0.1, 0.0, 0.0));
    let from_deg = about_deg;
    Hand::Knots { from_deg, knots }.motion()
}

impl fmt::Display for Hand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant { from_deg, deg_s } => {
                write!(f, "from {}° at {} deg/s", Plain(*from_deg), Plain(*deg_s))
            }
            Self::Knots { from_deg, knots } => {
                let (from, knots) = (Plain(*from_deg), Knots(knots));
                write!(f, "from {from}°, Ω linear between (t s: deg/s){knots}")
            }
            Self::Sine {
                centre_deg,
                amplitude_deg,
                frequency_hz,
            } => write!(
                f,
                "φ = {}° + {}° · sin(2π · {} Hz · t)",
                Plain(*centre_deg),
                Plain(*amplitude_deg),
                Plain(*frequency_hz)
            ),
            Self::Tremble {
                from_deg,
                deg_s,
                at_deg,
                by_deg,
                frequency_hz,
            } => write!(
                f,
                "from {}° at {} deg/s to {}°, then by ±{}° about it at {} Hz",
                Plain(*from_deg),
                Plain(*deg_s),
                Plain(*at_deg),
                Plain(*by_deg),
                Plain(*frequency_hz)
            ),
            Self::Wander {
                about_deg,
                deg_s,
                seed,
            } => write!(
                f,
                "a hand that wanders about {}° at up to {} deg/s (seed {seed})",
                Plain(*about_deg),
                Plain(*deg_s)
            ),
            Self::Strokes {
                from_deg,
                to_deg,
                deg_s,
                pause_s,
            } => write!(
                f,
                "minimum-jerk strokes from {}° to {}° at {} deg/s with a pause of {}",
                Plain(*from_deg),
                Plain(*to_deg),
                Plain(*deg_s),
                Time(*pause_s)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::Extremes;

    #[test]
    fn motions_begin_where_they_say_and_go_on_as_fast() {
        let jumps = Hand::jumps(30.0, &[(0.0, 60.0), (0.5, -20.0)]);
        let at = |hand: &Hand, t: f64| {
            let state = hand.motion().at(t);
            (state.phi_rad.to_degrees(), state.omega_rad_s.to_degrees())
        };
        let near = |found: (f64, f64), expected: (f64, f64)| {
            assert!((found.0 - expected.0).abs() < 1e-9, "{found:?}");
            assert!((found.1 - expected.1).abs() < 1e-9, "{found:?}");
        };
        near(at(&jumps, 0.25), (45.0, 60.0));
        near(at(&jumps, 0.75), (55.0, -20.0));
        near(
            at(&Hand::ramps(10.0, &[(0.0, 0.0), (1.0, 40.0)]), 0.5),
            (15.0, 20.0),
        );
        let tremble = Hand::Tremble {
            from_deg: 10.0,
            deg_s: 20.0,
            at_deg: 20.0,
            by_deg: 1.0,
            frequency_hz: 2.0,
        };
        near(at(&tremble, 0.25), (15.0, 20.0));
        let fastest = 2.0 * std::f64::consts::TAU;
        near(at(&tremble, 0.5), (20.0, fastest));
        near(at(&tremble, 0.625), (21.0, 0.0));
        let wander = Hand::Wander {
            about_deg: 60.0,
            deg_s: 300.0,
            seed: 1,
        };
        let angles = (0..400_u32).map(|n| at(&wander, 0.01 * f64::from(n)).0);
        let Extremes { low, high }: Extremes<f64> = angles.collect();
        assert!(
            low < 50.0 && high > 70.0 && low > -30.0 && high < 150.0,
            "{low} {high}"
        );
        assert_eq!(
            jumps.to_string(),
            "from 30°, Ω linear between (t s: deg/s) 0: 60, 0.5: 60|-20"
        );
    }
}
