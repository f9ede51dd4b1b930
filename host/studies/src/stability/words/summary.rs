//! `summary.json` of the matrix.

use super::StabilityOutcome;
use crate::machine;
use crate::stability::cases_table::cases_table;
use crate::stability::matrix::Counts;
use crate::stability::{Case, Cell, Row, Rung, Verdict};
use serde::{Serialize, Serializer};

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// The matrix without its cells.
#[derive(Serialize)]
pub(super) struct Summary<'m> {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    /// Computer on which the matrix was run.
    host: String,
    /// Whether cases of hours of simulated time were among them.
    pub(super) long: bool,
    pub(super) subjects: usize,
    pub(super) cells: usize,
    /// Counts of all cells.
    pub(super) counts: Counts,
    pub(super) cases: Vec<CaseSummary<'m>>,
    /// The cells that must hold and do not.
    #[serde(serialize_with = "as_rows")]
    broken: Vec<CaseCell<'m>>,
    pub(super) wall_s: f64,
}

/// One case.
#[derive(Serialize)]
pub(super) struct CaseSummary<'m> {
    pub(super) case: &'static str,
    name: &'static str,
    pub(super) title: &'static str,
    pub(super) counts: Counts,
    /// Cell nearest to its limit, of those that must hold, and do, and have a number.
    #[serde(serialize_with = "as_row")]
    pub(super) narrowest: Option<CaseCell<'m>>,
}

/// A cell with its case.
type CaseCell<'m> = (&'m Case, &'m Cell);

/// Cells with the names and numbers of `cases.csv`.
fn as_rows<S: Serializer>(cells: &[CaseCell<'_>], serializer: S) -> Result<S::Ok, S::Error> {
    cases_table(cells).serialize(serializer)
}

#[expect(clippy::ref_option, reason = "the form in which serde calls it")]
fn as_row<S: Serializer>(cell: &Option<CaseCell<'_>>, serializer: S) -> Result<S::Ok, S::Error> {
    let table = cases_table(cell.as_slice());
    table.objects().next().serialize(serializer)
}

impl<'m> Summary<'m> {
    pub(super) fn new(tried: &StabilityOutcome<'m>) -> Self {
        let matrix = tried.matrix;
        let cases: Vec<CaseSummary> = matrix.rows.iter().map(CaseSummary::new).collect();
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: machine::host(),
            long: matrix.rows.iter().any(|row| row.case.long),
            subjects: tried.subjects,
            cells: matrix.cells().count(),
            counts: Counts::of(matrix.cells().map(|(_, cell)| cell)),
            cases,
            broken: matrix.broken().collect(),
            wall_s: matrix.wall_s,
        }
    }
}

impl<'m> CaseSummary<'m> {
    fn new(row: &'m Row) -> Self {
        let others = |cell: &&Cell| cell.must_hold && cell.subject.solver != Rung::Reference;
        let held = row.cells.iter().filter(others);
        let held = held.filter_map(|cell| match cell.verdict {
            Verdict::Holds(margin) if margin.is_number() => Some((margin.share(), cell)),
            _ => None,
        });
        let narrowest = held.max_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            case: row.case.id,
            name: row.case.name,
            title: row.case.title,
            counts: Counts::of(&row.cells),
            narrowest: narrowest.map(|(_, cell)| (&row.case, cell)),
        }
    }
}
