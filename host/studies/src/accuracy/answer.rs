//! The answer to a need: the cheapest rung and step that are accurate enough.
//!
//! A rung at a step meets a need if on *every* scene studied no interior event
//! is unmatched and every limit holds. The cheapest of them depends on where
//! it is to run:
//!
//! | where | cost | the same cost | further condition |
//! |---|---|---|---|
//! | host | CPU time, median over the scenes | within the spread of the timings | – |
//! | target | mean cycles over the scenes, equal means by the worst observed | to the cycle | the worst observed step fits [`STEP_SHARE`](super::target::STEP_SHARE) of a tick |
//!
//! Of equal costs, the one furthest below the limits is chosen.

mod candidate;

use crate::accuracy::need::{Criterion, Need};
use crate::accuracy::point::Point;
use crate::accuracy::target::OnTarget;
pub use candidate::{Candidate, Cycles, Mark, Unmatched};
use candidate::{asked, candidates};
use serde::Serialize;
use std::cmp::Ordering;

/// Selects the points that may meet a need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Question<'a> {
    /// Convention.
    pub convention: &'a str,
    /// Precision.
    pub precision: &'a str,
    /// Step, s; any if `None`.
    pub step_s: Option<f64>,
    /// Costs of the ladder on the target, if they decide.
    #[serde(skip)]
    pub target: Option<&'a OnTarget>,
}

/// The longest step at which a rung meets the need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Longest {
    /// The rung there; `None` if it never meets the need.
    pub candidate: Option<Candidate>,
    /// The rung.
    pub solver: &'static str,
    /// Shorter steps at which it fails, s: luck at the longer one, or
    /// rounding at the shorter.
    pub fails_below_s: Vec<f64>,
}

/// A limit of the held torque that no solver can meet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unreachable {
    /// The shortest step of the question, s.
    pub step_s: f64,
    /// The least root mean square error of any torque that is held that long,
    /// N·m.
    pub floor_nm: f64,
    /// The scene.
    pub scene: String,
}

/// The answer to a need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The cheapest that meets it.
    pub chosen: Option<Candidate>,
    /// The next cheapest that meets it.
    pub runner_up: Option<Candidate>,
    /// Others that meet it at the same cost, and are not more accurate.
    pub equals: Vec<Candidate>,
    /// The cheapest of higher cost that meets it with a smaller error of the
    /// chosen one's limiting criterion.
    pub better: Option<Candidate>,
    /// Cheaper ones that fail, the costliest first; of each rung the costliest.
    pub cheaper: Vec<Candidate>,
    /// All that fail, the cheapest first, if costs on the target decide; otherwise empty.
    pub failed: Vec<Candidate>,
    /// Longest step of every rung, if the question has no fixed step; otherwise empty.
    pub longest: Vec<Longest>,
    /// The nearest, if nothing meets the need.
    pub nearest: Option<Candidate>,
    /// Reason why nothing can meet the need, if nothing can.
    pub unreachable: Option<Unreachable>,
}

/// Answers a need from measured points.
pub fn answer(points: &[Point], need: &Need, question: &Question<'_>) -> Answer {
    let candidates = candidates(points, need, question);
    let chosen = choose(&candidates);
    let is_chosen = |c: &Candidate| {
        chosen.is_some_and(|chosen| c.solver == chosen.solver && c.step_s == chosen.step_s)
    };
    let others = || candidates.iter().filter(|c| c.meets() && !is_chosen(c));
    let equals: Vec<Candidate> = others()
        .filter(|c| {
            chosen.is_some_and(|chosen| {
                c.by_cost(chosen) != Ordering::Greater || c.costs_like(chosen)
            })
        })
        .cloned()
        .collect();
    let longest = if question.step_s.is_none() {
        longest(&candidates)
    } else {
        Vec::new()
    };
    Answer {
        runner_up: others().min_by(|a, b| a.by_cost(b)).cloned(),
        better: chosen.and_then(|chosen| better(&candidates, chosen)),
        cheaper: chosen.map_or_else(Vec::new, |chosen| cheaper(&candidates, chosen)),
        failed: if question.target.is_some() {
            failed(&candidates)
        } else {
            Vec::new()
        },
        nearest: chosen.map_or_else(|| nearest(&candidates), |_| None),
        unreachable: chosen.map_or_else(|| unreachable(points, need, question), |_| None),
        chosen: chosen.cloned(),
        equals,
        longest,
    }
}

/// The cheapest that meets the need; of equally cheap ones the most accurate.
fn choose(candidates: &[Candidate]) -> Option<&Candidate> {
    let meeting = || candidates.iter().filter(|c| c.meets());
    let cheapest = meeting().min_by(|a, b| a.by_cost(b))?;
    meeting()
        .filter(|c| c.costs_like(cheapest))
        .min_by(|a, b| a.used().total_cmp(&b.used()))
}

/// The cheapest that costs more than `chosen` and has a smaller error of its
/// limiting criterion.
fn better(candidates: &[Candidate], chosen: &Candidate) -> Option<Candidate> {
    let tightest = chosen.tightest()?;
    candidates
        .iter()
        .filter(|c| c.meets() && c.by_cost(chosen) == Ordering::Greater)
        .filter(|c| {
            c.mark(tightest.limit.criterion)
                .is_some_and(|m| m.error < tightest.error)
        })
        .min_by(|a, b| a.by_cost(b))
        .cloned()
}

/// Costliest of each rung's candidates that are cheaper than `chosen` and fail.
fn cheaper(candidates: &[Candidate], chosen: &Candidate) -> Vec<Candidate> {
    let mut cheaper: Vec<&Candidate> = candidates
        .iter()
        .filter(|c| !c.meets() && c.by_cost(chosen) == Ordering::Less)
        .collect();
    cheaper.sort_by(|a, b| b.by_cost(a));
    let mut shown: Vec<Candidate> = Vec::new();
    for c in cheaper {
        if !shown.iter().any(|s| s.solver == c.solver) {
            shown.push(c.clone());
        }
    }
    shown
}

fn failed(candidates: &[Candidate]) -> Vec<Candidate> {
    let mut failed: Vec<Candidate> = candidates.iter().filter(|c| !c.meets()).cloned().collect();
    failed.sort_by(Candidate::by_cost);
    failed
}

fn longest(candidates: &[Candidate]) -> Vec<Longest> {
    let mut solvers: Vec<&'static str> = Vec::new();
    for c in candidates {
        if !solvers.contains(&c.solver) {
            solvers.push(c.solver);
        }
    }
    solvers
        .into_iter()
        .map(|solver| {
            let mine = || candidates.iter().filter(|c| c.solver == solver);
            let longest = mine()
                .filter(|c| c.meets())
                .max_by(|a, b| a.step_s.total_cmp(&b.step_s));
            Longest {
                solver,
                candidate: longest.cloned(),
                fails_below_s: longest.map_or_else(Vec::new, |l| {
                    mine()
                        .filter(|c| c.step_s < l.step_s && !c.meets())
                        .map(|c| c.step_s)
                        .collect()
                }),
            }
        })
        .collect()
}

/// The nearest: all events matched if possible, then the smallest excess.
fn nearest(candidates: &[Candidate]) -> Option<Candidate> {
    candidates
        .iter()
        .min_by(|a, b| {
            let lost = |c: &Candidate| c.unmatched.as_ref().map_or(0, |u| u.events);
            lost(a).cmp(&lost(b)).then(a.used().total_cmp(&b.used()))
        })
        .cloned()
}

/// Returns whether the limit of the held torque is below the floor of holding, even at
/// the shortest step.
fn unreachable(points: &[Point], need: &Need, question: &Question<'_>) -> Option<Unreachable> {
    let limit = need
        .limits()
        .iter()
        .find(|l| l.criterion == Criterion::Torque)?;
    let asked = asked(points, question);
    let step_s = asked.iter().map(|p| p.step_s).min_by(f64::total_cmp)?;
    let worst = asked
        .into_iter()
        .filter(|p| p.step_s == step_s && p.held_floor_nm.is_finite())
        .max_by(|a, b| a.held_floor_nm.total_cmp(&b.held_floor_nm))?;
    (worst.held_floor_nm > limit.at_most).then(|| Unreachable {
        step_s,
        floor_nm: worst.held_floor_nm,
        scene: worst.scene.clone(),
    })
}

#[cfg(test)]
mod tests;
