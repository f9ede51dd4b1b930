//! The `reference` solver: from event to event on the true motion.
//!
//! There is no step. In a stick the torque is known from the shaft's angle, in
//! a slip the object's motion is a closed form, and the end of either is found
//! by a search that cannot miss the first root (`first_root`). What is
//! left is rounding, a few 1e-15 s an event: this is what the other solvers are
//! measured against.
//!
//! The search runs ahead of the time asked for (`ahead`), so what it finds, to
//! the bit, and what it costs do not depend on how often the state is asked
//! for.
//!
//! The rules (`rules`) are those of the model's `frozen` and `velocity_match`
//! modules, written a second time and for the true motion, so that each checks
//! the other. `tests/crosscheck` checks both by other mathematics.
//!
//! The other symptoms are in [`symptoms`]. They, too, are solved from event to
//! event, each on its own.

mod ahead;
mod find_break;
mod find_match;
mod first_root;
mod follow;
mod parabola;
mod repeat;
mod rising;
mod rules;
mod swing;
pub mod symptoms;
mod tank;

pub use follow::Follow;

use ahead::Ahead;
use crepitus_model::{Convention, Event, Phase, Sense, Settings, Validated};
use crepitus_plant::{Motion, Piece, ShaftState};
use find_match::SteadySlip;
use repeat::Repeat;
use std::ops::ControlFlow;
use swing::Swing;

/// Number of roundings of a torque's terms within which it counts as at a limit. The
/// stepping solvers allow 1e-9 of the limit, as their errors add up.
const LIMIT_ROUNDINGS: f64 = 64.0;

/// Number of turns of the loop over pieces and events between two polls.
const POLL_EVERY: u32 = 1 << 10;

/// The stick-slip object on the true motion of the shaft.
#[derive(Clone, Debug)]
pub struct Reference<'a> {
    motion: &'a Motion,
    settings: Settings,
    swing: Swing,
    /// Tk/kr, rad.
    kinetic_angle_rad: f64,
    /// ωn, rad/s, and √(J·kr), N·m·s/rad.
    natural_rad_s: f64,
    impedance: f64,
    piece: Piece,
    /// Place of the piece in the motion.
    piece_place: usize,
    time_s: f64,
    /// The shaft now; just after a knot, at it.
    now: ShaftState,
    /// A bound of |d³Ω/dt³| on the piece, rad/s⁴.
    snap_bound: f64,
    state: State,
    /// State of the search for the end of this phase.
    ahead: Ahead,
    /// Turns of the loop over pieces and events so far.
    turns: u32,
    /// The cycle that repeats, while the shaft keeps its velocity.
    repeat: Option<Repeat>,
    /// The last slip at a steady speed: the next one is the same.
    steady: Option<SteadySlip>,
    /// The last frozen slip: s·Ω when it began, and its duration, s.
    frozen: (f64, f64),
}

#[derive(Clone, Copy, Debug)]
enum State {
    /// θ = theta + (φ − phi): anchored at the last event.
    Stick {
        theta: f64,
        phi: f64,
    },
    Slip(Slip),
}

#[derive(Clone, Copy, Debug)]
struct Slip {
    sense: Sense,
    /// Time of its beginning, s.
    start_s: f64,
    /// Time of its end, s: known for `frozen`, infinite for the others.
    end_s: f64,
    /// θ − s·Tk/kr when it began, rad.
    x: f64,
    /// θ̇ when it began, rad/s.
    v: f64,
}

impl<'a> Reference<'a> {
    /// An object in stick at θ = 0 at the start of `motion`.
    pub fn new(settings: &Validated<Settings>, motion: &'a Motion) -> Self {
        let piece = motion.piece(0.0);
        let p = &settings.parameters;
        Self {
            motion,
            settings: **settings,
            swing: Swing::of(p),
            kinetic_angle_rad: p.kinetic_torque_nm / p.stiffness_nm_per_rad,
            natural_rad_s: p.natural_rad_s(),
            impedance: p.impedance_nms_per_rad(),
            steady: None,
            frozen: (f64::NAN, f64::NAN),
            piece,
            piece_place: 0,
            snap_bound: piece.snap_bound(),
            time_s: 0.0,
            now: piece.at(0.0),
            state: State::Stick {
                theta: 0.0,
                phi: piece.at(0.0).phi_rad,
            },
            ahead: Ahead::from(0.0),
            turns: 0,
            repeat: None,
        }
    }

    /// Advances to `to_s` and reports every event on the way with its time
    /// since the start of the run, s, in `fraction`.
    pub fn advance(&mut self, to_s: f64, mut on_event: impl FnMut(Event<f64>)) {
        match self.follow(to_s, &mut on_event) {
            ControlFlow::Continue(()) => {}
        }
    }

    /// Advances as [`Self::advance`] does, for a follower that may end the run early; what
    /// it ends at is no whole event then.
    ///
    /// # Errors
    /// Error of the follower.
    pub fn follow<F: Follow>(&mut self, to_s: f64, follower: &mut F) -> ControlFlow<F::Stop> {
        loop {
            self.turns = self.turns.wrapping_add(1);
            if self.turns.is_multiple_of(POLL_EVERY) {
                follower.poll(self.time_s)?;
            }
            if self.piece.end_s < self.unheeding_until_s().min(to_s) {
                self.next_piece();
                continue;
            }
            let horizon_s = self.piece.end_s.min(to_s);
            if self.next_event(horizon_s, follower)? {
                continue;
            }
            if self.piece.end_s > to_s {
                self.go_to(horizon_s);
                return ControlFlow::Continue(());
            }
            self.next_piece();
            self.now = self.piece.at(self.time_s);
            self.ahead = Ahead::from(self.time_s);
            if self.piece.jump {
                self.jump(follower)?;
            }
        }
    }

    /// The time before which nothing that the shaft does changes what happens, s: a frozen slip
    /// lasts as long as it lasts.
    #[inline]
    fn unheeding_until_s(&self) -> f64 {
        match self.state {
            State::Slip(slip) if self.settings.convention == Convention::Frozen => slip.end_s,
            _ => f64::NEG_INFINITY,
        }
    }

    /// Goes on to the next piece; the shaft is not computed there.
    fn next_piece(&mut self) {
        self.time_s = self.piece.end_s;
        self.piece = self.motion.piece_from(self.time_s, &mut self.piece_place);
        self.snap_bound = self.piece.snap_bound();
        self.repeat = None;
    }

    /// The shaft just before the present piece began.
    fn before_piece(&self) -> ShaftState {
        let start_s = self.piece.start_s;
        if start_s > 0.0 {
            self.motion.piece(start_s.next_down()).at(start_s)
        } else {
            self.piece.at(start_s)
        }
    }

    /// The shaft now; just after it, at a knot.
    #[inline]
    pub fn shaft(&self) -> ShaftState {
        self.now
    }

    /// Current phase.
    pub fn phase(&self) -> Phase {
        match self.state {
            State::Stick { .. } => Phase::Stick,
            State::Slip(slip) => Phase::Slip(slip.sense),
        }
    }

    /// The torque shown, N·m.
    pub fn torque_nm(&self) -> f64 {
        match self.state {
            State::Stick { theta, phi } => {
                self.limited(self.stick_torque(theta, phi, &self.shaft()))
            }
            State::Slip(slip) => self.slip_torque(slip.sense),
        }
    }

    /// Angle θ of the object, rad.
    pub fn theta_rad(&self) -> f64 {
        match self.state {
            State::Stick { theta, phi } => theta + (self.shaft().phi_rad - phi),
            State::Slip(slip) => {
                self.swing(&slip, self.time_s).0 + slip.sense.of_signed(self.kinetic_angle_rad)
            }
        }
    }

    /// Velocity θ̇ of the object, rad/s.
    pub fn theta_dot_rad_s(&self) -> f64 {
        match self.state {
            State::Stick { .. } => self.shaft().omega_rad_s,
            State::Slip(slip) => self.swing(&slip, self.time_s).1,
        }
    }

    /// A call: inside [`Self::follow`] it would take its registers.
    #[inline(never)]
    fn go_to(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.now = self.piece.at(time_s);
    }

    /// Carries out the next event up to `horizon_s`, within the piece.
    fn next_event<F: Follow>(
        &mut self,
        horizon_s: f64,
        follower: &mut F,
    ) -> ControlFlow<F::Stop, bool> {
        if self.repeat.is_some() {
            return self.next_of_cycle(horizon_s, follower);
        }
        if let State::Slip(slip) = &self.state
            && self.settings.convention == Convention::Frozen
        {
            // Known since it began.
            let (end_s, sense) = (slip.end_s, slip.sense);
            if end_s > horizon_s {
                return ControlFlow::Continue(false);
            }
            self.go_to(end_s);
            self.end_slip(sense, follower)?;
            return ControlFlow::Continue(true);
        }
        let now_s = self.time_s;
        let found = self.look_ahead(horizon_s, &mut || follower.poll(now_s))?;
        let Some(end) = found else {
            return ControlFlow::Continue(false);
        };
        self.go_to(end.time_s);
        match self.state {
            State::Stick { theta, phi } => {
                let shaft = &self.now;
                let torque = self.stick_torque(theta, phi, shaft);
                // A kink of the velocity may break it by a jump of the torque.
                let before = if self.time_s > self.piece.start_s {
                    torque
                } else {
                    self.stick_torque(theta, phi, &self.before_piece())
                };
                let theta =
                    self.break_angle(end.sense, torque, shaft, theta + (shaft.phi_rad - phi));
                let omega_rad_s = shaft.omega_rad_s;
                self.begin_slip(end.sense, (theta, omega_rad_s), before, follower)?;
            }
            State::Slip(Slip { sense, .. }) => self.end_slip(sense, follower)?,
        }
        ControlFlow::Continue(true)
    }

    /// Changes the state of the object, now.
    fn change(&mut self, state: State) {
        self.state = state;
        self.ahead = Ahead::from(self.time_s);
    }

    /// The torque that keeps the object with the shaft, N·m.
    fn stick_torque(&self, theta: f64, phi: f64, shaft: &ShaftState) -> f64 {
        let spring =
            self.settings.parameters.stiffness_nm_per_rad * (theta + (shaft.phi_rad - phi));
        match self.settings.convention {
            Convention::Physical => spring + self.inertial(shaft),
            Convention::Frozen | Convention::Paper => spring,
        }
    }

    /// J·Ω̇ + c·Ω, N·m.
    fn inertial(&self, shaft: &ShaftState) -> f64 {
        let p = &self.settings.parameters;
        p.inertia_kg_m2 * shaft.omega_dot + p.damping_nms_per_rad * shaft.omega_rad_s
    }

    /// Rounding error that a stick's torque can have, N·m: of the swing that
    /// leads to it, of the angle, and of the time.
    fn limit_slack_nm(&self, shaft: &ShaftState) -> f64 {
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        let turned = shaft.phi_rad.abs() + shaft.omega_rad_s.abs() * self.piece.age_s(self.time_s);
        let size = p.static_torque_nm
            + self.impedance * shaft.omega_rad_s.abs()
            + p.inertia_kg_m2 * shaft.omega_dot.abs()
            + p.damping_nms_per_rad * shaft.omega_rad_s.abs()
            + kr * turned;
        LIMIT_ROUNDINGS * f64::EPSILON * size
    }

    fn slip_torque(&self, sense: Sense) -> f64 {
        sense.of_signed(self.settings.parameters.kinetic_torque_nm)
    }

    fn limited(&self, torque_nm: f64) -> f64 {
        let limit = self.settings.parameters.static_torque_nm;
        torque_nm.min(limit).max(-limit)
    }

    /// (x, v) of a slip. A call, as [`Self::go_to`].
    #[inline(never)]
    fn swing(&self, slip: &Slip, time_s: f64) -> (f64, f64) {
        self.swing.after(slip.x, slip.v, time_s - slip.start_s)
    }
}
