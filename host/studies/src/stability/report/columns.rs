//! The columns of the matrix: rungs, grouped by convention; and the
//! precisions, which share a column.

use crate::stability::{Cell, Matrix, Row, Rung, Subject};
use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;

/// See the module.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) groups: Vec<Group>,
    /// Precisions in the order of the subjects.
    pub(super) precisions: Vec<Precision>,
}

/// The rungs under one convention.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) convention: Convention,
    pub(super) rungs: Vec<Rung>,
}

impl Columns {
    /// Those that any row has.
    pub(super) fn of(matrix: &Matrix) -> Self {
        let subjects = || matrix.rows.iter().flat_map(|row| &row.cells);
        let used = |subject: &Subject| subjects().any(|cell| cell.subject == *subject);
        let mut columns = Self {
            groups: Vec::new(),
            precisions: Vec::new(),
        };
        for subject in Subject::all().into_iter().filter(used) {
            if !columns.precisions.contains(&subject.precision) {
                columns.precisions.push(subject.precision);
            }
            match columns.groups.last_mut() {
                Some(group) if group.convention == subject.convention => {
                    if !group.rungs.contains(&subject.solver) {
                        group.rungs.push(subject.solver);
                    }
                }
                _ => columns.groups.push(Group {
                    convention: subject.convention,
                    rungs: vec![subject.solver],
                }),
            }
        }
        columns
    }

    /// Returns those of these columns that a picture of a page's width has room for:
    /// in the precision of the device, and of `paper`, which differs from
    /// `physical` in the torque of a stick alone, two rungs.
    pub(super) fn pictured(mut self) -> Self {
        self.precisions.sort_by_key(|p| *p != Precision::F32);
        self.precisions.truncate(1);
        let is_single = self.precisions.first() == Some(&Precision::F32);
        for group in &mut self.groups {
            group
                .rungs
                .retain(|rung| !is_single || rung.single_refusal().is_none());
            if group.convention == Convention::Paper && group.rungs.len() > 2 {
                group.rungs.retain(|rung| {
                    matches!(rung, Rung::Ladder(Solver::Exact | Solver::ExactEvents))
                });
            }
        }
        self
    }
}

/// The cell of a row, if the case applies to this subject.
pub(super) fn cell(
    row: &Row,
    convention: Convention,
    solver: Rung,
    precision: Precision,
) -> Option<&Cell> {
    let subject = Subject {
        solver,
        convention,
        precision,
    };
    row.cells.iter().find(|cell| cell.subject == subject)
}
