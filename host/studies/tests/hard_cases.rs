//! The catalogue of hard cases as a test: every subject through every case
//! that takes seconds. A cell that must hold and does not is named with its
//! case, its subject, and what was measured.

use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;
use crepitus_studies::stability::{
    Case, Cell, Failure, Matrix, Plan, Rung, Subject, Verdict, catalogue, criterion, run,
};
use crepitus_studies::{Cancelled, StudyError, Watcher};
use std::collections::HashSet;
use std::sync::OnceLock;

/// Lets everything run.
struct Patient;

impl Watcher for Patient {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        assert!((0.0..=1.0).contains(&fraction));
        Ok(())
    }
}

/// All cases that take seconds, on all subjects; run once for all tests.
fn matrix() -> &'static Matrix {
    static MATRIX: OnceLock<Matrix> = OnceLock::new();
    MATRIX.get_or_init(|| {
        let plan = Plan {
            cases: catalogue::all().into_iter().filter(|c| !c.long).collect(),
            subjects: Subject::all(),
        };
        run(&plan, &mut Patient).expect("every trial can be run")
    })
}

fn verdict(id: &str, convention: Convention, solver: Solver, precision: Precision) -> Verdict {
    let subject = Subject {
        solver: Rung::Ladder(solver),
        convention,
        precision,
    };
    let row = matrix().rows.iter().find(|row| row.case.id == id);
    let cell = row.and_then(|row| row.cells.iter().find(|cell| cell.subject == subject));
    cell.expect("the cell is there").verdict
}

fn complaint(case: &Case, cell: &Cell) -> String {
    let Subject {
        solver,
        convention,
        precision,
    } = cell.subject;
    format!(
        "{} {}, {} {} {}: {} ({})\n",
        case.id,
        case.name,
        convention.name(),
        solver.name(),
        precision.name(),
        cell.verdict,
        cell.detail
    )
}

#[test]
fn what_must_hold_holds() {
    let text: String = matrix()
        .broken()
        .map(|(case, cell)| complaint(case, cell))
        .collect();
    assert!(text.is_empty(), "hard cases that must hold do not:\n{text}");
}

#[test]
fn the_firmware_is_asked_for_all_that_frozen_is_asked_for() {
    let asked = |subject: &Subject| {
        let asks = |cell: &Cell| cell.subject == *subject && cell.must_hold;
        let rows = matrix().rows.iter();
        rows.filter(|row| row.cells.iter().any(asks)).count()
    };
    let all = Subject::all();
    let frozen = all.iter().filter(|s| s.convention == Convention::Frozen);
    let firmware = all.iter().find(|s| s.is_firmware()).unwrap();
    assert_eq!(Some(asked(firmware)), frozen.map(asked).max());
    assert!(asked(firmware) >= 25);
}

#[test]
fn who_is_expected_to_fail_fails() {
    for precision in Precision::ALL {
        let physical = |id, solver| verdict(id, Convention::Physical, solver, precision);
        // ωn·h = 3.16 is above 2, where these two are stable.
        for solver in [Solver::Euler, Solver::Verlet] {
            let got = physical("H13", solver);
            let overflows = matches!(
                got,
                Verdict::Fails {
                    what: Failure::Overflow,
                    at_s: Some(_),
                    flagged: true
                }
            );
            assert!(overflows, "{} {got}", solver.name());
        }
        // The numerical damping of implicit Euler ends the effect.
        let got = physical("H01", Solver::ImplicitEuler);
        let Verdict::Fails {
            what: Failure::OtherEvents { found, expected },
            ..
        } = got
        else {
            panic!("implicit-euler {got}");
        };
        assert!(found == 1 && expected > 100, "implicit-euler {got}");
        // Who only looks at the ends of steps reverses where Tk = 0.
        let got = physical("H10", Solver::Exact);
        assert!(matches!(got, Verdict::Fails { .. }), "exact {got}");
        // A step late is the right motion, but not 1e-12 s.
        let got = physical("H01", Solver::ExactBreak);
        assert!(matches!(got, Verdict::Degrades { .. }), "exact-break {got}");
    }
}

#[test]
fn numbers_are_consecutive_and_texts_are_there() {
    let (mut ids, mut names) = (HashSet::new(), HashSet::new());
    let mut last = 0;
    for case in catalogue::all() {
        let Case { id, name, .. } = case;
        assert!(ids.insert(id) && names.insert(name), "{id} is there twice");
        let number = id.trim_start_matches('H').trim_end_matches('L');
        let number: u32 = number.parse().expect("H, a number, and L if it is long");
        assert_eq!(id.ends_with('L'), case.long, "{id}");
        if case.long {
            assert_eq!(number, last, "{id} follows its short sibling");
        } else {
            assert_eq!(number, last + 1, "{id} is out of order");
        }
        last = number;
        let texts = [name, case.title, case.hard, case.source];
        assert!(texts.iter().all(|t| !t.trim().is_empty()), "{id}: a text");
        assert!(!case.inputs().is_empty(), "{id} has no input");
        assert!(!case.criteria().is_empty(), "{id} asks nothing");
        asks_somebody(&case);
    }
    assert!(last >= 55);
    assert_eq!(criterion::common_bounds().len(), 3);
}

/// Somebody must hold, every trial has a criterion, and only long cases have
/// very many steps.
fn asks_somebody(case: &Case) {
    let (mut must, mut longest) = (0, 0.0_f64);
    for subject in Subject::all() {
        for trial in case.trials_of(subject) {
            assert!(!trial.criteria.is_empty(), "{}", case.id);
            must += usize::from((case.must)(subject));
            longest = longest.max(trial.input.steps());
        }
    }
    assert!(must > 0, "{} asks nobody", case.id);
    assert_eq!(longest > 5e6, case.long, "{}: {longest} steps", case.id);
}

/// Says no after a number of calls.
struct Impatient(u32);

impl Watcher for Impatient {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        self.0 = self.0.checked_sub(1).ok_or(Cancelled)?;
        Ok(())
    }
}

#[test]
fn a_watcher_ends_a_long_case_at_once() {
    let plan = Plan {
        cases: vec![catalogue::find("H23L").unwrap()],
        subjects: Subject::all(),
    };
    let begun = std::time::Instant::now();
    let ended = run(&plan, &mut Impatient(2));
    assert!(matches!(ended, Err(StudyError::Cancelled(_))));
    assert!(begun.elapsed().as_secs() < 10);
}
