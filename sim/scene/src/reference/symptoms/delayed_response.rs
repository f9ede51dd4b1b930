//! A first-order response to a delayed input, exact on each piece of the input.
//!
//! ```text
//! τ_a·ẏ + y = u(t − τ_d)
//! ```
//!
//! Where u is a polynomial, so is one solution y_p; where u is a constant and a
//! sine, y_p is a sine of the same frequency. Every solution is y_p and a
//! decaying exponential.

use super::runner::Instant;
use crepitus_plant::Piece;
use crepitus_plant::piece::Curve;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// A solution y_p on a piece of the input.
#[derive(Clone, Copy, Debug)]
pub(super) enum Particular {
    /// Σ cₖ·(t − origin)ᵏ.
    Polynomial { origin_s: f64, c: [f64; 6] },
    /// constant + sine·sin θ + cosine·cos θ; θ as `unit`, of amplitude 1.
    Sine {
        unit: Piece,
        omega: f64,
        sine: f64,
        cosine: f64,
        constant: f64,
    },
}

impl Particular {
    pub(super) fn constant(value: f64) -> Self {
        Self::Polynomial {
            origin_s: 0.0,
            c: [value, 0.0, 0.0, 0.0, 0.0, 0.0],
        }
    }

    /// Solution for u = gain·(s·φ + μ·s·Ω) − offset on a piece of the motion.
    pub(super) fn of_stretch(
        piece: &Piece,
        (gain, shift_s, offset): (f64, f64, f64),
        activation_s: f64,
    ) -> Self {
        match piece.curve {
            Curve::Polynomial(c) => {
                let derivative = |c: &[f64; 6]| {
                    let [_, c1, c2, c3, c4, c5] = *c;
                    [c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 0.0]
                };
                let rates = derivative(&c);
                let mut u = [0.0; 6];
                for (u, (c, rate)) in u.iter_mut().zip(c.iter().zip(rates)) {
                    *u = gain * (c + shift_s * rate);
                }
                u[0] -= offset;
                // y_p = u − τ_a·u̇ + τ_a²·ü …, as τ_a·ẏ_p + y_p = u.
                let (mut y, mut term) = (u, u);
                for _ in 0..5 {
                    term = derivative(&term).map(|x| -activation_s * x);
                    for (y, term) in y.iter_mut().zip(term) {
                        *y += term;
                    }
                }
                Self::Polynomial {
                    origin_s: piece.start_s,
                    c: y,
                }
            }
            Curve::Sine {
                centre_rad,
                amplitude_rad,
                frequency_hz,
                phase_turns,
            } => {
                let omega = TAU * frequency_hz;
                let (a, b) = (gain * amplitude_rad, gain * amplitude_rad * shift_s * omega);
                let lag = activation_s * omega;
                let scale = 1.0 / (1.0 + lag * lag);
                Self::Sine {
                    unit: Piece {
                        curve: Curve::Sine {
                            centre_rad: 0.0,
                            amplitude_rad: 1.0,
                            frequency_hz,
                            phase_turns,
                        },
                        ..*piece
                    },
                    omega,
                    sine: (a + lag * b) * scale,
                    cosine: (b - lag * a) * scale,
                    constant: gain * centre_rad - offset,
                }
            }
        }
    }

    fn at(&self, time_s: f64) -> f64 {
        match self {
            Self::Polynomial { origin_s, c } => {
                let t = time_s - origin_s;
                c.iter().rev().fold(0.0, |sum, c| sum * t + c)
            }
            Self::Sine {
                unit,
                omega,
                sine,
                cosine,
                constant,
            } => {
                let (sin, rate) = unit.angle_and_velocity(time_s);
                constant + sine * sin + cosine * (rate / omega)
            }
        }
    }
}

/// A piece of the input, in the input's time.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start_s: f64,
    particular: Particular,
    /// y where its answer begins, at start + τ_d.
    y_start: f64,
}

/// The response; zero before the first input.
#[derive(Clone, Debug)]
pub(super) struct DelayedResponse {
    delay_s: f64,
    activation_s: f64,
    /// Inputs whose answer is not over.
    segments: VecDeque<Segment>,
}

impl DelayedResponse {
    pub(super) fn new(delay_s: f64, activation_s: f64) -> Self {
        Self {
            delay_s,
            activation_s,
            segments: VecDeque::new(),
        }
    }

    /// Sets the particular solution that the input has from now on.
    pub(super) fn input(&mut self, at: &Instant, particular: Particular) {
        let y_start = self
            .segments
            .back()
            .map_or(0.0, |last| self.answer(last, at.time_s));
        self.segments.push_back(Segment {
            start_s: at.time_s,
            particular,
            y_start,
        });
        let answered_s = at.time_s - self.delay_s;
        while self
            .segments
            .get(1)
            .is_some_and(|s| s.start_s <= answered_s)
        {
            self.segments.pop_front();
        }
    }

    /// y at a time that is not before the last input.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        let input_s = time_s - self.delay_s;
        self.segments
            .iter()
            .rev()
            .find(|s| s.start_s <= input_s)
            .map_or(0.0, |s| self.answer(s, input_s))
    }

    /// y at `input_s` + τ_d, within the answer to a segment.
    fn answer(&self, segment: &Segment, input_s: f64) -> f64 {
        let free = segment.y_start - segment.particular.at(segment.start_s);
        let decay = (-(input_s - segment.start_s) / self.activation_s).exp();
        segment.particular.at(input_s) + free * decay
    }
}
