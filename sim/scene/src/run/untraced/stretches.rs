//! Stretches of time within a piece of the motion: what a stick adds up, and the highest speed.

use super::curved::{Integrals, integrals, zeros};
use super::{Since, Untraced};
use crate::run::tally::StickEnd;
use crepitus_model::{Convention, Settings};
use crepitus_plant::{Piece, ShaftState};

impl Untraced<'_, '_> {
    /// The first step that ends at `time_s` or after it.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "non-negative, and below 2^53 by the scene's checks"
    )]
    pub(super) fn step_from(&self, time_s: f64) -> u64 {
        let mut n = (time_s / self.step_s).ceil().max(0.0) as u64;
        while self.clock.time_s(n) < time_s {
            n += 1;
        }
        while n > 0 && self.clock.time_s(n - 1) >= time_s {
            n -= 1;
        }
        n
    }

    /// The ends of the steps around a time, s.
    fn around(&self, time_s: f64) -> [f64; 2] {
        let after = self.step_from(time_s);
        [after.saturating_sub(1), after].map(|n| self.clock.time_s(n))
    }

    /// Sees the highest speed of a piece that a step ends with: at its first and its last, or where the
    /// acceleration turns.
    pub(super) fn see_speeds(&mut self) {
        let piece = self.piece;
        let end_s = piece.end_s.min(self.end_s);
        let first_s = self
            .clock
            .time_s(self.step_from(piece.start_s.max(0.0).next_up()));
        let mut see = |time_s: f64| {
            if time_s <= end_s {
                let speed_rad_s = piece.angle_and_velocity(time_s).1.abs();
                self.fastest_rad_s = self.fastest_rad_s.max(speed_rad_s);
            }
        };
        see(first_s);
        see(end_s);
        if piece.is_parabolic() || end_s <= first_s {
            return;
        }
        let turns = zeros(&piece, (first_s, end_s), |t| piece.at(t).omega_dot);
        let times: Vec<f64> = turns.flat_map(|turn_s| self.around(turn_s)).collect();
        for time_s in times {
            if time_s >= first_s && time_s <= end_s {
                let speed_rad_s = piece.angle_and_velocity(time_s).1.abs();
                self.fastest_rad_s = self.fastest_rad_s.max(speed_rad_s);
            }
        }
    }

    /// The piece in which an event at `time_s` lies, not before the present one.
    pub(super) fn piece_at(&self, time_s: f64) -> Piece {
        if time_s < self.piece.end_s {
            self.piece
        } else {
            self.motion.piece(time_s)
        }
    }

    /// Accounts for the time up to `to_s`, without what happens there; `theta_rad` is the object's
    /// angle there, where it is known better than by the travel.
    pub(super) fn go_to(&mut self, to_s: f64, theta_rad: Option<f64>) {
        while self.piece.end_s <= to_s {
            let end_s = self.piece.end_s;
            self.stretch(end_s, theta_rad.filter(|_| end_s == to_s));
            if let Since::Stick { .. } = self.since {
                let torque_nm = self.stick_torque(&self.piece.at(end_s));
                self.tally.shown(torque_nm);
            }
            self.piece = self.motion.piece_from(end_s, &mut self.place);
            // What begins with the end of the run is not seen.
            if end_s < self.end_s {
                self.see_speeds();
            }
            if let Since::Slip(begun) = &mut self.since {
                begun.is_steady = false;
            }
        }
        self.stretch(to_s, theta_rad);
    }

    /// Accounts for a stretch within the piece.
    fn stretch(&mut self, to_s: f64, theta_rad: Option<f64>) {
        let from_s = self.time_s;
        if to_s <= from_s {
            return;
        }
        self.time_s = to_s;
        let Since::Stick { offset_rad } = self.since else {
            return;
        };
        let piece = self.piece;
        let end = |time_s: f64| {
            let shaft = piece.at(time_s);
            let known = theta_rad.filter(|_| time_s == to_s);
            StickEnd {
                theta_rad: known.unwrap_or(offset_rad + shaft.phi_rad),
                omega_rad_s: shaft.omega_rad_s,
                omega_dot: shaft.omega_dot,
            }
        };
        let turned = |from_s: f64, to_s: f64| piece.at(to_s).phi_rad - piece.at(from_s).phi_rad;
        if piece.is_steady() {
            let travel_rad = turned(from_s, to_s);
            self.tally
                .stick(to_s - from_s, travel_rad, end(from_s), end(to_s));
            return;
        }
        self.see_turns((from_s, to_s));
        // A part of a step, whole steps, a part of a step.
        let first_s = self.clock.time_s(self.step_from(from_s)).min(to_s);
        let mut last = self.step_from(to_s);
        if self.clock.time_s(last) > to_s {
            last = last.saturating_sub(1);
        }
        let last_s = self.clock.time_s(last).max(first_s);
        for (from_s, to_s) in [(from_s, first_s), (last_s, to_s)] {
            if to_s > from_s {
                self.tally
                    .stick(to_s - from_s, turned(from_s, to_s), end(from_s), end(to_s));
            }
        }
        if last_s <= first_s {
            return;
        }
        if piece.is_parabolic() {
            let ends = (end(first_s), end(last_s));
            self.tally
                .stick_steps(last_s - first_s, turned(first_s, last_s), ends, self.step_s);
        } else {
            let kr = self.settings.parameters.stiffness_nm_per_rad;
            let span_s = (first_s, last_s);
            let Integrals {
                torque,
                square,
                omega_squared,
                acceleration_torque,
            } = integrals(&piece, span_s, (kr, offset_rad));
            // A step takes T for a straight line, which is above its parabola by kr·Ω̇·h²/12 on average.
            let above = kr * self.step_s * self.step_s * (1.0 / 6.0) * acceleration_torque;
            self.tally
                .spring_stick(torque, square + above, omega_squared);
            for time_s in [first_s, last_s] {
                let torque_nm = self.stick_torque(&piece.at(time_s));
                self.tally.shown(torque_nm);
            }
        }
    }

    /// The torque of a stick may turn between its ends: it is seen at the ends of the steps around.
    fn see_turns(&mut self, (from_s, to_s): (f64, f64)) {
        let p = &self.settings.parameters;
        let (kr, c) = (p.stiffness_nm_per_rad, p.damping_nms_per_rad);
        let is_physical = self.settings.convention == Convention::Physical;
        let piece = self.piece;
        let rate = |time_s: f64| {
            let shaft = piece.at(time_s);
            let damped = if is_physical {
                c * shaft.omega_dot
            } else {
                0.0
            };
            kr * shaft.omega_rad_s + damped
        };
        if piece.is_parabolic() && (rate(from_s) > 0.0) == (rate(to_s) > 0.0) {
            return;
        }
        let turns = zeros(&piece, (from_s, to_s), rate);
        let times: Vec<f64> = turns.flat_map(|turn_s| self.around(turn_s)).collect();
        for time_s in times {
            if time_s >= from_s && time_s <= to_s {
                let torque_nm = self.stick_torque(&piece.at(time_s));
                self.tally.shown(torque_nm);
            }
        }
    }

    /// The torque shown in the present stick, N·m.
    fn stick_torque(&self, shaft: &ShaftState) -> f64 {
        let Since::Stick { offset_rad } = self.since else {
            return 0.0;
        };
        let p = &self.settings.parameters;
        let spring_nm = p.stiffness_nm_per_rad * (offset_rad + shaft.phi_rad);
        let torque_nm = match self.settings.convention {
            Convention::Physical => spring_nm + inertial_nm(self.settings, shaft),
            Convention::Frozen | Convention::Paper => spring_nm,
        };
        let limit_nm = p.static_torque_nm;
        torque_nm.clamp(-limit_nm, limit_nm)
    }
}

/// J·Ω̇ + c·Ω, N·m.
fn inertial_nm(settings: &Settings, shaft: &ShaftState) -> f64 {
    let p = &settings.parameters;
    p.inertia_kg_m2 * shaft.omega_dot + p.damping_nms_per_rad * shaft.omega_rad_s
}
