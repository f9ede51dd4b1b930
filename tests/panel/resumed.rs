//! A lesson whose program is killed while it stores answers, and that goes on from its folder.

use crate::page::{Page, Panel};
use crate::support::names;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

const STUDENTS: [&str; 2] = ["Quokka", "Wombat"];

/// Answers that are given in turn.
const ANSWERS: [&str; 4] = ["clonus", "texture", "crepitus", "cogwheel"];

/// The stored answers to the first knee, by student.
fn stored(folder: &Path) -> HashMap<String, String> {
    let text = fs::read_to_string(folder.join("session.json")).unwrap();
    let session: Value = serde_json::from_str(&text).expect("a whole session");
    let answers = session["answers"].as_array().unwrap().iter();
    let named = |value: &Value| value.as_str().unwrap().to_owned();
    answers
        .map(|answer| (named(&answer["student"]), named(&answer["disorder"])))
        .collect()
}

fn answer(disorder: &str) -> Value {
    json!({ "trial": 1, "disorder": disorder, "confidence": 3 })
}

/// Begins the lesson, or continues it.
fn hold(page: &mut Page, is_first: bool) {
    if is_first {
        page.ask("class", json!({ "open": true })).unwrap();
        return;
    }
    let lessons = page.ask("lessons", json!({})).unwrap()["lessons"].clone();
    assert_eq!(lessons.as_array().unwrap().len(), 1, "{lessons}");
    assert_eq!(lessons[0]["trial"], 1);
    let folder = lessons[0]["folder"].clone();
    for wrong in ["..", "no-such-lesson", "/etc"] {
        let wrong = json!({ "folder": wrong });
        assert!(page.ask("lesson-resume", wrong).is_err());
    }
    let folder = json!({ "folder": folder });
    page.ask("lesson-resume", folder.clone()).unwrap();
    page.until("the lesson", |page| {
        page.message("lesson")["began"] == false
    });
    let twice = page.ask("lesson-resume", folder);
    assert!(twice.unwrap_err().contains("a lesson is running"));
}

/// Every file is whole, every confirmed answer is there, and a phone has its seat again.
#[test]
fn a_killed_lesson_goes_on_and_no_answer_is_lost() {
    let sessions = tempfile::tempdir().unwrap();
    let path = sessions.path().to_str().unwrap();
    let mut keys: [Option<String>; 2] = [None, None];
    let mut confirmed: HashMap<String, String> = HashMap::new();
    for round in 0..4 {
        let mut panel = Panel::new(&["--device", "sim", "--sessions", path]);
        let mut page = panel.controlling();
        hold(&mut page, round == 0);
        let mut phones = Vec::new();
        for (name, key) in STUDENTS.iter().zip(&mut keys) {
            let (phone, own) = panel.joined(name, key.as_deref());
            assert!(key.as_ref().is_none_or(|key| *key == own));
            *key = Some(own);
            phones.push(phone);
        }
        page.go_on(Duration::from_millis(100));
        if round == 0 {
            // A third one never answers, so that the knee stays hidden.
            let lesson = json!({ "lesson": "blind-six", "students": ["Numbat"], "seed": 7 });
            page.ask("lesson-begin", lesson).unwrap();
        }
        let folder = sessions.path().join(&names(sessions.path())[0]);
        for (student, disorder) in &confirmed {
            assert_eq!(stored(&folder).get(student), Some(disorder));
        }
        page.ask("lesson-start", json!({})).unwrap();
        for nth in 0..5 {
            for (name, phone) in STUDENTS.iter().zip(&mut phones) {
                let disorder = ANSWERS[(nth + round) % ANSWERS.len()];
                phone.ask("answer", answer(disorder)).unwrap();
                confirmed.insert((*name).to_owned(), disorder.to_owned());
                // A reply is sent after the disk has it.
                assert_eq!(stored(&folder)[*name], disorder);
            }
        }
        // One more of each, which nobody confirms: the program is killed while it stores them.
        for (id, phone) in (900..).zip(&mut phones) {
            let mut last = answer("rigidity");
            last["id"] = json!(id);
            last["do"] = json!("answer");
            phone.send(&last.to_string());
        }
        std::thread::sleep(Duration::from_millis(2 * u64::try_from(round).unwrap()));
        panel.child.kill().unwrap();
        panel.child.wait().unwrap();
        let left = stored(&folder);
        for name in STUDENTS {
            let is_one = left[name] == confirmed[name] || left[name] == "rigidity";
            assert!(is_one, "{left:?}, confirmed {confirmed:?}");
            confirmed.insert(name.to_owned(), left[name].clone());
        }
    }
    ends_in_order(sessions.path(), &confirmed);
}

/// The last program ends the lesson: tables are whole, and nothing is left of phones and programs that are gone.
fn ends_in_order(sessions: &Path, confirmed: &HashMap<String, String>) {
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions.to_str().unwrap()]);
    let mut page = panel.controlling();
    hold(&mut page, false);
    let folder = sessions.join(&names(sessions)[0]);
    assert!(names(&folder).contains(&"class.json".to_owned()));
    // Its recordings tell the knee: not even those of the programs that were killed can be opened.
    let files = page.ask("recordings", json!({})).unwrap()["files"].clone();
    assert!(files.as_array().unwrap().len() >= 2, "{files}");
    for file in files.as_array().unwrap() {
        let lesson = &file["lesson"];
        assert!(lesson["trial"] == 1 && lesson["knee"].is_null(), "{file}");
        let opened = page.ask("open", json!({ "recording": file["id"] }));
        assert!(opened.unwrap_err().contains("blind lesson"));
    }
    page.ask("lesson-end", json!({ "language": "en" })).unwrap();
    page.until("its end", |page| page.message("lesson")["ended"] == true);
    assert_eq!(&stored(&folder), confirmed);
    let table = fs::read_to_string(folder.join("answers.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + STUDENTS.len(), "{table}");
    let left = names(&folder);
    assert!(!left.contains(&"class.json".to_owned()), "{left:?}");
    let is_second = |name: &String| name.starts_with("trial-01-2.");
    assert!(left.iter().any(is_second), "{left:?}");
    let lessons = page.ask("lessons", json!({})).unwrap();
    assert_eq!(lessons, json!({ "lessons": [] }));
    let files = page.ask("recordings", json!({})).unwrap()["files"].clone();
    let lesson = &files[0]["lesson"];
    assert!(lesson["knee"].is_object(), "{files}");
    assert_eq!(lesson["answers"].as_array().unwrap().len(), STUDENTS.len());
    assert!(panel.end().success());
}
