//! The work that every contestant does, and what it should come to.
//!
//! Ten seconds of a preset's stick-slip object on a shaft that turns at 1 rad/s. At a constant
//! speed every event has a closed form, so errors are measured against no other solver.
//!
//! The peers see it as an ODE with two modes. Its state is (u, v) with u = ωn·θ and v = θ̇, both
//! rad/s: in these units both are of order one in a slip, and one tolerance serves both.
//!
//! ```text
//! stick: u̇ = ωn·v   v̇ = 0               ends when Ts − kr·θ falls through zero
//! slip:  u̇ = ωn·v   v̇ = ωn·(uk − u)     ends when Ω − v falls through zero
//! ```

use crepitus_model::Parameters;
use std::f64::consts::PI;
use std::hint::black_box;

/// Ω, rad/s.
pub const OMEGA: f64 = 1.0;
/// Duration of the run, s.
pub const DURATION_S: f64 = 10.0;
/// Samples a second: every 50 µs.
pub const RATE_HZ: f64 = 20_000.0;
/// Number of samples; the first is at 50 µs, the last at the end.
pub const SAMPLES: usize = 200_000;

/// Output that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// All events, and the torque at every sample through the library's dense output.
    Samples,
    /// The same, but where the torque is known without the state (T = Tk in a slip) it is filled
    /// in: only sticks are sampled. What a user who knows this system would do.
    SamplesInStick,
    /// The events only.
    Events,
}

impl Task {
    /// All tasks.
    pub const ALL: [Self; 3] = [Self::Samples, Self::SamplesInStick, Self::Events];
}

/// Mode of the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Motion with the shaft.
    Stick,
    /// Swing, driven by Tk.
    Slip,
}

impl Mode {
    /// The mode after the event that ends this one.
    pub fn next(self) -> Self {
        match self {
            Self::Stick => Self::Slip,
            Self::Slip => Self::Stick,
        }
    }
}

/// State at the start: in stick at θ = 0.
pub const START: [f64; 2] = [0.0, OMEGA];

/// The two-mode ODE and the closed form, with what both compute once.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// The object.
    pub parameters: Parameters,
    /// ωn, rad/s.
    pub natural: f64,
    /// u at which a slip is without force.
    kinetic_u: f64,
    /// u at which a stick breaks.
    static_u: f64,
    /// kr/ωn: torque of a unit of u.
    torque_per_u: f64,
    /// Length of a stick, s.
    pub stick_s: f64,
    /// Length of a slip, s.
    pub slip_s: f64,
    /// The first break, s.
    first_s: f64,
}

impl Work {
    /// The work with an object.
    pub fn new(parameters: Parameters) -> Self {
        let stiffness = parameters.stiffness_nm_per_rad;
        let (kinetic, limit) = (parameters.kinetic_torque_nm, parameters.static_torque_nm);
        let natural = parameters.natural_rad_s();
        let lambda = (limit - kinetic) / (OMEGA * parameters.impedance_nms_per_rad());
        Self {
            parameters,
            natural,
            kinetic_u: natural * kinetic / stiffness,
            static_u: natural * limit / stiffness,
            torque_per_u: stiffness / natural,
            stick_s: 2.0 * (limit - kinetic) / (stiffness * OMEGA),
            slip_s: 2.0 * (PI - lambda.atan()) / natural,
            first_s: limit / (stiffness * OMEGA),
        }
    }

    /// Right-hand side.
    #[inline]
    pub fn derivative(&self, mode: Mode, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = self.natural * y[1];
        dydt[1] = match mode {
            Mode::Stick => 0.0,
            Mode::Slip => self.natural * (self.kinetic_u - y[0]),
        };
    }

    /// Jacobian times `w`.
    #[inline]
    pub fn jacobian_times(&self, mode: Mode, w: &[f64], out: &mut [f64]) {
        out[0] = self.natural * w[1];
        out[1] = match mode {
            Mode::Stick => 0.0,
            Mode::Slip => -self.natural * w[0],
        };
    }

    /// Positive within a mode; falls through zero at its end.
    #[inline]
    pub fn event(&self, mode: Mode, y: &[f64]) -> f64 {
        match mode {
            Mode::Stick => self.static_u - y[0],
            Mode::Slip => OMEGA - y[1],
        }
    }

    /// The torque shown, N·m. The caller has the state at that time: without the black box the
    /// compiler sees that a slip does not need it, and drops the interpolation.
    #[inline]
    pub fn torque(&self, mode: Mode, y: &[f64]) -> f64 {
        let y = black_box(y);
        match mode {
            Mode::Stick => self.torque_per_u * y[0],
            Mode::Slip => self.parameters.kinetic_torque_nm,
        }
    }

    /// State after the event: at v = Ω exactly.
    pub fn restart(y: [f64; 2]) -> [f64; 2] {
        [y[0], OMEGA]
    }

    /// The longest step that cannot pass over the end of a slip: how long v would stay above Ω if
    /// nothing happened. A detector that compares signs at the ends of a step needs it; the ends
    /// of a longer step may both lie below.
    pub fn safe_step_s(&self) -> f64 {
        // The other part of the turn of which the slip is one; short of it by 1 %.
        0.99 * (2.0 * PI / self.natural - self.slip_s)
    }

    /// Every event by the closed form, s.
    pub fn closed_form_events(&self) -> Vec<f64> {
        let cycle_s = self.stick_s + self.slip_s;
        let mut events = Vec::new();
        let mut slips = 0.0;
        loop {
            // Each from the first, so that nothing adds up.
            let begins_s = self.first_s + slips * cycle_s;
            for event_s in [begins_s, begins_s + self.slip_s] {
                if event_s > DURATION_S {
                    return events;
                }
                events.push(event_s);
            }
            slips += 1.0;
        }
    }

    /// The torque at `time_s` by the closed form; none within 1 µs of an event, where an error of
    /// time is an error of the whole jump.
    pub fn closed_form_torque(&self, time_s: f64) -> Option<f64> {
        const NEAR_S: f64 = 1e-6;
        let p = &self.parameters;
        let per_second = p.stiffness_nm_per_rad * OMEGA;
        let kinetic = p.kinetic_torque_nm;
        let cycle_s = self.stick_s + self.slip_s;
        let since_s = time_s - self.first_s;
        let near = |x: f64| x.abs() <= NEAR_S;
        if near(since_s) {
            return None;
        }
        if since_s < 0.0 {
            return Some(per_second * time_s);
        }
        let in_cycle_s = since_s.rem_euclid(cycle_s);
        let in_stick_s = in_cycle_s - self.slip_s;
        if near(in_cycle_s) || near(in_stick_s) || near(in_cycle_s - cycle_s) {
            None
        } else if in_stick_s < 0.0 {
            Some(kinetic)
        } else {
            Some((2.0 * kinetic - p.static_torque_nm) + per_second * in_stick_s)
        }
    }
}

/// Time of sample `n`, s.
#[inline]
#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
pub fn sample_s(n: usize) -> f64 {
    const STEP_S: f64 = 1.0 / RATE_HZ;
    (n + 1) as f64 * STEP_S
}

/// Output of a contestant. Made once: nobody pays for its memory.
#[derive(Clone, Debug)]
pub struct Delivery {
    /// Times of the events in their order, s.
    pub events: Vec<f64>,
    /// Torque at each sample, N·m.
    pub torque: Vec<f64>,
}

impl Delivery {
    /// Room for everything.
    pub fn new() -> Self {
        Self {
            events: Vec::with_capacity(4096),
            torque: vec![f64::NAN; SAMPLES],
        }
    }

    /// Forgets what was delivered, so that what is not delivered shows.
    pub fn wipe(&mut self) {
        self.events.clear();
        self.torque.fill(f64::NAN);
    }
}

/// Delivers samples in their order as a solver gets on.
pub struct Sampler<'a> {
    task: Task,
    kinetic: f64,
    torque: &'a mut [f64],
    next: usize,
}

impl<'a> Sampler<'a> {
    /// Begins with the first sample.
    pub fn new(work: &Work, task: Task, torque: &'a mut [f64]) -> Self {
        Self {
            task,
            kinetic: work.parameters.kinetic_torque_nm,
            torque,
            next: 0,
        }
    }

    /// Delivers the samples up to `until_s`, all in `mode`; `torque_at` has their torque at a time
    /// that is never after `until_s`.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a time of the run is not negative, and its samples are few"
    )]
    pub fn deliver(&mut self, mode: Mode, until_s: f64, mut torque_at: impl FnMut(f64) -> f64) {
        if self.task == Task::Events {
            return;
        }
        let end = ((until_s * RATE_HZ) as usize).clamp(self.next, SAMPLES);
        let begin = std::mem::replace(&mut self.next, end);
        if self.task == Task::SamplesInStick && mode == Mode::Slip {
            self.torque[begin..end].fill(self.kinetic);
            return;
        }
        for n in begin..end {
            self.torque[n] = torque_at(sample_s(n).min(until_s));
        }
    }
}

/// One solver with its settings, set up and ready to do the work again and again.
///
/// # Errors
/// The solver's message if it gives up.
pub type Runner = Box<dyn FnMut(Task, &mut Delivery) -> Result<(), String>>;

#[cfg(test)]
mod tests;
