//! The report of a session: one page to print, with two students and six knees on one sheet of A4.
//!
//! All its words are looked up by key, `report.…`, so that it is in the reader's language. It has no
//! scripts, no inline style attributes and no links; its style sheet is one `<style>` element.

mod words;

use crate::lesson::lesson::Answer;
use crate::lesson::session::Session;
use crate::lesson::summary::{Confusion, Scores, Summary};
use crepitus_pages::plot::page;
use crepitus_studies::experiment::finding::Finding;
use maud::{Markup, html};
use words::Words;

/// Looks a text up by its key: the caller's table of the reader's language.
pub type Text<'a> = &'a dyn Fn(&str) -> String;

/// The report as HTML, complete in itself.
pub fn report(session: &Session, text: Text<'_>) -> String {
    let words = Words(text);
    let lesson = &session.lesson;
    let summary = lesson.plan().blind.then(|| Summary::of(lesson));
    let body = html! {
        header {
            p.kicker { (words.get("report.kind")) }
            h1 { (lesson.plan().title) }
            @if !lesson.plan().description.is_empty() {
                p.description { (lesson.plan().description) }
            }
            (facts(session, &words))
        }
        main {
            @match &summary {
                Some(summary) => (results(session, summary, &words)),
                None => (knees(session, &words)),
            }
            (notes(session, &words))
            @if let Some(summary) = &summary { (remarks(summary, &words)) }
        }
    };
    let language = words.get("report.language");
    page::document_in(
        &language,
        &lesson.plan().title,
        include_str!("report/report.css"),
        &[],
        &body,
    )
}

/// Date, seed, students: what is needed to hold the lesson again.
fn facts(session: &Session, words: &Words<'_>) -> Markup {
    let lesson = &session.lesson;
    let mode = if lesson.plan().blind {
        "report.blind"
    } else {
        "report.open"
    };
    let begun = lesson.trial() - usize::from(!lesson.began());
    let trials = words.with(
        "report.trials_value",
        &[
            ("examined", &begun.to_string()),
            ("trials", &lesson.trials().to_string()),
        ],
    );
    let students = lesson.students().join(", ");
    let facts = [
        ("report.date", session.started.to_string()),
        (
            "report.lesson",
            format!("{}, {}", lesson.name(), words.get(mode)),
        ),
        ("report.trials", trials),
        ("report.seed", lesson.seed().to_string()),
        ("report.students", students),
        ("report.recordings", session.recordings.len().to_string()),
        ("report.version", session.tool.clone()),
    ];
    html! {
        dl {
            @for (key, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
                div { dt { (words.get(key)) } dd { (value) } }
            }
        }
        @if !lesson.ended() { p.remark { (words.get("report.not_ended")) } }
    }
}

/// All students in one table, then each.
fn results(session: &Session, summary: &Summary, words: &Words<'_>) -> Markup {
    let names = summary
        .students
        .iter()
        .map(|s| (s.student.clone(), &s.scores));
    let several = summary.students.len() > 1;
    let all = several.then(|| (words.get("report.all"), &summary.all));
    html! {
        section {
            h2 { (words.get("report.results")) }
            table.scores {
                thead { tr {
                    @for key in [
                        "report.student", "report.right", "report.kappa", "report.level_kappa",
                        "report.confidence_right", "report.confidence_wrong",
                    ] { th scope="col" { (words.get(key)) } }
                } }
                tbody { @for (name, scores) in names.chain(all) { (score_row(&name, scores, words)) } }
            }
        }
        @for student in &summary.students {
            section.student {
                div {
                    h2 { (student.student) ": " (right_of(&student.scores, words)) }
                    (trials(session, &student.student, words))
                }
                (confusion(&student.scores.confusion, words))
            }
        }
    }
}

fn score_row(name: &str, scores: &Scores, words: &Words<'_>) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            td { (right_of(scores, words)) }
            td { (words.interval(scores.kappa)) }
            td { (words.interval(scores.level_kappa)) }
            td { (words.mean(scores.confidence_right)) }
            td { (words.mean(scores.confidence_wrong)) }
        }
    }
}

fn right_of(scores: &Scores, words: &Words<'_>) -> String {
    let (right, answers) = (scores.right.to_string(), scores.answers.to_string());
    words.with(
        "report.right_value",
        &[("right", &right), ("answers", &answers)],
    )
}

/// Every trial of a student.
fn trials(session: &Session, student: &str, words: &Words<'_>) -> Markup {
    let lesson = &session.lesson;
    let answer_to = |trial: usize| {
        let mut answers = lesson.answers().iter();
        answers.find(|a| a.trial == trial && a.student == student)
    };
    html! {
        table.trials {
            thead { tr {
                @for key in ["report.trial", "report.knee", "report.answer", "report.confidence", "report.verdict"] {
                    th scope="col" { (words.get(key)) }
                }
            } }
            tbody {
                // The knee of a trial that was not reached is not revealed.
                @for trial in (1..=lesson.trials()).filter(|trial| lesson.is_revealed(*trial)) {
                    @let answer = answer_to(trial);
                    @let knee = lesson.knee_of(trial);
                    tr {
                        th scope="row" { (trial) }
                        td { (knee.disorder.map_or_else(|| knee.title.clone(), |d| words.finding(d, knee.level))) }
                        @match answer {
                            Some(answer) => {
                                td { (words.finding(answer.disorder, answer.level)) }
                                td.number { (answer.confidence) }
                                td { (verdict(session, answer, words)) }
                            }
                            None => { td { (words.get("report.no_answer")) } td {} td {} }
                        }
                    }
                }
            }
        }
    }
}

/// Returns whether disorder and level are right, or why the answer does not count.
fn verdict(session: &Session, answer: &Answer, words: &Words<'_>) -> String {
    if let (false, Some(share)) = (answer.counts(), answer.torque_share) {
        let share = words.number(100.0 * share, 0);
        return words.with("report.without_torque", &[("share", &share)]);
    }
    let knee = session.lesson.knee_of(answer.trial);
    words.get(match (answer.is_right(knee), answer.is_level_right(knee)) {
        (false, _) => "report.no",
        (true, Some(false)) => "report.not_the_level",
        (true, _) => "report.yes",
    })
}

/// A student's confusion matrix.
fn confusion(confusion: &Confusion, words: &Words<'_>) -> Markup {
    html! {
        @if !confusion.rows.is_empty() {
            table.confusion {
                caption { (words.get("report.confusion")) }
                thead { tr {
                    td {}
                    @for column in &confusion.columns {
                        th scope="col" { span { (words.finding(*column, None)) } }
                    }
                } }
                tbody {
                    @for (row, counts) in confusion.rows.iter().zip(&confusion.counts) {
                        tr {
                            th scope="row" { (words.finding(*row, None)) }
                            @for (column, count) in confusion.columns.iter().zip(counts) {
                                (cell(*row, *column, *count))
                            }
                        }
                    }
                }
            }
        }
    }
}

fn cell(row: Finding, column: Finding, count: usize) -> Markup {
    html! {
        td.number.right[row == column].wrong[row != column && count > 0] {
            @if count > 0 { (count) } @else { "·" }
        }
    }
}

/// The knees of an open lesson.
fn knees(session: &Session, words: &Words<'_>) -> Markup {
    let lesson = &session.lesson;
    html! {
        section {
            h2 { (words.get("report.knees")) }
            table.trials {
                tbody {
                    @for trial in 1..=lesson.trials() {
                        @let knee = lesson.knee_of(trial);
                        @let is_healthy = knee.disorder == Some(Finding::Healthy);
                        tr {
                            th scope="row" { (trial) }
                            td { @if !is_healthy { (knee.title) } }
                            td { @if let Some(finding) = knee.disorder { (words.finding(finding, knee.level)) } }
                        }
                    }
                }
            }
        }
    }
}

fn notes(session: &Session, words: &Words<'_>) -> Markup {
    let notes = session.lesson.notes();
    html! {
        @if !notes.is_empty() {
            section {
                h2 { (words.get("report.notes")) }
                table.notes {
                    thead { tr {
                        @for key in ["report.trial", "report.time", "report.note"] {
                            th scope="col" { (words.get(key)) }
                        }
                    } }
                    tbody {
                        @for note in notes {
                            tr {
                                td.number { (note.trial) }
                                td.number { (words.number(note.time_s, 1)) }
                                td { (note.text) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Remarks on how to read the numbers.
fn remarks(summary: &Summary, words: &Words<'_>) -> Markup {
    html! {
        p.remark {
            @for key in &summary.remarks { (words.get(&format!("report.{key}"))) " " }
        }
    }
}

#[cfg(test)]
mod tests;
