//! `clonus` (section 8): beats by the clock, from a quick stretch on.
//!
//! ```text
//! idle → beating  where s(φ − φ_h) rises above 0 with sΩ ≥ Ω_on   `start`
//! beat n at t₀ = start + τ_d, then after P_n = (1/f)(1 + ε·2⁻ⁿ), n = 0, 1 …
//! beat n:  T = s·A·sin(π(t − t_n)/(D·P_n)) for its first D·P_n
//! `stop` where s(φ_h − φ) ≥ hysteresis, `done` where beat number `beats` would
//! begin
//! ```
//!
//! Readings: a crossing that is too slow, and a start beyond φ_h, are passed
//! over until the joint has been below the hysteresis, which is no event then.
//! After `done` it takes the same return to be started again, and that is a
//! `stop`. A touch of φ_h is no crossing. A beat under way at a `stop` runs out;
//! the first beat of another start cuts it off. The tank of the active effects
//! is a later stage: this is the torque that the law asks for.

use super::Word as Kind;
use super::guard::{Guard, When};
use super::keys::{Reader, SymptomError};
use super::runner::{Instant, Law, Reported, Watches};
use std::f64::consts::PI;

/// Rounding of a velocity that is Ω_on, relative.
const SAME: f64 = 16.0 * f64::EPSILON;

/// The clonus of one group of muscles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clonus {
    /// s·φ_h, rad.
    hold: f64,
    /// rad.
    hysteresis: f64,
    /// Ω_on, rad/s.
    start_velocity: f64,
    /// 1/f, s.
    period_s: f64,
    /// A, N·m.
    amplitude_nm: f64,
    /// D.
    push: f64,
    /// ε.
    first_stretch: f64,
    /// τ_d, s.
    delay_s: f64,
    /// Number of beats; infinite if sustained.
    beats: f64,
    state: State,
    beat: Option<Beat>,
}

#[derive(Clone, Copy, Debug)]
enum State {
    /// Waits for a stretch.
    Idle,
    /// Waits for the return; whether this is a `stop`.
    Over { is_stop: bool },
    /// Time of the start, s, and the number of the next beat.
    Beating { since_s: f64, next: f64 },
}

/// A beat: when it began, and D·P_n, s.
#[derive(Clone, Copy, Debug)]
struct Beat {
    start_s: f64,
    push_s: f64,
}

/// Actions of clonus.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    Stretch,
    Beat,
    Return,
}

impl Clonus {
    pub(super) fn read(reader: &Reader<'_>, sign: f64) -> Result<Self, SymptomError> {
        let beats = reader.checked("beats", 0.0, "a whole number of 0 or more", |x| {
            x.fract() == 0.0 && x >= 0.0
        })?;
        Ok(Self {
            hold: sign * reader.angle("hold_deg", 60.0)?,
            hysteresis: reader.positive("hysteresis_deg", 5.0)?.to_radians(),
            start_velocity: reader.number("start_velocity_deg_s", 100.0)?.to_radians(),
            period_s: 1.0 / reader.positive("frequency_hz", 6.0)?,
            amplitude_nm: reader.at_least_zero("amplitude_nm", 1.5)?,
            push: reader.checked("push_share", 0.45, "a number above 0, at most 1", |x| {
                x > 0.0 && x <= 1.0
            })?,
            first_stretch: reader.at_least_zero("first_stretch", 0.3)?,
            delay_s: reader.at_least_zero("delay_s", 0.05)?,
            beats: if beats == 0.0 { f64::INFINITY } else { beats },
            state: State::Idle,
            beat: None,
        })
    }

    /// t_n = t₀ + Σ P_i: in one term, so that it does not drift.
    fn beat_s(&self, since_s: f64, n: f64) -> f64 {
        let stretched = self.first_stretch * (2.0 - 2.0 * (-n).exp2());
        since_s + self.delay_s + self.period_s * (n + stretched)
    }
}

impl Law for Clonus {
    type Action = Action;

    fn arm(&mut self, at: &Instant) {
        if at.x > self.hold {
            self.state = State::Over { is_stop: false };
        }
    }

    fn watches(&self, watches: &mut Watches<Action>) {
        let back = When::Holds(Guard::below(self.hold - self.hysteresis));
        match self.state {
            State::Idle => {
                watches.push((When::Crosses(Guard::above(self.hold)), Action::Stretch));
            }
            State::Over { .. } => watches.push((back, Action::Return)),
            State::Beating { since_s, next } => {
                // First, so that at one instant there is no new beat.
                watches.push((back, Action::Return));
                watches.push((When::At(self.beat_s(since_s, next)), Action::Beat));
            }
        }
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        match (action, self.state) {
            (Action::Stretch, _) => {
                if at.v < self.start_velocity * (1.0 - SAME) {
                    self.state = State::Over { is_stop: false };
                    return None;
                }
                self.state = State::Beating {
                    since_s: at.time_s,
                    next: 0.0,
                };
                Some(Kind::Start.into())
            }
            (Action::Beat, State::Beating { next, .. }) if next >= self.beats => {
                self.state = State::Over { is_stop: true };
                Some(Kind::Done.into())
            }
            (Action::Beat, State::Beating { since_s, next }) => {
                let interval_s = self.period_s * (1.0 + self.first_stretch * (-next).exp2());
                self.beat = Some(Beat {
                    start_s: at.time_s,
                    push_s: self.push * interval_s,
                });
                self.state = State::Beating {
                    since_s,
                    next: next + 1.0,
                };
                Some(Kind::Beat.into())
            }
            (Action::Return, state) => {
                self.state = State::Idle;
                let is_stop = !matches!(state, State::Over { is_stop: false });
                is_stop.then(|| Kind::Stop.into())
            }
            (Action::Beat, State::Idle | State::Over { .. }) => None,
        }
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        match self.beat {
            Some(Beat { start_s, push_s }) if at.time_s < start_s + push_s => {
                self.amplitude_nm * (PI * (at.time_s - start_s) / push_s).sin()
            }
            _ => 0.0,
        }
    }
}
