//! The two-mode problem on a moving hand, as an ODE with events.
//!
//! The state is (u, v) as in [`crate::work`], u = ωn·θ and v = θ̇, both rad/s; s is the sense of a
//! slip.
//!
//! ```text
//! stick: u̇ = ωn·Ω(t)   v̇ = 0                  ends when Ts − |T| falls through zero
//! slip:  u̇ = ωn·v      v̇ = ωn·(s·uk − u)      ends when s·(Ω(t) − v) falls through zero
//! ```
//!
//! T = kr·θ, under `physical` with J·Ω̇. A frozen slip has a known duration and is not integrated.
//! A peer that knows the system need not integrate a stick: θ = θ₀ + φ(t) − φ₀ ([`StickBy::Position`]); all
//! that is left then is the library's search for the event.

use super::integrator::{Integrator, Step};
use crate::motion::{Cursor, Hand};
use crepitus_model::{Convention, Parameters};
use std::cell::Cell;
use std::f64::consts::PI;

/// Largest excess over Ts that still counts as Ts, relative.
const SLACK: f64 = 1e-12;
/// More events than any of the motions has.
const MOST_EVENTS: usize = 4000;

/// Source of a peer's angle in a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StickBy {
    /// Integration of θ̇ = Ω.
    Integration,
    /// Law of a stick, which the peer knows: θ follows φ.
    Position,
}

/// Phase of the object.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// θ = θ₀ + φ − φ₀.
    Stick {
        /// θ₀ − φ₀, rad.
        offset_rad: f64,
    },
    /// Swing of the object.
    Slip {
        /// s.
        sense: f64,
    },
}

/// The problem, and the phase that it is in.
pub struct Phases {
    cursor: Cursor,
    duration_s: f64,
    longest_stick_step_s: f64,
    convention: Convention,
    stick_by: StickBy,
    joint: Parameters,
    natural: f64,
    /// u at which a slip is without force.
    kinetic_u: f64,
    phase: Cell<Phase>,
}

impl Phases {
    /// Creates the problem, in stick at θ = 0 at the start.
    pub fn new(hand: &Hand, convention: Convention, stick_by: StickBy) -> Self {
        let joint = hand.joint.parameters;
        let natural = joint.natural_rad_s();
        Self {
            cursor: Cursor::new(&hand.motion, hand.duration_s),
            duration_s: hand.duration_s,
            longest_stick_step_s: hand.turn_s,
            convention,
            stick_by,
            joint,
            natural,
            kinetic_u: natural * joint.kinetic_torque_nm / joint.stiffness_nm_per_rad,
            phase: Cell::new(Phase::Stick { offset_rad: 0.0 }),
        }
    }

    /// Duration of the run, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Right-hand side.
    #[inline]
    pub fn derivative(&self, time_s: f64, y: &[f64], dydt: &mut [f64]) {
        match (self.phase.get(), self.stick_by) {
            (Phase::Stick { .. }, StickBy::Integration) => {
                dydt[0] = self.natural * self.omega(time_s);
                dydt[1] = 0.0;
            }
            (Phase::Stick { .. }, StickBy::Position) => dydt.fill(0.0),
            (Phase::Slip { sense }, _) => {
                dydt[0] = self.natural * y[1];
                dydt[1] = self.natural * (sense * self.kinetic_u - y[0]);
            }
        }
    }

    /// Jacobian times `w`.
    #[inline]
    pub fn jacobian_times(&self, w: &[f64], out: &mut [f64]) {
        match self.phase.get() {
            Phase::Stick { .. } => out.fill(0.0),
            Phase::Slip { .. } => {
                out[0] = self.natural * w[1];
                out[1] = -self.natural * w[0];
            }
        }
    }

    /// Positive within a phase; falls through zero at its end.
    #[inline]
    pub fn event(&self, time_s: f64, y: &[f64]) -> f64 {
        match self.phase.get() {
            Phase::Stick { offset_rad } => {
                self.joint.static_torque_nm - self.stick_torque(time_s, y[0], offset_rad).abs()
            }
            Phase::Slip { sense } => sense * (self.omega(time_s) - y[1]),
        }
    }

    /// Does the whole run with a library and notes its events.
    ///
    /// # Errors
    /// The library's message if it gives up, or more events than there can be.
    pub fn run(
        &self,
        integrator: &mut impl Integrator,
        slip_limit_s: Option<f64>,
        events: &mut Vec<f64>,
    ) -> Result<(), String> {
        events.clear();
        let slip_limit_s = slip_limit_s.unwrap_or(f64::INFINITY);
        let mut slip_step_s: Option<f64> = None;
        let (mut from_s, mut y) = (0.0, self.stick(0.0, 0.0));
        while events.len() < MOST_EVENTS {
            let sticks = matches!(self.phase.get(), Phase::Stick { .. });
            let step = if sticks {
                Step {
                    first_s: Some(self.stick_step_s(from_s, y)),
                    longest_s: self.longest_stick_step_s,
                }
            } else {
                Step {
                    first_s: slip_step_s.map(|h| h.min(slip_limit_s)),
                    longest_s: slip_limit_s,
                }
            };
            let Some(end) = integrator.phase(from_s, y, step)? else {
                return Ok(());
            };
            if end.time_s > self.duration_s {
                return Ok(());
            }
            if !sticks {
                slip_step_s = Some(end.step_s);
            }
            events.push(end.time_s);
            from_s = end.time_s;
            y = self.switch(end.time_s, end.y);
            if let Some((end_s, theta_rad)) = self.frozen_end(from_s) {
                if end_s > self.duration_s {
                    return Ok(());
                }
                events.push(end_s);
                from_s = end_s;
                y = self.stick(end_s, theta_rad);
            }
        }
        Err(format!("more than {MOST_EVENTS} events"))
    }

    /// The end of this phase is now: the next one, and its state.
    fn switch(&self, time_s: f64, y: [f64; 2]) -> [f64; 2] {
        match self.phase.get() {
            Phase::Stick { offset_rad } => {
                let torque = self.stick_torque(time_s, y[0], offset_rad);
                let u = match self.stick_by {
                    StickBy::Integration => y[0],
                    StickBy::Position => self.natural * (offset_rad + self.phi(time_s)),
                };
                self.slip(time_s, u, torque.signum())
            }
            Phase::Slip { sense } => {
                let theta_rad = y[0] / self.natural;
                let required = self.joint.stiffness_nm_per_rad * theta_rad + self.inertial(time_s);
                let limit = self.joint.static_torque_nm * (1.0 + SLACK);
                // More than a stick can hold: the object slips on the other way.
                if required.abs() > limit && sense * required < 0.0 {
                    self.slip(time_s, y[0], -sense)
                } else {
                    self.stick(time_s, theta_rad)
                }
            }
        }
    }

    fn stick(&self, time_s: f64, theta_rad: f64) -> [f64; 2] {
        let offset_rad = theta_rad - self.phi(time_s);
        self.phase.set(Phase::Stick { offset_rad });
        [self.natural * theta_rad, 0.0]
    }

    fn slip(&self, time_s: f64, u: f64, sense: f64) -> [f64; 2] {
        self.phase.set(Phase::Slip { sense });
        [u, self.omega(time_s)]
    }

    /// Time at which a frozen slip that begins now ends, and θ there.
    fn frozen_end(&self, time_s: f64) -> Option<(f64, f64)> {
        let Phase::Slip { sense } = self.phase.get() else {
            return None;
        };
        if self.convention != Convention::Frozen {
            return None;
        }
        let speed = (sense * self.omega(time_s)).max(0.0);
        let p = &self.joint;
        let (kinetic, limit) = (p.kinetic_torque_nm, p.static_torque_nm);
        let lag = (limit - kinetic).atan2(speed * p.impedance_nms_per_rad());
        let theta_rad = sense * (2.0 * kinetic - limit) / p.stiffness_nm_per_rad;
        Some((time_s + 2.0 * (PI - lag) / self.natural, theta_rad))
    }

    /// A step a little longer than the stick, if the torque goes on as it does now.
    fn stick_step_s(&self, time_s: f64, y: [f64; 2]) -> f64 {
        let shaft = self.cursor.piece(time_s).at(time_s);
        let stiffness = self.joint.stiffness_nm_per_rad;
        let torque = stiffness * y[0] / self.natural + self.inertial(time_s);
        let rate = match self.convention {
            Convention::Physical => {
                stiffness * shaft.omega_rad_s + self.joint.inertia_kg_m2 * shaft.omega_ddot
            }
            _ => stiffness * shaft.omega_rad_s,
        };
        let room = self.joint.static_torque_nm - torque * rate.signum();
        (1.25 * room / rate.abs()).clamp(1e-6, self.longest_stick_step_s)
    }

    #[inline]
    fn stick_torque(&self, time_s: f64, u: f64, offset_rad: f64) -> f64 {
        let stiffness = self.joint.stiffness_nm_per_rad;
        let physical = self.convention == Convention::Physical;
        if !physical && self.stick_by == StickBy::Integration {
            return stiffness * (u / self.natural);
        }
        // The shaft is computed once for both of its terms.
        let shaft = self.cursor.piece(time_s).at(time_s);
        let theta_rad = match self.stick_by {
            StickBy::Integration => u / self.natural,
            StickBy::Position => offset_rad + shaft.phi_rad,
        };
        let inertial = if physical {
            self.joint.inertia_kg_m2 * shaft.omega_dot
        } else {
            0.0
        };
        stiffness * theta_rad + inertial
    }

    #[inline]
    fn inertial(&self, time_s: f64) -> f64 {
        match self.convention {
            Convention::Physical => {
                self.joint.inertia_kg_m2 * self.cursor.piece(time_s).at(time_s).omega_dot
            }
            Convention::Frozen | Convention::Paper => 0.0,
        }
    }

    #[inline]
    fn omega(&self, time_s: f64) -> f64 {
        self.cursor.piece(time_s).angle_and_velocity(time_s).1
    }

    #[inline]
    fn phi(&self, time_s: f64) -> f64 {
        self.cursor.piece(time_s).angle_and_velocity(time_s).0
    }
}
