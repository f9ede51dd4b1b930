//! The journal of a corpus run: a CSV file, one row a piece, convention and
//! motion.
//!
//! A piece is [`PIECE`] cases. Its rows are written at once when it is done,
//! so an interrupted run continues with the first incomplete piece.
//! `notable` lists the cases that do not simply agree, as `number:verdict`.

use crate::compare::{Comparison, Difference, Verdict, compare};
use crate::corpus::{Case, MotionKind};
use crate::watched::Watched;
use crepitus_model::Convention;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

/// Cases of a piece.
pub const PIECE: u64 = 250;

/// The first line.
pub const HEADER: &str = "piece,first_case,convention,motion,cases,events,agreed,conditioned,undecidable,\
    disagreed,law_broken,worst_time_error,notable";

/// Rows of a piece: conventions times motions.
pub const ROWS: usize = Convention::ALL.len() * MotionKind::ALL.len();

/// The counts of some cases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counts {
    /// Cases.
    pub cases: u64,
    /// Events that agree.
    pub events: u64,
    /// Cases whose events all agree.
    pub agreed: u64,
    /// Agreed cases whose tolerance followed the conditioning.
    pub conditioned: u64,
    /// Cases decided by rounding from some event on.
    pub undecidable: u64,
    /// Cases with a real difference.
    pub disagreed: u64,
    /// Cases in which `reference` breaks the sign law.
    pub law_broken: u64,
    /// The worst |Δt|/(t + 1/ωn) within the plain tolerance.
    pub worst: f64,
    /// Cases that do not simply agree.
    pub notable: Vec<String>,
}

impl Counts {
    /// Adds one case.
    pub fn add(&mut self, number: u64, comparison: &Comparison) {
        self.cases += 1;
        self.events += comparison.events as u64;
        self.worst = self.worst.max(comparison.worst);
        let what = match &comparison.verdict {
            Verdict::Agreed => {
                self.agreed += 1;
                self.conditioned += u64::from(comparison.conditioned);
                None
            }
            Verdict::Undecidable(doubt) => {
                self.undecidable += 1;
                Some(doubt.name())
            }
            Verdict::Disagreed(difference) => {
                self.disagreed += 1;
                Some(match difference {
                    Difference::Sequence => "SEQUENCE",
                    Difference::Time(_) => "TIME",
                    Difference::Theta(_) => "THETA",
                    Difference::TorqueBefore(_) | Difference::TorqueAfter(_) => "TORQUE",
                    Difference::Hung => "HUNG",
                    Difference::Died => "DIED",
                })
            }
        };
        self.notable
            .extend(what.map(|what| format!("{number}:{what}")));
        if comparison.law_broken {
            self.law_broken += 1;
            self.notable.push(format!("{number}:LAW"));
        }
    }

    /// Adds other counts.
    pub fn merge(&mut self, other: &Self) {
        self.cases += other.cases;
        self.events += other.events;
        self.agreed += other.agreed;
        self.conditioned += other.conditioned;
        self.undecidable += other.undecidable;
        self.disagreed += other.disagreed;
        self.law_broken += other.law_broken;
        self.worst = self.worst.max(other.worst);
        self.notable.extend_from_slice(&other.notable);
    }
}

/// A row: what it counts, and the counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Index of the piece, from 0.
    pub piece: u64,
    /// Convention of the piece.
    pub convention: Convention,
    /// Motion of the piece.
    pub motion: MotionKind,
    /// The counts.
    pub counts: Counts,
}

impl Row {
    /// The line of the file.
    pub fn line(&self) -> String {
        let c = &self.counts;
        format!(
            "{},{},{},{},{},{},{},{},{},{},{},{:.1e},{}",
            self.piece,
            self.piece * PIECE,
            self.convention.name(),
            self.motion.name(),
            c.cases,
            c.events,
            c.agreed,
            c.conditioned,
            c.undecidable,
            c.disagreed,
            c.law_broken,
            c.worst,
            c.notable.join(" ")
        )
    }

    /// The row of a line; `None` where it is not one.
    pub fn of(line: &str) -> Option<Self> {
        let mut cells = line.split(',');
        let piece: u64 = cells.next()?.parse().ok()?;
        let first: u64 = cells.next()?.parse().ok()?;
        let name = cells.next()?;
        let convention = Convention::ALL.into_iter().find(|c| c.name() == name)?;
        let name = cells.next()?;
        let motion = MotionKind::ALL.into_iter().find(|m| m.name() == name)?;
        let mut count = || cells.next()?.parse::<u64>().ok();
        let counts = Counts {
            cases: count()?,
            events: count()?,
            agreed: count()?,
            conditioned: count()?,
            undecidable: count()?,
            disagreed: count()?,
            law_broken: count()?,
            worst: cells.next()?.parse().ok()?,
            notable: cells
                .next()?
                .split_whitespace()
                .map(str::to_owned)
                .collect(),
        };
        (first == piece * PIECE && cells.next().is_none()).then_some(Self {
            piece,
            convention,
            motion,
            counts,
        })
    }
}

/// The rows of a piece from the comparisons of its cases.
#[derive(Clone, Debug)]
pub struct Tally {
    rows: Vec<Row>,
}

impl Tally {
    /// Rows with nothing counted yet.
    pub fn new(piece: u64) -> Self {
        let rows = Convention::ALL
            .into_iter()
            .flat_map(|convention| {
                MotionKind::ALL.into_iter().map(move |motion| Row {
                    piece,
                    convention,
                    motion,
                    counts: Counts::default(),
                })
            })
            .collect();
        Self { rows }
    }

    /// Adds a case.
    pub fn add(&mut self, case: &Case, comparison: &Comparison) {
        for row in &mut self.rows {
            if row.convention == case.settings.convention && row.motion == case.kind {
                row.counts.add(case.number, comparison);
            }
        }
    }

    /// The rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

/// Runs a piece.
///
/// # Errors
/// If no child process can be started.
pub fn run_piece(program: &Path, limit: Duration, piece: u64) -> io::Result<Tally> {
    let mut tally = Tally::new(piece);
    for answer in Watched::new(program, limit, piece * PIECE, (piece + 1) * PIECE) {
        let (number, answer) = answer?;
        let case = Case::new(number);
        tally.add(&case, &compare(&case, &answer));
    }
    Ok(tally)
}

/// The complete pieces of a journal, in order of the file.
///
/// # Errors
/// If the file exists and cannot be read.
pub fn read(path: &Path) -> io::Result<Vec<Vec<Row>>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(path)?;
    let rows: Vec<Row> = text.lines().skip(1).map_while(Row::of).collect();
    Ok(rows
        .chunks_exact(ROWS)
        .map(<[Row]>::to_vec)
        .take_while(|piece| piece.iter().all(|row| row.piece == piece[0].piece))
        .collect())
}

/// Appends a piece in one write.
///
/// # Errors
/// Errors of the file system.
pub fn append(path: &Path, rows: &[Row]) -> io::Result<()> {
    let mut text = String::new();
    for row in rows {
        text.push_str(&row.line());
        text.push('\n');
    }
    let mut file = OpenOptions::new().append(true).open(path)?;
    file.write_all(text.as_bytes())
}
