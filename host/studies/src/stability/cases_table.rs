//! `cases.csv`: one row a cell of the matrix. Numbers read back to the same
//! bits; a column that a verdict has nothing for is empty.

use super::case::Case;
use super::matrix::Cell;
use super::verdict::{Failure, Margin, Verdict};
use crepitus_model::Real;
use crepitus_pages::table::Table;

/// A row a cell. `measured` and `limit` are in `unit`; of other events than
/// the true ones they are the counts.
pub(super) fn cases_table<'r>(cells: &'r [(&Case, &Cell)]) -> Table<'r, (&'r Case, &'r Cell)> {
    let margin =
        |of: fn(Margin) -> f64| move |(_, cell): &(&Case, &Cell)| margin(&cell.verdict).map(of);
    Table::of(cells)
        .column("case", |(case, _)| case.id)
        .column("name", |(case, _)| case.name)
        .column("convention", |(_, cell)| cell.subject.convention.name())
        .column("solver", |(_, cell)| cell.subject.solver.name())
        .column("precision", |(_, cell)| cell.subject.precision.name())
        .column("must_hold", |(_, cell)| cell.must_hold)
        .column("verdict", |(_, cell)| cell.verdict.name())
        .column("flagged", |(_, cell)| cell.verdict.is_flagged())
        .column("measured", margin(|m| m.measured))
        .column("limit", margin(|m| m.limit))
        .column("unit", |(_, cell)| {
            self::margin(&cell.verdict).map(|m| m.unit)
        })
        .column("at_s", |(_, cell)| match cell.verdict {
            Verdict::Fails { at_s, .. } => at_s,
            _ => None,
        })
        .column("detail", |(_, cell)| match &cell.verdict {
            Verdict::Fails { what, .. } if cell.detail.is_empty() => what.to_string(),
            Verdict::Fails { what, .. } => format!("{what}: {}", cell.detail),
            _ => cell.detail.clone(),
        })
}

/// The number of a verdict and what it is held against.
fn margin(verdict: &Verdict) -> Option<Margin> {
    match *verdict {
        Verdict::Holds(margin) | Verdict::Degrades { margin, .. } => Some(margin),
        Verdict::Fails {
            what: Failure::OtherEvents { found, expected },
            ..
        } => Some(Margin {
            measured: f64::from_whole(found),
            limit: f64::from_whole(expected),
            unit: "events",
        }),
        Verdict::Fails { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::{Subject, catalogue};

    #[test]
    fn rows_have_the_columns_and_read_back() {
        let third = 1.0 / 3.0;
        let held = Margin {
            measured: third,
            limit: 1e-12,
            unit: "N·m",
        };
        let others = Failure::OtherEvents {
            found: 1,
            expected: 637,
        };
        let fails = |what, at_s| Verdict::fails(what, at_s).flag(true);
        let verdicts = [
            (Verdict::Holds(held), "at 1 rad/s, \"slow\""),
            (Verdict::of(f64::NAN, 0.5, ""), "two\nlines"),
            (fails(others, None), ""),
            (fails(Failure::Overflow, Some(third)), "the second trial"),
        ];
        let case = catalogue::find("H01").unwrap();
        let cells: Vec<Cell> = Subject::all()
            .into_iter()
            .zip(verdicts)
            .map(|(subject, (verdict, detail))| Cell {
                subject,
                must_hold: verdict.holds(),
                verdict,
                detail: detail.to_owned(),
            })
            .collect();
        let rows: Vec<_> = cells.iter().map(|cell| (&case, cell)).collect();
        let text = cases_table(&rows).to_csv();
        let lines: Vec<Vec<String>> = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes())
            .records()
            .map(|record| record.unwrap().iter().map(str::to_owned).collect())
            .collect();
        assert_eq!(lines.len(), 5);
        assert_eq!(lines[0].len(), 13);
        let column = |name| lines[0].iter().position(|h| h == name).unwrap();
        let of = |line: usize, name| lines[line][column(name)].as_str();
        assert_eq!(
            lines[1][..7],
            [
                "H01",
                "constant-speed",
                "frozen",
                "exact",
                "f32",
                "true",
                "holds"
            ]
        );
        assert_eq!(of(1, "measured").parse(), Ok(third));
        assert_eq!(of(1, "limit").parse(), Ok(1e-12));
        assert_eq!(of(1, "unit"), "N·m");
        assert_eq!(of(1, "detail"), "at 1 rad/s, \"slow\"");
        assert_eq!(lines[2][4..9], ["f64", "false", "degrades", "false", "nan"]);
        assert_eq!(of(2, "detail"), "two\nlines");
        assert_eq!(
            lines[3][6..12],
            ["fails", "true", "1.0", "637.0", "events", ""]
        );
        assert_eq!(of(3, "detail"), "1 events instead of 637");
        assert_eq!(lines[4][8..11], ["", "", ""]);
        assert_eq!(of(4, "at_s").parse(), Ok(third));
        assert_eq!(of(4, "detail"), "overflow: the second trial");
    }
}
