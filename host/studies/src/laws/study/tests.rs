use super::*;
use crate::laws::law_tables::leaderboard_table;
use crate::laws::{TASKS, Use, answers};
use crate::watcher::Cancelled;

struct Nobody;

impl Watcher for Nobody {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        assert!((0.0..=1.0 + 1e-12).contains(&fraction));
        Ok(())
    }
}

#[test]
fn every_law_has_every_number_the_same_twice() {
    let plan = Plan {
        repeats: 0,
        ..Plan::of(Extent::Quick)
    };
    let [first, second] = [(); 2].map(|()| run(&plan, &mut Nobody).unwrap());
    assert_eq!(first.rows, second.rows);
    let bits = |study: &LawStudy| leaderboard_table(&study.rows).to_csv();
    assert_eq!(bits(&first), bits(&second));
    let quantities: usize = TASKS.iter().map(|task| task.quantities().len()).sum();
    assert_eq!(first.rows.len(), ENTRIES.len() * quantities);
    for row in &first.rows {
        assert!(row.value.is_some() || row.failed.is_some(), "{row:?}");
        let numbers = [
            row.value,
            row.converged,
            row.model_error,
            row.relative_error,
        ];
        assert!(numbers.iter().flatten().all(|x| x.is_finite()), "{row:?}");
        assert!(row.scale > 0.0 && row.demanded.is_finite(), "{row:?}");
    }
    let answers = answers(&first);
    assert_eq!(answers.len(), Use::ALL.len());
    assert!(
        answers
            .iter()
            .all(|answer| answer.scores.len() == ENTRIES.len())
    );
    assert!(first.costs.iter().all(|costs| costs.bytes > 0));
}

#[test]
fn ours_does_what_the_joint_demands() {
    let plan = Plan {
        laws: vec!["frozen".to_owned()],
        repeats: 0,
        joints: joints().to_vec(),
        ..Plan::of(Extent::Quick)
    };
    let study = run(&plan, &mut Nobody).unwrap();
    for row in &study.rows {
        // Converged it is the reference; the leg's loop has its delay, whatever the law.
        let most = match row.quantity {
            "hand-onset" => 0.2,
            "hand-energy" => 0.05,
            "knee-rms" | "hour-drift" => 1e-3,
            // A slip ends with the change, and a stick of the same torque begins.
            "encoder-frequency" | "encoder-rms" | "change-jump-slip" => 0.02,
            _ => 0.01,
        };
        let error = row.model_error.map(|error| error.abs() / row.scale);
        assert!(
            error.is_some_and(|error| error <= most),
            "{error:?} of {most}: {row:#?}"
        );
        assert_eq!(row.failed, None, "{row:#?}");
    }
}

#[test]
fn a_plan_takes_some_laws_and_tasks_and_a_watcher_ends_it() {
    struct Ends(u32);
    impl Watcher for Ends {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            self.0 = self.0.checked_sub(1).ok_or(Cancelled)?;
            Ok(())
        }
    }
    let plan = Plan {
        laws: vec!["frozen".to_owned()],
        tasks: vec!["creep".to_owned(), "grating".to_owned()],
        repeats: 1,
        ..Plan::of(Extent::Quick)
    };
    let study = run(&plan, &mut Nobody).unwrap();
    let quantities: Vec<_> = study.rows.iter().map(|row| row.quantity).collect();
    let expected = [
        "grating-frequency",
        "grating-peak",
        "grating-band",
        "creep",
        "break-away-slow",
    ];
    assert_eq!(quantities, expected);
    let time = study.costs.first().and_then(|costs| costs.grating);
    assert!(time.is_some_and(|time| time.ns > 0.0));
    for most in [0, 2] {
        let ended = run(&plan, &mut Ends(most));
        assert!(matches!(ended, Err(StudyError::Cancelled(_))));
    }
}
