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

mod first_root;

use crepitus_model::oscillator::Oscillator;
use crepitus_model::{
    Convention, Event, EventKind, Phase, Real, Restart, Sense, Settings, Validated,
};
use crepitus_plant::{Motion, Piece, ShaftState};
use first_root::{Sample, first_root};

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
    piece: Piece,
    time_s: f64,
    state: State,
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
            oscillator: Oscillator::new(p),
            kinetic_angle_rad: p.kinetic_torque_nm / p.stiffness_nm_per_rad,
            piece,
            time_s: 0.0,
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
                continue;
            }
            self.time_s = horizon_s;
            if self.piece.end_s > to_s {
                return;
            }
            self.piece = self.motion.piece(self.piece.end_s);
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
        self.piece.at(self.time_s)
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

    /// Carries out the next event up to `horizon_s`, within the piece.
    fn next_event(&mut self, horizon_s: f64, on_event: &mut impl FnMut(Event<f64>)) -> bool {
        match self.state {
            State::Stick { theta, phi } => {
                let Some((time_s, sense)) = self.find_break(theta, phi, horizon_s) else {
                    return false;
                };
                let shaft = self.piece.at(time_s);
                let before = self.stick_torque(theta, phi, &shaft);
                let theta = theta + (shaft.phi_rad - phi);
                self.time_s = time_s;
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
                self.time_s = time_s;
                self.end_slip(&slip, on_event);
                true
            }
        }
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

    /// When s·T first reaches `limit_nm` in a stick whose torque is the
    /// spring's, with the object's inertia and damping if `inertial`.
    fn reaches(
        &self,
        (theta, phi): (f64, f64),
        inertial: bool,
        (sense, limit_nm): (Sense, f64),
        (from_s, to_s): (f64, f64),
    ) -> Option<f64> {
        let p = &self.settings.parameters;
        let (j, c) = if inertial {
            (p.inertia_kg_m2, p.damping_nms_per_rad)
        } else {
            (0.0, 0.0)
        };
        let kr = p.stiffness_nm_per_rad;
        let bounds = self.piece.bounds(from_s, to_s);
        let bound = kr * bounds.omega_dot + c * bounds.omega_ddot + j * bounds.omega_dddot;
        first_root(from_s, to_s, |time_s| {
            let s = self.piece.at(time_s);
            let torque = kr * (theta + (s.phi_rad - phi)) + (j * s.omega_dot + c * s.omega_rad_s);
            let rate = kr * s.omega_rad_s + (j * s.omega_ddot + c * s.omega_dot);
            Sample {
                value: limit_nm - sense.of_signed(torque),
                slope: -sense.of_signed(rate),
                bound,
                noise: 2.0 * f64::EPSILON * (limit_nm + torque.abs()),
                slack: SLACK * limit_nm,
            }
        })
    }

    /// The next break of a stick up to `to_s`.
    fn find_break(&self, theta: f64, phi: f64, to_s: f64) -> Option<(f64, Sense)> {
        let anchor = (theta, phi);
        let limit = self.settings.parameters.static_torque_nm;
        let physical = self.settings.convention == Convention::Physical;
        let at = |sense, from_s| {
            self.reaches(anchor, physical, (sense, limit), (from_s, to_s))
                .map(|t| (t, sense))
        };
        let first = match (
            at(Sense::Positive, self.time_s),
            at(Sense::Negative, self.time_s),
        ) {
            (Some(p), Some(n)) => Some(if n.0 < p.0 { n } else { p }),
            (p, n) => p.or(n),
        }?;
        if self.settings.convention != Convention::Paper {
            return Some(first);
        }
        // `paper`: a slip cannot begin while the shaft brakes too hard for it;
        // until the true torque reaches Tk the stick is held at its limit.
        let (mut time_s, sense) = first;
        let kinetic = self.settings.parameters.kinetic_torque_nm;
        loop {
            let slips_s = self.reaches(anchor, true, (sense, kinetic), (time_s, to_s))?;
            let shaft = self.piece.at(slips_s);
            let torque = sense.of_signed(self.stick_torque(theta, phi, &shaft));
            if torque >= limit * (1.0 - SLACK) {
                return Some((slips_s, sense));
            }
            // Meanwhile the spring fell below the limit: look for it again.
            (time_s, _) = at(sense, slips_s)?;
        }
    }

    /// The next velocity match of a slip up to `to_s`.
    fn find_match(&self, slip: &Slip, to_s: f64) -> Option<f64> {
        let from_s = self.time_s.max(slip.apart_s);
        if from_s > to_s {
            return None;
        }
        let motion_bound = self.piece.bounds(from_s, to_s).omega_ddot;
        first_root(from_s, to_s, |time_s| {
            let (x, v) = self.swing(slip, time_s);
            let s = self.piece.at(time_s);
            let speed = s.omega_rad_s.abs() + self.oscillator.speed_bound(x, v);
            let noise = 2.0 * f64::EPSILON * speed;
            Sample {
                value: slip.sense.of_signed(s.omega_rad_s - v),
                slope: slip
                    .sense
                    .of_signed(s.omega_dot - self.oscillator.acceleration(x, v)),
                bound: motion_bound + self.oscillator.jerk_bound(x, v),
                noise,
                slack: noise,
            }
        })
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
        self.state = State::Slip(self.slip(sense, theta, v));
    }

    /// A slip that begins now.
    fn slip(&self, sense: Sense, theta: f64, v: f64) -> Slip {
        let p = &self.settings.parameters;
        let drop = p.static_torque_nm - p.kinetic_torque_nm;
        let end_s = if self.settings.convention == Convention::Frozen {
            // Eqs. (10)–(11).
            let lag = drop.atan2(sense.of_signed(v).max(0.0) * p.impedance_nms_per_rad());
            self.time_s + 2.0 * (std::f64::consts::PI - lag) / p.natural_rad_s()
        } else {
            f64::INFINITY
        };

        Slip {
            sense,
            start_s: self.time_s,
            // A slip that begins with a touch does not end with it.
            apart_s: if self.touches() {
                self.time_s + self.oscillator.quarter_radian_s()
            } else {
                self.time_s
            },
            end_s,
            x: theta - sense.of_signed(self.kinetic_angle_rad),
            v,
        }
    }

    /// Ends a slip now: in stick, in slip of the other sense, or in a touch.
    fn end_slip(&mut self, slip: &Slip, on_event: &mut impl FnMut(Event<f64>)) {
        let p = self.settings.parameters;
        let sense = slip.sense;
        let shaft = self.shaft();
        let (x, _) = self.swing(slip, self.time_s);
        let theta = match (self.settings.convention, self.settings.restart) {
            (Convention::Frozen, Restart::Elastic) => {
                sense.of_signed(p.restart_torque_nm() / p.stiffness_nm_per_rad)
            }
            (Convention::Frozen, Restart::FromKinetic) => sense.of_signed(self.kinetic_angle_rad),
            _ => x + sense.of_signed(self.kinetic_angle_rad),
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
            && sense.of_signed(required) >= limit * (1.0 - <f64 as Real>::TOUCH_SLACK)
            && sense.of_signed(shaft.omega_rad_s) > 0.0;
        if slips.is_some() || breaks_at_once {
            // A touch: the velocities meet and part again. The slip goes on,
            // and nothing is felt or reported.
            self.state = State::Slip(Slip {
                apart_s: self.time_s + self.oscillator.quarter_radian_s(),
                ..self.slip(sense, theta, shaft.omega_rad_s)
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
