//! The `reference` solver: from event to event on the true motion.
//!
//! There is no step. In a stick the torque is known from the shaft's angle, in
//! a slip the object's motion is a closed form, and the end of either is found
//! by a search that cannot miss the first root (`first_root`). What is
//! left is rounding, a few 1e-15 s an event: this is what the other solvers are
//! measured against.
//!
//! The rules are those of the model's `frozen` and `velocity_match` modules,
//! written a second time and for the true motion, so that each checks the
//! other.

mod find_break;
mod find_match;
mod first_root;
mod repeat;

use crepitus_model::oscillator::Oscillator;
use crepitus_model::{
    Convention, Event, EventKind, Phase, Real, Restart, Sense, Settings, Validated,
};
use crepitus_plant::{Motion, Piece, ShaftState};
use find_match::SteadySlip;

/// How near to the static limit counts as at it, as in the model.
const SLACK: f64 = <f64 as Real>::LIMIT_SLACK;

/// The stick-slip object on the true motion of the shaft.
#[derive(Clone, Debug)]
pub struct Reference<'a> {
    motion: &'a Motion,
    settings: Settings,
    oscillator: Oscillator<f64>,
    /// Tk/kr, rad.
    kinetic_angle_rad: f64,
    /// ωn, rad/s, and √(J·kr), N·m·s/rad.
    natural_rad_s: f64,
    impedance: f64,
    piece: Piece,
    time_s: f64,
    /// The shaft now; just after a knot, at it.
    now: ShaftState,
    state: State,
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
    /// When it began, s.
    start_s: f64,
    /// Until when no velocity match counts, s: after a touch the velocities
    /// have to part first.
    apart_s: f64,
    /// When it ends, s: known for `frozen`, infinite for the others.
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
            oscillator: Oscillator::of(p),
            kinetic_angle_rad: p.kinetic_torque_nm / p.stiffness_nm_per_rad,
            natural_rad_s: p.natural_rad_s(),
            impedance: p.impedance_nms_per_rad(),
            steady: None,
            frozen: (f64::NAN, f64::NAN),
            piece,
            time_s: 0.0,
            now: piece.at(0.0),
            state: State::Stick {
                theta: 0.0,
                phi: piece.at(0.0).phi_rad,
            },
        }
    }

    /// Goes on to `to_s` and reports every event on the way with its time
    /// since the start of the run, s, in `fraction`.
    pub fn advance(&mut self, to_s: f64, mut on_event: impl FnMut(Event<f64>)) {
        loop {
            let horizon_s = self.piece.end_s.min(to_s);
            if self.next_event(horizon_s, &mut on_event) {
                if self.piece.is_steady() {
                    self.repeat_cycles(horizon_s, &mut on_event);
                }
                continue;
            }
            self.go_to(horizon_s);
            if self.piece.end_s > to_s {
                return;
            }
            self.piece = self.motion.piece(self.piece.end_s);
            self.now = self.piece.at(self.time_s);
            if self.piece.jump {
                self.jump(&mut on_event);
            }
            if self.time_s >= to_s && self.piece.end_s > to_s {
                // An event due at once belongs to this instant.
                while self.next_event(to_s, &mut on_event) {}
                return;
            }
        }
    }

    /// The shaft now; just after it, at a knot.
    pub fn shaft(&self) -> ShaftState {
        self.now
    }

    /// What the object does now.
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

    fn go_to(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.now = self.piece.at(time_s);
    }

    /// Carries out the next event up to `horizon_s`, within the piece.
    fn next_event(&mut self, horizon_s: f64, on_event: &mut impl FnMut(Event<f64>)) -> bool {
        match self.state {
            State::Stick { theta, phi } => {
                let Some((time_s, sense)) = self.find_break(theta, phi, horizon_s) else {
                    return false;
                };
                self.go_to(time_s);
                let shaft = self.now;
                let before = self.stick_torque(theta, phi, &shaft);
                let theta = self.break_angle(sense, before, &shaft, theta + (shaft.phi_rad - phi));
                self.begin_slip(sense, (theta, shaft.omega_rad_s), before, on_event);
                true
            }
            State::Slip(slip) => {
                let time_s = if self.settings.convention == Convention::Frozen {
                    (slip.end_s <= horizon_s).then_some(slip.end_s)
                } else {
                    self.find_match(&slip, horizon_s)
                };
                let Some(time_s) = time_s else {
                    return false;
                };
                self.go_to(time_s);
                self.end_slip(&slip, on_event);
                true
            }
        }
    }

    /// θ at a break. At the static limit it is known better than the sum of
    /// the travel, which carries the rounding of a large angle.
    fn break_angle(&self, sense: Sense, torque: f64, shaft: &ShaftState, theta: f64) -> f64 {
        let p = &self.settings.parameters;
        let limit = sense.of_signed(p.static_torque_nm);
        if (torque - limit).abs() > SLACK * p.static_torque_nm {
            return theta;
        }
        let inertial = match self.settings.convention {
            Convention::Physical => self.inertial(shaft),
            Convention::Frozen | Convention::Paper => 0.0,
        };
        (limit - inertial) / p.stiffness_nm_per_rad
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

    fn slip_torque(&self, sense: Sense) -> f64 {
        sense.of_signed(self.settings.parameters.kinetic_torque_nm)
    }

    /// Ts = Tk, as far as numbers tell.
    fn touches(&self) -> bool {
        let p = &self.settings.parameters;
        p.static_torque_nm - p.kinetic_torque_nm <= SLACK * p.static_torque_nm
    }

    fn limited(&self, torque_nm: f64) -> f64 {
        let limit = self.settings.parameters.static_torque_nm;
        torque_nm.min(limit).max(-limit)
    }

    /// (x, v) of a slip.
    fn swing(&self, slip: &Slip, time_s: f64) -> (f64, f64) {
        self.oscillator
            .transition(time_s - slip.start_s)
            .apply(slip.x, slip.v)
    }

    /// Begins a slip now, object at (θ, θ̇).
    fn begin_slip(
        &mut self,
        sense: Sense,
        (theta, v): (f64, f64),
        torque_before_nm: f64,
        on_event: &mut impl FnMut(Event<f64>),
    ) {
        let omega = self.shaft().omega_rad_s;
        let from = self.phase();
        on_event(Event {
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
        });
        let slip = self.slip(sense, theta, v);
        self.state = State::Slip(slip);
    }

    /// As [`touch_slack_nm`](crepitus_model::Active::touch_slack_nm).
    fn touch_slack_nm(&self, omega_rad_s: f64) -> f64 {
        let limit = self.settings.parameters.static_torque_nm;
        f64::TOUCH_SLACK * (limit + self.impedance * omega_rad_s.abs())
    }

    /// A slip that begins now.
    fn slip(&mut self, sense: Sense, theta: f64, v: f64) -> Slip {
        let p = &self.settings.parameters;
        let drop = p.static_torque_nm - p.kinetic_torque_nm;
        let x = theta - sense.of_signed(self.kinetic_angle_rad);
        let end_s = if self.settings.convention == Convention::Frozen {
            // Eqs. (10)–(11).
            let relative = sense.of_signed(v).max(0.0);
            if relative != self.frozen.0 {
                let lag = drop.atan2(relative * self.impedance);
                let duration_s = 2.0 * (std::f64::consts::PI - lag) / self.natural_rad_s;
                self.frozen = (relative, duration_s);
            }
            self.time_s + self.frozen.1
        } else {
            f64::INFINITY
        };
        Slip {
            sense,
            start_s: self.time_s,
            // A slip that begins with a touch does not end with it.
            apart_s: if self.touches() {
                self.apart_s(sense, x, v)
            } else {
                self.time_s
            },
            end_s,
            x,
            v,
        }
    }

    /// Until when velocities that touch now without crossing are surely apart,
    /// if they part: g ≥ g̈·d²/2 − |g⃛|·d³/6 is above zero up to 3·g̈/|g⃛|.
    fn apart_s(&self, sense: Sense, x: f64, v: f64) -> f64 {
        let shaft = self.shaft();
        let v_dot = self.oscillator.acceleration(x, v);
        let parting = sense.of_signed(shaft.omega_ddot - self.oscillator.acceleration(v, v_dot));
        let bounds = self.piece.bounds(self.time_s, self.piece.end_s);
        let snap = bounds.omega_dddot + self.oscillator.snap_bound(x, v);
        self.time_s + (3.0 * parting / snap).max(0.0)
    }

    /// Ends a slip now: in stick, in slip of the other sense, or in a touch.
    fn end_slip(&mut self, slip: &Slip, on_event: &mut impl FnMut(Event<f64>)) {
        let p = self.settings.parameters;
        let sense = slip.sense;
        let shaft = self.shaft();
        let theta = match (self.settings.convention, self.settings.restart) {
            (Convention::Frozen, Restart::Elastic) => {
                sense.of_signed(p.restart_torque_nm() / p.stiffness_nm_per_rad)
            }
            (Convention::Frozen, Restart::FromKinetic) => sense.of_signed(self.kinetic_angle_rad),
            _ => self.met_at(slip) + sense.of_signed(self.kinetic_angle_rad),
        };
        let required = self.stick_torque(theta, shaft.phi_rad, &shaft);
        let limit = p.static_torque_nm;
        let beyond = required.abs() > limit * (1.0 + SLACK);
        let true_torque = p.stiffness_nm_per_rad * theta + self.inertial(&shaft);
        // The sense in which it slips on, if stick cannot hold it.
        let slips = Sense::of(required)
            .filter(|s| beyond && s.of_signed(true_torque) >= p.kinetic_torque_nm * (1.0 - SLACK));
        if let Some(other) = slips
            && other != sense
        {
            let before = self.slip_torque(sense);
            self.begin_slip(other, (theta, shaft.omega_rad_s), before, on_event);
            return;
        }
        // With Ts = Tk the stick would break where it begins.
        let breaks_at_once = self.touches()
            && !beyond
            && sense.of_signed(required) >= limit - self.touch_slack_nm(shaft.omega_rad_s)
            && sense.of_signed(shaft.omega_rad_s) > 0.0;
        if slips.is_some() || breaks_at_once {
            // A touch: the velocities meet and part again. The slip goes on,
            // and nothing is felt or reported.
            let slip = self.slip(sense, theta, shaft.omega_rad_s);
            self.state = State::Slip(Slip {
                apart_s: self.apart_s(sense, slip.x, slip.v),
                ..slip
            });
            return;
        }
        on_event(Event {
            kind: EventKind::Stick,
            fraction: self.time_s,
            from: Phase::Slip(sense),
            to: Phase::Stick,
            theta_rad: theta,
            theta_dot_rad_s: shaft.omega_rad_s,
            omega_rad_s: shaft.omega_rad_s,
            torque_before_nm: self.slip_torque(sense),
            torque_after_nm: self.limited(required),
        });
        self.state = State::Stick {
            theta,
            phi: shaft.phi_rad,
        };
    }

    /// The shaft's velocity has jumped: what sticks is torn loose, what slips
    /// may have to slip the other way. A frozen object does not notice.
    fn jump(&mut self, on_event: &mut impl FnMut(Event<f64>)) {
        if self.settings.convention == Convention::Frozen {
            return;
        }
        let shaft = self.shaft();
        let (theta, v, before) = match self.state {
            State::Stick { theta, phi } => {
                let left = self
                    .motion
                    .piece(self.piece.start_s.next_down())
                    .at(self.time_s);
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
            (Some(s), Phase::Slip(now)) if s == now => {}
            (Some(s), _) => self.begin_slip(s, (theta, v), before, on_event),
            (None, _) => {}
        }
    }
}
