//! Rules of the three conventions for what happens at an event.

use super::{Follow, Reference, Slip, State};
use crepitus_model::{Convention, Event, EventKind, Phase, Restart, Sense};
use crepitus_plant::ShaftState;
use std::ops::ControlFlow;

/// Number of roundings within which Ts and Tk are equal.
pub(super) const ROUNDINGS: f64 = 4.0;

impl Reference<'_> {
    /// θ at a break. At the static limit it is known better than the sum of
    /// the travel, which carries the rounding of a large angle.
    pub(super) fn break_angle(
        &self,
        sense: Sense,
        torque: f64,
        shaft: &ShaftState,
        theta: f64,
    ) -> f64 {
        let p = &self.settings.parameters;
        let limit = sense.of_signed(p.static_torque_nm);
        if (torque - limit).abs() > self.limit_slack_nm(shaft) {
            return theta;
        }
        let inertial = match self.settings.convention {
            Convention::Physical => self.inertial(shaft),
            Convention::Frozen | Convention::Paper => 0.0,
        };
        (limit - inertial) / p.stiffness_nm_per_rad
    }

    /// Ts = Tk, as far as numbers tell.
    pub(crate) fn touches(&self) -> bool {
        let p = &self.settings.parameters;
        p.static_torque_nm - p.kinetic_torque_nm <= ROUNDINGS * f64::EPSILON * p.static_torque_nm
    }

    /// Begins a slip now, object at (θ, θ̇).
    pub(super) fn begin_slip<F: Follow>(
        &mut self,
        sense: Sense,
        (theta, v): (f64, f64),
        torque_before_nm: f64,
        follower: &mut F,
    ) -> ControlFlow<F::Stop> {
        let omega = self.now.omega_rad_s;
        let from = self.phase();
        follower.event(Event {
            kind: match from {
                Phase::Stick => EventKind::Break,
                Phase::Slip(_) => EventKind::Reverse,
            },
            fraction: self.time_s,
            from,
            to: Phase::Slip(sense),
            theta_rad: theta,
            theta_dot_rad_s: v,
            omega_rad_s: omega,
            torque_before_nm: self.limited(torque_before_nm),
            torque_after_nm: self.slip_torque(sense),
        })?;
        let slip = self.slip(sense, theta, v);
        self.change(State::Slip(slip));
        ControlFlow::Continue(())
    }

    /// A slip that begins now.
    fn slip(&mut self, sense: Sense, theta: f64, v: f64) -> Slip {
        let end_s = if self.settings.convention == Convention::Frozen {
            self.time_s + self.frozen_duration_s(sense.of_signed(v))
        } else {
            f64::INFINITY
        };
        Slip {
            sense,
            start_s: self.time_s,
            end_s,
            x: theta - sense.of_signed(self.kinetic_angle_rad),
            v,
        }
    }

    /// Eqs. (10)–(11): how long a frozen slip lasts that begins at this speed
    /// in its own sense, s.
    fn frozen_duration_s(&mut self, speed_rad_s: f64) -> f64 {
        let p = &self.settings.parameters;
        let speed = speed_rad_s.max(0.0);
        if speed != self.frozen.0 {
            let drop = p.static_torque_nm - p.kinetic_torque_nm;
            let lag = drop.atan2(speed * self.impedance);
            let duration_s = 2.0 * (std::f64::consts::PI - lag) / self.natural_rad_s;
            self.frozen = (speed, duration_s);
        }
        self.frozen.1
    }

    /// Ends the slip now: in stick, or in slip of the other sense.
    pub(super) fn end_slip<F: Follow>(
        &mut self,
        sense: Sense,
        follower: &mut F,
    ) -> ControlFlow<F::Stop> {
        let theta = self.theta_at_end(sense);
        let (phi_rad, omega_rad_s) = (self.now.phi_rad, self.now.omega_rad_s);
        let required = self.stick_torque(theta, phi_rad, &self.now);
        let limit = self.settings.parameters.static_torque_nm;
        // Stick cannot hold it, and the shaft can overtake it the other way. In
        // its own sense it cannot: the shaft has just fallen behind.
        if sense.of_signed(required) < 0.0
            && required.abs() > limit + self.limit_slack_nm(&self.now)
            && self.slips(theta, phi_rad, &self.now, sense.opposite())
        {
            let (state, before) = ((theta, omega_rad_s), self.slip_torque(sense));
            return self.begin_slip(sense.opposite(), state, before, follower);
        }
        if self.settings.convention == Convention::Frozen
            && self.touches()
            && sense.of_signed(omega_rad_s) > 0.0
        {
            // The stick would break where it begins, so the slip continues, and
            // nothing is felt or reported.
            let slip = self.slip(sense, theta, omega_rad_s);
            self.change(State::Slip(slip));
            return ControlFlow::Continue(());
        }
        follower.event(Event {
            kind: EventKind::Stick,
            fraction: self.time_s,
            from: Phase::Slip(sense),
            to: Phase::Stick,
            theta_rad: theta,
            theta_dot_rad_s: omega_rad_s,
            omega_rad_s,
            torque_before_nm: self.slip_torque(sense),
            torque_after_nm: self.limited(required),
        })?;
        self.change(State::Stick {
            theta,
            phi: phi_rad,
        });
        self.begin_repeating();
        ControlFlow::Continue(())
    }

    /// θ where the slip ends, now.
    fn theta_at_end(&self, sense: Sense) -> f64 {
        let p = &self.settings.parameters;
        match (self.settings.convention, self.settings.restart, &self.state) {
            (Convention::Frozen, Restart::Elastic, _) => {
                sense.of_signed(p.restart_torque_nm() / p.stiffness_nm_per_rad)
            }
            (_, _, State::Slip(slip)) if self.settings.convention != Convention::Frozen => {
                self.met_at(slip) + sense.of_signed(self.kinetic_angle_rad)
            }
            _ => sense.of_signed(self.kinetic_angle_rad),
        }
    }

    /// The shaft's velocity has jumped: what sticks is torn loose, what slips
    /// may have to slip the other way. A frozen object does not notice.
    pub(super) fn jump<F: Follow>(&mut self, follower: &mut F) -> ControlFlow<F::Stop> {
        if self.settings.convention == Convention::Frozen {
            return ControlFlow::Continue(());
        }
        let shaft = self.shaft();
        let (theta, v, before) = match self.state {
            State::Stick { theta, phi } => {
                let left = self.before_piece();
                (
                    theta + (shaft.phi_rad - phi),
                    left.omega_rad_s,
                    self.stick_torque(theta, phi, &left),
                )
            }
            State::Slip(slip) => {
                let (x, v) = self.swing(&slip, self.time_s);
                let theta = x + slip.sense.of_signed(self.kinetic_angle_rad);
                (theta, v, self.slip_torque(slip.sense))
            }
        };
        match (Sense::of(shaft.omega_rad_s - v), self.phase()) {
            (Some(s), Phase::Slip(now)) if s == now => ControlFlow::Continue(()),
            (Some(s), _) => self.begin_slip(s, (theta, v), before, follower),
            (None, _) => ControlFlow::Continue(()),
        }
    }
}
