//! Costs of every rung, and of what else the device does, on its core.

use super::Row;
use crepitus_pages::table::show::{fixed, scaled, scientific};
use crepitus_pages::table::{Cell, Table};

/// Table for people, and `cycles.csv`: a row a subject.
pub fn target_table(rows: &[Row]) -> Table<'_, Row> {
    Table::of(rows)
        .people("what", Row::name)
        .column("subject", |row| row.subject)
        .column("form", |row| row.form)
        .people("convention", |row| row.convention.unwrap_or("–"))
        .column("convention", |row| row.convention)
        .column("is_rung", |row| row.is_rung)
        .column("frequency_error_rel", |row| {
            if row.is_rung {
                Cell::from(row.frequency_error_rel)
            } else {
                Cell::Missing
            }
        })
        .headed("frequency error")
        .rounded(scientific)
        .right()
        .column("mean_cycles", |row| row.mean_cycles)
        .headed("mean cycles")
        .rounded(fixed::<0>)
        .column("worst_cycles", |row| row.worst_cycles)
        .headed("worst observed")
        .column("worst_on", |row| row.worst_on.as_str())
        .headed("on")
        .column("mean_instructions", |row| row.mean_instructions)
        .headed("mean instructions")
        .rounded(fixed::<0>)
        .column("worst_instructions", |row| row.worst_instructions)
        .headed("most")
        .people("worst, % of a tick", |row| row.worst_share)
        .rounded(scaled::<100, 1>)
        .column("steps", |row| Cell::from(row.steps))
}
