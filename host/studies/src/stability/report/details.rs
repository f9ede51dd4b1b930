//! Every case in words: why it is hard, exactly what goes in, what must hold,
//! where it comes from, and all verdicts.

use super::look::look;
use crate::stability::matrix::Counts;
use crate::stability::{Cell, Matrix, Row};
use crepitus_pages::plot::page::scrolling;
use maud::{Markup, html};

pub(super) fn cases(matrix: &Matrix) -> Markup {
    let alone = matrix.rows.len() == 1;
    html! {
        @if !matrix.rows.is_empty() {
            section.cases {
                h2 { "The cases" }
                @for row in &matrix.rows {
                    details.case open[alone] {
                        summary {
                            span.what { b { (row.case.id) } " " (row.case.title) }
                            " "
                            span.tally { (tally(row)) }
                        }
                        // The heat map leads here; a closed element opens for it.
                        div.body id=(row.case.id) {
                            (about(row))
                            (verdicts(row))
                        }
                    }
                }
            }
        }
    }
}

/// `40 hold, 2 degrade, 4 fail`.
fn tally(row: &Row) -> String {
    let counts = Counts::of(&row.cells);
    let parts: Vec<String> = [
        (counts.holds, "hold"),
        (counts.degrades, "degrade"),
        (counts.fails, "fail"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    parts.join(", ")
}

fn about(row: &Row) -> Markup {
    let case = &row.case;
    let lines = |lines: Vec<String>| {
        html! { @for line in &lines { p { (line) } } }
    };
    html! {
        dl {
            dt { "Name" } dd { code { (case.name) } }
            dt { "Why it is hard" } dd { p { (case.hard) } }
            dt { "Input" } dd { (lines(case.inputs())) }
            dt { "Criterion" } dd { (lines(case.criteria())) }
            dt { "Source" } dd { p { (case.source) } }
        }
    }
}

fn verdicts(row: &Row) -> Markup {
    html! {
        div.verdicts { (scrolling("All verdicts", &html! {
            table {
                thead { tr {
                    th scope="col" { "convention" }
                    th scope="col" { "rung" }
                    th scope="col" { "precision" }
                    th scope="col" { "verdict" }
                    th scope="col" { "where and what" }
                } }
                tbody { @for cell in &row.cells { (line(cell)) } }
            }
        })) }
    }
}

fn line(cell: &Cell) -> Markup {
    let (tone, _) = look(cell);
    html! {
        tr {
            th scope="row" { (cell.subject.convention.name()) }
            td { (cell.subject.solver.name()) }
            td { (cell.subject.precision.name()) }
            td {
                span.swatch.(tone.ground.name) {} " "
                (cell.verdict.to_string())
                @if cell.is_broken() { b { " – must hold" } }
                @else if cell.must_hold { " (must)" }
            }
            td { (cell.detail) }
        }
    }
}
