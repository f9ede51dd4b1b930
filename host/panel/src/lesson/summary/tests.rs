use super::*;
use crate::lesson::plan::{Known, Plan};

fn examined(knees: &[&str], answers: &[(&str, Option<&str>)]) -> Scores {
    let knees = knees
        .iter()
        .map(|name| format!("[[knee]]\npreset = \"{name}\"\n"));
    let text = "title = \"x\"\nblind = true\n".to_owned() + &knees.collect::<String>();
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let plan = Plan::from_toml(&text).unwrap().check(known).unwrap();
    let mut lesson = Lesson::begin("x", plan, vec!["A".to_owned()], 5).unwrap();
    for left in (0..lesson.trials()).rev() {
        lesson.start().unwrap();
        let asked = lesson.order[lesson.current];
        if let Some((disorder, level)) = answers.get(asked) {
            lesson.answer("A", disorder, *level, 3, 0.0).unwrap();
        }
        if left > 0 {
            lesson.next_trial().unwrap();
        }
    }
    Summary::of(&lesson).all
}

#[test]
fn a_trial_without_an_answer_is_not_counted() {
    let scores = examined(
        &["healthy", "fine", "coarse"],
        &[("healthy", None), ("clonus", None)],
    );
    assert_eq!((scores.answers, scores.right), (2, 1));
    assert_eq!(
        scores.confusion.rows,
        [Finding::Healthy, Finding::Disorder(Disorder::Crepitus)]
    );
    let columns = [Disorder::Clonus, Disorder::Crepitus].map(Finding::Disorder);
    assert_eq!(scores.confusion.columns[1..], columns);
    assert_eq!(scores.confusion.counts, [[1, 0, 0], [0, 1, 0]]);
}

/// A healthy knee has the level "none"; an end-feel has no level at all.
#[test]
fn levels_count_where_both_have_one() {
    let knees = ["healthy", "fine", "bone-on-bone", "end-feel-hard"];
    let scores = examined(
        &knees,
        &[
            ("healthy", None),
            ("texture", Some("mild")),
            ("crepitus", None),
            ("end-feel", Some("severe")),
        ],
    );
    assert_eq!((scores.answers, scores.right), (4, 3));
    // None and mild, both right, whatever the disorder.
    let level = scores.level_kappa.unwrap();
    assert!((level.value - 1.0).abs() < 1e-12, "{level:?}");
    // po = 3/4; pe = 3 · 1/4 · 1/4, of healthy, crepitus and end-feel once each but crepitus twice.
    let (po, pe): (f64, f64) = (0.75, 4.0 / 16.0);
    let kappa = scores.kappa.unwrap().value;
    assert!((kappa - (po - pe) / (1.0 - pe)).abs() < 1e-12, "{kappa}");
}

#[test]
fn kappa_needs_knees_that_differ() {
    let scores = examined(
        &["mas-1-catch", "mas-3-catch"],
        &[("spasticity", Some("mild")), ("clonus", Some("moderate"))],
    );
    assert_eq!(scores.kappa, None);
    assert!(scores.level_kappa.is_some());
}

#[test]
fn nothing_answered_has_no_numbers() {
    let scores = examined(&["fine", "healthy"], &[]);
    assert_eq!(
        (scores.answers, scores.kappa, scores.confidence_right),
        (0, None, None)
    );
    assert_eq!(scores.confusion, Confusion::default());
}

#[test]
fn an_answer_counts_with_torque_for_half_of_the_time() {
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let text = "title = \"x\"\nblind = true\nfeedback = \"end\"\n[[knee]]\npreset = \"healthy\"\n";
    let plan = Plan::from_toml(text).unwrap().check(known).unwrap();
    let students = ["A", "B", "C"].map(str::to_owned).to_vec();
    let mut lesson = Lesson::begin("x", plan, students, 5).unwrap();
    lesson.start().unwrap();
    for (student, share) in [("A", 0.0), ("B", 0.499), ("C", 0.5)] {
        lesson.set_torque_share(share);
        lesson.answer(student, "healthy", None, 3, 0.0).unwrap();
    }
    let summary = Summary::of(&lesson);
    assert_eq!((summary.answers, summary.right), (1, 1));
    assert_eq!(summary.all.without_torque, 2);
    assert_eq!(summary.students[0].scores.answers, 0);
    assert_eq!(summary.students[0].scores.confidence_right, None);
}

#[test]
fn remarks_say_what_the_numbers_do_not() {
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let text = "title = \"x\"\nblind = true\n\
        [[knee]]\npreset = \"healthy\"\n[[knee]]\npreset = \"fine\"\n";
    let plan = Plan::from_toml(text).unwrap().check(known).unwrap();
    let students = ["A", "B"].map(str::to_owned).to_vec();
    let mut lesson = Lesson::begin("x", plan, students, 5).unwrap();
    for share in [0.0, 1.0] {
        lesson.start().unwrap();
        lesson.set_torque_share(share);
        let truth = lesson.knee().disorder.unwrap().name();
        for student in ["A", "B"] {
            lesson.answer(student, truth, None, 3, 0.0).unwrap();
        }
        let _ = lesson.next_trial();
    }
    let remarks = Summary::of(&lesson).remarks;
    assert_eq!(remarks, ["about_kappa", "left_out", "few", "pooled"]);
    let two = examined(
        &["healthy", "fine"],
        &[("healthy", None), ("crepitus", None)],
    );
    assert_eq!(two.kappa.map(|kappa| kappa.low >= kappa.high), Some(true));
    let one = StudentScores {
        student: "A".to_owned(),
        scores: two.clone(),
    };
    let said = super::remarks(&[one], &two);
    assert_eq!(said, ["about_kappa", "few", "no_width"]);
}
