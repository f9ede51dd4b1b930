//! Criteria of a trial: statements in words, each with its check.

use super::input::Input;
use super::observation::Observation;
use super::subject::{Rung, Subject};
use super::text::Plain;
use super::verdict::{Failure, Verdict};
use crate::true_events::TrueEvent;
use crepitus_model::EVENTS_PER_STEP;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;
use std::fmt;
use std::rc::Rc;

/// Share by which a torque may exceed Ts, and under `frozen` the angle of a stick Ts/kr.
pub(super) const BOUND_SLACK: f64 = 1e-5;

/// Largest missing share of (work + stored energy) under `physical` with both
/// events located.
const BALANCE: Limits = Limits(1e-10, 1e-4);

/// Descriptions of the bounds that every trial has in common.
pub fn common_bounds() -> [String; 3] {
    [
        format!(
            "finite, and |T| ≤ Ts · (1 + {BOUND_SLACK:e}), after every step and at every event"
        ),
        format!(
            "frozen: |θ| ≤ Ts/kr · (1 + {BOUND_SLACK:e}) in every stick, but after a step of {EVENTS_PER_STEP} events"
        ),
        format!(
            "physical, exact-events: |work − stored − dissipated| within {} of the largest |work| + stored so far, \
             which is at least Ts²/2kr, where no step has {EVENTS_PER_STEP} events",
            BALANCE.in_unit("")
        ),
    ]
}

/// Checks the common bounds; `None` if they are kept.
pub(super) fn common(evidence: &Evidence<'_>) -> Option<Verdict> {
    let seen = evidence.seen;
    if seen.overflow_s.is_some() {
        return Some(Verdict::fails(Failure::Overflow, seen.overflow_s));
    }
    if seen.above_s.is_some() {
        return Some(Verdict::fails(Failure::AboveTheLimit, seen.above_s));
    }
    let verdict = Verdict::of(seen.imbalance?, BALANCE.of(evidence), "");
    let is_bound = evidence.subject.solver == Rung::Ladder(Solver::ExactEvents);
    (is_bound && !verdict.holds()).then_some(verdict)
}

/// A limit in f64, and in f32.
#[derive(Clone, Copy)]
pub(super) struct Limits(pub(super) f64, pub(super) f64);

impl From<f64> for Limits {
    fn from(both: f64) -> Self {
        Self(both, both)
    }
}

impl Limits {
    /// The limit in the precision of the run.
    pub(super) fn of(self, evidence: &Evidence<'_>) -> f64 {
        match evidence.subject.precision {
            Precision::F32 => self.1,
            Precision::F64 => self.0,
        }
    }

    /// Both in words; one if they are equal.
    pub(super) fn in_unit(self, unit: &str) -> String {
        let one = |x: f64| match unit {
            "" => Plain(x).to_string(),
            unit => format!("{} {unit}", Plain(x)),
        };
        if self.0 == self.1 {
            one(self.0)
        } else {
            format!("{} (f64), {} (f32)", one(self.0), one(self.1))
        }
    }
}

/// Observations for a criterion.
#[derive(Clone, Copy)]
pub(super) struct Evidence<'a> {
    pub(super) subject: Subject,
    pub(super) seen: &'a Observation,
    /// The true events, if the input has some.
    pub(super) truth: &'a [TrueEvent],
    /// Observation of the second input of a comparison.
    pub(super) twin: Option<&'a Observation>,
}

/// Basis of a check.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Basis {
    /// The run alone.
    Run,
    /// The steps of the run: the reference has none.
    Steps,
    /// The true events, which are those of the reference.
    Truth,
}

/// A criterion.
#[derive(Clone)]
pub struct Criterion {
    text: String,
    check: Rc<dyn Fn(&Evidence<'_>) -> Verdict>,
    pub(super) basis: Basis,
    /// Start of the judged part of the run, s.
    pub(super) from_s: Option<f64>,
    /// The second input of a comparison.
    pub(super) twin: Option<Input>,
    pub(super) bits: Option<u64>,
}

impl Criterion {
    pub(super) fn new(
        text: impl Into<String>,
        check: impl Fn(&Evidence<'_>) -> Verdict + 'static,
    ) -> Self {
        Self {
            text: text.into(),
            check: Rc::new(check),
            basis: Basis::Run,
            from_s: None,
            twin: None,
            bits: None,
        }
    }

    /// Hash of all torque bits, if that is the criterion.
    pub fn torque_bits(&self) -> Option<u64> {
        self.bits
    }

    /// Sets the basis of the check.
    pub(super) fn on(self, basis: Basis) -> Self {
        Self { basis, ..self }
    }

    /// Sets the start of the judged part of the run, s.
    pub(super) fn since(self, from_s: impl Into<Option<f64>>) -> Self {
        Self {
            from_s: from_s.into(),
            ..self
        }
    }

    /// Checks it against the evidence.
    pub(super) fn judge(&self, evidence: &Evidence<'_>) -> Verdict {
        (self.check)(evidence)
    }

    /// A result that does not fit into a verdict.
    pub(super) fn remark(&self, seen: &Observation) -> String {
        match self.bits {
            Some(hash) if seen.torque_bits.0 != hash => {
                format!("; found {:#018x}", seen.torque_bits.0)
            }
            _ => String::new(),
        }
    }
}

impl fmt::Display for Criterion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
