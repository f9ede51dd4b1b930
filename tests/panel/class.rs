//! Students who answer on their phones: each sees and changes the own answers alone.

use crate::SIM;
use crate::page::{Page, Panel};
use serde_json::{Value, json};
use std::time::Duration;

/// The last state of a student's lesson on a phone.
fn own(phone: &Page) -> &Value {
    &phone.message("own")["lesson"]
}

/// An answer to a trial.
fn answer(trial: usize, disorder: &str) -> Value {
    json!({ "trial": trial, "disorder": disorder, "level": "mild", "confidence": 2 })
}

/// Has the page in control begin a blind lesson of those who have joined and these, and its first trial.
fn begin(page: &mut Page, students: &[&str]) {
    // What has come meanwhile: its request is not late.
    page.go_on(Duration::from_millis(100));
    let lesson = json!({ "lesson": "blind-six", "students": students, "seed": 7 });
    page.ask("lesson-begin", lesson).unwrap();
    page.ask("lesson-start", json!({})).unwrap();
}

/// Has it go on to the next trial.
fn next(page: &mut Page) {
    page.go_on(Duration::from_millis(100));
    page.ask("lesson-next", json!({})).unwrap();
    page.ask("lesson-start", json!({})).unwrap();
}

#[test]
fn each_student_sees_the_own_answers_alone() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut page = panel.controlling();
    let mut early = panel.student_page();
    let closed = early.ask("join", json!({ "name": "Quokka" })).unwrap_err();
    assert!(closed.contains("the class is closed"), "{closed}");
    assert!(viewer.message("class")["invitation"].is_null());
    page.ask("class", json!({ "open": true })).unwrap();
    viewer.until("the invitation", |page| {
        page.message("class")["invitation"]["link"] == panel.student
    });
    let (mut quokka, _) = panel.joined("Quokka", None);
    let (mut wombat, _) = panel.joined("Wombat", None);
    page.until("both", |page| {
        let seats = page.message("class")["seats"].as_array();
        seats.is_some_and(|seats| seats.len() == 2 && seats[0]["here"] == true)
    });
    viewer.until("their number", |page| page.message("class")["joined"] == 2);
    assert!(!viewer.message("class").to_string().contains("Quokka"));
    begin(&mut page, &["Numbat"]);
    for phone in [&mut quokka, &mut wombat] {
        phone.until("the trial", |phone| own(phone)["takes_answer"] == true);
    }
    quokka.ask("answer", answer(1, "clonus")).unwrap();
    quokka.until("the answer", |phone| {
        own(phone)["answers"][0]["disorder"] == "clonus"
    });
    let given = &own(&quokka)["answers"][0];
    assert!(given["right"].is_null() && own(&quokka)["knee"].is_null());
    // Nobody has armed: what was answered is kept and marked.
    assert!(given["counts"] == false && given["torque_share"] == 0.0);
    wombat.go_on(Duration::from_millis(100));
    assert_eq!(own(&wombat)["answers"], json!([]));
    page.until("who has answered", |page| {
        page.message("lesson")["answers"][0]["student"] == "Quokka"
    });
    assert!(page.message("lesson")["answers"][0]["disorder"].is_null());
    page.ask("note", json!({ "text": "of the teacher" }))
        .unwrap();
    wombat.ask("answer", answer(1, "healthy")).unwrap();
    let numbat = json!({ "student": "Numbat", "disorder": "crepitus", "confidence": 1 });
    page.ask("lesson-answer", numbat).unwrap();
    for phone in [&mut quokka, &mut wombat] {
        phone.until("the verdict", |phone| {
            own(phone)["answers"][0]["right"].is_boolean() && own(phone)["knee"].is_object()
        });
    }
    // On a wall, too, answers are nobody's.
    viewer.until("the knee", |page| {
        page.message("lesson")["knee"].is_object()
    });
    for answer in viewer.message("lesson")["answers"].as_array().unwrap() {
        assert!(answer["student"].is_string() && answer["disorder"].is_null());
        assert!(answer["right"].is_null() && answer["confidence"].is_null());
    }
    for (phone, others) in [
        (&quokka, ["Wombat", "Numbat"]),
        (&wombat, ["Quokka", "Numbat"]),
    ] {
        for message in &phone.history {
            let text = message.to_string();
            assert!(!others.iter().any(|other| text.contains(other)), "{text}");
        }
        let known = ["hello", "status", "own", "beat"];
        for kind in phone.latest.keys() {
            assert!(known.contains(&kind.as_str()), "{kind}");
        }
        assert!(phone.frames.is_empty() && phone.notes.is_empty());
    }
}

#[test]
fn a_student_answers_and_stops_and_nothing_else() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("class", json!({ "open": true })).unwrap();
    let (mut phone, _) = panel.joined("Quokka", None);
    for (what, more) in [
        ("take", json!({})),
        ("release", json!({})),
        ("arm", json!({})),
        ("disarm", json!({})),
        ("zero", json!({})),
        ("clear-fault", json!({})),
        ("apply", json!({ "preset": "coarse" })),
        ("set", json!({ "changes": [] })),
        ("reset", json!({})),
        ("save", json!({})),
        ("target", json!({ "target": "slow" })),
        ("note", json!({ "text": "a" })),
        ("record", json!({ "running": true, "name": "a" })),
        ("lesson-begin", json!({ "students": ["Quokka"] })),
        ("lesson-start", json!({})),
        ("lesson-next", json!({})),
        ("lesson-end", json!({})),
        ("lesson-close", json!({})),
        ("lesson-resume", json!({ "folder": "a" })),
        ("lessons", json!({})),
        ("severity", json!({ "worse": true })),
        ("class", json!({ "open": false })),
        ("free-seat", json!({ "student": "Quokka" })),
        ("report", json!({})),
        ("recordings", json!({})),
        ("open", json!({ "recording": 0 })),
        ("fault", json!({ "code": 1 })),
    ] {
        let error = phone.ask(what, more).unwrap_err();
        assert!(error.contains("link is for answers"), "{what}: {error}");
    }
    let other = json!({ "student": "Quokka", "disorder": "clonus", "confidence": 1 });
    assert!(phone.ask("lesson-answer", other).is_err());
    // Nor does it hear the knee.
    phone.send(r#"{"listen":true}"#);
    phone.go_on(Duration::from_millis(300));
    assert!(phone.frames.is_empty());
    page.arm();
    phone.until_state("armed");
    phone.ask("stop", json!({})).unwrap();
    page.until_state("disarmed");
    page.until("who it was", |page| {
        page.status("torque_end")["cause"] == "stop-student"
    });
    phone.until_state("disarmed");
}

/// By name, by key, by a request that names another one, or by a message that is sent again.
#[test]
fn nobody_answers_for_another() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("class", json!({ "open": true })).unwrap();
    let (mut quokka, key) = panel.joined("Quokka", None);
    let (mut wombat, _) = panel.joined("Wombat", None);
    begin(&mut page, &[]);
    let mut thief = panel.student_page();
    let mut guessed = key.clone();
    guessed.replace_range(..1, if key.starts_with('0') { "1" } else { "0" });
    for guess in [json!(null), json!(""), json!(guessed), json!(key[..31])] {
        let seat = json!({ "name": "quokka", "key": guess });
        let error = thief.ask("join", seat).unwrap_err();
        assert!(error.contains("is taken"), "{error}");
    }
    let error = thief.ask("answer", answer(1, "texture")).unwrap_err();
    assert!(error.contains("join the class first"), "{error}");
    // Who has a seat has no other.
    let seat = json!({ "name": "Quokka", "key": key });
    let error = wombat.ask("join", seat).unwrap_err();
    assert!(error.contains("has joined as"), "{error}");
    quokka.ask("answer", answer(1, "clonus")).unwrap();
    let mut named = answer(1, "healthy");
    named["student"] = json!("Quokka");
    wombat.ask("answer", named).unwrap();
    page.until("both answers", |page| {
        let answers = page.message("lesson")["answers"].as_array();
        answers.is_some_and(|answers| answers.len() == 2 && answers[1]["disorder"].is_string())
    });
    let answers = page.message("lesson")["answers"].clone();
    for (at, student, disorder) in [(0_usize, "Quokka", "clonus"), (1, "Wombat", "healthy")] {
        assert_eq!(answers[at]["student"], student);
        assert_eq!(answers[at]["disorder"], disorder);
    }
    // The knee is known now, and then it is another one.
    let error = quokka.ask("answer", answer(1, "healthy")).unwrap_err();
    assert!(error.contains("are closed"), "{error}");
    next(&mut page);
    let error = quokka.ask("answer", answer(1, "clonus")).unwrap_err();
    assert!(error.contains("this answer is to knee 1"), "{error}");
    let answers = page.message("lesson")["answers"].as_array();
    assert_eq!(answers.unwrap().len(), 2);
    // After a reload the phone goes on; once the teacher has freed the seat, another one has it.
    drop(quokka);
    let (mut quokka, _) = panel.joined("Quokka", Some(&key));
    quokka.until("the old answer", |phone| {
        own(phone)["answers"][0]["disorder"] == "clonus"
    });
    page.ask("free-seat", json!({ "student": "Quokka" }))
        .unwrap();
    quokka.until("the loss", |phone| phone.message("own").is_null());
    let error = quokka.ask("answer", answer(2, "clonus")).unwrap_err();
    assert!(error.contains("join the class first"), "{error}");
    thief.ask("join", json!({ "name": "Quokka" })).unwrap();
    let seat = json!({ "name": "Quokka", "key": key });
    assert!(quokka.ask("join", seat).is_err());
}

/// A student who comes later takes part from the next knee on.
#[test]
fn who_comes_later_waits_for_the_next_knee() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("class", json!({ "open": true })).unwrap();
    begin(&mut page, &["Numbat"]);
    let (mut late, _) = panel.joined("Wombat", None);
    assert!(own(&late).is_null());
    let error = late.ask("answer", answer(1, "clonus")).unwrap_err();
    assert!(error.contains("from the next knee on"), "{error}");
    next(&mut page);
    late.until("the trial", |phone| own(phone)["takes_answer"] == true);
    late.ask("answer", answer(2, "clonus")).unwrap();
    page.until("the answer", |page| {
        page.message("lesson")["answers"][0]["student"] == "Wombat"
    });
    let students = &page.message("lesson")["students"];
    assert_eq!(students, &json!(["Numbat", "Wombat"]));
}
