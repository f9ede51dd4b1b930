//! The matrix as a table: a pair of lines a case (f32 above f64), a column a
//! rung, a colour and a number a cell.

use super::columns::{Columns, cell};
use super::{look, scale};
use crate::stability::{Matrix, Row};
use crepitus_pages::plot::page::scrolling;
use maud::{Markup, html};

pub(super) fn table(matrix: &Matrix) -> Markup {
    let columns = Columns::of(matrix);
    html! {
        section.table.matrix {
            h2 { "The matrix" }
            (legend())
            (scrolling("Matrix of cases and rungs", &html! {
                table.heat {
                    thead {
                        tr {
                            th.case rowspan="2" scope="col" { "case" }
                            th rowspan="2" scope="col" {}
                            @for group in &columns.groups {
                                th.convention colspan=(group.rungs.len()) scope="colgroup" {
                                    (group.convention.name())
                                }
                            }
                        }
                        tr {
                            @for group in &columns.groups {
                                @for (i, rung) in group.rungs.iter().enumerate() {
                                    th.rung.first[i == 0] scope="col" { span { (rung.name()) } }
                                }
                            }
                        }
                    }
                    @for row in &matrix.rows { (lines(row, &columns)) }
                }
            }))
            p.caption {
                "The number is the worst of all trials of the case, of the criterion with the "
                "narrowest margin; its limit and its unit stand in the words that show under the "
                "pointer and in the list of cases below. An empty cell: the case has no meaning "
                "there."
            }
        }
    }
}

/// A case: one line a precision.
fn lines(row: &Row, columns: &Columns) -> Markup {
    let case = &row.case;
    html! {
        tbody {
            @for (i, precision) in columns.precisions.iter().enumerate() {
                tr {
                    @if i == 0 {
                        th.case rowspan=(columns.precisions.len()) scope="rowgroup" title=(case.title) {
                            a href={ "#" (case.id) } { b { (case.id) } " " span { (case.name) } }
                        }
                    }
                    th.precision scope="row" { (precision.name()) }
                    @for group in &columns.groups {
                        @for (i, rung) in group.rungs.iter().enumerate() {
                            @match cell(row, group.convention, *rung, *precision) {
                                Some(found) => {
                                    @let (tone, short) = look::look(found);
                                    td .(tone.ground.name) .first[i == 0] .must[found.must_hold]
                                        .broken[found.is_broken()]
                                        title={ (case.id) " " (case.name) ", " (look::words(found)) } {
                                        (short)
                                        @if found.verdict.is_flagged() { sup { (look::FLAG) } }
                                    }
                                }
                                None => td.none.first[i == 0] {},
                            }
                        }
                    }
                }
            }
        }
    }
}

fn legend() -> Markup {
    html! {
        ul.legend {
            li { span { b { "holds" } ", measured / limit:" } }
            @for (tone, text) in scale::stretches() {
                li { span.swatch.(tone.ground.name) {} (text) }
            }
        }
        ul.legend {
            li { span.swatch.plain { (look::MET) } "met, without a number; or the reference" }
            li { span.swatch.(scale::DEGRADES.ground.name) { (look::DEGRADES) }
                "degrades: right in kind, a number is above its limit" }
            li { span.swatch.(scale::FAILS.ground.name) { (look::FAILS) }
                "fails: something else than the joint (∞ overflow, Ts torque above its limit, or \
                 the number of events found)" }
            li { span.swatch.plain { sup { (look::FLAG) } } "the run itself warns of it" }
            li { span.swatch.plain.must {} "must hold" }
        }
    }
}
