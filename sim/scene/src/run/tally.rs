//! Totals of a run: events, cycles, torque, energy.
//!
//! Energy is booked by phase, from its two ends and closed forms, so a slip
//! costs nothing per step. The terms of one run satisfy
//!
//! ```text
//! work_in + convention = Δspring + Δkinetic + friction + viscous + residual
//! ```
//!
//! `work_in` is ∫T·dφ of the torque shown. `convention` is the energy that the
//! object gains without a torque being shown for it: under `frozen` and
//! `paper` the inertia and damping that the stick torque leaves out, under
//! `frozen` also the reset at the end of a slip, and with Ts = Tk where it goes on instead; behind
//! a device also what it does while it refuses samples. `residual` is what numerical error leaves.

use super::TorqueSummary;
use super::energy::Energy;
use super::lead::Lead;
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_model::{Convention, Event, EventKind, Phase, Sense, Settings};
use crepitus_plant::Extremes;

/// Extremes, mean and root mean square of a torque, over time or over samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct TorqueTally {
    extremes_nm: Extremes<f64>,
    /// ∫T dt, N·m·s, or the sum of samples, N·m.
    integral: f64,
    /// ∫T² dt, N²·m²·s, or the sum of squares, N²·m².
    square: f64,
}

impl TorqueTally {
    /// Adds a sample.
    #[inline]
    pub fn add(&mut self, torque_nm: f64) {
        self.extremes_nm.add(torque_nm);
        self.integral += torque_nm;
        self.square += torque_nm * torque_nm;
    }

    /// Returns the summary over `whole`: the time, s, or the number of samples.
    pub fn summary(&self, whole: f64) -> TorqueSummary {
        TorqueSummary {
            min_nm: self.extremes_nm.low,
            mean_nm: self.integral / whole,
            max_nm: self.extremes_nm.high,
            rms_nm: (self.square / whole).sqrt(),
        }
    }
}

/// Cycles: break to break in the same sense with one stick between.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cycles {
    pub(super) count: u64,
    pub(super) total_s: f64,
    pub(super) length_s: Extremes<f64>,
    last_break: Option<(f64, Sense)>,
}

/// One end of a stretch of stick.
#[derive(Clone, Copy, Debug)]
pub(super) struct StickEnd {
    pub(super) theta_rad: f64,
    pub(super) omega_rad_s: f64,
    pub(super) omega_dot: f64,
}

/// The shaft in a stretch of stick, as all joints have it that stick meanwhile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    dt_s: f64,
    delta_phi: f64,
    /// Velocity, rad/s, and acceleration, rad/s², at both ends.
    from: (f64, f64),
    to: (f64, f64),
    /// ∫Ω² dt of a linear Ω.
    omega_squared: f64,
    /// ∫θ dt beyond the mean of its ends, of a cubic with their slopes.
    theta_dt: f64,
}

impl Stretch {
    /// A stretch of `dt_s`, in which the shaft turned by `delta_phi`, with velocity and acceleration at its ends.
    #[inline]
    pub(super) fn new(dt_s: f64, delta_phi: f64, from: (f64, f64), to: (f64, f64)) -> Self {
        let (a, b) = (from.0, to.0);
        Self {
            dt_s,
            delta_phi,
            from,
            to,
            omega_squared: dt_s * (a * a + a * b + b * b) / 3.0,
            theta_dt: dt_s * dt_s * (a - b) / 12.0,
        }
    }

    /// The end of it with the object at `theta_rad`.
    #[inline]
    pub(super) fn end(&self, theta_rad: f64) -> StickEnd {
        let (omega_rad_s, omega_dot) = self.to;
        StickEnd {
            theta_rad,
            omega_rad_s,
            omega_dot,
        }
    }
}

/// The running totals.
#[derive(Clone, Debug)]
pub(super) struct Tally {
    settings: Settings,
    oscillator: Oscillator<f64>,
    start: ObjectState,
    pub(super) events: [u64; 3],
    pub(super) cycles: Cycles,
    pub(super) torque: TorqueTally,
    pub(super) energy: Energy,
    pub(super) lead: Lead,
    /// Ts = Tk under `frozen`: a slip goes on where it would end, with the shaft's velocity of then
    /// and without an event.
    goes_on: bool,
}

/// The object at some time, on a shaft at the angle `phi_rad`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectState {
    pub(super) phase: Phase,
    pub(super) time_s: f64,
    pub(super) phi_rad: f64,
    pub(super) theta_rad: f64,
    pub(super) theta_dot_rad_s: f64,
}

/// Time in which a device refuses samples: what it shows does not come from the object, which
/// stands still.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    start: ObjectState,
    /// ∫T dt, ∫T² dt and ∫T dφ of what is shown instead.
    integral: f64,
    square: f64,
    work_j: f64,
}

impl Gap {
    pub(super) fn new(start: ObjectState) -> Self {
        Self {
            start,
            integral: 0.0,
            square: 0.0,
            work_j: 0.0,
        }
    }

    /// A step of it.
    pub(super) fn hold(&mut self, torque_nm: f64, dt_s: f64, delta_phi: f64) {
        self.integral += torque_nm * dt_s;
        self.square += torque_nm * torque_nm * dt_s;
        self.work_j += torque_nm * delta_phi;
    }
}

impl Tally {
    /// A run that begins in stick at θ = 0 with the shaft at `omega_rad_s`;
    /// angles of the shaft count from here. `touches`: the solver takes Ts and Tk for equal.
    pub(super) fn new(settings: Settings, omega_rad_s: f64, lead: Lead, touches: bool) -> Self {
        Self {
            oscillator: Oscillator::of(&settings.parameters),
            start: ObjectState {
                phase: Phase::Stick,
                time_s: 0.0,
                phi_rad: 0.0,
                theta_rad: 0.0,
                theta_dot_rad_s: omega_rad_s,
            },
            events: [0; 3],
            cycles: Cycles::default(),
            torque: TorqueTally::default(),
            energy: Energy::new(&settings.parameters, omega_rad_s),
            lead,
            goes_on: touches && settings.convention == Convention::Frozen,
            settings,
        }
    }

    /// Notes a torque that was shown.
    #[inline]
    pub(super) fn shown(&mut self, torque_nm: f64) {
        self.torque.extremes_nm.add(torque_nm);
    }

    /// Notes a torque that was computed again, unless it is beyond the others by rounding only.
    #[inline]
    fn shown_again(&mut self, torque_nm: f64) {
        let Extremes { low, high } = self.torque.extremes_nm;
        let rounding_nm = 1e-6 * (torque_nm.abs() + high.max(-low));
        let known = low - rounding_nm..=high + rounding_nm;
        if !known.contains(&torque_nm) && torque_nm.is_finite() {
            self.shown(torque_nm);
        }
    }

    /// A stretch of stick of `dt_s` in which the shaft turned by `delta_phi`.
    pub(super) fn stick(&mut self, dt_s: f64, delta_phi: f64, a: StickEnd, b: StickEnd) {
        let shaft = |end: &StickEnd| (end.omega_rad_s, end.omega_dot);
        let stretch = Stretch::new(dt_s, delta_phi, shaft(&a), shaft(&b));
        self.stick_over(&stretch, a.theta_rad, b.theta_rad);
    }

    /// A stretch of stick, from one angle of the object to another.
    pub(super) fn stick_over(&mut self, stretch: &Stretch, from_rad: f64, to_rad: f64) {
        let Stretch {
            dt_s, delta_phi, ..
        } = *stretch;
        // Torn loose by a jump: what the stick would show there was not shown.
        if dt_s == 0.0 {
            return;
        }
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        // ∫θ dt over a cubic with these ends and slopes.
        let theta_dt = dt_s * (from_rad + to_rad) / 2.0 + stretch.theta_dt;
        let mut integral = kr * theta_dt;
        let (mut from, mut to) = (kr * from_rad, kr * to_rad);
        let viscous = p.damping_nms_per_rad * stretch.omega_squared;
        self.energy.viscous_j += viscous;
        if self.settings.convention == Convention::Physical {
            integral += p.inertia_kg_m2 * (stretch.to.0 - stretch.from.0)
                + p.damping_nms_per_rad * delta_phi;
            let inertial = |(omega, omega_dot): (f64, f64)| {
                p.inertia_kg_m2 * omega_dot + p.damping_nms_per_rad * omega
            };
            from += inertial(stretch.from);
            to += inertial(stretch.to);
            self.energy.work_in_j += viscous;
        } else {
            self.energy.convention_j += viscous;
        }
        // Held at the limit, or in a step that finds the break at its end only, less is shown
        // than the spring pulls.
        let limit = p.static_torque_nm;
        let shown = (from.clamp(-limit, limit), to.clamp(-limit, limit));
        let shown_nm = f64::midpoint(shown.0, shown.1);
        let excess = f64::midpoint(from, to) - shown_nm;
        // More than rounding: a break that was located is at the limit.
        if excess.abs() > 1e-12 * limit {
            self.energy.work_in_j -= excess * delta_phi;
            self.energy.convention_j += excess * delta_phi;
            integral = shown_nm * dt_s;
            (from, to) = shown;
        }
        // The shaft of the step is not that of the joint: the step had more events than it takes
        // in, or is far too long for the method.
        if integral.abs() > (1.0 + 1e-9) * limit * dt_s {
            integral = f64::midpoint(from, to) * dt_s;
        }
        for torque_nm in [from, to, integral / dt_s] {
            self.shown_again(torque_nm);
        }
        self.torque.integral += integral;
        self.torque.square += dt_s * (from * from + from * to + to * to) / 3.0;
    }

    /// A stretch of whole steps of `step_s` in stick, between `ends`, on a shaft of constant
    /// acceleration: the sum of what [`Self::stick`] makes of each.
    pub(super) fn stick_steps(
        &mut self,
        dt_s: f64,
        delta_phi: f64,
        (a, b): (StickEnd, StickEnd),
        step_s: f64,
    ) {
        self.stick(dt_s, delta_phi, a, b);
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        let torque_nm = |end: &StickEnd| match self.settings.convention {
            Convention::Physical => {
                kr * end.theta_rad
                    + p.inertia_kg_m2 * end.omega_dot
                    + p.damping_nms_per_rad * end.omega_rad_s
            }
            Convention::Frozen | Convention::Paper => kr * end.theta_rad,
        };
        let sum_nm = torque_nm(&a) + torque_nm(&b);
        // The mean of a parabola above that of its ends: over the whole, and over a step, of which the
        // square is that of a straight line.
        let above_nm = |dt_s: f64| -kr * a.omega_dot * dt_s * dt_s / 12.0;
        let (whole_nm, step_nm) = (above_nm(dt_s), above_nm(step_s));
        let integral = dt_s * (0.5 * sum_nm + whole_nm);
        self.torque.square += dt_s
            * (whole_nm * sum_nm + 1.2 * whole_nm * whole_nm + 0.8 * step_nm * step_nm)
            - 2.0 * step_nm * integral;
    }

    /// A stretch of stick under `frozen`, with these integrals of T, T² and Ω² over time.
    pub(super) fn spring_stick(&mut self, torque: f64, square: f64, omega_squared: f64) {
        let viscous = self.settings.parameters.damping_nms_per_rad * omega_squared;
        self.energy.viscous_j += viscous;
        self.energy.convention_j += viscous;
        self.torque.integral += torque;
        self.torque.square += square;
    }

    /// An event at `time_s`, shaft at `phi_rad`.
    pub(super) fn event(&mut self, time_s: f64, phi_rad: f64, event: &Event<f64>) {
        self.events[match event.kind {
            EventKind::Break => 0,
            EventKind::Stick => 1,
            EventKind::Reverse => 2,
        }] += 1;
        self.cycles.event(time_s, event);
        self.shown(event.torque_before_nm);
        self.shown(event.torque_after_nm);
        let frozen = self.settings.convention == Convention::Frozen;
        let (theta, theta_dot) = match self.start.phase {
            // Each that went on lasted a period, and ended as it began.
            Phase::Slip(_) if self.goes_on => (self.start.theta_rad, self.start.theta_dot_rad_s),
            // A frozen slip ends with a reset: the object's own state is the
            // closed form.
            Phase::Slip(sense) if frozen => self.swing(sense, time_s - self.start.time_s),
            _ => (event.theta_rad, event.theta_dot_rad_s),
        };
        self.end_phase(time_s, phi_rad, theta, theta_dot);
        if frozen && event.kind == EventKind::Stick {
            self.energy
                .reset(theta, theta_dot, event.theta_rad, event.theta_dot_rad_s);
        }
        self.start = ObjectState {
            phase: event.to,
            time_s,
            phi_rad,
            theta_rad: event.theta_rad,
            theta_dot_rad_s: event.theta_dot_rad_s,
        };
    }

    /// A stretch in which this torque was shown.
    pub(super) fn constant(&mut self, torque_nm: f64, dt_s: f64) {
        self.torque.integral += torque_nm * dt_s;
        self.torque.square += torque_nm * torque_nm * dt_s;
        self.shown(torque_nm);
    }

    /// The end of a gap after which the object goes on in its phase.
    pub(super) fn caught_up(&mut self, gap: &Gap) {
        // Of a slip the whole time counts when it ends.
        if gap.start.phase == Phase::Stick {
            self.torque.integral += gap.integral;
            self.torque.square += gap.square;
        }
        self.energy.held(gap.work_j);
    }

    /// The end of a gap after which the object begins again.
    pub(super) fn restart(&mut self, gap: &Gap, now: ObjectState) {
        let s = gap.start;
        self.end_phase(s.time_s, s.phi_rad, s.theta_rad, s.theta_dot_rad_s);
        self.torque.integral += gap.integral;
        self.torque.square += gap.square;
        self.energy.held(gap.work_j);
        self.energy.reset(
            s.theta_rad,
            s.theta_dot_rad_s,
            now.theta_rad,
            now.theta_dot_rad_s,
        );
        self.cycles.last_break = None;
        self.start = now;
    }

    /// Completes the totals at the end of the run.
    pub(super) fn finish(&mut self, time_s: f64, phi_rad: f64, theta: f64, theta_dot: f64) {
        self.end_phase(time_s, phi_rad, theta, theta_dot);
        self.energy.finish(theta, theta_dot);
    }

    /// State of the object `after_s` into the present slip.
    fn swing(&self, sense: Sense, after_s: f64) -> (f64, f64) {
        let centre = sense.of_signed(
            self.settings.parameters.kinetic_torque_nm
                / self.settings.parameters.stiffness_nm_per_rad,
        );
        let (x, v) = self
            .oscillator
            .transition(after_s)
            .apply(self.start.theta_rad - centre, self.start.theta_dot_rad_s);
        (x + centre, v)
    }

    fn end_phase(&mut self, time_s: f64, phi_rad: f64, theta: f64, theta_dot: f64) {
        let p = self.settings.parameters;
        let s = self.start;
        let delta_phi = phi_rad - s.phi_rad;
        match s.phase {
            Phase::Stick => {
                let mean_theta = s.theta_rad + delta_phi / 2.0;
                self.energy.work_in_j += p.stiffness_nm_per_rad * mean_theta * delta_phi;
                let kinetic = 0.5
                    * p.inertia_kg_m2
                    * (theta_dot - s.theta_dot_rad_s)
                    * (theta_dot + s.theta_dot_rad_s);
                if self.settings.convention == Convention::Physical {
                    self.energy.work_in_j += kinetic;
                } else {
                    self.energy.convention_j += kinetic;
                }
            }
            Phase::Slip(sense) => {
                let torque = sense.of_signed(p.kinetic_torque_nm);
                let dt_s = time_s - s.time_s;
                self.torque.integral += torque * dt_s;
                self.torque.square += torque * torque * dt_s;
                self.shown(torque);
                self.energy.work_in_j += torque * delta_phi;
                self.energy.friction_j += torque * (delta_phi - (theta - s.theta_rad));
                let centre = torque / p.stiffness_nm_per_rad;
                if self.goes_on {
                    // A slip alone keeps the energy of its swing.
                    self.energy.reset(
                        s.theta_rad - centre,
                        s.theta_dot_rad_s,
                        theta - centre,
                        theta_dot,
                    );
                }
                if p.damping_nms_per_rad > 0.0 {
                    self.energy.viscous_j += super::energy::viscous_loss(
                        &p,
                        &self.oscillator,
                        (s.theta_rad - centre, s.theta_dot_rad_s),
                        dt_s,
                    );
                }
            }
        }
    }
}

impl Cycles {
    fn event(&mut self, time_s: f64, event: &Event<f64>) {
        match (event.kind, event.to) {
            (EventKind::Break, Phase::Slip(sense)) => {
                if let Some((last_s, last_sense)) = self.last_break
                    && last_sense == sense
                {
                    let length_s = time_s - last_s;
                    self.length_s.add(length_s);
                    self.count += 1;
                    self.total_s += length_s;
                }
                self.last_break = Some((time_s, sense));
            }
            (EventKind::Reverse, _) => self.last_break = None,
            _ => {}
        }
    }
}
