//! The smooth pieces that every motion is made of.
//!
//! A motion of the shaft is analytic between a few knots. A piece gives the
//! angle and three derivatives at any time, and bounds of them, from which the
//! event-driven reference solver knows how far it may look ahead.

use std::f64::consts::TAU;

/// The shaft at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShaftState {
    /// Angle φ, rad.
    pub phi_rad: f64,
    /// Velocity Ω, rad/s.
    pub omega_rad_s: f64,
    /// Acceleration Ω̇, rad/s².
    pub omega_dot: f64,
    /// Ω̈, rad/s³.
    pub omega_ddot: f64,
}

/// Bounds over a stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// max |Ω̇|, rad/s².
    pub omega_dot: f64,
    /// max |Ω̈|, rad/s³.
    pub omega_ddot: f64,
    /// max |d³Ω/dt³|, rad/s⁴.
    pub omega_dddot: f64,
}

/// An analytic stretch of a motion, from `start_s` to `end_s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start of the piece, s.
    pub start_s: f64,
    /// End of the piece, s; infinite for the last piece of a motion.
    pub end_s: f64,
    /// Whether the velocity jumps where it begins. Without a jump the piece
    /// before ends with the same velocity, though perhaps not the same bits.
    pub jump: bool,
    /// The angle.
    pub curve: Curve,
}

/// The angle of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// φ = Σ cₖ·τᵏ with τ = t − start.
    Polynomial([f64; 6]),
    /// φ = φ₀ + A·sin(2π(f·t + p)).
    Sine {
        /// φ₀, rad.
        centre_rad: f64,
        /// A, rad.
        amplitude_rad: f64,
        /// f, Hz.
        frequency_hz: f64,
        /// p, turns.
        phase_turns: f64,
    },
}

/// A piece with a linear velocity: φ = c₀ + c₁τ + c₂τ² with τ = t − start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parabola {
    start_s: f64,
    coefficients: [f64; 3],
}

impl Parabola {
    /// Angle and velocity at `time_s`, rad and rad/s: those of the piece, to the bit.
    #[inline]
    pub fn angle_and_velocity(&self, time_s: f64) -> (f64, f64) {
        let [c0, c1, c2] = self.coefficients;
        let t = time_s - self.start_s;
        ((c2 * t + c1) * t + c0, 2.0 * c2 * t + c1)
    }
}

impl Piece {
    /// The piece as a parabola, if it is one.
    pub fn parabola(&self) -> Option<Parabola> {
        match self.curve {
            Curve::Polynomial([c0, c1, c2, ..]) if self.is_parabolic() => Some(Parabola {
                start_s: self.start_s,
                coefficients: [c0, c1, c2],
            }),
            _ => None,
        }
    }

    /// Returns whether the velocity is linear in time, so that the angle is a parabola.
    #[inline]
    pub fn is_parabolic(&self) -> bool {
        matches!(self.curve, Curve::Polynomial([_, _, _, c3, c4, c5]) if (c3, c4, c5) == (0.0, 0.0, 0.0))
    }

    /// The time that the curve counts from where it is computed at `time_s`, s:
    /// what its terms, or its phase, are rounded by grows with it.
    pub fn age_s(&self, time_s: f64) -> f64 {
        match self.curve {
            Curve::Polynomial(_) => (time_s - self.start_s).abs(),
            Curve::Sine {
                frequency_hz,
                phase_turns,
                ..
            } => (frequency_hz * time_s + phase_turns).abs() / frequency_hz,
        }
    }

    /// Returns whether the velocity is constant.
    pub fn is_steady(&self) -> bool {
        self.is_parabolic() && matches!(self.curve, Curve::Polynomial([_, _, c2, ..]) if c2 == 0.0)
    }

    /// A bound of |d³Ω/dt³| on the whole piece, rad/s⁴.
    #[inline]
    pub fn snap_bound(&self) -> f64 {
        match self.curve {
            Curve::Polynomial([.., c4, c5]) if (c4, c5) == (0.0, 0.0) => 0.0,
            _ => self.bounds(self.start_s, self.end_s).omega_dddot,
        }
    }

    /// Angle and velocity at `time_s`, rad and rad/s: all that a step needs.
    #[inline]
    pub fn angle_and_velocity(&self, time_s: f64) -> (f64, f64) {
        match self.curve {
            Curve::Polynomial([c0, c1, c2, c3, c4, c5]) => {
                if let Some(parabola) = self.parabola() {
                    return parabola.angle_and_velocity(time_s);
                }
                let t = time_s - self.start_s;
                (
                    ((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t + c0,
                    (((5.0 * c5 * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1,
                )
            }
            Curve::Sine {
                centre_rad,
                amplitude_rad,
                frequency_hz,
                phase_turns,
            } => {
                let (sin, cos) = sin_cos_turns(frequency_hz * time_s + phase_turns);
                (
                    centre_rad + amplitude_rad * sin,
                    amplitude_rad * TAU * frequency_hz * cos,
                )
            }
        }
    }

    /// The shaft at `time_s`, which may be either end.
    #[inline]
    pub fn at(&self, time_s: f64) -> ShaftState {
        let (phi_rad, omega_rad_s) = self.angle_and_velocity(time_s);
        match self.curve {
            Curve::Polynomial(c) => {
                let t = time_s - self.start_s;
                let [_, _, c2, c3, c4, c5] = c;
                ShaftState {
                    phi_rad,
                    omega_rad_s,
                    omega_dot: ((20.0 * c5 * t + 12.0 * c4) * t + 6.0 * c3) * t + 2.0 * c2,
                    omega_ddot: (60.0 * c5 * t + 24.0 * c4) * t + 6.0 * c3,
                }
            }
            Curve::Sine {
                centre_rad,
                frequency_hz,
                ..
            } => {
                let w = TAU * frequency_hz;
                ShaftState {
                    phi_rad,
                    omega_rad_s,
                    omega_dot: -(w * w * (phi_rad - centre_rad)),
                    omega_ddot: -(w * w * omega_rad_s),
                }
            }
        }
    }

    /// Bounds of the derivatives between two times within the piece.
    pub fn bounds(&self, from_s: f64, to_s: f64) -> Bounds {
        match self.curve {
            Curve::Polynomial(c) => {
                let reach = (from_s - self.start_s)
                    .abs()
                    .max((to_s - self.start_s).abs());
                let [_, _, c2, c3, c4, c5] = c.map(f64::abs);
                // 0·∞ is nothing: a piece without end is at most parabolic.
                let term = |c: f64, power: i32| if c == 0.0 { 0.0 } else { c * reach.powi(power) };
                Bounds {
                    omega_dot: 2.0 * c2
                        + 6.0 * term(c3, 1)
                        + 12.0 * term(c4, 2)
                        + 20.0 * term(c5, 3),
                    omega_ddot: 6.0 * c3 + 24.0 * term(c4, 1) + 60.0 * term(c5, 2),
                    omega_dddot: 24.0 * c4 + 120.0 * term(c5, 1),
                }
            }
            Curve::Sine {
                amplitude_rad,
                frequency_hz,
                ..
            } => {
                let w = TAU * frequency_hz;
                let a = amplitude_rad.abs() * w * w;
                Bounds {
                    omega_dot: a,
                    omega_ddot: a * w,
                    omega_dddot: a * w * w,
                }
            }
        }
    }
}

/// (sin 2πx, cos 2πx), exact at every quarter turn however large x is.
#[inline]
fn sin_cos_turns(x: f64) -> (f64, f64) {
    let r = x - rounded(x);
    // The whole number of quarters nearest to r, which is at most half a turn.
    let size = r.abs();
    let quarters = if size < 0.125 {
        0.0
    } else if size < 0.375 {
        0.25
    } else {
        0.5
    };
    let (sin, cos) = (TAU * (r - quarters * 1.0_f64.copysign(r))).sin_cos();
    if quarters == 0.0 {
        (sin, cos)
    } else if quarters == 0.5 {
        (-sin, -cos)
    } else if r > 0.0 {
        (cos, -sin)
    } else {
        (-cos, sin)
    }
}

/// Nearest whole number, halves away from zero: `f64::round`, which is a call into the C library.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "below 2^51, where every whole number has an i64 and an f64"
)]
fn rounded(x: f64) -> f64 {
    /// The largest number below a half: with a half itself, the sum could round up.
    const HALF: f64 = 0.5 - f64::EPSILON / 4.0;
    const MOST: f64 = 2_251_799_813_685_248.0;
    if x.abs() < MOST {
        (x + HALF.copysign(x)) as i64 as f64
    } else {
        x.round()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces() -> [Piece; 2] {
        [
            Piece {
                start_s: 0.5,
                end_s: 2.0,
                jump: false,
                curve: Curve::Polynomial([0.1, -0.4, 0.3, 1.1, -0.6, 0.2]),
            },
            Piece {
                start_s: 0.0,
                end_s: 2.0,
                jump: false,
                curve: Curve::Sine {
                    centre_rad: 0.4,
                    amplitude_rad: 0.7,
                    frequency_hz: 0.9,
                    phase_turns: 0.1,
                },
            },
        ]
    }

    #[test]
    fn derivatives_match_differences() {
        let h = 1e-5;
        for piece in pieces() {
            for t in [0.6, 1.0, 1.9] {
                let (a, m, b) = (piece.at(t - h), piece.at(t), piece.at(t + h));
                let slope = |f: fn(&ShaftState) -> f64| (f(&b) - f(&a)) / (2.0 * h);
                assert!((slope(|s| s.phi_rad) - m.omega_rad_s).abs() < 1e-8);
                assert!((slope(|s| s.omega_rad_s) - m.omega_dot).abs() < 1e-7);
                assert!((slope(|s| s.omega_dot) - m.omega_ddot).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn bounds_bound() {
        for piece in pieces() {
            let bounds = piece.bounds(0.6, 1.9);
            for i in 0..=130 {
                let s = piece.at(0.6 + 0.01 * f64::from(i));
                assert!(s.omega_dot.abs() <= bounds.omega_dot * (1.0 + 1e-12));
                assert!(s.omega_ddot.abs() <= bounds.omega_ddot * (1.0 + 1e-12));
            }
        }
    }

    #[test]
    fn a_piece_without_end_has_finite_bounds_when_it_is_linear() {
        let bounds = Piece {
            start_s: 0.0,
            end_s: f64::INFINITY,
            jump: false,
            curve: Curve::Polynomial([0.0, 2.0, 0.5, 0.0, 0.0, 0.0]),
        }
        .bounds(0.0, f64::INFINITY);
        assert_eq!((bounds.omega_dot, bounds.omega_ddot), (1.0, 0.0));
    }

    #[test]
    fn rounding_is_that_of_the_library() {
        let steps = (0..2_000_000).map(|n| f64::from(n) * 0.001_953_125 - 1953.0);
        let near = [
            0.5,
            1.5,
            2.5,
            1e9 + 0.5,
            1_073_741_824.5,
            2_147_483_648.0,
            1e300,
        ];
        let near = near
            .iter()
            .flat_map(|x: &f64| [x.next_down(), *x, x.next_up()]);
        for x in steps.chain(near.flat_map(|x| [x, -x])) {
            assert_eq!(rounded(x), x.round(), "{x:e}");
        }
        assert!(rounded(f64::NAN).is_nan());
        assert_eq!(rounded(f64::INFINITY), f64::INFINITY);
    }

    /// Quarters as they were counted by rounding; the boundary of two octants is where it matters.
    #[test]
    fn octants_are_those_of_a_rounded_quarter() {
        for n in -4000..=4000 {
            let x = f64::from(n) / 1000.0;
            let eighth = f64::from(n) / 8.0;
            for x in [x, eighth, eighth.next_up(), eighth.next_down()] {
                let r = x - x.round();
                let quarter = (4.0 * r).round();
                let (sin, cos) = (TAU * (r - quarter / 4.0)).sin_cos();
                let expected = match quarter {
                    0.0 => (sin, cos),
                    1.0 => (cos, -sin),
                    -1.0 => (-cos, sin),
                    _ => (-sin, -cos),
                };
                assert_eq!(sin_cos_turns(x), expected, "{x:e}");
            }
        }
    }

    #[test]
    fn quarter_turns_are_exact_after_a_million_of_them() {
        for n in [0.0, 1.0, 1e6, -1e6] {
            assert_eq!(sin_cos_turns(n), (0.0, 1.0));
            assert_eq!(sin_cos_turns(n + 0.25), (1.0, 0.0));
            assert_eq!(sin_cos_turns(n - 0.25), (-1.0, 0.0));
            assert_eq!(sin_cos_turns(n + 0.5).1, -1.0);
        }
    }
}
