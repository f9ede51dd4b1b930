//! Law × use: mean errors, cost and bytes, a line a law.

use super::numbers::{cost, costs_of, percent, unit_of_cost};
use crate::laws::ranking::Answer;
use crate::laws::{LawStudy, Use};
use crepitus_pages::table::Table;

/// A use in a word.
pub(crate) fn short_name(of: Use) -> &'static str {
    match of {
        Use::Grating => "grating",
        Use::Rest => "rest",
        Use::Moving => "moving",
        Use::Coupled => "leg",
        Use::Running => "running",
    }
}

/// The laws, by the mean of their scores, smallest first.
pub(crate) fn in_order(study: &LawStudy, answers: &[Answer]) -> Vec<&'static str> {
    let mean = |law: &str| {
        let scores = answers.iter().filter_map(|answer| score(answer, law));
        scores.sum::<f64>()
    };
    let mut laws: Vec<_> = study.laws.iter().map(|(law, _)| *law).collect();
    // Stable: equal ones stay in the order of the study.
    laws.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
    laws
}

/// Score of a law for a use.
pub(crate) fn score(answer: &Answer, law: &str) -> Option<f64> {
    let score = answer.scores.iter().find(|score| score.law == law);
    score.map(|score| score.score)
}

/// The table over these laws.
pub(crate) fn table<'l>(
    study: &LawStudy,
    answers: &[Answer],
    laws: &'l [&'static str],
) -> Table<'l, &'static str> {
    let mut table = Table::of(laws)
        .people("law", |law| *law)
        .group("mean error, %, for");
    for answer in answers {
        let error = |law: &&'static str| percent(score(answer, law).unwrap_or(f64::NAN));
        table = table.people(short_name(answer.of), error).right();
    }
    table
        .group("a step")
        .people(unit_of_cost(study), |law| cost(study, law))
        .right()
        .people("bytes", |law| {
            costs_of(study, law).map_or_else(|| "–".to_owned(), |costs| costs.bytes.to_string())
        })
        .right()
}
