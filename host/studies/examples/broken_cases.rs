//! Runs every subject that must hold through the hard cases, and prints a line a case:
//! `H01 holds`, `H01 broken: …` or `H01 panics`. `crepitus-faults` runs it on
//! sources with a planted fault.

use crepitus_studies::stability::{Case, Plan, Subject, catalogue, run};
use crepitus_studies::{Cancelled, Watcher};
use std::io::Write;
use std::panic::catch_unwind;

/// Lets everything run.
struct Patient;

impl Watcher for Patient {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// Outcome of a case.
fn outcome(case: &Case) -> String {
    let plan = Plan {
        cases: vec![case.clone()],
        subjects: Subject::all()
            .into_iter()
            .filter(|s| (case.must)(*s))
            .collect(),
    };
    match catch_unwind(|| run(&plan, &mut Patient)) {
        Err(_) => "panics".to_owned(),
        Ok(Err(error)) => format!("broken: {error}"),
        Ok(Ok(matrix)) => matrix.broken().next().map_or_else(
            || "holds".to_owned(),
            |(_, cell)| {
                let Subject {
                    solver,
                    convention,
                    precision,
                } = cell.subject;
                format!(
                    "broken: {} {} {}: {} ({})",
                    convention.name(),
                    solver.name(),
                    precision.name(),
                    cell.verdict,
                    cell.detail
                )
            },
        ),
    }
}

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout();
    for case in catalogue::all().iter().filter(|case| !case.long) {
        writeln!(out, "{} {}", case.id, outcome(case))?;
        out.flush()?;
    }
    Ok(())
}
