//! Cycles at a steady speed, of which one is like the other.
//!
//! While the shaft keeps its velocity, the stick that follows a slip begins
//! where the last one began, so the cycle repeats to the end of the stretch.
//! Its length is known once; the rest is multiplication.

use super::{Follow, Reference, Slip, State};
use crepitus_model::{Convention, Event, EventKind, Phase, Sense};
use std::ops::ControlFlow;

/// A cycle that repeats.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repeat {
    /// Start of the first cycle, s.
    origin_s: f64,
    /// Number of cycles that are over.
    count: f64,
    cycle: Cycle,
}

/// One cycle: a stick, the break, the slip, the next stick.
#[derive(Clone, Copy, Debug)]
struct Cycle {
    stick_s: f64,
    slip_s: f64,
    on_break: Event<f64>,
    on_stick: Event<f64>,
}

impl Repeat {
    /// Time at which the stick of the present cycle breaks, s.
    fn break_s(&self) -> f64 {
        self.origin_s + (self.count * self.length_s() + self.cycle.stick_s)
    }

    /// Time at which the slip of the present cycle ends, s.
    fn end_s(&self) -> f64 {
        self.origin_s + (self.count + 1.0) * self.length_s()
    }

    fn length_s(&self) -> f64 {
        self.cycle.stick_s + self.cycle.slip_s
    }
}

impl Reference<'_> {
    /// Begins to repeat, at the beginning of a stick: from now on it is one cycle after the
    /// other, if it comes back to where it began.
    #[inline]
    pub(super) fn begin_repeating(&mut self) {
        self.repeat = None;
        if self.piece.is_steady() {
            self.repeat_steadily();
        }
    }

    /// A call: on a moving hand nothing repeats.
    #[inline(never)]
    fn repeat_steadily(&mut self) {
        let cycle = self.cycle().map(|cycle| Repeat {
            origin_s: self.time_s,
            count: 0.0,
            cycle,
        });
        // A cycle shorter than the resolution of time does not count.
        self.repeat = cycle.filter(|r| r.break_s() > r.origin_s && r.end_s() > r.break_s());
    }

    /// Carries out what is left of the present cycle up to `horizon_s`, and
    /// all whole cycles after it.
    pub(super) fn next_of_cycle<F: Follow>(
        &mut self,
        horizon_s: f64,
        follower: &mut F,
    ) -> ControlFlow<F::Stop, bool> {
        let Some(mut repeat) = self.repeat else {
            return ControlFlow::Continue(false);
        };
        let cycle = repeat.cycle;
        let mut slips = matches!(self.state, State::Slip(_));
        let mut reached_s = None;
        loop {
            let next_s = if slips {
                repeat.end_s()
            } else {
                repeat.break_s()
            };
            if next_s > horizon_s {
                break;
            }
            let event = if slips {
                cycle.on_stick
            } else {
                cycle.on_break
            };
            follower.event(Event {
                fraction: next_s,
                ..event
            })?;
            if slips {
                repeat.count += 1.0;
            }
            slips = !slips;
            reached_s = Some(next_s);
        }
        let Some(time_s) = reached_s else {
            return ControlFlow::Continue(false);
        };
        self.go_to(time_s);
        self.repeat = Some(repeat);
        let state = if slips {
            self.slip_of(&repeat)
        } else {
            State::Stick {
                theta: cycle.on_stick.theta_rad,
                phi: self.now.phi_rad,
            }
        };
        self.change(state);
        ControlFlow::Continue(true)
    }

    /// The slip of the present cycle.
    fn slip_of(&self, repeat: &Repeat) -> State {
        let event = repeat.cycle.on_break;
        let sense = match event.to {
            Phase::Slip(sense) => sense,
            Phase::Stick => Sense::Positive,
        };
        let end_s = match self.settings.convention {
            Convention::Frozen => repeat.end_s(),
            Convention::Paper | Convention::Physical => f64::INFINITY,
        };
        State::Slip(Slip {
            sense,
            start_s: repeat.break_s(),
            end_s,
            x: event.theta_rad - sense.of_signed(self.kinetic_angle_rad),
            v: event.omega_rad_s,
        })
    }

    /// The cycle that begins with the stick that begins now, at a constant velocity, if it repeats.
    fn cycle(&self) -> Option<Cycle> {
        let State::Stick { theta, phi } = self.state else {
            return None;
        };
        let omega = self.now.omega_rad_s;
        let sense = Sense::of(omega).filter(|_| !self.touches())?;
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
        // A cycle repeats if it comes back to where it began.
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
