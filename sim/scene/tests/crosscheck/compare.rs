//! Two event lists of one case, and the verdict.
//!
//! Event by event: the same kind and senses, and times, angles and torques
//! within
//!
//! ```text
//! |Δt| ≤ 10⁻¹²·t + 10⁻¹¹·min(1/ωn, duration)
//! |Δθ| ≤ 10⁻¹¹·max(|θ|, Ts/kr) + 2⁻⁴⁹·|φ| + |θ̇|·(bound of Δt)
//! |ΔT| ≤ 10⁻¹¹·Ts + kr·(bound of Δθ)
//! ```
//! If that fails, the case is solved [`TRIALS`] times more with
//! [rounding](crate::rounding) of ±[`UNITS`] units. The difference of these
//! solutions at an event, times [`MARGIN`], is added to the tolerance. If one of
//! them has another sequence from an event on, the case is **undecidable** from
//! there: rounding decides, and only earlier events are compared. Any other
//! difference is **real**.

use crate::corpus::{Case, MOST_EVENTS};
use crate::double_double::Dd;
use crate::event::{Cause, History, Unsolved};
use crate::rounding::Rounding;
use crate::solver::{Problem, solve, solve_rounded};
use crate::theirs::LAW_ROUNDINGS;
use crate::watched::Answer;
use crepitus_model::{Event, EventKind};
use crepitus_plant::Motion;

/// Solutions with rounding.
pub const TRIALS: u64 = 8;
/// Rounding of every number in them, units of 2⁻⁵³: what a torque may be
/// beyond the limit and still count as at it is tens of roundings too.
pub const UNITS: f64 = 32.0;
/// Factor of their differences in the tolerance.
pub const MARGIN: f64 = 2.0;

/// Reason why rounding decides a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The torque at a match is at the static limit.
    AtLimit,
    /// An event falls on a boundary of the motion.
    AtBoundary,
    /// The velocities all but touch.
    Graze,
    /// Rounding of earlier events has grown.
    Grown,
    /// Ts = 0: there is no friction, and the torque is 0 whatever happens.
    NoFriction,
    /// Even 31 digits do not decide.
    Unsolved(&'static str),
}

impl Doubt {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::AtLimit => "at-limit",
            Self::AtBoundary => "at-boundary",
            Self::Graze => "graze",
            Self::Grown => "grown",
            Self::NoFriction => "no-friction",
            Self::Unsolved(why) => why,
        }
    }
}

/// Difference of two solutions.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// Kind or sense, or an event that one does not have.
    Sequence,
    /// The time, s.
    Time(f64),
    /// The angle, rad.
    Theta(f64),
    /// The torque just before, N·m.
    TorqueBefore(f64),
    /// The torque just after, N·m.
    TorqueAfter(f64),
    /// There is no answer.
    Hung,
    /// The other process died.
    Died,
}

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// All events agree.
    Agreed,
    /// They agree up to this event; from there rounding decides.
    Undecidable(Doubt),
    /// They differ, at this event.
    Disagreed(Difference),
}

/// A comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The result.
    pub verdict: Verdict,
    /// Events that agree.
    pub events: usize,
    /// Whether the tolerance had to follow the conditioning.
    pub conditioned: bool,
    /// The worst |Δt|/(t + 1/ωn) of events that agree within the plain
    /// tolerance.
    pub worst: f64,
    /// Time difference that conditioning allows at the first event that does not agree, s.
    pub allowed_s: f64,
    /// Whether the sign law is broken.
    pub law_broken: bool,
}

/// The second solver's answer to a case.
///
/// # Errors
/// [`Unsolved`] where 31 digits do not decide.
pub fn ours(case: &Case) -> Result<History, Unsolved> {
    solve(problem(case))
}

fn problem(case: &Case) -> Problem<'_> {
    Problem {
        settings: &case.settings,
        motion: &case.motion,
        duration_s: case.duration_s,
        most_events: MOST_EVENTS,
    }
}

/// Differences that rounding makes at an event.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    time_s: f64,
    theta_rad: f64,
    torque_nm: f64,
}

/// A list of events under comparison.
struct Pair<'a> {
    case: &'a Case,
    ours: &'a History,
    theirs: &'a [Event<f64>],
    /// Allowed on top, by event; the last counts for all beyond.
    spreads: Vec<Spread>,
}

/// Compares the answers to a case.
pub fn compare(case: &Case, answer: &Answer) -> Comparison {
    let mut comparison = Comparison {
        verdict: Verdict::Agreed,
        events: 0,
        conditioned: false,
        worst: 0.0,
        allowed_s: 0.0,
        law_broken: false,
    };
    let theirs = match answer {
        Answer::Solved(theirs) => theirs,
        Answer::Hung => {
            comparison.verdict = Verdict::Disagreed(Difference::Hung);
            return comparison;
        }
        Answer::Died => {
            comparison.verdict = Verdict::Disagreed(Difference::Died);
            return comparison;
        }
    };
    comparison.law_broken = theirs.breach > LAW_ROUNDINGS;
    let history = match ours(case) {
        Ok(history) => history,
        Err(why) => {
            comparison.verdict = Verdict::Undecidable(Doubt::Unsolved(match why {
                Unsolved::Unclear { .. } => "unclear",
                Unsolved::PileUp { .. } => "pile-up",
                Unsolved::Inconsistent { .. } => "inconsistent",
                Unsolved::TooLong { .. } => "too-long",
            }));
            return comparison;
        }
    };
    let mut pair = Pair {
        case,
        ours: &history,
        theirs: &theirs.events,
        spreads: Vec::new(),
    };
    let (mut at, mut difference) = pair.first_difference(&mut comparison.worst);
    if difference.is_some() {
        let alike = pair.round();
        comparison.conditioned = true;
        (at, difference) = pair.first_difference(&mut 0.0);
        if let Some(real) = &difference {
            comparison.verdict = if case.settings.parameters.static_torque_nm == 0.0 {
                Verdict::Undecidable(Doubt::NoFriction)
            } else if at >= alike && !pair.rule_decides(at) {
                Verdict::Undecidable(pair.doubt(alike))
            } else {
                Verdict::Disagreed(real.clone())
            };
        }
    }
    comparison.events = at;
    comparison.allowed_s = MARGIN * pair.spread(at).time_s;
    comparison
}

/// min(1/ωn, duration), s.
fn scale_s(case: &Case) -> f64 {
    (1.0 / case.settings.parameters.natural_rad_s()).min(case.duration_s)
}

/// Returns whether an error is more than allowed, or no number.
fn is_beyond(error: f64, bound: f64) -> bool {
    error.is_nan() || error > bound
}

/// |x − y|.
fn apart(x: Dd, y: Dd) -> f64 {
    (x - y).abs().to_f64()
}

impl Pair<'_> {
    fn spread(&self, at: usize) -> Spread {
        let last = self.spreads.len().saturating_sub(1);
        self.spreads.get(at.min(last)).copied().unwrap_or_default()
    }

    fn time_bound_s(&self, at: usize, time_s: f64) -> f64 {
        1e-12 * time_s + 1e-11 * scale_s(self.case) + MARGIN * self.spread(at).time_s
    }

    /// Index at which the lists part, or the number of events that they share.
    fn first_difference(&self, worst: &mut f64) -> (usize, Option<Difference>) {
        let (ours, theirs) = (&self.ours.events, self.theirs);
        let p = &self.case.settings.parameters;
        let least = ours.len().min(theirs.len());
        for (at, (a, b)) in ours.iter().zip(theirs).enumerate() {
            if (a.kind, a.from, a.to) != (b.kind, b.from.sign(), b.to.sign()) {
                return (at, Some(Difference::Sequence));
            }
            let time_s = a.time_s.to_f64();
            let time_bound = self.time_bound_s(at, time_s);
            let spread = self.spread(at);
            let error = apart(a.time_s, Dd::new(b.fraction));
            if is_beyond(error, time_bound) {
                return (at, Some(Difference::Time(error)));
            }
            *worst = worst.max(error / (time_s + 1.0 / p.natural_rad_s()));
            let phi = self.case.motion.at(time_s).phi_rad.abs();
            let theta_bound = 1e-11
                * (a.theta_rad.to_f64().abs()).max(p.static_torque_nm / p.stiffness_nm_per_rad)
                + 8.0 * f64::EPSILON * phi
                + a.theta_dot_rad_s.to_f64().abs() * time_bound
                + MARGIN * spread.theta_rad;
            let error = apart(a.theta_rad, Dd::new(b.theta_rad));
            if is_beyond(error, theta_bound) {
                return (at, Some(Difference::Theta(error)));
            }
            let torque_bound = 1e-11 * p.static_torque_nm
                + p.stiffness_nm_per_rad * theta_bound
                + MARGIN * spread.torque_nm;
            let error = apart(a.torque_after_nm, Dd::new(b.torque_after_nm));
            if is_beyond(error, torque_bound) {
                return (at, Some(Difference::TorqueAfter(error)));
            }
            // At the start and at jumps there is no one torque before.
            if let Some(before) = a.torque_before_nm
                && a.cause != Cause::VelocityJump
            {
                let error = apart(before, Dd::new(b.torque_before_nm));
                if is_beyond(error, torque_bound) {
                    return (at, Some(Difference::TorqueBefore(error)));
                }
            }
        }
        // An event at the very end may be on either side of it.
        let extra_s = (ours.get(least).map(|e| e.time_s.to_f64()))
            .or_else(|| theirs.get(least).map(|e| e.fraction));
        match extra_s {
            Some(time_s) if time_s < self.case.duration_s - self.time_bound_s(least, time_s) => {
                (least, Some(Difference::Sequence))
            }
            _ => (least, None),
        }
    }

    /// Solves with rounding; the first event at which a solution has another
    /// sequence.
    fn round(&mut self) -> usize {
        let ours = &self.ours.events;
        let mut spreads = vec![Spread::default(); ours.len()];
        let mut alike = usize::MAX;
        for trial in 1..=TRIALS {
            let seed = self.case.number.wrapping_mul(TRIALS).wrapping_add(trial);
            let rounded = match solve_rounded(problem(self.case), Rounding::of(UNITS, seed)) {
                Ok(history) => history.events,
                // The solver stopped somewhere: nothing beyond the first is certain.
                Err(_) => Vec::new(),
            };
            let same = (ours.iter().zip(&rounded))
                .position(|(a, b)| (a.kind, a.from, a.to) != (b.kind, b.from, b.to))
                .unwrap_or(ours.len().min(rounded.len()));
            if same < ours.len().max(rounded.len()) {
                alike = alike.min(same);
            }
            for ((spread, a), b) in spreads.iter_mut().zip(ours).zip(&rounded).take(same) {
                spread.time_s = spread.time_s.max(apart(a.time_s, b.time_s));
                spread.theta_rad = spread.theta_rad.max(apart(a.theta_rad, b.theta_rad));
                spread.torque_nm = spread
                    .torque_nm
                    .max(apart(a.torque_after_nm, b.torque_after_nm));
            }
        }
        spreads.truncate(alike);
        self.spreads = spreads;
        alike
    }

    /// Returns whether a written rule decides where rounding would not: a touch is no
    /// event, and a torque at the static limit sticks.
    fn rule_decides(&self, at: usize) -> bool {
        let p = &self.case.settings.parameters;
        let touch = p.static_torque_nm == p.kinetic_torque_nm
            && self.theirs.get(at).is_some_and(|e| {
                let near = 1e-6 * scale_s(self.case);
                let met = |t: &f64| (t - e.fraction).abs() < near;
                e.kind != EventKind::Break && self.ours.touches_s.iter().any(met)
            });
        let tie = self.ours.events.get(at).is_some_and(|e| {
            let exact = e.excess.is_some_and(|x| x.abs() < 1e-20);
            let reversed = |t: &Event<f64>| t.kind == EventKind::Reverse;
            exact && e.kind == EventKind::Stick && self.theirs.get(at).is_some_and(reversed)
        });
        touch || tie
    }

    /// Reason why rounding decides at an event.
    fn doubt(&self, at: usize) -> Doubt {
        let before = self.spreads.last().copied().unwrap_or_default();
        if before.time_s > 1e-8 * scale_s(self.case) {
            return Doubt::Grown;
        }
        let event = self.ours.events.get(at);
        if event.is_some_and(|e| e.excess.is_some_and(|x| x.abs() < 1e-6)) {
            return Doubt::AtLimit;
        }
        let times = [
            event.map(|e| e.time_s.to_f64()),
            self.theirs.get(at).map(|e| e.fraction),
        ];
        let bounded = |t: f64| {
            let near = |end: f64| (t - end).abs() <= 1e-11 * t + 1e-11 * scale_s(self.case);
            match &self.case.motion {
                Motion::Single(_) => false,
                motion => {
                    let piece = motion.piece(t);
                    near(piece.start_s) || near(piece.end_s)
                }
            }
        };
        if times.into_iter().flatten().any(bounded) {
            Doubt::AtBoundary
        } else {
            Doubt::Graze
        }
    }
}
