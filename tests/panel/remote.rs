//! The teacher's own phone: it runs the lesson of the page in control, and sees what no other page may.

use crate::page::{Page, Panel};
use crate::support::names;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Has the page read what has come, so that its request is not late, and asks.
fn ask(page: &mut Page, what: &str, more: Value) -> Result<Value, String> {
    page.go_on(Duration::from_millis(100));
    page.ask(what, more)
}

/// Preset of the first trial, from the session's file.
fn first_knee(sessions: &Path) -> String {
    let folder = sessions.join(&names(sessions)[0]);
    let text = fs::read_to_string(folder.join("session.json")).unwrap();
    let session: Value = serde_json::from_str(&text).unwrap();
    let place = usize::try_from(session["order"][0].as_u64().unwrap()).unwrap();
    session["knees"][place]["preset"]
        .as_str()
        .unwrap()
        .to_owned()
}

#[test]
fn the_remote_steps_while_a_page_controls() {
    let panel = Panel::new(&crate::SIM);
    let mut page = panel.teacher_page();
    let mut remote = panel.remote_page();
    for (what, more) in [
        ("take", json!({})),
        ("arm", json!({})),
        ("disarm", json!({})),
        ("apply", json!({ "preset": "coarse" })),
        ("lesson-begin", json!({ "students": [] })),
        ("lesson-end", json!({})),
        ("class", json!({ "open": true })),
        ("recordings", json!({})),
        ("join", json!({ "name": "Quokka" })),
    ] {
        let error = remote.ask(what, more).unwrap_err();
        assert!(error.contains("the remote cannot"), "{what}: {error}");
    }
    let worse = json!({ "worse": true });
    let error = ask(&mut remote, "severity", worse.clone()).unwrap_err();
    assert!(error.contains("no page has control"), "{error}");
    ask(&mut page, "take", json!({})).unwrap();
    ask(&mut page, "apply", json!({ "preset": "healthy" })).unwrap();
    let error = ask(&mut remote, "severity", worse.clone()).unwrap_err();
    assert!(error.contains("choose a disorder"), "{error}");
    ask(&mut page, "apply", json!({ "preset": "mas-2-catch" })).unwrap();
    ask(&mut remote, "severity", worse.clone()).unwrap();
    let shows = |page: &Page, preset: &str| page.message("parameters")["preset"] == preset;
    page.until("the worse one", |page| shows(page, "mas-3-catch"));
    remote.until("its name", |page| {
        page.message("knee")["now"]["preset"] == "mas-3-catch"
    });
    ask(&mut remote, "severity", json!({ "worse": false })).unwrap();
    page.until("the milder one", |page| shows(page, "mas-2-catch"));
    ask(&mut page, "apply", json!({ "preset": "mas-4-lead-pipe" })).unwrap();
    let error = ask(&mut remote, "severity", worse).unwrap_err();
    assert!(error.contains("no worse form"), "{error}");
    remote.ask("note", json!({ "text": "from afar" })).unwrap();
    page.until("the note", |page| {
        page.notes.iter().any(|note| note["text"] == "from afar")
    });
    page.arm();
    remote.ask("stop", json!({})).unwrap();
    page.until_state("disarmed");
    page.until("who it was", |page| {
        page.status("torque_end")["cause"] == "stop-remote"
    });
}

#[test]
fn in_a_blind_trial_the_remote_sees_the_knee_and_a_wall_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let mut page = panel.controlling();
    let mut viewer = panel.viewer_page();
    let mut remote = panel.remote_page();
    let lesson = json!({ "lesson": "blind-six", "students": ["A"], "seed": 7 });
    ask(&mut page, "lesson-begin", lesson).unwrap();
    let truth = first_knee(folder.path());
    remote.until("the knee to come", |page| {
        page.message("knee")["next"]["preset"] == truth
    });
    viewer.history.clear();
    page.history.clear();
    ask(&mut remote, "lesson-start", json!({})).unwrap();
    remote.until("the knee", |page| {
        page.message("knee")["now"]["preset"] == truth && page.message("knee")["next"].is_null()
    });
    for other in [&mut page, &mut viewer] {
        other.until("the trial", |page| page.message("lesson")["began"] == true);
        other.go_on(Duration::from_millis(200));
        assert!(other.message("lesson")["knee"].is_null());
        assert_eq!(other.message("parameters"), &json!({ "hidden": true }));
        assert_eq!(other.frames.last().unwrap().masks, 3);
        assert!(!other.latest.contains_key("knee"));
        // Nor for an instant; a healthy knee is among the choices.
        for message in &other.history {
            let is_told = message.to_string().contains(&format!("\"{truth}\""));
            assert!(!is_told || truth == "healthy", "{message}");
        }
    }
    assert!(viewer.message("lesson")["seed"].is_null());
    assert_eq!(page.message("lesson")["seed"], 7);
    let error = ask(&mut remote, "severity", json!({ "worse": true })).unwrap_err();
    assert!(error.contains("blind trial"), "{error}");
    ask(&mut remote, "lesson-next", json!({})).unwrap();
    ask(&mut page, "release", json!({})).unwrap();
    let error = ask(&mut remote, "lesson-start", json!({})).unwrap_err();
    assert!(error.contains("no page has control"), "{error}");
}
