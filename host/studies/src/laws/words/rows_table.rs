//! Every number: law × joint, a table a quantity.

use super::numbers::{known, percent, plain};
use crate::laws::{LawStudy, Quantity, Row, TASKS, Task};
use crepitus_pages::table::Table;
use crepitus_pages::words::{WIDTH, wrapped};
use std::fmt::Write;

/// Quantities that the study has rows of, each with its task and rows.
pub(crate) fn by_quantity(study: &LawStudy) -> Vec<(&'static dyn Task, &Quantity, Vec<&Row>)> {
    let quantities = TASKS.iter().flat_map(|task| {
        let quantities = task.quantities().iter();
        quantities.map(move |quantity| (*task, quantity))
    });
    let with_rows = quantities.map(|(task, quantity)| {
        let rows = study.rows.iter();
        let rows: Vec<&Row> = rows.filter(|row| row.quantity == quantity.name).collect();
        (task, quantity, rows)
    });
    with_rows.filter(|(_, _, rows)| !rows.is_empty()).collect()
}

/// The rows of one quantity.
pub(crate) fn table<'r>(rows: &'r [&'r Row]) -> Table<'r, &'r Row> {
    let unit = rows.first().map_or("", |row| row.unit);
    let of = |what: &str| {
        if unit == "1" {
            what.to_owned()
        } else {
            format!("{what}, {unit}")
        }
    };
    Table::of(rows)
        .people("law", |row| row.law)
        .people("joint", |row| row.joint)
        .people(of("demanded"), |row| plain(row.demanded))
        .right()
        .people(of("at 20 kHz"), |row| known(row.value))
        .right()
        .people(of("model error"), |row| {
            // An error that is still moving is marked.
            let mark = if row.is_settled || row.model_error.is_none() {
                ""
            } else {
                "~"
            };
            format!("{mark}{}", known(row.model_error))
        })
        .right()
        .people(of("numerical error"), |row| known(row.numerical_error))
        .right()
        .people("error, %", |row| {
            percent(row.relative_error.unwrap_or(f64::NAN))
        })
        .right()
        .people("", |row| note(row))
}

/// Reason why a law cannot do it, at the tick or ever.
fn note(row: &Row) -> String {
    match (row.failed, row.converged_failed) {
        (Some(reason), Some(_)) => format!("fails: {reason}"),
        (Some(reason), None) => format!("fails at 20 kHz: {reason}"),
        (None, Some(reason)) => format!("fails converged: {reason}"),
        (None, None) => String::new(),
    }
}

/// All of them as text.
pub(super) fn text(study: &LawStudy) -> String {
    let mut text = String::new();
    for (task, quantity, rows) in by_quantity(study) {
        let heading = format!(
            "{} ({}): {}; {}",
            quantity.name,
            task.title(),
            quantity.title,
            quantity.demands
        );
        let heading = wrapped(&heading, WIDTH).join("\n");
        // Writing to a String cannot fail.
        let _ = write!(text, "\n{heading}\n\n{}", table(&rows).to_text());
    }
    text
}
