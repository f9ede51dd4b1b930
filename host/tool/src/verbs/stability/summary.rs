//! `summary.json` of the matrix.

use crepitus_study::stability::{Cell, Margin, Matrix, Plan, Row, Verdict};
use serde::Serialize;

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// The matrix without its cells.
#[derive(Serialize)]
pub(super) struct Summary {
    #[serde(rename = "summary_version")]
    version: u32,
    pub(super) crepitus_version: &'static str,
    /// What it was run on.
    host: String,
    /// Whether cases of hours of simulated time were among them.
    pub(super) long: bool,
    pub(super) subjects: usize,
    pub(super) cells: usize,
    /// Of all cells.
    pub(super) counts: Counts,
    pub(super) cases: Vec<CaseSummary>,
    /// The cells that must hold and do not.
    broken: Vec<CellSummary>,
    pub(super) wall_s: f64,
}

/// How many cells stand how.
#[derive(Clone, Copy, Default, Serialize)]
pub(super) struct Counts {
    pub(super) holds: usize,
    pub(super) degrades: usize,
    pub(super) fails: usize,
    pub(super) must_hold: usize,
    pub(super) broken: usize,
}

/// One case.
#[derive(Serialize)]
pub(super) struct CaseSummary {
    pub(super) case: &'static str,
    name: &'static str,
    pub(super) title: &'static str,
    pub(super) counts: Counts,
    /// Of the cells that must hold, and do, the one nearest to its limit.
    pub(super) narrowest: Option<CellSummary>,
}

/// One cell.
#[derive(Clone, Serialize)]
pub(super) struct CellSummary {
    case: &'static str,
    convention: &'static str,
    solver: &'static str,
    precision: &'static str,
    /// In words.
    pub(super) verdict: String,
    measured: Option<f64>,
    limit: Option<f64>,
    unit: Option<&'static str>,
    pub(super) detail: String,
    #[serde(skip)]
    pub(super) subject: String,
}

impl Summary {
    pub(super) fn new(plan: &Plan, matrix: &Matrix) -> Self {
        let cases: Vec<CaseSummary> = matrix.rows.iter().map(CaseSummary::new).collect();
        let mut counts = Counts::default();
        for case in &cases {
            counts.add(&case.counts);
        }
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: format!("{} {}", std::env::consts::ARCH, std::env::consts::OS),
            long: matrix.rows.iter().any(|row| row.case.long),
            subjects: plan.subjects.len(),
            cells: matrix.rows.iter().map(|row| row.cells.len()).sum(),
            counts,
            cases,
            broken: matrix
                .broken()
                .map(|(case, cell)| CellSummary::new(case.id, cell))
                .collect(),
            wall_s: matrix.wall_s,
        }
    }
}

impl Counts {
    fn of(cells: &[Cell]) -> Self {
        let mut counts = Self::default();
        for cell in cells {
            match cell.verdict {
                Verdict::Holds(_) => counts.holds += 1,
                Verdict::Degrades { .. } => counts.degrades += 1,
                Verdict::Fails { .. } => counts.fails += 1,
            }
            counts.must_hold += usize::from(cell.must_hold);
            counts.broken += usize::from(cell.must_hold && !cell.verdict.holds());
        }
        counts
    }

    fn add(&mut self, other: &Self) {
        self.holds += other.holds;
        self.degrades += other.degrades;
        self.fails += other.fails;
        self.must_hold += other.must_hold;
        self.broken += other.broken;
    }
}

impl CaseSummary {
    fn new(row: &Row) -> Self {
        let held = row.cells.iter().filter(|cell| cell.must_hold);
        let held = held.filter_map(|cell| match cell.verdict {
            Verdict::Holds(margin) => Some((margin.share(), cell)),
            _ => None,
        });
        let narrowest = held.max_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            case: row.case.id,
            name: row.case.name,
            title: row.case.title,
            counts: Counts::of(&row.cells),
            narrowest: narrowest.map(|(_, cell)| CellSummary::new(row.case.id, cell)),
        }
    }
}

impl CellSummary {
    fn new(case: &'static str, cell: &Cell) -> Self {
        let margin: Option<Margin> = match cell.verdict {
            Verdict::Holds(margin) | Verdict::Degrades { margin, .. } => Some(margin),
            Verdict::Fails { .. } => None,
        };
        Self {
            case,
            convention: cell.subject.convention.name(),
            solver: cell.subject.solver.name(),
            precision: cell.subject.precision.name(),
            verdict: cell.verdict.to_string(),
            measured: margin.map(|m| m.measured),
            limit: margin.map(|m| m.limit),
            unit: margin.map(|m| m.unit),
            detail: cell.detail.clone(),
            subject: super::table::subject(cell.subject),
        }
    }
}
