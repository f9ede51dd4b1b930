use super::*;
use crate::lesson::plan::{Feedback, Known};
use crate::lesson::plans;
use serde_json::{Value, json};

/// Six blind knees; the first trial of this seed runs.
fn begin(feedback: Feedback) -> Lesson {
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let mut plan = plans::find("blind-six").unwrap().read().unwrap();
    plan.feedback = feedback;
    let students = ["Ada", "Ben"].map(str::to_owned).to_vec();
    let mut lesson = Lesson::begin("six", plan.check(known).unwrap(), students, 1).unwrap();
    lesson.start().unwrap();
    lesson
}

fn own(lesson: &Lesson, student: &str) -> Value {
    serde_json::to_value(lesson.own_view(student)).unwrap()
}

#[test]
fn a_student_sees_the_own_answer_and_nothing_of_the_other() {
    let mut lesson = begin(Feedback::Each);
    lesson.set_torque_share(0.25);
    lesson
        .answer("Ada", "clonus", Some("severe"), 5, 1.0)
        .unwrap();
    let [ada, ben] = ["Ada", "Ben"].map(|name| own(&lesson, name));
    let answer = &ada["answers"][0];
    assert_eq!(
        (&answer["disorder"], &answer["level"]),
        (&json!("clonus"), &json!("severe"))
    );
    // What was answered without torque is marked at once.
    assert_eq!(answer["counts"], false);
    // Whether it is right is hidden, as the knee is.
    assert!(answer["right"].is_null() && answer["knee"].is_null() && ada["knee"].is_null());
    assert!(ada["takes_answer"] == true && ben["takes_answer"] == true);
    assert_eq!(ben["answers"], json!([]));
    assert!(!ben.to_string().contains("Ada"));
    lesson.answer("Ben", "healthy", None, 1, 2.0).unwrap();
    let [ada, ben] = ["Ada", "Ben"].map(|name| own(&lesson, name));
    for (view, other) in [(&ada, "Ben"), (&ben, "Ada")] {
        assert!(view["answers"][0]["right"].is_boolean() && view["knee"].is_object());
        assert_eq!(view["takes_answer"], false);
        assert!(view["scores"].is_null() && !view.to_string().contains(other));
    }
}

#[test]
fn with_feedback_at_the_end_verdicts_and_scores_come_then() {
    let mut lesson = begin(Feedback::End);
    for student in ["Ada", "Ben"] {
        lesson.answer(student, "healthy", None, 3, 1.0).unwrap();
    }
    lesson.next_trial().unwrap();
    let ada = own(&lesson, "Ada");
    assert!(ada["answers"][0]["right"].is_null() && ada["knee"].is_null());
    assert_eq!(ada["takes_answer"], false, "it has not begun");
    lesson.end().unwrap();
    let ada = own(&lesson, "Ada");
    assert!(ada["answers"][0]["right"].is_boolean());
    assert_eq!(ada["scores"]["answers"], 1);
    assert!(!ada.to_string().contains("Ben"));
}

#[test]
fn who_is_not_in_the_lesson_sees_nothing_of_it() {
    let mut lesson = begin(Feedback::Each);
    assert_eq!(own(&lesson, "Cem"), Value::Null);
    // Another writing of the name is the same student.
    assert!(own(&lesson, "aDA").is_object());
    lesson.next_trial().unwrap();
    lesson.admit("Cem").unwrap();
    assert_eq!(own(&lesson, "Cem")["answers"], json!([]));
}

/// Viewers, of which one is a projector in front of all students.
#[test]
fn the_public_part_names_nobody_s_answer() {
    let mut lesson = begin(Feedback::Each);
    let public = |lesson: &Lesson| serde_json::to_value(lesson.view(Some("folder")).public());
    for student in ["Ada", "Ben"] {
        lesson
            .answer(student, "clonus", Some("mild"), 2, 1.0)
            .unwrap();
    }
    let view = public(&lesson).unwrap();
    for answer in view["answers"].as_array().unwrap() {
        assert!(answer["student"].is_string());
        for hidden in ["disorder", "level", "confidence", "right", "level_right"] {
            assert!(answer[hidden].is_null(), "{hidden}");
        }
    }
    // With seed and plan anybody could look up the knees to come.
    assert!(view["seed"].is_null() && view["stored"].is_null());
    lesson.end().unwrap();
    let view = public(&lesson).unwrap();
    assert_eq!(view["seed"], 1);
    assert_eq!(view["summary"]["students"], json!([]));
    assert_eq!(view["summary"]["all"]["answers"], 2);
}
