//! Bound of how far the events of the steps may be from those of the true motion.
//!
//! A step of h takes the velocity for linear: it is off by h²·|Ω̈|/8, and the angle by
//! h³·|Ω̈|/(72·√3), at most. A `frozen` slip gets its duration from the velocity at its break,
//!
//! ```text
//! D(Ω) = 2·(π − atan2(Ts − Tk, |Ω|·Z))/ωn     |dD/dΩ| = 2/ωn·(Ts − Tk)·Z/((Ts − Tk)² + Ω²·Z²)
//! ```
//!
//! and a stick that begins late by e breaks late by e·|Ω(begin)|/|Ω(break)|. To first order the
//! errors add up so; half of the limit is left for the rest.

use crepitus_model::{Event, EventKind, Settings};
use crepitus_plant::Piece;

/// Largest bound at which an event counts as that of the steps, s.
const LIMIT_S: f64 = 0.5e-9;

/// Running bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorBound {
    step_s: f64,
    natural_rad_s: f64,
    /// Ts − Tk, N·m, and √(J·kr), N·m·s/rad.
    drop_nm: f64,
    impedance: f64,
    /// Bound of the error of the last event, s.
    error_s: f64,
    /// |Ω| at the last event, rad/s.
    speed_rad_s: f64,
}

impl ErrorBound {
    pub(super) fn new(settings: &Settings, step_s: f64) -> Self {
        let p = &settings.parameters;
        Self {
            step_s,
            natural_rad_s: p.natural_rad_s(),
            drop_nm: p.static_torque_nm - p.kinetic_torque_nm,
            impedance: p.impedance_nms_per_rad(),
            error_s: 0.0,
            speed_rad_s: 0.0,
        }
    }

    /// Returns whether events are those of the steps, to the limit.
    pub(super) fn is_small(&self) -> bool {
        self.error_s <= LIMIT_S
    }

    /// Follows an event on its piece.
    pub(super) fn event(&mut self, event: &Event<f64>, piece: &Piece) {
        let speed = event.omega_rad_s.abs();
        let time_s = event.fraction;
        if event.kind == EventKind::Break && !piece.is_parabolic() {
            let h = self.step_s;
            let near = (
                (time_s - h).max(piece.start_s),
                (time_s + h).min(piece.end_s),
            );
            let omega_ddot = piece.bounds(near.0, near.1).omega_ddot;
            let angle_rad = omega_ddot * h * h * h * (1.0 / 124.0);
            let omega_rad_s = omega_ddot * h * h * (1.0 / 8.0);
            let late_s = (self.error_s * self.speed_rad_s + angle_rad) / speed;
            let at_break = self.impedance * speed;
            let slope = 2.0 * self.drop_nm * self.impedance
                / (self.natural_rad_s * (self.drop_nm * self.drop_nm + at_break * at_break));
            let accelerated = late_s * piece.at(time_s).omega_dot.abs();
            // Of this event, and of the end of the slip that begins.
            self.error_s = late_s + slope * (omega_rad_s + accelerated);
        } else if event.kind == EventKind::Break && self.error_s > 0.0 {
            self.error_s *= (self.speed_rad_s / speed).max(1.0);
        }
        self.speed_rad_s = speed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::{Convention, Phase, Sense};
    use crepitus_plant::piece::Curve;

    #[test]
    fn longer_steps_and_sharper_bends_are_worse() {
        let settings = Settings {
            convention: Convention::Frozen,
            ..Settings::default()
        };
        let after = |step_s: f64, c3: f64| {
            let piece = Piece {
                start_s: 0.0,
                end_s: 1.0,
                jump: false,
                curve: Curve::Polynomial([0.0, 1.0, 0.0, c3, 0.0, 0.0]),
            };
            let mut bound = ErrorBound::new(&settings, step_s);
            bound.event(
                &Event {
                    kind: EventKind::Break,
                    fraction: 0.1,
                    from: Phase::Stick,
                    to: Phase::Slip(Sense::Positive),
                    theta_rad: 1e-3,
                    theta_dot_rad_s: 1.0,
                    omega_rad_s: 1.0,
                    torque_before_nm: 0.4,
                    torque_after_nm: 0.2,
                },
                &piece,
            );
            bound
        };
        assert!(after(5e-5, 1.0).is_small());
        assert!(!after(5e-3, 1.0).is_small() && !after(5e-5, 1e6).is_small());
        assert_eq!(after(1e-3, 0.0).error_s, 0.0);
    }
}
