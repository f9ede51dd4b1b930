//! The torque that a device holds, against the true one over continuous time.
//!
//! A device shows the torque of tick n until tick n + 1. The error that the hand
//! feels is therefore not that at the tick but
//!
//! ```text
//! e² = 1/(N·h) · Σₙ ∫ (Tₙ − T(t))² dt,   t from tₙ to tₙ₊₁
//! ```
//!
//! with Tₙ the joint's torque at tₙ and T the reference's torque: the
//! spring's along the true motion in a stick, s·Tk in a slip, and its jumps
//! at the events, not at the ticks. (A delay between sample and torque
//! is additional; it is the device's, not the solver's.)
//!
//! For every tick the mean m and the variance v of T within it are enough,
//! since the mean of (Tₙ − T)² over the tick is (Tₙ − m)² + v. No held value
//! can avoid the variance: √(mean of v) is the floor of holding.
//!
//! T is integrated from event to event and from knot to knot of the motion: in
//! a slip it is constant; in a stick the three-point Gauss rule is exact where
//! Ω is linear in time, and of sixth order elsewhere.
//!
//! At a constant speed, with ticks at no special phase, closed forms exist:
//! with Δ = Ts − Tk, the ramp r = kr·Ω and the period P of a cycle a joint
//! without an error of its own is off by
//!
//! ```text
//! e² = (Δ²·h − r²·h³/12)/P
//! ```
//!
//! which is nearly Δ·√(h/P), and the floor is √((Δ²·h/3 − r²·h³/60)/P), nearly
//! √3 times less.

use crate::accuracy::scenes::StudyScene;
use crate::sampling::Sampling;
use crate::true_events::TrueEvent;
use crepitus_model::{Convention, EventKind, Real};
use crepitus_plant::{Extremes, Motion, Piece, ShaftState};

/// Nodes and weights of the three-point Gauss rule on (0, 1).
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Number of parts of an interval that may have a kink.
const KINKED_PARTS: u32 = 32;

/// The true torque within every tick.
#[derive(Clone, Debug, Default)]
pub struct HeldTorque {
    ticks: Vec<Tick>,
}

/// The true torque within one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Mean, N·m.
    pub mean_nm: f64,
    /// Mean of the squared distance from the mean, (N·m)².
    pub variance: f64,
    /// Smallest, N·m, of the ends and nodes of its parts.
    pub low_nm: f64,
    /// Largest, likewise.
    pub high_nm: f64,
}

impl Tick {
    /// Mean of (`held_nm` − T)² over the tick, (N·m)².
    #[inline]
    pub fn mean_square(&self, held_nm: f64) -> f64 {
        let offset_nm = held_nm - self.mean_nm;
        offset_nm * offset_nm + self.variance
    }

    /// Largest |`held_nm` − T| within the tick, N·m.
    #[inline]
    pub fn largest_nm(&self, held_nm: f64) -> f64 {
        (held_nm - self.low_nm)
            .abs()
            .max((held_nm - self.high_nm).abs())
    }
}

impl HeldTorque {
    /// Integrates the true torque over the ticks of `sampling`, between the
    /// reference's `events` in the order of time.
    pub fn new(scene: &StudyScene, sampling: &Sampling<'_>, events: &[TrueEvent]) -> Self {
        let mut path = Path::new(scene);
        let mut events = events.iter().peekable();
        let mut ticks = Vec::with_capacity(usize::try_from(sampling.steps()).unwrap_or(0));
        let mut start_s = 0.0;
        for n in 1..=sampling.steps() {
            let end_s = sampling.time_s(n, 0.0);
            let mut sum = Sum::default();
            while let Some(event) = events.next_if(|e| e.event.time_s <= end_s) {
                // An event of the last tick may be earlier by rounding.
                let time_s = event.event.time_s.max(start_s);
                path.add(start_s, time_s, &mut sum);
                path.pass(time_s, event);
                start_s = time_s;
            }
            path.add(start_s, end_s, &mut sum);
            ticks.push(sum.tick(path.now_nm(end_s)));
            start_s = end_s;
        }
        Self { ticks }
    }

    /// The tick that begins when step `step` begins.
    #[inline]
    pub fn tick(&self, step: usize) -> Option<&Tick> {
        self.ticks.get(step)
    }

    /// The least root mean square error of any value that is held for a tick,
    /// N·m: that of each tick's mean. NaN without a tick.
    pub fn floor_nm(&self) -> f64 {
        let count = f64::from_whole(u64::try_from(self.ticks.len()).unwrap_or(u64::MAX));
        (self.ticks.iter().map(|t| t.variance).sum::<f64>() / count).sqrt()
    }
}

/// State of the object since the last event.
#[derive(Clone, Copy, Debug)]
enum State {
    /// θ = theta + (φ − phi).
    Stick { theta: f64, phi: f64 },
    /// T is constant.
    Slip { torque_nm: f64 },
}

/// The true torque from one event to the next.
struct Path<'a> {
    motion: &'a Motion,
    piece: Piece,
    /// kr.
    stiffness: f64,
    /// J and c where the stick's torque has them, otherwise 0.
    inertia: f64,
    damping: f64,
    /// N·m.
    limit_nm: f64,
    state: State,
}

impl<'a> Path<'a> {
    fn new(scene: &'a StudyScene) -> Self {
        let p = &scene.settings.parameters;
        let is_inertial = scene.settings.convention == Convention::Physical;
        let part = |x: f64| if is_inertial { x } else { 0.0 };
        let piece = scene.motion.piece(0.0);
        Self {
            motion: &scene.motion,
            piece,
            stiffness: p.stiffness_nm_per_rad,
            inertia: part(p.inertia_kg_m2),
            damping: part(p.damping_nms_per_rad),
            limit_nm: p.static_torque_nm,
            state: State::Stick {
                theta: 0.0,
                phi: piece.at(0.0).phi_rad,
            },
        }
    }

    fn inertial_nm(&self, shaft: &ShaftState) -> f64 {
        self.inertia * shaft.omega_dot + self.damping * shaft.omega_rad_s
    }

    /// T at a time within the piece.
    fn at_nm(&self, time_s: f64) -> f64 {
        match self.state {
            State::Stick { theta, phi } => {
                let shaft = self.piece.at(time_s);
                let torque_nm =
                    self.stiffness * (theta + (shaft.phi_rad - phi)) + self.inertial_nm(&shaft);
                // A `paper` stick may be held at its limit.
                torque_nm.min(self.limit_nm).max(-self.limit_nm)
            }
            State::Slip { torque_nm } => torque_nm,
        }
    }

    /// T at a time that has been reached.
    fn now_nm(&mut self, time_s: f64) -> f64 {
        self.reach(time_s);
        self.at_nm(time_s)
    }

    /// Goes on to the piece of a time.
    fn reach(&mut self, time_s: f64) {
        while self.piece.end_s <= time_s {
            self.piece = self.motion.piece(self.piece.end_s);
        }
    }

    /// Adds the torque between two times without an event.
    fn add(&mut self, mut start_s: f64, end_s: f64, sum: &mut Sum) {
        self.reach(start_s);
        while start_s < end_s {
            let knot_s = self.piece.end_s.min(end_s);
            match self.state {
                State::Stick { .. } => self.add_stick(start_s, knot_s, sum),
                State::Slip { torque_nm } => {
                    sum.add(knot_s - start_s, torque_nm, 0.0);
                    sum.extremes_nm.add(torque_nm);
                }
            }
            start_s = knot_s;
            self.reach(start_s);
        }
    }

    /// Adds a stretch of a stick within a piece. Where it ends at the limit it
    /// may have a kink: a `paper` stick can be held there.
    fn add_stick(&self, start_s: f64, end_s: f64, sum: &mut Sum) {
        let at_limit = |time_s| self.at_nm(time_s).abs() >= self.limit_nm;
        let parts = if at_limit(start_s) || at_limit(end_s) {
            KINKED_PARTS
        } else {
            1
        };
        let part_s = (end_s - start_s) / f64::from(parts);
        for i in 0..parts {
            let from_s = start_s + part_s * f64::from(i);
            sum.add_smooth(from_s, part_s, |time_s| self.at_nm(time_s));
        }
    }

    /// Begins the phase after an event.
    fn pass(&mut self, time_s: f64, event: &TrueEvent) {
        self.reach(time_s);
        self.state = if event.event.kind == EventKind::Stick {
            State::Stick {
                theta: event.theta_rad,
                phi: self.piece.at(time_s).phi_rad,
            }
        } else {
            State::Slip {
                torque_nm: event.torque_after_nm,
            }
        };
    }
}

/// Parts of a tick: their lengths, means and variances.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    length_s: f64,
    mean_nm: f64,
    /// Squared distance from the mean, over time, (N·m)²·s.
    squares: f64,
    extremes_nm: Extremes<f64>,
}

impl Sum {
    /// Adds a part with this mean and variance.
    fn add(&mut self, length_s: f64, mean_nm: f64, variance: f64) {
        let total_s = self.length_s + length_s;
        if total_s <= 0.0 {
            return;
        }
        let offset_nm = mean_nm - self.mean_nm;
        let share = length_s / total_s;
        self.squares += length_s * variance + offset_nm * offset_nm * share * self.length_s;
        self.mean_nm += offset_nm * share;
        self.length_s = total_s;
    }

    /// Adds a part in which the torque is smooth.
    fn add_smooth(&mut self, start_s: f64, length_s: f64, at_nm: impl Fn(f64) -> f64) {
        let nodes = GAUSS.map(|(node, weight)| (at_nm(start_s + node * length_s), weight));
        let mean_nm: f64 = nodes.iter().map(|(t, weight)| t * weight).sum();
        let variance = nodes
            .iter()
            .map(|(t, weight)| (t - mean_nm) * (t - mean_nm) * weight)
            .sum();
        self.add(length_s, mean_nm, variance);
        for time_s in [start_s, start_s + length_s] {
            self.extremes_nm.add(at_nm(time_s));
        }
        for (torque_nm, _) in nodes {
            self.extremes_nm.add(torque_nm);
        }
    }

    /// The whole; `now_nm` if it has no length.
    fn tick(self, now_nm: f64) -> Tick {
        if self.length_s <= 0.0 {
            return Tick {
                mean_nm: now_nm,
                variance: 0.0,
                low_nm: now_nm,
                high_nm: now_nm,
            };
        }
        Tick {
            mean_nm: self.mean_nm,
            variance: self.squares / self.length_s,
            low_nm: self.extremes_nm.low,
            high_nm: self.extremes_nm.high,
        }
    }
}

#[cfg(test)]
mod tests;
