//! A rung at a step, compared with a need over all scenes of a question.

use super::Question;
use crate::accuracy::need::{Criterion, Limit, Need};
use crate::accuracy::point::Point;
use crate::accuracy::target::{OnTarget, STEP_SHARE, TICK_CYCLES};
use crate::accuracy::timing::quantile;
use serde::Serialize;
use std::cmp::Ordering;

/// A rung at a step, over all scenes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The rung.
    pub solver: &'static str,
    /// The step, s.
    pub step_s: f64,
    /// Median CPU time of a step on the host, ns.
    pub ns_per_step: f64,
    /// Median CPU time of a simulated second on the host, µs.
    pub us_per_simulated_s: f64,
    /// Median spread of the timings.
    pub time_spread: f64,
    /// Cost on the target, if that decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycles: Option<Cycles>,
    /// The scene with most unmatched events, if any has.
    pub unmatched: Option<Unmatched>,
    /// The worst error of each limited criterion.
    pub marks: Vec<Mark>,
}

/// Cost of a step on the target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cycles {
    /// Mean over the scenes of the study, cycles.
    pub mean: f64,
    /// Worst observed, cycles.
    pub worst: u32,
    /// The input of the worst step.
    pub worst_on: String,
}

impl Cycles {
    /// The worst as a share of a tick.
    pub fn worst_share(&self) -> f64 {
        f64::from(self.worst) / TICK_CYCLES
    }

    /// Returns whether the worst step fits the share of a tick that it may take.
    pub fn fits(&self) -> bool {
        self.worst_share() <= STEP_SHARE
    }

    /// Compares the means, equal means by the worst.
    fn order(&self, other: &Self) -> Ordering {
        self.mean
            .total_cmp(&other.mean)
            .then(self.worst.cmp(&other.worst))
    }
}

/// Unmatched events of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unmatched {
    /// Their number.
    pub events: u64,
    /// Number of events of the reference.
    pub events_true: u64,
    /// The scene.
    pub scene: String,
}

/// The worst error of a criterion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mark {
    /// The limit.
    #[serde(flatten)]
    pub limit: Limit,
    /// The error, in the criterion's unit.
    pub error: f64,
    /// Scene with this error.
    pub scene: String,
}

impl Mark {
    /// Error over limit: above one it fails.
    pub fn ratio(&self) -> f64 {
        self.error / self.limit.at_most
    }
}

impl Candidate {
    /// Returns whether the need is met, and the worst step on the target fits its
    /// share of a tick.
    pub fn meets(&self) -> bool {
        self.unmatched.is_none()
            && self.marks.iter().all(|m| m.ratio() <= 1.0)
            && self.cycles.as_ref().is_none_or(Cycles::fits)
    }

    /// The criterion nearest to its limit, or furthest beyond.
    pub fn tightest(&self) -> Option<&Mark> {
        self.marks
            .iter()
            .max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// The error of a criterion.
    pub fn mark(&self, criterion: Criterion) -> Option<&Mark> {
        self.marks.iter().find(|m| m.limit.criterion == criterion)
    }

    /// Share of one core of the host for real time.
    pub fn core_share(&self) -> f64 {
        self.us_per_simulated_s * 1e-6
    }

    /// Used share of the tightest limit.
    pub(super) fn used(&self) -> f64 {
        self.tightest().map_or(0.0, Mark::ratio)
    }

    /// Compares costs: cycles of the target if they decide, otherwise the
    /// host's time.
    pub(super) fn by_cost(&self, other: &Self) -> Ordering {
        match (&self.cycles, &other.cycles) {
            (Some(a), Some(b)) => a.order(b),
            _ => self.us_per_simulated_s.total_cmp(&other.us_per_simulated_s),
        }
    }

    /// Returns whether both costs are equal: to the cycle on the target, within the
    /// spread of timings on the host.
    pub(super) fn costs_like(&self, other: &Self) -> bool {
        if let (Some(a), Some(b)) = (&self.cycles, &other.cycles) {
            return a.order(b) == Ordering::Equal;
        }
        let spread = self.time_spread.max(other.time_spread);
        let (low, high) = if self.us_per_simulated_s < other.us_per_simulated_s {
            (self.us_per_simulated_s, other.us_per_simulated_s)
        } else {
            (other.us_per_simulated_s, self.us_per_simulated_s)
        };
        high <= low * (1.0 + spread)
    }
}

/// The points that a question selects.
pub(super) fn asked<'p>(points: &'p [Point], question: &Question<'_>) -> Vec<&'p Point> {
    points
        .iter()
        .filter(|p| {
            p.is_exact() && p.convention == question.convention && p.precision == question.precision
        })
        .filter(|p| question.step_s.is_none_or(|h| p.step_s == h))
        .collect()
}

/// Each rung and step studied on every scene of the question; if the target
/// decides, each that was run there.
pub(super) fn candidates(points: &[Point], need: &Need, question: &Question<'_>) -> Vec<Candidate> {
    let asked = asked(points, question);
    let mut scenes: Vec<&str> = Vec::new();
    let mut keys: Vec<(&'static str, f64)> = Vec::new();
    for p in &asked {
        if !scenes.contains(&p.scene.as_str()) {
            scenes.push(&p.scene);
        }
        if !keys.contains(&(p.solver, p.step_s)) {
            keys.push((p.solver, p.step_s));
        }
    }
    keys.into_iter()
        .filter_map(|(solver, step_s)| {
            let mine: Vec<&Point> = asked
                .iter()
                .copied()
                .filter(|p| p.solver == solver && p.step_s == step_s)
                .collect();
            let cycles = match question.target {
                Some(target) => Some(cycles(target, solver, question.convention)?),
                None => None,
            };
            (mine.len() == scenes.len()).then(|| Candidate {
                cycles,
                ..candidate(solver, step_s, &mine, need)
            })
        })
        .collect()
}

/// The cost of a rung on the target.
fn cycles(target: &OnTarget, solver: &str, convention: &str) -> Option<Cycles> {
    let row = target
        .rows
        .iter()
        .find(|row| row.is_rung && row.subject == solver && row.convention == Some(convention))?;
    Some(Cycles {
        mean: row.mean_cycles,
        worst: row.worst_cycles,
        worst_on: row.worst_on.clone(),
    })
}

fn candidate(solver: &'static str, step_s: f64, points: &[&Point], need: &Need) -> Candidate {
    let median = |value: fn(&Point) -> f64| {
        let mut values: Vec<f64> = points.iter().map(|p| value(p)).collect();
        values.sort_by(f64::total_cmp);
        quantile(&values, 0.5)
    };
    let worst_of = |limit: &Limit| {
        points
            .iter()
            .map(|p| Mark {
                limit: *limit,
                error: limit.criterion.judged(p),
                scene: p.scene.clone(),
            })
            .max_by(|a, b| a.error.total_cmp(&b.error))
    };
    Candidate {
        solver,
        step_s,
        ns_per_step: median(|p| p.ns_per_step),
        us_per_simulated_s: median(|p| p.us_per_simulated_s),
        time_spread: median(|p| p.time_spread),
        cycles: None,
        unmatched: points
            .iter()
            .filter(|p| p.unmatched > 0)
            .max_by_key(|p| p.unmatched)
            .map(|p| Unmatched {
                events: p.unmatched,
                events_true: p.events_true,
                scene: p.scene.clone(),
            }),
        marks: need.limits().iter().filter_map(worst_of).collect(),
    }
}
