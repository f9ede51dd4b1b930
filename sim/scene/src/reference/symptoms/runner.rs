//! A law along a motion, from event to event.
//!
//! A law is a state machine: in each state it names what may end the state. The
//! first of these is searched ahead of the time asked for, in windows that begin
//! where the state or a piece of the motion begins: so an event is the same to
//! the bit however often the torque is asked for.

use super::guard::{Span, When};
use super::{SymptomEvent, Word};
use crepitus_plant::piece::Curve;
use crepitus_plant::{Motion, Piece};

/// First window on a piece without a period, s.
const WINDOW_S: f64 = 1.0;

/// The most actions at one instant: no law takes so many on its own.
const CROWD: u32 = 32;

/// The furthest that the search is moved on for that, s.
const MOST_MOVED_S: f64 = 1e-9;

/// The shaft at one time, in the direction of the law.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant {
    pub(super) time_s: f64,
    /// s·φ, rad.
    pub(super) x: f64,
    /// s·Ω just after, rad/s.
    pub(super) v: f64,
}

/// Possible next actions of a law, with their conditions.
pub(super) type Watches<A> = Vec<(When, A)>;

/// Report of an action.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported {
    pub(super) kind: Word,
    pub(super) peak_nm: Option<f64>,
}

impl From<Word> for Reported {
    fn from(kind: Word) -> Self {
        Self {
            kind,
            peak_nm: None,
        }
    }
}

/// A law of a symptom, written for s = +1.
pub(super) trait Law {
    /// Actions of the law.
    type Action: Copy;

    /// Takes the state in which it is armed: without torque.
    fn arm(&mut self, at: &Instant);

    /// Takes notice of a piece of the motion that begins now; `sign` is s.
    fn enter(&mut self, _piece: &Piece, _sign: f64, _at: &Instant) {}

    /// Lists what may end the present state.
    fn watches(&self, watches: &mut Watches<Self::Action>);

    /// Carries out an action, and says what is reported of it.
    fn act(&mut self, action: Self::Action, at: &Instant) -> Option<Reported>;

    /// The torque, N·m.
    fn torque_nm(&self, at: &Instant) -> f64;
}

/// A law of any type that follows a motion.
pub(super) trait Run: std::fmt::Debug {
    /// Advances to `to_s`, and adds every event on the way.
    fn advance(&mut self, to_s: f64, events: &mut Vec<SymptomEvent>);

    /// The torque now, N·m.
    fn torque_nm(&self) -> f64;
}

/// Runs a law.
#[derive(Debug)]
pub(super) struct Runner<'a, L: Law> {
    motion: &'a Motion,
    piece: Piece,
    /// Place of the piece in the motion.
    piece_place: usize,
    sign: f64,
    law: L,
    time_s: f64,
    ahead: Ahead<L::Action>,
    watches: Watches<L::Action>,
    /// Actions since the time last advanced.
    crowd: u32,
    /// Time by which the search was last moved on because there were too many actions, s.
    moved_s: f64,
}

/// State of the search for the next action.
#[derive(Clone, Copy, Debug)]
struct Ahead<A> {
    /// Time from which on nothing is known, s.
    from_s: f64,
    begun: bool,
    /// Length of the next window, as a multiple of the first.
    windows: f64,
    found: Option<(f64, A)>,
}

impl<A> Ahead<A> {
    fn from(time_s: f64) -> Self {
        Self {
            from_s: time_s,
            begun: false,
            windows: 1.0,
            found: None,
        }
    }
}

impl<'a, L: Law> Runner<'a, L> {
    /// Arms `law` at the start of `motion`; it resists growing s·φ, s = `sign`.
    pub(super) fn new(mut law: L, sign: f64, motion: &'a Motion) -> Self {
        let piece = motion.piece(0.0);
        let at = instant(&piece, sign, 0.0);
        law.arm(&at);
        law.enter(&piece, sign, &at);
        Self {
            motion,
            piece,
            piece_place: 0,
            sign,
            law,
            time_s: 0.0,
            ahead: Ahead::from(0.0),
            watches: Watches::new(),
            crowd: 0,
            moved_s: 0.0,
        }
    }

    fn now(&self) -> Instant {
        instant(&self.piece, self.sign, self.time_s)
    }

    /// The next action, if it is not after `horizon_s` and before the end of
    /// the piece: at a knot it is the velocity just after it that counts.
    fn look_ahead(&mut self, horizon_s: f64) -> Option<(f64, L::Action)> {
        if !self.ahead.begun {
            self.watches.clear();
            self.law.watches(&mut self.watches);
        }
        while self.ahead.found.is_none() && !(self.ahead.begun && self.ahead.from_s >= horizon_s) {
            let from_s = self.ahead.from_s;
            let window_s = match self.piece.curve {
                Curve::Polynomial(_) => WINDOW_S,
                Curve::Sine { frequency_hz, .. } => 1.0 / frequency_hz,
            };
            let to_s = (from_s + self.ahead.windows * window_s)
                .max(from_s.next_up())
                .min(self.piece.end_s);
            let mut first: Option<(f64, L::Action)> = None;
            for (when, action) in &self.watches {
                let until_s = first.map_or(to_s, |(time_s, _)| time_s);
                let found = Span::new(&self.piece, self.sign, from_s, until_s).first(when);
                if let Some(time_s) = found
                    && time_s < self.piece.end_s
                    && first.is_none_or(|(first_s, _)| time_s < first_s)
                {
                    first = Some((time_s, *action));
                }
            }
            self.ahead.found = first;
            self.ahead.begun = true;
            self.ahead.from_s = to_s;
            self.ahead.windows *= 2.0;
        }
        self.ahead.found.filter(|(time_s, _)| *time_s <= horizon_s)
    }

    fn act(&mut self, time_s: f64, action: L::Action, events: &mut Vec<SymptomEvent>) {
        if time_s > self.time_s {
            self.crowd = 0;
            if time_s > self.time_s + 2.0 * MOST_MOVED_S {
                self.moved_s = 0.0;
            }
        } else {
            self.crowd += 1;
        }
        self.time_s = time_s;
        let at = self.now();
        let before_nm = self.law.torque_nm(&at);
        if let Some(Reported { kind, peak_nm }) = self.law.act(action, &at) {
            let shaft = self.piece.at(time_s);
            events.push(SymptomEvent {
                time_s,
                kind,
                angle_rad: shaft.phi_rad,
                omega_rad_s: shaft.omega_rad_s,
                torque_before_nm: self.sign * before_nm,
                torque_after_nm: self.sign * self.law.torque_nm(&at),
                peak_nm,
            });
        }
        // Rounding must not hold it at one instant, nor in a row of them.
        let moved_s = if self.crowd > CROWD {
            self.crowd = 0;
            let least_s = time_s.next_up() - time_s;
            self.moved_s = (2.0 * self.moved_s).clamp(least_s, MOST_MOVED_S.max(least_s));
            self.moved_s
        } else {
            0.0
        };
        self.ahead = Ahead::from(time_s + moved_s);
    }
}

impl<L: Law + std::fmt::Debug> Run for Runner<'_, L>
where
    L::Action: std::fmt::Debug,
{
    fn advance(&mut self, to_s: f64, events: &mut Vec<SymptomEvent>) {
        loop {
            let horizon_s = self.piece.end_s.min(to_s);
            if let Some((time_s, action)) = self.look_ahead(horizon_s) {
                self.act(time_s, action, events);
                continue;
            }
            self.time_s = self.time_s.max(horizon_s);
            if self.piece.end_s > to_s {
                return;
            }
            self.piece = self
                .motion
                .piece_from(self.piece.end_s, &mut self.piece_place);
            self.law.enter(&self.piece, self.sign, &self.now());
            self.ahead = Ahead::from(self.time_s);
        }
    }

    fn torque_nm(&self) -> f64 {
        self.sign * self.law.torque_nm(&self.now())
    }
}

fn instant(piece: &Piece, sign: f64, time_s: f64) -> Instant {
    let (phi_rad, omega_rad_s) = piece.angle_and_velocity(time_s);
    Instant {
        time_s,
        x: sign * phi_rad,
        v: sign * omega_rad_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Acts at once, again and again, for a microsecond.
    #[derive(Debug)]
    struct Chatters {
        actions: u32,
        last_s: f64,
    }

    impl Law for Chatters {
        type Action = ();

        fn arm(&mut self, _: &Instant) {}

        fn watches(&self, watches: &mut Watches<()>) {
            if self.last_s < 0.5 + 1e-6 {
                watches.push((When::At(0.5), ()));
            }
        }

        fn act(&mut self, (): (), at: &Instant) -> Option<Reported> {
            self.actions += 1;
            assert!(self.actions < 100_000, "{self:?}");
            self.last_s = at.time_s;
            None
        }

        fn torque_nm(&self, _: &Instant) -> f64 {
            0.0
        }
    }

    #[test]
    fn a_law_that_chatters_is_moved_on() {
        let motion = Motion::constant(1.0);
        let law = Chatters {
            actions: 0,
            last_s: 0.0,
        };
        let mut runner = Runner::new(law, 1.0, &motion);
        runner.advance(1.0, &mut Vec::new());
        assert!(runner.law.actions > CROWD);
    }
}
