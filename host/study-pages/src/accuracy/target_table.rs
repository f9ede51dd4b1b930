//! What every rung, and what else the device does, costs on its core.

use crepitus_plot::page::scrolling;
use crepitus_study::accuracy::target::{OnTarget, Row};
use maud::{Markup, html};

use crepitus_plot::number::{fixed, rounded, scientific};

/// The table, with what its numbers are.
pub(crate) fn table(on: &OnTarget) -> Markup {
    html! {
        section.table.tick {
            h2 { "A step on the device's core" }
            (scrolling("Cycles of a step on the target", &html! {
                table.grid {
                    thead { tr {
                        th scope="col" { "what" }
                        th scope="col" { "convention" }
                        th.number scope="col" { "frequency error" }
                        th.number scope="col" { "mean cycles" }
                        th.number scope="col" { "worst observed" }
                        th scope="col" { "on" }
                        th.number scope="col" { "mean instructions" }
                        th.number scope="col" { "most" }
                        th.number scope="col" { "worst, % of a tick" }
                    } }
                    tbody { @for row in &on.rows { (line(row)) } }
                }
            }))
            p.caption {
                (on.label) ". In f32 at a tick of 50 µs, which has " (rounded(on.tick_cycles))
                " cycles. Means are over the scenes of this study; the worst is the worst of all "
                "steps that were run, on inputs with breaks, matches and reversals: observed, no "
                "bound. Each of " (rounded(steps(on))) " steps gave the bits of the host."
            }
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
fn steps(on: &OnTarget) -> f64 {
    on.steps as f64
}

fn line(row: &Row) -> Markup {
    html! {
        tr {
            th scope="row" { (row.name()) }
            td { (row.convention.unwrap_or("–")) }
            td.number { @if row.is_rung { (scientific(row.frequency_error_rel)) } }
            td.number { (rounded(row.mean_cycles)) }
            td.number { (row.worst_cycles) }
            td { (row.worst_on) }
            td.number { (rounded(row.mean_instructions)) }
            td.number { (row.worst_instructions) }
            td.number { (fixed(100.0 * row.worst_share, 1)) }
        }
    }
}
