use super::*;
use crate::lesson::plan::{Known, Plan};
use serde_json::json;

fn begin(students: &[&str]) -> Lesson {
    let plan = "title = \"Two\"\ndescription = \"d\"\ninstruction = \"all\"\nblind = true\n\
        [[knee]]\npreset = \"mas-2-catch\"\n\
        [[knee]]\npreset = \"mas-2-catch\"\ninstruction = \"own\"\ntarget = \"slow\"\ntime_s = 60\n";
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let plan = Plan::from_toml(plan).unwrap().check(known).unwrap();
    let students = students.iter().copied().map(str::to_owned).collect();
    // The order of this seed is that of the plan.
    Lesson::begin("two", plan, students, 3).unwrap()
}

/// The whole message, key by key, as the page reads it.
#[test]
fn the_message_is_that_of_the_page() {
    let mut lesson = begin(&["A"]);
    let choices = json!({
        "disorders": [
            "healthy", "end-feel", "range-deficit", "rigidity", "cogwheel", "spasticity", "clasp-knife",
            "clonus", "texture", "crepitus",
        ],
        "levels": ["mild", "moderate", "severe"],
    });
    let mut expected = json!({
        "title": "Two", "description": "d", "blind": true, "curves": false, "feedback": "each", "seed": 3,
        "name": "two", "stored": null, "students": ["A"], "trial": 1, "trials": 2, "instruction": "all",
        "target": null, "time_s": null, "began": false, "knee": null, "answers": [], "ended": false,
        "choices": choices, "summary": null,
    });
    let view = |lesson: &Lesson, stored| serde_json::to_value(lesson.view(stored)).unwrap();
    assert_eq!(view(&lesson, None), expected);

    lesson.start().unwrap();
    lesson.set_torque_share(0.75);
    lesson
        .answer("A", "spasticity", Some("mild"), 4, 7.0)
        .unwrap();
    expected["began"] = json!(true);
    expected["stored"] = json!("folder");
    expected["knee"] = json!({
        "preset": "mas-2-catch", "title": "Spasticity, MAS 2, as an examiner feels it",
        "disorder": "spasticity", "level": "moderate",
    });
    expected["answers"] = json!([{
        "student": "A", "trial": 1, "disorder": "spasticity", "level": "mild", "confidence": 4,
        "right": true, "level_right": false, "counts": true, "torque_share": 0.75,
    }]);
    assert_eq!(view(&lesson, Some("folder")), expected);

    lesson.next_trial().unwrap();
    lesson.start().unwrap();
    lesson.end().unwrap();
    expected["trial"] = json!(2);
    expected["stored"] = json!(null);
    expected["instruction"] = json!("own");
    expected["target"] = json!("slow");
    expected["time_s"] = json!(60.0);
    expected["ended"] = json!(true);
    let scores = json!({
        "answers": 1, "without_torque": 0, "right": 1, "confidence_right": 4.0, "confidence_wrong": null, "kappa": null,
        "level_kappa": null,
        "confusion": { "rows": ["spasticity"], "columns": ["spasticity"], "counts": [[1]] },
    });
    let mut student = scores.clone();
    student["student"] = json!("A");
    expected["summary"] = json!({
        "answers": 1, "right": 1, "students": [student], "all": scores, "remarks": ["about_kappa", "few"],
    });
    assert_eq!(view(&lesson, None), expected);
}

#[test]
fn answers_are_judged_once_all_have_answered() {
    let mut lesson = begin(&["A", "B"]);
    lesson.start().unwrap();
    lesson.answer("A", "clonus", None, 4, 7.0).unwrap();
    let view = lesson.view(None);
    assert_eq!((view.knee, view.answers[0].right), (None, None));
    // B does not see what A has answered.
    let answer = &view.answers[0];
    assert_eq!(answer.student, "A");
    assert_eq!(
        (answer.disorder, answer.level, answer.confidence),
        (None, None, None)
    );
    lesson
        .answer("B", "spasticity", Some("moderate"), 4, 7.0)
        .unwrap();
    let view = lesson.view(None);
    assert!(view.knee.is_some() && view.summary.is_none());
    let judged: Vec<_> = view
        .answers
        .iter()
        .map(|a| (a.right, a.level_right))
        .collect();
    assert_eq!(judged, [(Some(false), None), (Some(true), Some(true))]);
    // The next knee is hidden again, what was judged stays.
    lesson.next_trial().unwrap();
    let view = lesson.view(None);
    assert_eq!((view.knee, view.answers[0].right), (None, Some(false)));
}
