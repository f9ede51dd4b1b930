//! Order of the laws by their errors, and which to take for what.
//!
//! The rule, the same for all laws and uses:
//!
//! 1. the score of a law for a use is the mean of its relative errors over all quantities of the use
//!    and all joints; an error beyond 1, and a quantity that the law cannot do, count as 1;
//! 2. the laws within a tenth of the smallest score, or within 0.005 of it, are as good as the
//!    best;
//! 3. of those the answer is the one whose step costs least: in cycles of the controller, or in
//!    time on the host if it was not run there.

use super::costs::Costs;
use super::row::Row;
use super::study::LawStudy;
use super::task::Use;
use serde::Serialize;

/// Scores that close to the best are as good: a share of it, or absolutely.
const AS_GOOD_SHARE: f64 = 0.1;
const AS_GOOD: f64 = 0.005;

/// Score of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Name of the law.
    pub law: &'static str,
    /// Mean of the relative errors, those beyond 1 counting as 1.
    pub score: f64,
    /// Quantities on joints that it cannot do.
    pub failed: usize,
    /// Quantity and joint of its largest error, if any is above zero.
    pub worst: Option<Worst>,
}

/// The largest error of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Name of the joint.
    pub joint: &'static str,
    /// Relative error; `None` if it cannot do it.
    pub relative_error: Option<f64>,
    /// Reason why it cannot.
    pub failed: Option<&'static str>,
}

/// The law to take for a use.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// The use.
    pub of: Use,
    /// Name of the law; `None` if every law fails in all.
    pub law: Option<&'static str>,
    /// Laws as good as the best, best first.
    pub as_good: Vec<&'static str>,
    /// All laws, best first.
    pub scores: Vec<Score>,
}

/// Order of the laws in one quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Order {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Laws with their worst relative error over the joints, smallest first; `None` if one fails.
    pub laws: Vec<(&'static str, Option<f64>)>,
}

/// The law to take for each use that the study has rows of.
pub fn answers(study: &LawStudy) -> Vec<Answer> {
    let uses = Use::ALL.into_iter();
    let of = |of: Use| {
        let rows: Vec<&Row> = study.rows.iter().filter(|row| row.of == of).collect();
        (!rows.is_empty()).then(|| answer(of, &rows, study))
    };
    uses.filter_map(of).collect()
}

fn answer(of: Use, rows: &[&Row], study: &LawStudy) -> Answer {
    let mut scores: Vec<Score> = study.laws.iter().map(|(law, _)| score(law, rows)).collect();
    // Stable: equal scores stay in the order of the table.
    scores.sort_by(|a, b| a.score.total_cmp(&b.score));
    let best = scores.first().map_or(1.0, |best| best.score);
    let most = (best * (1.0 + AS_GOOD_SHARE)).max(best + AS_GOOD);
    let as_good = scores.iter().filter(|s| s.score <= most && s.score < 1.0);
    let as_good: Vec<_> = as_good.map(|s| s.law).collect();
    let cost = |law: &str| {
        let costs = study.costs.iter().find(|costs| costs.law == law);
        costs.map_or(f64::INFINITY, Costs::of_a_step)
    };
    let cheapest = as_good
        .iter()
        .copied()
        .min_by(|a, b| cost(a).total_cmp(&cost(b)));
    Answer {
        of,
        law: cheapest,
        as_good,
        scores,
    }
}

fn score(law: &'static str, rows: &[&Row]) -> Score {
    let own = rows.iter().filter(|row| row.law == law);
    let own: Vec<&&Row> = own.collect();
    let sum: f64 = own.iter().map(|row| row.error_or_failed().min(1.0)).sum();
    let worst = own
        .iter()
        .max_by(|a, b| a.error_or_failed().total_cmp(&b.error_or_failed()));
    Score {
        law,
        score: sum / own.len().max(1) as f64,
        failed: own.iter().filter(|row| row.failed.is_some()).count(),
        worst: worst
            .filter(|row| row.error_or_failed() > 0.0)
            .map(|row| Worst {
                quantity: row.quantity,
                joint: row.joint,
                relative_error: row.relative_error.filter(|_| row.failed.is_none()),
                failed: row.failed,
            }),
    }
}

/// The order of the laws in every quantity, in the order of the rows.
pub fn orders(study: &LawStudy) -> Vec<Order> {
    let mut quantities: Vec<&'static str> = Vec::new();
    for row in &study.rows {
        if !quantities.contains(&row.quantity) {
            quantities.push(row.quantity);
        }
    }
    let order = |quantity| {
        let worst = |law: &'static str| {
            let rows = study.rows.iter();
            let own = rows.filter(|row| row.law == law && row.quantity == quantity);
            let worst = own.map(Row::error_or_failed).fold(0.0, f64::max);
            (law, worst)
        };
        let mut laws: Vec<_> = study.laws.iter().map(|(law, _)| worst(law)).collect();
        laws.sort_by(|a, b| a.1.total_cmp(&b.1));
        let known = |(law, worst): (_, f64)| (law, worst.is_finite().then_some(worst));
        Order {
            quantity,
            laws: laws.into_iter().map(known).collect(),
        }
    };
    quantities.into_iter().map(order).collect()
}

#[cfg(test)]
mod tests;
