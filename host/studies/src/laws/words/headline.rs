//! The answer of the study: a sentence a use, then where ours is not the best.

use super::numbers::{cost, costs_of, percent, unit_of_cost};
use super::scores_table::short_name;
use crate::laws::LawStudy;
use crate::laws::costs::Costs;
use crate::laws::ranking::{Answer, Score};

/// The law that the device renders.
const OURS: &str = "frozen";

/// A line a use, and a last one if another law than ours is better somewhere.
pub(super) fn answer(study: &LawStudy, answers: &[Answer]) -> String {
    if answers.is_empty() {
        return "No law was run on any task.".to_owned();
    }
    let mut lines: Vec<String> = answers
        .iter()
        .enumerate()
        .map(|(place, answer)| line(study, answer, place == 0))
        .collect();
    lines.extend(not_the_best(study, answers));
    lines.join("\n")
}

fn line(study: &LawStudy, answer: &Answer, is_first: bool) -> String {
    let of = answer.of.title();
    let rate = if is_first { " at 20 kHz" } else { "" };
    let score = |law| answer.scores.iter().find(|score| score.law == law);
    let Some((law, score)) = answer.law.and_then(|law| Some((law, score(law)?))) else {
        return format!("For {of}{rate} none of these laws will do: each fails in everything.");
    };
    let others = match answer.as_good.len().saturating_sub(1) {
        0 => String::new(),
        1 => "; one other is as good".to_owned(),
        n => format!("; {n} others are as good"),
    };
    format!(
        "For {of}{rate} take {law}: {}{}{others}.",
        error(score),
        cost_and_bytes(study, law)
    )
}

fn error(score: &Score) -> String {
    let fails = match score.failed {
        0 => String::new(),
        1 => ", one number failed".to_owned(),
        n => format!(", {n} numbers failed"),
    };
    format!("mean error {} %{fails}", percent(score.score))
}

fn cost_and_bytes(study: &LawStudy, law: &str) -> String {
    let Some(costs) = costs_of(study, law) else {
        return String::new();
    };
    let bytes = costs.bytes;
    if costs.of_a_step().is_finite() {
        let (cost, unit) = (cost(study, law), unit_of_cost(study));
        format!(", {cost} {unit} a step, {bytes} bytes")
    } else {
        format!(", {bytes} bytes")
    }
}

/// Uses in which another law has smaller errors than ours, or the same for a smaller cost.
fn not_the_best(study: &LawStudy, answers: &[Answer]) -> Option<String> {
    let found: Vec<String> = answers
        .iter()
        .filter_map(|answer| better(study, answer))
        .collect();
    (!found.is_empty()).then(|| format!("Where {OURS} is not the best: {}.", found.join("; ")))
}

fn better(study: &LawStudy, answer: &Answer) -> Option<String> {
    let ours = answer.scores.iter().find(|score| score.law == OURS)?;
    let best = answer.scores.first()?;
    let name = short_name(answer.of);
    if !answer.as_good.contains(&OURS) {
        return (best.score < ours.score).then(|| {
            format!(
                "{name}, {} errs by {} %, {OURS} by {} %",
                best.law,
                percent(best.score),
                percent(ours.score)
            )
        });
    }
    let law = answer.law.filter(|law| *law != OURS)?;
    let of = |law| costs_of(study, law).map_or(f64::INFINITY, Costs::of_a_step);
    (of(law) < of(OURS)).then(|| {
        let unit = unit_of_cost(study);
        format!(
            "{name}, {law} is as good and costs {} {unit} for {}",
            cost(study, law),
            cost(study, OURS)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::ranking::answers;
    use crate::laws::words::tests::{row, study};

    fn said(rows: &[(&'static str, Option<f64>)]) -> String {
        let rows = rows.iter().map(|(law, error)| row(law, *error));
        let study = study(rows.collect());
        answer(&study, &answers(&study))
    }

    #[test]
    fn a_law_is_named_with_its_error_its_cost_and_its_bytes() {
        let text = said(&[("frozen", Some(0.001)), ("dahl", Some(0.5))]);
        assert_eq!(
            text,
            "For rest and creep at 20 kHz take frozen: mean error 0.10 %, 30 ns a step, 40 bytes."
        );
    }

    #[test]
    fn where_ours_is_worse_or_dearer_it_says_so() {
        let text = said(&[("frozen", Some(0.2)), ("dahl", Some(0.01))]);
        assert!(text.contains("take dahl"), "{text}");
        let line = "Where frozen is not the best: rest, dahl errs by 1.0 %, frozen by 20 %.";
        assert_eq!(text.lines().last(), Some(line));
        let text = said(&[("frozen", Some(0.01)), ("dahl", Some(0.01))]);
        assert!(text.contains("one other is as good"), "{text}");
        let line = "Where frozen is not the best: rest, dahl is as good and costs 10 ns for 30.";
        assert_eq!(text.lines().last(), Some(line));
    }

    #[test]
    fn where_all_fail_no_law_is_named() {
        let text = said(&[("frozen", None), ("dahl", None)]);
        assert!(text.contains("none of these laws will do"), "{text}");
        assert!(!text.contains("take"), "{text}");
        assert_eq!(said(&[]), "No law was run on any task.");
    }
}
