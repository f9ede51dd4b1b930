//! The answer of the study in a few sentences, and every solver in a table that fits on a screen.

use super::summary::{Counts, Summary};
use super::table::subject;
use crate::stability::{Cell, Failure, Matrix, Rung, Subject, Verdict};
use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_pages::table::Table;
use crepitus_pages::table::show::UNKNOWN;
use crepitus_scene::scene::Precision;

/// The device's solver, what the simplest one does instead, and what the one does that is always stable; then what must hold.
pub(super) fn answer(matrix: &Matrix, summary: &Summary<'_>) -> String {
    let cells = cells(matrix);
    let device: Vec<&Cell> = of(&cells, Subject::is_firmware);
    let euler = of(&cells, is_single(Solver::Euler));
    let implicit = of(&cells, is_single(Solver::ImplicitEuler));
    let counts = &summary.counts;
    let must = format!(
        "Of all {} cells {} must hold, and {}.",
        summary.cells,
        counts.must_hold,
        match counts.broken {
            0 => "all do".to_owned(),
            1 => "one does not".to_owned(),
            n => format!("{n} do not"),
        }
    );
    let sentences = [
        device.first().map(|first| {
            format!(
                "The solver that the device runs ({}) holds in {} of {} hard cases.",
                subject(first.subject),
                Counts::of(device.iter().copied()).holds,
                device.len()
            )
        }),
        failures("Explicit Euler", &euler),
        failures("Implicit Euler", &implicit),
        Some(must),
    ];
    sentences
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" ")
}

/// Failures of a solver, by what its torque is like.
fn failures(name: &str, cells: &[&Cell]) -> Option<String> {
    let fails = |is: fn(Failure) -> bool| {
        let failed = cells.iter().filter(|cell| match cell.verdict {
            Verdict::Fails { what, .. } => is(what),
            _ => false,
        });
        failed.count()
    };
    let all = fails(|_| true);
    let explodes = fails(|what| matches!(what, Failure::Overflow | Failure::AboveTheLimit));
    let events = |is: fn(u64, u64) -> bool| {
        let failed = cells.iter().filter(|cell| match cell.verdict {
            Verdict::Fails {
                what: Failure::OtherEvents { found, expected },
                ..
            } => is(found, expected),
            _ => false,
        });
        failed.count()
    };
    let causes = [
        (explodes, "explodes"),
        (
            events(|found, expected| found > expected),
            "breaks too often",
        ),
        (
            events(|found, expected| found < expected),
            "loses breaks: the patient is healed",
        ),
    ];
    let causes: Vec<String> = causes
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("in {count} it {what}"))
        .collect();
    let first = cells.first()?;
    let what = if causes.is_empty() {
        String::new()
    } else {
        format!("; {}", causes.join(", "))
    };
    Some(format!(
        "{name} ({}) fails in {all} of {}{what}.",
        first.subject.precision.name(),
        cells.len()
    ))
}

fn cells(matrix: &Matrix) -> Vec<&Cell> {
    matrix.rows.iter().flat_map(|row| &row.cells).collect()
}

fn of<'c>(cells: &[&'c Cell], is: impl Fn(Subject) -> bool) -> Vec<&'c Cell> {
    cells
        .iter()
        .copied()
        .filter(|cell| is(cell.subject))
        .collect()
}

fn is_single(solver: Solver) -> impl Fn(Subject) -> bool {
    move |subject| {
        subject.solver == Rung::Ladder(solver)
            && subject.convention == Convention::Physical
            && subject.precision == Precision::F32
    }
}

/// A line a solver, a column a convention: in how many of its cells it holds.
pub(super) fn table(matrix: &Matrix) -> String {
    let cells = cells(matrix);
    let mut rungs = Rung::all();
    rungs.retain(|rung| cells.iter().any(|cell| cell.subject.solver == *rung));
    let mut table =
        Table::of(&rungs).people("holds in, of cells in f32 and f64", |rung| rung.name());
    for convention in Convention::ALL {
        let held = |rung: &Rung| {
            let mine = of(&cells, |subject| {
                subject.solver == *rung && subject.convention == convention
            });
            match mine.len() {
                0 => UNKNOWN.to_owned(),
                all => format!("{} of {all}", Counts::of(mine.iter().copied()).holds),
            }
        };
        table = table.people(convention.name(), held).right();
    }
    table.to_text()
}
