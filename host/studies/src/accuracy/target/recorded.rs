//! Costs on the controller that stand on record, so that they can be said without an emulator.
//!
//! `docs/figures.sh` makes them again; tests compare them with the table of the book and with a run of
//! the emulated controller.

use super::{LABEL, OnTarget, Row, TICK_CYCLES};

/// The `cycles.csv` of `crepitus accuracy --target` on the standard scenes: columns of
/// [`target_table`](super::table::target_table).
const RECORDED: &str = include_str!("cycles.csv");

/// The costs on record.
pub fn on_target() -> OnTarget {
    let rows: Vec<Row> = RECORDED.lines().skip(1).filter_map(row).collect();
    OnTarget {
        label: LABEL,
        tick_cycles: TICK_CYCLES,
        steps: rows.iter().map(|row| row.steps).sum(),
        rows,
    }
}

/// A row; none of a line that is no row, which a test excludes.
fn row(line: &'static str) -> Option<Row> {
    let fields: Vec<&str> = line.split(',').collect();
    let [
        subject,
        form,
        convention,
        is_rung,
        frequency,
        mean,
        worst,
        worst_on,
        instructions,
        most,
        steps,
    ] = fields.as_slice()
    else {
        return None;
    };
    let given = |text: &&'static str| Some(*text).filter(|text| !text.is_empty());
    let mean_cycles: f64 = mean.parse().ok()?;
    let worst_cycles: u32 = worst.parse().ok()?;
    Some(Row {
        subject,
        form: given(form),
        convention: given(convention),
        is_rung: is_rung.parse().ok()?,
        frequency_error_rel: frequency.parse().unwrap_or(f64::NAN),
        mean_cycles,
        worst_cycles,
        worst_on: (*worst_on).to_owned(),
        mean_instructions: instructions.parse().ok()?,
        worst_instructions: most.parse().ok()?,
        mean_share: mean_cycles / TICK_CYCLES,
        worst_share: f64::from(worst_cycles) / TICK_CYCLES,
        steps: steps.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::super::table::target_table;
    use super::*;
    use crepitus_ladder::Subject;
    use crepitus_model::Convention;

    #[test]
    fn every_subject_is_on_record_and_reads_back() {
        let on = on_target();
        let all = Subject::all().filter(|subject| subject.law().is_none());
        let names: Vec<_> = all
            .map(|subject| {
                (
                    subject.name(),
                    subject.form(),
                    subject.convention().map(Convention::name),
                )
            })
            .collect();
        let found: Vec<_> = on
            .rows
            .iter()
            .map(|row| (row.subject, row.form, row.convention))
            .collect();
        assert_eq!(found, names);
        assert_eq!(target_table(&on.rows).to_csv(), RECORDED);
        assert!(
            on.rows
                .iter()
                .all(|row| row.mean_cycles <= f64::from(row.worst_cycles))
        );
    }

    #[test]
    fn the_book_has_the_table() {
        let book = include_str!("../../../../../docs/accuracy.md");
        let table = target_table(&on_target().rows).to_markdown();
        assert!(
            book.contains(&table),
            "run docs/figures.sh: it writes the table that is on record:\n{table}"
        );
    }
}
