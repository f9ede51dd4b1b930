//! The answer of the study in a few sentences, and every solver in a table that fits on a screen.

use super::summary::Summary;
use crate::stability::matrix::Counts;
use crate::stability::{Cell, Failure, Matrix, Rung, Subject, Verdict};
use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_pages::table::Table;
use crepitus_pages::table::show::UNKNOWN;
use crepitus_scene::scene::Precision;
use std::cmp::Ordering;

/// The device's solver, what the simplest one does instead, and what the one does that is always stable; then what must hold.
pub(super) fn answer(matrix: &Matrix, summary: &Summary<'_>) -> String {
    let device = of(matrix, Subject::is_firmware);
    let single = |solver| {
        of(matrix, move |subject| {
            subject.solver == Rung::Ladder(solver)
                && subject.convention == Convention::Physical
                && subject.precision == Precision::F32
        })
    };
    let holds = device.first().map(|first| {
        format!(
            "The solver that the device runs ({}) holds in {} of {} hard cases.",
            first.subject,
            Counts::of(device.iter().copied()).holds,
            device.len()
        )
    });
    let must = format!(
        "Of all {} cells {} must hold, and {}.",
        summary.cells,
        summary.counts.must_hold,
        match summary.counts.broken {
            0 => "all do".to_owned(),
            1 => "one does not".to_owned(),
            n => format!("{n} do not"),
        }
    );
    let sentences: Vec<String> = [
        holds,
        failures("Explicit Euler", &single(Solver::Euler)),
        failures("Implicit Euler", &single(Solver::ImplicitEuler)),
        Some(must),
    ]
    .into_iter()
    .flatten()
    .collect();
    sentences.join(" ")
}

/// Failures of a solver, by what its torque is like.
fn failures(name: &str, cells: &[&Cell]) -> Option<String> {
    let first = cells.first()?;
    let fails = |is: fn(Failure) -> bool| {
        let failed = cells.iter().filter(|cell| match cell.verdict {
            Verdict::Fails { what, .. } => is(what),
            _ => false,
        });
        failed.count()
    };
    let causes: Vec<String> = [
        (
            fails(|what| matches!(what, Failure::Overflow | Failure::AboveTheLimit)),
            "explodes",
        ),
        (fails(|what| events(what).is_gt()), "breaks too often"),
        (
            fails(|what| events(what).is_lt()),
            "loses breaks: the patient is healed",
        ),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("in {count} it {what}"))
    .collect();
    let what = if causes.is_empty() {
        String::new()
    } else {
        format!("; {}", causes.join(", "))
    };
    Some(format!(
        "{name} ({}) fails in {} of {}{what}.",
        first.subject.precision.name(),
        fails(|_| true),
        cells.len()
    ))
}

/// The number of events against the expected one.
fn events(what: Failure) -> Ordering {
    match what {
        Failure::OtherEvents { found, expected } => found.cmp(&expected),
        _ => Ordering::Equal,
    }
}

fn of(matrix: &Matrix, is: impl Fn(Subject) -> bool) -> Vec<&Cell> {
    let cells = matrix.cells().map(|(_, cell)| cell);
    cells.filter(|cell| is(cell.subject)).collect()
}

/// A line a solver, a column a convention: in how many of its cells it holds.
pub(super) fn table(matrix: &Matrix) -> String {
    let mut rungs = Rung::all();
    rungs.retain(|rung| !of(matrix, |subject| subject.solver == *rung).is_empty());
    let mut table =
        Table::of(&rungs).people("holds in, of cells in f32 and f64", |rung| rung.name());
    for convention in Convention::ALL {
        let held = |rung: &Rung| {
            let mine = of(matrix, |subject| {
                subject.solver == *rung && subject.convention == convention
            });
            match mine.len() {
                0 => UNKNOWN.to_owned(),
                all => format!("{} of {all}", Counts::of(mine).holds),
            }
        };
        table = table.people(convention.name(), held).right();
    }
    table.to_text()
}
