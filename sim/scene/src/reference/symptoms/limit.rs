//! Limits of a play, as functions of time and of the angle.
//!
//! A limit is written for the direction in which it acts: with y = x and
//! u = u(t, x) for the upper one, with y = −x and u = −ℓ(t, −y) for the lower
//! one. So each form is written once.

use super::guard::{Decay, Guard};

/// A limit of the torque, N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    /// u = base + slope·(y − at) + D·e^(−(t − t₀)/τ).
    Line {
        base: f64,
        slope: f64,
        at: f64,
        decay: Option<Decay>,
    },
    /// u = min(cap, K1·p + K2·p²), p = y − at; where the torque is at the cap
    /// already, the cap.
    Wall {
        at: f64,
        stiffness: f64,
        stiffening: f64,
        cap: f64,
        capped: bool,
    },
    /// u = base + height·max(0, 1 − (peak − y)/width), for y ≤ peak.
    Ramp {
        base: f64,
        height: f64,
        peak: f64,
        width: f64,
    },
}

impl Limit {
    /// A limit that is equal at every angle and time.
    pub(super) const fn level(torque_nm: f64) -> Self {
        Self::line(torque_nm, 0.0, 0.0)
    }

    /// base + slope·(y − at).
    pub(super) const fn line(base: f64, slope: f64, at: f64) -> Self {
        Self::Line {
            base,
            slope,
            at,
            decay: None,
        }
    }

    /// Torque of the limit, N·m.
    pub(super) fn value(&self, time_s: f64, y: f64) -> f64 {
        match *self {
            Self::Line {
                base,
                slope,
                at,
                decay,
            } => base + slope * (y - at) + decay.map_or(0.0, |d| d.at(time_s)),
            Self::Wall {
                at,
                stiffness,
                stiffening,
                cap,
                capped,
            } => {
                let p = (y - at).max(0.0);
                if capped {
                    cap
                } else {
                    ((stiffening * p + stiffness) * p).min(cap)
                }
            }
            Self::Ramp {
                base,
                height,
                peak,
                width,
            } => base + height * (1.0 - (peak - y) / width).max(0.0),
        }
    }

    /// The condition at which the torque σ·(y − anchor) reaches it from below.
    pub(super) fn reach(&self, sigma: f64, anchor: f64) -> Guard {
        match *self {
            Self::Line {
                base,
                slope,
                at,
                decay,
            } => Guard {
                constant: base - slope * at + sigma * anchor,
                terms: base.abs() + (slope * at).abs() + (sigma * anchor).abs(),
                angle: slope - sigma,
                velocity: 0.0,
                decay,
            },
            Self::Wall {
                at,
                stiffness,
                stiffening,
                cap,
                ..
            } => {
                // K2·p² + (K1 − σ)·p + σ·q = 0, the smaller root, without the
                // difference of like numbers.
                let q = anchor - at;
                let steeper = sigma - stiffness;
                let root = (steeper * steeper - 4.0 * stiffening * sigma * q).sqrt();
                let p = 2.0 * sigma * q / (steeper + root);
                let below_cap = (stiffening * p + stiffness) * p < cap;
                // No root, or one beyond the cap: NaN and ∞ compare so, too.
                let (from, moved) = if below_cap {
                    (at, p)
                } else {
                    (anchor, cap / sigma)
                };
                Guard::above(from + moved).of_terms(from.abs() + moved.abs())
            }
            Self::Ramp {
                base,
                height,
                peak,
                width,
            } => {
                let flat = anchor + base / sigma;
                if flat <= peak - width {
                    return Guard::above(flat);
                }
                Self::line(base + height, height / width, peak).reach(sigma, anchor)
            }
        }
    }

    /// The condition at which the torque leaves it: σ·ẏ < du/dt. None if
    /// it falls along the limit as fast as along σ.
    pub(super) fn turn(&self, sigma: f64) -> Option<Guard> {
        let velocity = match *self {
            Self::Line { slope, decay, .. } => {
                let decay = decay.map(|d| Decay {
                    amplitude: d.amplitude / d.time_s,
                    ..d
                });
                return (sigma > slope || decay.is_some()).then_some(Guard {
                    velocity: sigma - slope,
                    decay,
                    ..Guard::default()
                });
            }
            Self::Wall {
                stiffness,
                stiffening,
                capped,
                ..
            } => capped || sigma > stiffness || stiffening > 0.0,
            Self::Ramp { .. } => true,
        };
        velocity.then_some(Guard {
            velocity: 1.0,
            ..Guard::default()
        })
    }
}
