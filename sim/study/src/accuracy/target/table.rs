//! Costs of every rung, and of what else the device does, on its core.

use super::Row;
use crepitus_table::show::{fixed, scaled, scientific};
use crepitus_table::{Cell, Table};

/// Table for people, a row a subject.
pub fn target_table(rows: &[Row]) -> Table<'_, Row> {
    Table::of(rows)
        .people("what", Row::name)
        .people("convention", |row| row.convention.unwrap_or("–"))
        .people("frequency error", |row| {
            if row.is_rung {
                Cell::from(row.frequency_error_rel)
            } else {
                Cell::Missing
            }
        })
        .rounded(scientific)
        .right()
        .people("mean cycles", |row| row.mean_cycles)
        .rounded(fixed::<0>)
        .people("worst observed", |row| row.worst_cycles)
        .people("on", |row| row.worst_on.as_str())
        .people("mean instructions", |row| row.mean_instructions)
        .rounded(fixed::<0>)
        .people("most", |row| row.worst_instructions)
        .people("worst, % of a tick", |row| row.worst_share)
        .rounded(scaled::<100, 1>)
}
