//! Error and cost of the symptoms besides crepitus.

use crepitus_plot::number::{fixed, scientific};
use crepitus_plot::page::scrolling;
use crepitus_study::accuracy::symptoms::SymptomPoint;
use maud::{Markup, html};

use super::pair::is_device_tick;

/// At the device's tick, and by step; nothing without symptoms.
pub(crate) fn tables(points: &[SymptomPoint]) -> Markup {
    html! {
        @if !points.is_empty() {
            section.table.tick {
                h2 { "The other symptoms" }
                (at_the_tick(points))
                p.caption {
                    "Each at its defaults, by its law alone, against its event-driven reference, on a steady "
                    "movement, strokes and a tremor together. Torque is compared at the ends of steps. × crepitus: "
                    "CPU time of a step over that of a step of crepitus (exact-events, frozen) in the same "
                    "precision, timed in turn."
                }
            }
            section.table.tick {
                h3 { "Largest torque error by step, N·m" }
                (by_step(points))
            }
        }
    }
}

fn at_the_tick(points: &[SymptomPoint]) -> Markup {
    scrolling(
        "Symptoms at 50 µs",
        &html! {
            table.grid {
                thead { tr {
                    th scope="col" { "symptom" }
                    th scope="col" { "precision" }
                    th.number scope="col" { "events" }
                    th.number scope="col" { "worst event error (s)" }
                    th.number scope="col" { "largest torque error (N·m)" }
                    th.number scope="col" { "RMS (N·m)" }
                    th.number scope="col" { "ns a step" }
                    th.number scope="col" { "× crepitus" }
                } }
                tbody {
                    @for p in points.iter().filter(|p| is_device_tick(p.step_s)) { (line(p)) }
                }
            }
        },
    )
}

fn line(p: &SymptomPoint) -> Markup {
    html! {
        tr {
            th scope="row" { (p.name()) }
            td { (p.precision) }
            td.number { (p.events_true) }
            @if p.unmatched > 0 {
                td.wrong { (p.unmatched) " unmatched" }
            } @else if p.events_true == 0 {
                td.number { "–" }
            } @else {
                td.number { (scientific(p.max_event_error_s)) }
            }
            td.number { (scientific(p.max_tick_torque_error_nm)) }
            td.number { (scientific(p.rms_tick_torque_error_nm)) }
            td.number { (fixed(p.ns_per_step, 1)) }
            td.number { (fixed(p.time_ratio, 1)) }
        }
    }
}

/// A column a step, a row a symptom in a precision.
fn by_step(points: &[SymptomPoint]) -> Markup {
    let mut steps_s: Vec<f64> = points.iter().map(|p| p.step_s).collect();
    steps_s.sort_by(|a, b| b.total_cmp(a));
    steps_s.dedup();
    let is_same = |a: &SymptomPoint, b: &SymptomPoint| {
        (a.symptom, a.form, a.precision) == (b.symptom, b.form, b.precision)
    };
    scrolling(
        "Torque error of symptoms by step",
        &html! {
            table.grid {
                thead { tr {
                    th scope="col" { "symptom" }
                    th scope="col" { "precision" }
                    @for step_s in &steps_s {
                        th.number scope="col" { (step(*step_s)) }
                    }
                } }
                tbody {
                    @for row in points.chunk_by(is_same) {
                        @if let Some(first) = row.first() {
                            tr {
                                th scope="row" { (first.name()) }
                                td { (first.precision) }
                                @for step_s in &steps_s {
                                    @match row.iter().find(|p| p.step_s == *step_s) {
                                        Some(p) => td.number { (scientific(p.max_tick_torque_error_nm)) },
                                        None => td.number { "–" },
                                    }
                                }
                            }
                        }
                    }
                }
            }
        },
    )
}

fn step(step_s: f64) -> String {
    format!("{} µs", (step_s * 1e9).round() / 1e3)
}
