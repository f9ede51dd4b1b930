//! List of what no curve may show: first of all wrong numbers of events.

use crate::accuracy::Point;
use maud::{Markup, html};

use super::curve::{Unfit, unfit};
use super::measure::Measure;
use super::pair::{Pair, Study, View};
use crepitus_pages::plot::number::{count, duration};
use crepitus_pages::plot::page::scrolling;
use crepitus_pages::table::Table;

/// The points of one rung in one view that are missing for one reason.
#[derive(Debug)]
struct Row {
    rung: &'static str,
    precision: String,
    reason: &'static str,
    /// Steps from the longest to the shortest.
    steps: Vec<String>,
}

/// Events found of true ones; where the number is right, how many are not.
pub(crate) fn found(point: &Point) -> String {
    let number = format!("{} of {}", count(point.events), count(point.events_true));
    if point.events == point.events_true {
        format!("{number}, {} without a partner", count(point.unmatched))
    } else {
        number
    }
}

const WRONG_EVENTS: &str = "wrong events";

fn rows(study: &Study, pair: &Pair) -> Vec<Row> {
    let mut rows = Vec::new();
    for rung in &study.rungs {
        for view in &study.views {
            rows.extend(rows_of(pair, rung, *view));
        }
    }
    rows
}

fn rows_of(pair: &Pair, rung: &'static str, view: View) -> Vec<Row> {
    let points = pair.of(rung, view);
    let mut rows = Vec::new();
    let mut row = |reason, steps: Vec<String>| {
        if !steps.is_empty() {
            rows.push(Row {
                rung,
                precision: view.name(),
                reason,
                steps,
            });
        }
    };
    let wrong = points.iter().filter(|point| point.unmatched > 0);
    row(
        WRONG_EVENTS,
        wrong
            .map(|point| format!("{}: {}", duration(point.step_s), found(point)))
            .collect(),
    );
    for measure in Measure::ALL {
        let without = points
            .iter()
            .filter(|point| unfit(point, measure) == Some(Unfit::NoNumber));
        let reason = match measure {
            Measure::EventTime => "no event-time error, or no cost",
            Measure::HeldTorque => "no held torque error, or no cost",
            Measure::TickTorque => "no torque error at the tick, or no cost",
            Measure::Frequency => "no frequency error, or no cost",
        };
        row(
            reason,
            without.map(|point| duration(point.step_s)).collect(),
        );
    }
    rows
}

/// Table of the points left out; empty if all points are in their curves.
pub(crate) fn table(study: &Study, pair: &Pair) -> Markup {
    let rows = rows(study, pair);
    html! {
        @if !rows.is_empty() {
            section.table.left-out {
                h3 { "In no curve" }
                p.note {
                    "Points that the diagrams leave out. After each step, where the number of "
                    "events is wrong: events found of true ones. Where the number is right but some belong "
                    "elsewhere: how many are without a partner in the reference or the run."
                }
                (scrolling("Points in no curve", &listed(&rows).to_html()))
            }
        }
    }
}

fn listed(rows: &[Row]) -> Table<'_, Row> {
    Table::of(rows)
        .people("rung", |row| row.rung)
        .people("precision", |row| row.precision.as_str())
        .people("why", |row| row.reason)
        .people("steps", |row| row.steps.join("; "))
}
