use super::*;
use crate::lesson::plan::Known;
use crate::lesson::plans;

fn plan(change: impl FnOnce(&mut Plan)) -> CheckedPlan {
    let mut plan = plans::find("blind-six").unwrap().read().unwrap();
    change(&mut plan);
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    plan.check(known).unwrap()
}

fn begin(students: &[&str], change: impl FnOnce(&mut Plan)) -> Lesson {
    let students = students.iter().copied().map(str::to_owned).collect();
    Lesson::begin("six", plan(change), students, 1).unwrap()
}

#[test]
fn a_lesson_that_cannot_begin_says_why() {
    let begin = |students: &[&str], blind: bool, seed: u64| {
        let students = students.iter().copied().map(str::to_owned).collect();
        Lesson::begin("six", plan(|plan| plan.blind = blind), students, seed)
    };
    assert_eq!(
        begin(&[], true, 1).unwrap_err(),
        BeginError::Students { students: 0 }
    );
    assert!(begin(&[], false, 1).is_ok());
    let names: Vec<_> = (0..31).map(|n| format!("s{n}")).collect();
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    assert!(begin(&names[..30], true, MOST_SEED).is_ok());
    assert!(
        begin(&names, true, 1)
            .unwrap_err()
            .to_string()
            .contains("at most 30")
    );
    let seed = begin(&["A"], true, MOST_SEED + 1).unwrap_err();
    assert_eq!(
        seed,
        BeginError::Seed {
            seed: MOST_SEED + 1
        }
    );
    for right in ["A", "Zoë 2", "x-y_z", "abcdefghijklmnopqrst", "7"] {
        assert!(begin(&[right], true, 1).is_ok(), "{right}");
    }
    for wrong in [
        "",
        " A",
        "A ",
        "-A",
        "A_",
        "A,B",
        "a\nb",
        "abcdefghijklmnopqrstu",
        "<b>",
        "a\u{202e}b",
    ] {
        let error = begin(&["B", wrong], true, 1).unwrap_err();
        assert!(
            matches!(&error, BeginError::Pseudonym { pseudonym } if pseudonym == wrong),
            "{error}"
        );
    }
    let twice = begin(&["Ada", "Ben", "ada"], true, 1).unwrap_err();
    assert_eq!(
        twice.to_string(),
        "the pseudonym \"ada\" occurs twice: give every student another one"
    );
}

#[test]
fn the_order_is_that_of_the_seed_or_of_the_plan() {
    let blind = begin(&["A"], |plan| plan.repeats = 2);
    let presets: Vec<_> = blind.plan().knees.iter().map(|knee| &knee.preset).collect();
    assert_eq!(blind.order, order::shuffled(&presets, 2, 1));
    assert_eq!(blind.trials(), 12);
    let open = begin(&[], |plan| {
        plan.blind = false;
        plan.repeats = 2;
    });
    assert_eq!(open.order, [0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5]);
}

#[test]
fn requests_in_the_wrong_order_are_rejected() {
    let mut lesson = begin(&["A"], |plan| plan.knees.truncate(2));
    let answer = |lesson: &mut Lesson| lesson.answer("A", "healthy", None, 3, 1.0);
    assert_eq!(answer(&mut lesson), Err(LessonError::NotBegun { trial: 1 }));
    assert_eq!(lesson.next_trial(), Err(LessonError::NotBegun { trial: 1 }));
    lesson.start().unwrap();
    assert_eq!(lesson.start(), Err(LessonError::Begun { trial: 1 }));
    // A trial may be left without an answer.
    lesson.next_trial().unwrap();
    assert_eq!((lesson.trial(), lesson.began()), (2, false));
    lesson.start().unwrap();
    answer(&mut lesson).unwrap();
    assert_eq!(
        lesson.next_trial(),
        Err(LessonError::LastTrial { trial: 2 })
    );
    lesson.end().unwrap();
    assert_eq!(lesson.end(), Err(LessonError::Ended));
    assert_eq!(lesson.next_trial(), Err(LessonError::Ended));
    assert_eq!(answer(&mut lesson), Err(LessonError::Ended));
    assert_eq!(lesson.start(), Err(LessonError::Ended));
    lesson.note(3.0, "afterwards", By::Teacher).unwrap();
    assert_eq!(lesson.notes().len(), 1);
}

#[test]
fn an_open_lesson_takes_no_answers() {
    let mut lesson = begin(&["A"], |plan| plan.blind = false);
    assert!(!lesson.is_hidden());
    let knee = lesson.start().unwrap().clone();
    assert_eq!((&knee, knee.preset.as_str()), (lesson.knee(), "healthy"));
    let refused = lesson.answer("A", "healthy", None, 3, 1.0);
    assert_eq!(refused, Err(LessonError::Open));
}

#[test]
fn wrong_parts_of_an_answer_are_named() {
    let mut lesson = begin(&["A", "B"], |_| ());
    lesson.start().unwrap();
    for (student, disorder, level, confidence, part) in [
        ("C", "clonus", None, 3, "expected one of A, B"),
        ("A", "limp", None, 3, "expected one of healthy, end-feel"),
        ("A", "clonus", Some("marked"), 3, "mild, moderate, severe"),
        ("A", "clonus", None, 0, "1 (a guess)"),
        ("A", "clonus", None, 6, "the confidence is 6"),
    ] {
        let error = lesson.answer(student, disorder, level, confidence, 1.0);
        let error = error.unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    assert!(lesson.answers().is_empty());
}

#[test]
fn a_second_answer_replaces_the_first_until_the_knee_is_revealed() {
    let mut lesson = begin(&["A", "B"], |_| ());
    lesson.start().unwrap();
    lesson.answer("A", "clonus", Some("mild"), 3, 1.0).unwrap();
    lesson
        .answer("A", "healthy", Some("severe"), 4, 2.0)
        .unwrap();
    let [answer] = lesson.answers() else {
        panic!("one answer")
    };
    assert_eq!((answer.disorder, answer.level), (Finding::Healthy, None));
    assert_eq!((answer.confidence, answer.time_s), (4, 2.0));
    assert!(lesson.is_hidden());
    lesson.answer("B", "clonus", None, 1, 3.0).unwrap();
    assert!(!lesson.is_hidden());
    let late = lesson.answer("A", "clonus", None, 1, 4.0);
    assert_eq!(late, Err(LessonError::Revealed { trial: 1 }));
}

#[test]
fn with_feedback_at_the_end_answers_stay_open_until_the_trial_is_left() {
    let mut lesson = begin(&["A"], |plan| plan.feedback = Feedback::End);
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 1, 1.0).unwrap();
    lesson.answer("A", "texture", None, 1, 2.0).unwrap();
    lesson.next_trial().unwrap();
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 1, 3.0).unwrap();
    assert_eq!(lesson.answers().len(), 2);
    assert_eq!(lesson.answers()[0].disorder.name(), "texture");
    assert!(!lesson.is_revealed(1) && lesson.is_hidden());
    lesson.end().unwrap();
    assert!(lesson.is_revealed(1) && !lesson.is_hidden());
}

#[test]
fn a_trial_that_was_left_is_revealed_and_the_next_one_is_not() {
    let mut lesson = begin(&["A", "B"], |_| ());
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 1, 1.0).unwrap();
    lesson.next_trial().unwrap();
    assert!(lesson.is_revealed(1) && !lesson.is_revealed(2) && !lesson.is_revealed(3));
}

#[test]
fn notes_have_a_text() {
    let mut lesson = begin(&["A"], |_| ());
    lesson.note(1.0, "  hm  ", By::Lesson).unwrap();
    assert_eq!(
        (lesson.notes()[0].text.as_str(), lesson.notes()[0].by),
        ("hm", By::Lesson)
    );
    let error = lesson.note(1.0, " ", By::Teacher).unwrap_err();
    assert_eq!(error, LessonError::Note { characters: 0 });
    let long = "x".repeat(501);
    assert!(lesson.note(1.0, &long, By::Teacher).is_err());
}

#[test]
fn a_student_who_comes_later_is_admitted_between_trials() {
    let mut lesson = begin(&["A"], |_| ());
    lesson.start().unwrap();
    assert_eq!(lesson.admit("B"), Err(LessonError::Begun { trial: 1 }));
    lesson.answer("A", "clonus", None, 1, 1.0).unwrap();
    assert!(lesson.is_revealed(1));
    lesson.next_trial().unwrap();
    lesson.admit("B").unwrap();
    for (name, part) in [("a", "occurs twice"), ("-", "is invalid")] {
        let error = lesson.admit(name).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(lesson.students(), ["A", "B"]);
    // What was revealed stays so, and the new one is waited for.
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 1, 2.0).unwrap();
    assert!(lesson.is_revealed(1) && lesson.is_hidden());
    for nth in 3..=30 {
        lesson.began = false;
        lesson.admit(&format!("s{nth}")).unwrap();
    }
    let full = lesson.admit("s31").unwrap_err().to_string();
    assert!(full.contains("at most 30"), "{full}");
    lesson.end().unwrap();
    assert_eq!(lesson.admit("C"), Err(LessonError::Ended));
}

#[test]
fn a_trial_that_was_interrupted_is_started_again_and_keeps_its_answers() {
    let mut lesson = begin(&["A", "B"], |_| ());
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 1, 1.0).unwrap();
    lesson.take_up();
    assert!(!lesson.began() && lesson.is_hidden());
    lesson.start().unwrap();
    lesson.answer("B", "clonus", None, 1, 1.0).unwrap();
    assert_eq!(lesson.answers().len(), 2);
    // All is said of this one: its knee was shown.
    lesson.take_up();
    assert!(lesson.began() && !lesson.is_hidden());
    lesson.next_trial().unwrap();
    let mut open = begin(&[], |plan| plan.blind = false);
    open.start().unwrap();
    open.take_up();
    assert!(!open.began());
}
