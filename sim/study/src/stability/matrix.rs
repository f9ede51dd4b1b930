//! The matrix of cases and subjects.

use super::case::Case;
use super::subject::Subject;
use super::verdict::Verdict;

/// One subject in one case.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Which subject.
    pub subject: Subject,
    /// Whether it must hold: the tool and the tests fail if it does not.
    pub must_hold: bool,
    /// How it stood the worst of the case's trials.
    pub verdict: Verdict,
    /// Which trial that was, and which criterion.
    pub detail: String,
}

/// One case and the subjects that it applies to.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case.
    pub case: Case,
    /// Its cells, in the order of [`Subject::all`].
    pub cells: Vec<Cell>,
}

/// All rows, in the order of the catalogue.
#[derive(Clone, Debug, Default)]
pub struct Matrix {
    /// The rows.
    pub rows: Vec<Row>,
    /// How long it took, s.
    pub wall_s: f64,
}

impl Matrix {
    /// The cells that must hold and do not.
    pub fn broken(&self) -> impl Iterator<Item = (&Case, &Cell)> {
        self.rows.iter().flat_map(|row| {
            row.cells
                .iter()
                .filter(|cell| cell.must_hold && !cell.verdict.holds())
                .map(|cell| (&row.case, cell))
        })
    }
}
