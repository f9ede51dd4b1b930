//! Cycles at a steady speed, of which one is like the other.
//!
//! While the shaft keeps its velocity, the stick that follows a slip begins
//! where the last one began, so the cycle repeats to the end of the stretch.
//! Its length is known once; the rest is multiplication.

use super::{Reference, State};
use crepitus_model::{Convention, Event, EventKind, Phase, Sense};

/// One cycle: a stick, the break, the slip, the next stick.
struct Cycle {
    stick_s: f64,
    slip_s: f64,
    on_break: Event<f64>,
    on_stick: Event<f64>,
}

impl Reference<'_> {
    /// From the beginning of a stick, carries out all whole cycles up to
    /// `horizon_s` in which the shaft keeps its velocity.
    pub(super) fn repeat_cycles(&mut self, horizon_s: f64, on_event: &mut impl FnMut(Event<f64>)) {
        let Some(cycle) = self.cycle() else {
            return;
        };
        let start_s = self.time_s;
        let length_s = cycle.stick_s + cycle.slip_s;
        let (mut count, mut end_s) = (0.0, start_s);
        loop {
            let next_s = start_s + (count + 1.0) * length_s;
            // Written so that a cycle without length, or NaN, ends it.
            if !(next_s > end_s && next_s <= horizon_s) {
                break;
            }
            on_event(Event {
                fraction: start_s + (count * length_s + cycle.stick_s),
                ..cycle.on_break
            });
            on_event(Event {
                fraction: next_s,
                ..cycle.on_stick
            });
            count += 1.0;
            end_s = next_s;
        }
        if count > 0.0 {
            self.go_to(end_s);
            self.state = State::Stick {
                theta: cycle.on_stick.theta_rad,
                phi: self.now.phi_rad,
            };
        }
    }

    /// The cycle that begins with the stick that begins now, if it repeats.
    fn cycle(&self) -> Option<Cycle> {
        let State::Stick { theta, phi } = self.state else {
            return None;
        };
        let omega = self.now.omega_rad_s;
        let sense = Sense::of(omega).filter(|_| self.piece.is_steady() && !self.touches())?;
        let p = &self.settings.parameters;
        let limit = sense.of_signed(p.static_torque_nm);
        let break_theta = self.break_angle(sense, limit, &self.now, theta);
        let x = break_theta - sense.of_signed(self.kinetic_angle_rad);
        let (slip_s, end_theta) = if self.settings.convention == Convention::Frozen {
            let (relative, duration_s) = self.frozen;
            let known = relative == sense.of_signed(omega);
            known.then_some((duration_s, theta))?
        } else {
            let (duration_s, x_end) = self.steady?.for_state(x, omega)?;
            (duration_s, x_end + sense.of_signed(self.kinetic_angle_rad))
        };
        // It repeats if it comes back to where it began.
        if end_theta != theta || phi != self.now.phi_rad {
            return None;
        }
        let slipping = self.slip_torque(sense);
        let event = |kind, from, to, theta_rad, before, after| Event {
            kind,
            fraction: 0.0,
            from,
            to,
            theta_rad,
            theta_dot_rad_s: omega,
            omega_rad_s: omega,
            torque_before_nm: before,
            torque_after_nm: after,
        };
        let (stick, slip) = (Phase::Stick, Phase::Slip(sense));
        Some(Cycle {
            stick_s: (break_theta - theta) / omega,
            slip_s,
            on_break: event(EventKind::Break, stick, slip, break_theta, limit, slipping),
            on_stick: event(
                EventKind::Stick,
                slip,
                stick,
                theta,
                slipping,
                self.torque_nm(),
            ),
        })
    }
}
