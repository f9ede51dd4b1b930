//! The table: a row a variant.

use crate::effects::influence::BANDS_HZ;
use crate::effects::row::{Added, Outcome, Ran};
use crate::effects::{EffectsStudy, Row};
use crepitus_pages::plot::page::scrolling;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::run::AddedTime;
use maud::{Markup, html};

use super::look;
use crepitus_pages::plot::number::{count, fixed, rounded};

pub(super) fn table(study: &EffectsStudy) -> Markup {
    html! {
        section.table {
            h2 { "What each effect adds, and what it costs" }
            (scrolling("Variants of the scene", &html! {
                table.grid {
                    thead {
                        tr {
                            th scope="col" {}
                            th.number.group colspan="3" scope="colgroup" { "the effect adds" }
                            th.number.group colspan="5" scope="colgroup" { "the hand then feels, mN·m" }
                            th.number.group colspan="2" scope="colgroup" { "" }
                            th.number.group colspan="2" scope="colgroup" { "the effect costs" }
                        }
                        tr {
                            th scope="col" { "variant" }
                            th.number scope="col" { "RMS, mN·m" }
                            th.number scope="col" { "peak, mN·m" }
                            th.number scope="col" { "events" }
                            th.number scope="col" { "RMS" }
                            th.number scope="col" { "peak" }
                            @for (low, high) in BANDS_HZ {
                                th.number scope="col" { (rounded(low)) "–" (rounded(high)) " Hz" }
                            }
                            th.number scope="col" { "events" }
                            th.number scope="col" { "ns a step" }
                            th.number scope="col" { "ns a step" }
                            th.number scope="col" { "states" }
                        }
                    }
                    tbody { @for row in &study.rows { (line(row)) } }
                }
            }))
            p.caption {
                "What an effect adds is the run with it less the run without it, tick by tick: for an effect of the "
                "scene the scene less the variant, for an absent one the variant less the scene. In parentheses what "
                "leaves or comes with it. Bands are the RMS of the torque within each. Times are " (CLOCK) " on "
                "one core of one machine, the fastest of " (count(u64::from(study.timings)))
                " in which all variants take turns: their ratios mean more than the numbers. < x: the "
                "difference is below what can be measured, x ns."
            }
        }
    }
}

fn line(row: &Row) -> Markup {
    html! {
        tr {
            th scope="row" {
                span.rung { (look::of(row.change).inline(true)) (row.name()) }
            }
            @match &row.outcome {
                Outcome::Failed { failure } => td.wrong.why colspan="12" { (failure) },
                Outcome::Ran(ran) => {
                    (adds(ran.added.as_ref()))
                    (feels(ran))
                    td.number { (count(ran.events)) }
                    td.number { (rounded(row.ns_per_step)) }
                    (costs(row, ran.added.as_ref()))
                }
            }
        }
    }
}

fn adds(added: Option<&Added>) -> Markup {
    html! {
        @if let Some(added) = added {
            td.number { (milli(added.rms_nm)) }
            td.number { (milli(added.peak_nm)) }
            td.number { (signed(added.events)) }
        } @else {
            td colspan="3" {}
        }
    }
}

fn feels(ran: &Ran) -> Markup {
    html! {
        td.number { (milli(ran.torque.rms_nm)) }
        td.number { (milli(ran.torque.peak_nm)) }
        @for band in ran.torque.bands_nm { td.number { (milli(band)) } }
    }
}

fn costs(row: &Row, added: Option<&Added>) -> Markup {
    html! {
        @if let Some(added) = added {
            td.number { (cost(&added.time)) }
            td.number { (signed(added.states)) }
        } @else {
            td.number { "–" }
            td.number { (row.states) }
        }
    }
}

/// Cost in words; of one that is lost in the timings its bound.
fn cost(added: &AddedTime) -> String {
    match added.ns_per_step {
        Some(ns) => rounded(ns),
        None if added.is_below_resolution() => format!("< {}", rounded(added.ns_resolution)),
        None => "–".to_owned(),
    }
}

/// Torque in mN·m.
fn milli(nm: f64) -> String {
    rounded(1e3 * nm)
}

/// A count with its sign.
fn signed(n: i64) -> String {
    let digits = count(n.unsigned_abs());
    match n {
        0 => digits,
        n if n < 0 => format!("\u{2212}{digits}"),
        _ => format!("+{digits}"),
    }
}

/// Formats a difference of torques, N·m, with its significant digits.
pub(super) fn torque(nm: f64) -> String {
    if nm == 0.0 {
        "0 N·m".to_owned()
    } else if nm >= 0.1 {
        format!("{} N·m", rounded(nm))
    } else {
        format!("{} mN·m", rounded(1e3 * nm))
    }
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    if share.is_finite() {
        format!("{} %", fixed(100.0 * share, 1))
    } else {
        "not known".to_owned()
    }
}
