//! The answer to a need: the cheapest rung and step that are accurate enough.
//!
//! A rung at a step meets a need if on *every* scene studied no interior event
//! is unmatched and every limit holds. Its cost is the median over the scenes.
//! Among those that meet the need the cheapest is chosen; of those that cost
//! the same within the spread of their timings, the one that is furthest below
//! the limits.

use crate::accuracy::need::{Criterion, Limit, Need};
use crate::accuracy::point::Point;
use crate::accuracy::timing::quantile;
use serde::Serialize;

/// Among which points a need is to be met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Question<'a> {
    /// Of this convention.
    pub convention: &'a str,
    /// In this precision.
    pub precision: &'a str,
    /// At this step, s; at any if `None`.
    pub step_s: Option<f64>,
}

/// A rung at a step, over all scenes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The rung.
    pub solver: &'static str,
    /// The step, s.
    pub step_s: f64,
    /// Median cost of a step, ns.
    pub ns_per_step: f64,
    /// Median cost of a simulated second, µs.
    pub us_per_simulated_s: f64,
    /// Median spread of the timings.
    pub time_spread: f64,
    /// The scene with most unmatched events, if any has.
    pub unmatched: Option<Unmatched>,
    /// The worst error of each limited criterion.
    pub marks: Vec<Mark>,
}

/// Unmatched events of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unmatched {
    /// How many.
    pub events: u64,
    /// Of how many of the reference.
    pub events_true: u64,
    /// Where.
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
    /// Where it is.
    pub scene: String,
}

impl Mark {
    /// Error over limit: above one it fails.
    pub fn ratio(&self) -> f64 {
        self.error / self.limit.at_most
    }
}

impl Candidate {
    /// Whether the need is met.
    pub fn meets(&self) -> bool {
        self.unmatched.is_none() && self.marks.iter().all(|m| m.ratio() <= 1.0)
    }

    /// The criterion that is nearest to its limit, or furthest beyond.
    pub fn tightest(&self) -> Option<&Mark> {
        self.marks
            .iter()
            .max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// The error of a criterion.
    pub fn mark(&self, criterion: Criterion) -> Option<&Mark> {
        self.marks.iter().find(|m| m.limit.criterion == criterion)
    }

    /// Share of one core that real time takes.
    pub fn core_share(&self) -> f64 {
        self.us_per_simulated_s * 1e-6
    }

    /// How far the tightest criterion is used up.
    fn used(&self) -> f64 {
        self.tightest().map_or(0.0, Mark::ratio)
    }

    /// Whether the costs of both are the same within the spread of timings.
    fn costs_like(&self, other: &Self) -> bool {
        let spread = self.time_spread.max(other.time_spread);
        let (low, high) = if self.us_per_simulated_s < other.us_per_simulated_s {
            (self.us_per_simulated_s, other.us_per_simulated_s)
        } else {
            (other.us_per_simulated_s, self.us_per_simulated_s)
        };
        high <= low * (1.0 + spread)
    }
}

/// The longest step at which a rung meets the need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Longest {
    /// The rung there; `None` if it never meets the need.
    pub candidate: Option<Candidate>,
    /// The rung.
    pub solver: &'static str,
    /// Shorter steps at which it does not, s: luck at the longer one, or
    /// rounding at the shorter.
    pub fails_below_s: Vec<f64>,
}

/// What is known about a need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The cheapest that meets it.
    pub chosen: Option<Candidate>,
    /// Others that meet it at the same cost within the timing's spread, and
    /// are not more exact.
    pub equals: Vec<Candidate>,
    /// The cheapest that meets it with a smaller error where the chosen one is
    /// tightest, at a higher cost.
    pub better: Option<Candidate>,
    /// Cheaper ones that fail, dearest first; of each rung the dearest.
    pub cheaper: Vec<Candidate>,
    /// Without a fixed step: the longest step of every rung.
    pub longest: Vec<Longest>,
    /// Where nothing meets the need: what comes nearest.
    pub nearest: Option<Candidate>,
}

/// Answers a need from measured points.
pub fn answer(points: &[Point], need: &Need, question: &Question<'_>) -> Answer {
    let candidates = candidates(points, need, question);
    let chosen = choose(&candidates);
    let is_chosen = |c: &Candidate| {
        chosen.is_some_and(|chosen| c.solver == chosen.solver && c.step_s == chosen.step_s)
    };
    let equals: Vec<Candidate> = candidates
        .iter()
        .filter(|c| c.meets() && !is_chosen(c))
        .filter(|c| {
            chosen.is_some_and(|chosen| {
                c.us_per_simulated_s <= chosen.us_per_simulated_s || c.costs_like(chosen)
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
        better: chosen.and_then(|chosen| better(&candidates, chosen)),
        cheaper: chosen.map_or_else(Vec::new, |chosen| cheaper(&candidates, chosen)),
        nearest: chosen.map_or_else(|| nearest(&candidates), |_| None),
        chosen: chosen.cloned(),
        equals,
        longest,
    }
}

/// Each rung and step that was studied on every scene of the question.
fn candidates(points: &[Point], need: &Need, question: &Question<'_>) -> Vec<Candidate> {
    let asked: Vec<&Point> = points
        .iter()
        .filter(|p| p.convention == question.convention && p.precision == question.precision)
        .filter(|p| question.step_s.is_none_or(|h| p.step_s == h))
        .collect();
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
            (mine.len() == scenes.len()).then(|| candidate(solver, step_s, &mine, need))
        })
        .collect()
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

/// The cheapest that meets the need; of equally cheap ones the most exact.
fn choose(candidates: &[Candidate]) -> Option<&Candidate> {
    let meeting = || candidates.iter().filter(|c| c.meets());
    let cheapest = meeting().min_by(|a, b| by_cost(a, b))?;
    meeting()
        .filter(|c| c.costs_like(cheapest))
        .min_by(|a, b| a.used().total_cmp(&b.used()))
}

fn by_cost(a: &Candidate, b: &Candidate) -> std::cmp::Ordering {
    a.us_per_simulated_s.total_cmp(&b.us_per_simulated_s)
}

/// The cheapest that is smaller than `chosen` where that is tightest, and
/// costs more.
fn better(candidates: &[Candidate], chosen: &Candidate) -> Option<Candidate> {
    let tightest = chosen.tightest()?;
    candidates
        .iter()
        .filter(|c| c.meets() && c.us_per_simulated_s > chosen.us_per_simulated_s)
        .filter(|c| {
            c.mark(tightest.limit.criterion)
                .is_some_and(|m| m.error < tightest.error)
        })
        .min_by(|a, b| by_cost(a, b))
        .cloned()
}

/// Of each rung the dearest that is cheaper than `chosen` and fails.
fn cheaper(candidates: &[Candidate], chosen: &Candidate) -> Vec<Candidate> {
    let mut cheaper: Vec<&Candidate> = candidates
        .iter()
        .filter(|c| !c.meets() && c.us_per_simulated_s < chosen.us_per_simulated_s)
        .collect();
    cheaper.sort_by(|a, b| by_cost(b, a));
    let mut shown: Vec<Candidate> = Vec::new();
    for c in cheaper {
        if !shown.iter().any(|s| s.solver == c.solver) {
            shown.push(c.clone());
        }
    }
    shown
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

/// What fails least: all events matched if possible, then the smallest excess.
fn nearest(candidates: &[Candidate]) -> Option<Candidate> {
    candidates
        .iter()
        .min_by(|a, b| {
            let lost = |c: &Candidate| c.unmatched.as_ref().map_or(0, |u| u.events);
            lost(a).cmp(&lost(b)).then(a.used().total_cmp(&b.used()))
        })
        .cloned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::point::tests::point;

    /// A rung on two scenes: cost of a step, torque error, interval error.
    fn rung(solver: &'static str, step_s: f64, ns: f64, torque: f64, interval: f64) -> [Point; 2] {
        ["slow", "fast"].map(|scene| Point {
            scene: scene.to_owned(),
            ns_per_step: ns,
            us_per_simulated_s: ns * 1e-3 / step_s,
            rms_torque_error_nm: torque,
            max_interval_error_s: interval,
            ..point(solver, step_s)
        })
    }

    fn ask(points: &[Point], need: &str, step_s: Option<f64>) -> Answer {
        let question = Question {
            convention: "frozen",
            precision: "f32",
            step_s,
        };
        answer(points, &need.parse().unwrap(), &question)
    }

    fn name(candidate: Option<&Candidate>) -> Option<(&'static str, f64)> {
        candidate.map(|c| (c.solver, c.step_s))
    }

    #[test]
    fn the_cheapest_that_meets_the_need_is_chosen_and_the_rest_explained() {
        let points = [
            rung("a", 5e-5, 2.0, 9e-3, 1e-4),
            rung("b", 5e-5, 3.0, 4e-3, 4e-4),
            rung("c", 5e-5, 4.0, 4e-3, 1e-5),
            rung("d", 5e-5, 9.0, 1e-3, 1e-5),
        ]
        .concat();
        let a = ask(&points, "torque=5e-3,interval=5e-4", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
        // Both are used to 80 %; c is as tight in torque, d is not.
        assert_eq!(a.chosen.as_ref().unwrap().tightest().unwrap().ratio(), 0.8);
        assert_eq!(a.cheaper.len(), 1);
        let why = a.cheaper[0].tightest().unwrap();
        assert_eq!(why.limit.criterion, Criterion::Torque);
        assert!((why.ratio() - 1.8).abs() < 1e-12);
        assert!(a.equals.is_empty() && a.nearest.is_none() && a.longest.is_empty());
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.better.as_ref()), Some(("d", 5e-5)));
        assert!((a.chosen.unwrap().core_share() - 60e-6).abs() < 1e-12);
    }

    #[test]
    fn a_need_holds_on_all_scenes_or_not_at_all() {
        let mut points = [
            rung("a", 5e-5, 2.0, 1e-3, 1e-5),
            rung("b", 5e-5, 3.0, 1e-3, 1e-5),
        ]
        .concat();
        points[1].rms_torque_error_nm = 6e-3;
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
        assert_eq!(a.cheaper[0].tightest().unwrap().scene, "fast");
    }

    #[test]
    fn unmatched_events_fail_however_small_the_errors() {
        let mut points = [
            rung("a", 5e-5, 2.0, 1e-9, 1e-9),
            rung("b", 5e-5, 3.0, 1e-3, 1e-5),
        ]
        .concat();
        points[0].unmatched = 3;
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
        let lost = a.cheaper[0].unmatched.as_ref().unwrap();
        assert_eq!((lost.events, lost.scene.as_str()), (3, "slow"));
    }

    #[test]
    fn at_equal_cost_the_more_exact_wins() {
        let mut points = [
            rung("a", 5e-5, 3.00, 4e-3, 1e-5),
            rung("b", 5e-5, 3.02, 1e-4, 1e-5),
            rung("c", 5e-5, 3.50, 1e-6, 1e-5),
        ]
        .concat();
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
        assert_eq!(name(a.equals.first()), Some(("a", 5e-5)));
        assert!(a.cheaper.is_empty());
        for p in &mut points {
            p.time_spread = 0.001;
        }
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("a", 5e-5)));
    }

    #[test]
    fn without_a_step_the_longest_of_each_rung_is_told() {
        let points = [
            rung("a", 1e-3, 2.0, 9e-3, 1e-5),
            rung("a", 1e-4, 2.0, 4e-3, 1e-5),
            rung("a", 1e-5, 2.0, 8e-3, 1e-5),
            rung("b", 1e-3, 8.0, 1e-3, 1e-5),
            rung("c", 1e-3, 1.0, 1.0, 1e-5),
        ]
        .concat();
        let a = ask(&points, "torque=5e-3", None);
        // 8 ns a millisecond are less than 2 ns a tenth of it.
        assert_eq!(name(a.chosen.as_ref()), Some(("b", 1e-3)));
        let told: Vec<_> = a
            .longest
            .iter()
            .map(|l| (l.solver, name(l.candidate.as_ref()).map(|n| n.1)))
            .collect();
        assert_eq!(told, [("a", Some(1e-4)), ("b", Some(1e-3)), ("c", None)]);
        assert_eq!(a.longest[0].fails_below_s, [1e-5]);
        // Of each rung the dearest that is still cheaper.
        let cheaper: Vec<_> = a.cheaper.iter().map(|c| (c.solver, c.step_s)).collect();
        assert_eq!(cheaper, [("a", 1e-3), ("c", 1e-3)]);
    }

    #[test]
    fn where_nothing_is_enough_the_nearest_is_told() {
        let mut points = [
            rung("a", 5e-5, 2.0, 9e-3, 1e-5),
            rung("b", 5e-5, 3.0, 7e-3, 1e-5),
            rung("c", 5e-5, 3.0, 1e-9, 1e-5),
        ]
        .concat();
        points[5].unmatched = 1;
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert!(a.chosen.is_none() && a.cheaper.is_empty() && a.better.is_none());
        assert_eq!(name(a.nearest.as_ref()), Some(("b", 5e-5)));
    }

    #[test]
    fn other_conventions_precisions_and_steps_do_not_count() {
        let mut points = [
            rung("a", 5e-5, 1.0, 1e-3, 1e-5),
            rung("b", 5e-5, 2.0, 1e-3, 1e-5),
            rung("c", 1e-3, 1.0, 1e-3, 1e-5),
            rung("d", 5e-5, 3.0, 1e-3, 1e-5),
        ]
        .concat();
        points[0].convention = "physical";
        points[1].convention = "physical";
        points[2].precision = "f64";
        points[3].precision = "f64";
        let a = ask(&points, "torque=5e-3", Some(5e-5));
        assert_eq!(name(a.chosen.as_ref()), Some(("d", 5e-5)));
        assert!(a.equals.is_empty() && a.cheaper.is_empty());
    }

    #[test]
    fn what_is_not_known_fails_in_torque_and_passes_where_there_is_no_event() {
        let mut points = rung("a", 5e-5, 2.0, 1e-3, f64::NAN).to_vec();
        assert!(ask(&points, "interval=1e-9", None).chosen.is_some());
        points[0].rms_torque_error_nm = f64::NAN;
        assert!(ask(&points, "torque=1", None).chosen.is_none());
    }
}
