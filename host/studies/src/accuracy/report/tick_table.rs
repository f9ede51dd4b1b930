//! Cost and error of every rung at the device's tick, 50 µs.

use crate::accuracy::Point;
use crepitus_pages::plot::page::scrolling;
use maud::{Markup, html};

use super::left_out::found;
use super::measure::Measure;
use super::pair::{Pair, Study, View, is_device_tick};
use crepitus_pages::plot::CurveStyle;
use crepitus_pages::plot::number::{fixed, rounded, scientific};

/// A rung at one precision.
#[derive(Debug)]
struct Row<'p> {
    /// Place of the rung among those of the study.
    rung: usize,
    point: &'p Point,
    /// Time per step over that of the cheapest rung at this precision.
    ratio: f64,
}

fn rows<'p>(study: &Study<'p>, pair: &Pair<'p>) -> Vec<Row<'p>> {
    let mut rows = Vec::new();
    for (rung, name) in study.rungs.iter().enumerate() {
        for view in pair.views(study) {
            let points = pair.of(name, view);
            let Some(point) = points.into_iter().find(|p| is_device_tick(p.step_s)) else {
                continue;
            };
            rows.push(Row {
                rung,
                point,
                ratio: point.ns_per_step / cheapest(pair, view),
            });
        }
    }
    rows
}

/// The shortest time of a step at the device's tick, ns.
fn cheapest(pair: &Pair, view: View) -> f64 {
    pair.points()
        .filter(|p| View::of(p) == view && is_device_tick(p.step_s) && p.ns_per_step > 0.0)
        .map(|p| p.ns_per_step)
        .fold(f64::INFINITY, f64::min)
}

/// Table at the device's tick; empty without a point at this tick.
pub(crate) fn table(study: &Study, pair: &Pair) -> Markup {
    let rows = rows(study, pair);
    html! {
        @if !rows.is_empty() {
            section.table.tick {
                h3 { "At the device's tick, 50 µs" }
                (scrolling("Rungs at 50 µs", &html! {
                    table.grid {
                        thead { tr {
                            th scope="col" { "rung" }
                            th scope="col" { "precision" }
                            th.number scope="col" { "ns a step" }
                            th.number scope="col" { "quartiles" }
                            th.number scope="col" { "× cheapest" }
                            th.number scope="col" { "worst event error (s)" }
                            th.number scope="col" { "held torque, RMS error (N·m)" }
                            th.number scope="col" { "torque at the tick, RMS error (N·m)" }
                            th.number scope="col" { "frequency error" }
                            th.number scope="col" { "digits" }
                        } }
                        tbody { @for row in &rows { (line(row)) } }
                    }
                }))
                p.caption {
                    "CPU time per step, the median and the quartiles of the repeats, beside them over that of the cheapest rung at the "
                    "same precision and input. "
                    (floor(&rows))
                    "Digits: correct digits of the cycle frequency, −log₁₀ of its "
                    "relative error."
                }
            }
        }
    }
}

/// The least that any held torque is off here, if it is known.
fn floor(rows: &[Row]) -> String {
    let floor_nm = rows.first().map_or(f64::NAN, |row| row.point.held_floor_nm);
    if floor_nm.is_finite() {
        format!(
            "No torque that is held for a tick can be nearer than {} N·m to the true one. ",
            scientific(floor_nm)
        )
    } else {
        String::new()
    }
}

fn line(row: &Row) -> Markup {
    let point = row.point;
    let frequency = Measure::Frequency.of(point);
    html! {
        tr {
            th scope="row" {
                span.rung { (CurveStyle::of(row.rung).inline(false)) (point.solver) }
            }
            td { (View::of(point).name()) }
            td.number { (nanoseconds(point.ns_per_step)) }
            td.number {
                (nanoseconds(point.ns_per_step_q1)) "–" (nanoseconds(point.ns_per_step_q3))
            }
            td.number { (nanoseconds(row.ratio)) }
            @if point.unmatched > 0 {
                td.wrong colspan="5" {
                    "wrong events: " (found(point))
                }
            } @else {
                td.number { (scientific(Measure::EventTime.of(point))) }
                td.number { (scientific(Measure::HeldTorque.of(point))) }
                td.number { (scientific(Measure::TickTorque.of(point))) }
                td.number { (scientific(frequency)) }
                td.number { (digits(frequency)) }
            }
        }
    }
}

/// Formats nanoseconds, with one decimal where it is significant.
fn nanoseconds(value: f64) -> String {
    if value.is_finite() && value.abs() < 100.0 {
        fixed(value, 1)
    } else {
        rounded(value)
    }
}

fn digits(error: f64) -> String {
    match error {
        0.0 => "all".to_owned(),
        e if e > 0.0 && e.is_finite() => fixed(-e.log10(), 1),
        _ => "–".to_owned(),
    }
}
