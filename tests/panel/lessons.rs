//! Lessons: what a blind trial hides, what is stored, which answers count.

use crate::page::{Page, Panel};
use crate::support::names;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Answers the current trial rightly, as a page cannot: from the session's file.
fn truth(folder: &Path, trial: usize) -> (String, Value) {
    let text = fs::read_to_string(folder.join("session.json")).unwrap();
    let session: Value = serde_json::from_str(&text).unwrap();
    let place = session["order"][trial - 1].as_u64().unwrap();
    let knee = &session["knees"][usize::try_from(place).unwrap()];
    (
        knee["disorder"].as_str().unwrap().to_owned(),
        knee["level"].clone(),
    )
}

#[test]
fn a_blind_lesson_hides_the_knee_until_it_was_named() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let mut viewer = panel.viewer_page();
    let mut page = panel.controlling();
    page.arm();
    let begin = json!({ "lesson": "blind-six", "students": ["A", "B"], "seed": 7 });
    assert_eq!(page.ask("lesson-begin", begin).unwrap()["seed"], 7);
    let session = folder.path().join(&names(folder.path())[0]);
    for trial in 1..=6 {
        // What was revealed of the trial before.
        viewer.go_on(Duration::from_millis(50));
        viewer.history.clear();
        page.ask("lesson-start", json!({})).unwrap();
        for page in [&mut page, &mut viewer] {
            page.until("the trial", |page| {
                let lesson = &page.latest["lesson"];
                lesson["trial"] == trial && lesson["began"] == true
            });
            page.until("nothing", |page| {
                page.latest["parameters"]["hidden"] == true
            });
            page.frames.clear();
            page.go_on(Duration::from_millis(300));
            assert_eq!(page.latest["lesson"]["knee"], Value::Null);
            assert_eq!(page.latest["parameters"], json!({ "hidden": true }));
            for frame in page.frames.iter().filter(|frame| frame.bins > 0) {
                assert_eq!(frame.masks, 3);
                for bin in 0..frame.bins {
                    assert!((0..4).all(|place| frame.value(bin, place).is_nan()));
                    assert_eq!(frame.states(bin), 0);
                    assert!(frame.value(bin, 6).is_finite(), "the angle is shown");
                }
            }
        }
        // Nor was it shown for an instant, while the device got it.
        let shown = viewer
            .history
            .iter()
            .filter(|message| message["parameters"].is_object());
        for message in shown {
            assert_eq!(message["parameters"], json!({ "hidden": true }));
        }
        let files = page.ask("recordings", json!({})).unwrap()["files"].clone();
        let id = files[0]["id"].clone();
        let error = page.ask("open", json!({ "recording": id })).unwrap_err();
        assert!(error.contains("blind lesson"), "{error}");
        assert!(page.ask("apply", json!({ "preset": "healthy" })).is_err());
        assert!(page.ask("set", json!({ "changes": [] })).is_err());
        // The page in control did not answer while the other one was looked at.
        page.arm();
        page.go_on(Duration::from_millis(700));
        let (disorder, level) = truth(&session, trial);
        page.ask("note", json!({ "text": format!("note of {trial}") }))
            .unwrap();
        let right =
            json!({ "student": "A", "disorder": disorder, "level": level, "confidence": 4 });
        page.ask("lesson-answer", right).unwrap();
        page.go_on(Duration::from_millis(50));
        // B has not answered yet.
        assert_eq!(page.latest["lesson"]["knee"], Value::Null);
        let guess = json!({ "student": "B", "disorder": "healthy", "confidence": 1 });
        page.ask("lesson-answer", guess).unwrap();
        page.until("the knee", |page| !page.latest["lesson"]["knee"].is_null());
        page.until("parameters", |page| {
            page.latest["parameters"]["hidden"].is_null()
        });
        let what = if trial < 6 {
            "lesson-next"
        } else {
            "lesson-end"
        };
        page.ask(what, json!({ "language": "de" })).unwrap();
    }
    page.until("its end", |page| page.latest["lesson"]["ended"] == true);
    let summary = page.latest["lesson"]["summary"].clone();
    assert_eq!(summary["students"][0]["right"], 6);
    assert_eq!(summary["students"][0]["kappa"]["value"], 1.0);
    has_its_report(&panel, &mut page, &session);
    has_its_recordings(&mut page, &session);
    assert!(panel.end().success());
    let again = names(&session);
    assert!(!again.iter().any(|name| name.starts_with('.')), "{again:?}");
}

/// Once, and as a file.
fn has_its_report(panel: &Panel, page: &mut Page, session: &Path) {
    let path = page.ask("report", json!({})).unwrap()["path"].clone();
    let path = path.as_str().unwrap();
    let html = panel.get(path, &[]);
    assert!(html.starts_with("HTTP/1.1 200"), "{html}");
    assert!(html.contains("kappa") && !html.contains("<script"));
    assert_eq!(panel.status(path, &[]), 404);
    let german = fs::read_to_string(session.join("report.html")).unwrap();
    assert!(german.contains("Kappa"), "{german}");
}

/// One a trial, with names that tell nothing.
fn has_its_recordings(page: &mut Page, session: &Path) {
    page.ask("lesson-close", json!({})).unwrap();
    let files = names(session);
    let trials: Vec<_> = files
        .iter()
        .filter(|name| name.starts_with("trial-0"))
        .collect();
    assert_eq!(trials.len(), 6, "{files:?}");
    let listed = page.ask("recordings", json!({})).unwrap();
    let listed = listed["files"].as_array().unwrap();
    assert_eq!(listed.len(), 6);
    // A note stands in the recording of its trial, after the time in which it was looked at.
    let fourth = listed
        .iter()
        .find(|file| file["name"].as_str().unwrap().contains("trial-04"));
    let opened = page
        .ask("open", json!({ "recording": fourth.unwrap()["id"] }))
        .unwrap();
    assert_eq!(opened["notes"].as_array().unwrap().len(), 1, "{opened}");
    assert_eq!(opened["notes"][0]["text"], "note of 4");
    let after_s = opened["notes"][0]["time_s"].as_f64().unwrap();
    assert!((0.5..5.0).contains(&after_s), "{after_s}");
}

#[test]
fn answers_without_torque_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let mut page = panel.controlling();
    let begin = json!({ "lesson": "blind-six", "students": ["A"], "seed": 7 });
    page.ask("lesson-begin", begin).unwrap();
    let session = folder.path().join(&names(folder.path())[0]);
    for trial in 1..=3 {
        page.ask("lesson-start", json!({})).unwrap();
        match trial {
            1 => {}
            2 => page.arm(),
            // Of the time that the motor is driven, less than half.
            _ => {
                page.ask("disarm", json!({})).unwrap();
                page.go_on(Duration::from_millis(700));
                page.arm();
            }
        }
        page.go_on(Duration::from_millis(if trial == 3 { 200 } else { 1500 }));
        let (disorder, level) = truth(&session, trial);
        let answer =
            json!({ "student": "A", "disorder": disorder, "level": level, "confidence": 4 });
        page.ask("lesson-answer", answer).unwrap();
        page.ask("lesson-next", json!({})).unwrap();
    }
    let ended = page.ask("lesson-end", json!({ "language": "en" })).unwrap();
    page.until("results", |page| {
        !page.latest["lesson"]["summary"].is_null()
    });
    let lesson = &page.latest["lesson"];
    let of = |name: &str| [0, 1, 2].map(|at: usize| lesson["answers"][at][name].clone());
    assert_eq!(of("counts"), [false, true, false].map(Value::from));
    assert_eq!(of("torque_share")[0], 0.0);
    let all = &lesson["summary"]["all"];
    assert_eq!((&all["answers"], &all["right"]), (&json!(1), &json!(1)));
    assert_eq!(all["without_torque"], 2);
    // The same in every file.
    let stored: Value =
        serde_json::from_str(&fs::read_to_string(session.join("session.json")).unwrap()).unwrap();
    for (answer, share) in stored["answers"]
        .as_array()
        .unwrap()
        .iter()
        .zip(of("torque_share"))
    {
        assert_eq!(answer["torque_share"], share);
    }
    let table = fs::read_to_string(session.join("answers.csv")).unwrap();
    let counts: Vec<_> = table
        .lines()
        .map(|line| line.rsplit(',').next().unwrap())
        .collect();
    assert_eq!(counts, ["counts", "false", "true", "false"]);
    let report = fs::read_to_string(ended["report"].as_str().unwrap()).unwrap();
    assert!(report.contains("left out: the motor was on for 0 % of the time"));
}
