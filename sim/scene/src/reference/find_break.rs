//! When a stick of the reference solver breaks.

use super::first_root::{Sample, first_root};
use super::{Reference, SLACK};
use crepitus_model::locate::{ExactEvents, StickPath, earlier, first_break};
use crepitus_model::shaft::Linear;
use crepitus_model::{Convention, Sense};
use crepitus_plant::ShaftState;

impl Reference<'_> {
    /// The torque of a stick and its first derivative: the spring's, with the
    /// object's inertia and damping if `inertial`.
    fn torque_and_rate(
        &self,
        (theta, phi): (f64, f64),
        inertial: bool,
        s: &ShaftState,
    ) -> (f64, f64) {
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        let (torque, rate) = (kr * (theta + (s.phi_rad - phi)), kr * s.omega_rad_s);
        if !inertial {
            return (torque, rate);
        }
        let (j, c) = (p.inertia_kg_m2, p.damping_nms_per_rad);
        (
            torque + (j * s.omega_dot + c * s.omega_rad_s),
            rate + (j * s.omega_ddot + c * s.omega_dot),
        )
    }

    /// When s·T first reaches `limit_nm` on a piece of any shape.
    fn reaches(
        &self,
        anchor: (f64, f64),
        inertial: bool,
        (sense, limit_nm): (Sense, f64),
        (from_s, to_s): (f64, f64),
    ) -> Option<f64> {
        let p = &self.settings.parameters;
        let bounds = self.piece.bounds(from_s, to_s);
        let mut bound = p.stiffness_nm_per_rad * bounds.omega_dot;
        if inertial {
            bound +=
                p.damping_nms_per_rad * bounds.omega_ddot + p.inertia_kg_m2 * bounds.omega_dddot;
        }
        first_root(from_s, to_s, |time_s| {
            let (torque, rate) = self.torque_and_rate(anchor, inertial, &self.piece.at(time_s));
            Sample {
                value: limit_nm - sense.of_signed(torque),
                slope: -sense.of_signed(rate),
                bound,
                noise: 2.0 * f64::EPSILON * (limit_nm + torque.abs()),
                slack: SLACK * limit_nm,
            }
        })
    }

    /// The first time up to `to_s` at which |T| reaches the static limit.
    fn reaches_limit(&self, anchor: (f64, f64), to_s: f64) -> Option<(f64, Sense)> {
        let limit = self.settings.parameters.static_torque_nm;
        let physical = self.settings.convention == Convention::Physical;
        let from_s = self.time_s;
        if self.piece.is_parabolic() {
            // So is the torque, whose root the model knows.
            let (torque_nm, rate) = self.torque_and_rate(anchor, physical, &self.now);
            let path = StickPath {
                torque_nm,
                rate,
                curvature: self.settings.parameters.stiffness_nm_per_rad * self.now.omega_dot,
                shape: Linear,
            };
            return first_break::<f64, ExactEvents>(&path, limit, to_s - from_s)
                .map(|(after_s, sense)| (from_s + after_s, sense));
        }
        let at = |sense| {
            self.reaches(anchor, physical, (sense, limit), (from_s, to_s))
                .map(|t| (t, sense))
        };
        earlier(at(Sense::Positive), at(Sense::Negative))
    }

    /// The next break of a stick up to `to_s`.
    pub(super) fn find_break(&self, theta: f64, phi: f64, to_s: f64) -> Option<(f64, Sense)> {
        let anchor = (theta, phi);
        let first = self.reaches_limit(anchor, to_s)?;
        if self.settings.convention != Convention::Paper {
            return Some(first);
        }
        let shaft = self.piece.at(first.0);
        if self.slips(theta, phi, &shaft, first.1) {
            return Some(first);
        }
        earlier(
            self.held_break(anchor, Sense::Positive, to_s),
            self.held_break(anchor, Sense::Negative, to_s),
        )
    }

    /// Whether the true torque of a stick is at least Tk in `sense`.
    fn slips(&self, theta: f64, phi: f64, shaft: &ShaftState, sense: Sense) -> bool {
        let (torque, _) = self.torque_and_rate((theta, phi), true, shaft);
        let kinetic = self.settings.parameters.kinetic_torque_nm;
        sense.of_signed(torque) >= kinetic * (1.0 - SLACK)
    }

    /// The next break in `sense` of a `paper` stick: a slip cannot begin while
    /// the shaft brakes too hard for it, and until the true torque reaches Tk
    /// the stick is held at its limit.
    fn held_break(&self, anchor: (f64, f64), sense: Sense, to_s: f64) -> Option<(f64, Sense)> {
        let limit = self.settings.parameters.static_torque_nm;
        let kinetic = self.settings.parameters.kinetic_torque_nm;
        let mut time_s = self.time_s;
        loop {
            // At the limit, or below it again since the spring came back.
            time_s = self.reaches(anchor, false, (sense, limit), (time_s, to_s))?;
            time_s = self.reaches(anchor, true, (sense, kinetic), (time_s, to_s))?;
            let (torque, _) = self.torque_and_rate(anchor, false, &self.piece.at(time_s));
            if sense.of_signed(torque) >= limit * (1.0 - SLACK) {
                return Some((time_s, sense));
            }
        }
    }
}
