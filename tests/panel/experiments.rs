//! Sessions of experiments: who may hold one, what no page sees, and what is on the disk when.

use crate::page::{Page, Panel};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::Duration;

const PROTOCOL: &str = "title = 'Difference of torque'\n[threshold]\nquantity = 'torque'\nreference = 1.0\n\
    [threshold.constant]\ndifferences = [0.31]\nrepeats = 4\n";

/// Steps of a session.
fn step(page: &mut Page, step: &str, mut more: Value) -> Result<Value, String> {
    more["step"] = json!(step);
    page.ask("experiment", more)
}

fn begin(page: &mut Page, participant: &str) -> Result<Value, String> {
    let more = json!({ "file": "torque.toml", "participant": participant });
    step(page, "begin", more)
}

/// Feels both intervals of a trial and chooses; where the page answers too late for the torque, again.
fn answer(page: &mut Page, trial: usize) {
    for _ in 0..20 {
        page.arm();
        let felt = page.message("experiment")["trial"]["felt"].clone();
        let next = felt
            .as_array()
            .unwrap()
            .iter()
            .position(|felt| felt == false);
        let done = match next {
            Some(place) => {
                let more = json!({ "trial": trial, "interval": place + 1 });
                step(page, "feel", more)
            }
            None => step(page, "choose", json!({ "trial": trial, "answer": 1 })),
        };
        page.go_on(Duration::from_millis(100));
        if done.is_ok() && next.is_none() {
            return;
        }
    }
    panic!("{:?}", page.message("experiment"));
}

/// Lines of the table of P01.
fn lines(folder: &Path) -> usize {
    let own = folder.join("study/P01/difference-of-torque-1/trials.csv");
    fs::read_to_string(own).unwrap().lines().count()
}

/// Returns whether nothing that a page got tells a level.
fn hides(page: &Page) -> bool {
    let of = |kind: &'static str| {
        page.history
            .iter()
            .filter_map(move |message| message.get(kind))
    };
    let is_blank = page
        .frames
        .iter()
        .filter(|frame| frame.bins > 0)
        .all(|frame| {
            frame.masks == 3
                && (0..frame.bins).all(|bin| (0..4).all(|place| frame.value(bin, place).is_nan()))
        });
    let told: String = of("experiment").map(ToString::to_string).collect();
    let secrets = [
        "0.31",
        "1.31",
        "lead-pipe",
        "difference\"",
        "comparison",
        "right",
    ];
    is_blank
        && of("parameters").all(|parameters| *parameters == json!({ "hidden": true }))
        && secrets.iter().all(|secret| !told.contains(secret))
}

#[test]
fn a_killed_session_goes_on_and_no_page_sees_a_level() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("torque.toml"), PROTOCOL).unwrap();
    let arguments = [
        "--device",
        "sim",
        "--experiments",
        folder.path().to_str().unwrap(),
    ];
    let mut answered = 0;
    for round in 0..2 {
        let mut panel = Panel::new(&arguments);
        let mut page = panel.controlling();
        let mut viewer = panel.viewer_page();
        let list = page.ask("experiments", json!({})).unwrap();
        assert_eq!(list["protocols"][0]["kind"], "2ifc", "{list}");
        assert_eq!(list["unfinished"].as_array().unwrap().len(), round);
        begin(&mut page, "P01").unwrap();
        for page in [&mut page, &mut viewer] {
            page.until("nothing", |page| {
                page.message("parameters")["hidden"] == true
            });
            page.go_on(Duration::from_millis(50));
            page.history.clear();
            page.frames.clear();
        }
        for _ in 0..2 {
            answered += 1;
            answer(&mut page, answered);
            // A reply is sent after the disk has it.
            assert_eq!(lines(folder.path()), 1 + answered);
        }
        viewer.go_on(Duration::from_millis(100));
        assert!(hides(&page) && hides(&viewer), "{:?}", page.history);
        assert!(viewer.message("experiment").is_null());
        panel.child.kill().unwrap();
        panel.child.wait().unwrap();
    }
    let panel = Panel::new(&arguments);
    let mut page = panel.teacher_page();
    let path = page.ask("experiment-results", json!({})).unwrap()["path"].clone();
    let html = panel.get(path.as_str().unwrap(), &[]);
    assert!(
        html.starts_with("HTTP/1.1 200") && html.contains("Difference of torque"),
        "{html}"
    );
    assert!(panel.end().success());
}

#[test]
fn a_teacher_in_control_holds_a_session_and_nobody_else() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("torque.toml"), PROTOCOL).unwrap();
    let panel = Panel::new(&[
        "--device",
        "sim",
        "--experiments",
        folder.path().to_str().unwrap(),
    ]);
    let mut page = panel.controlling();
    for other in [
        &mut panel.viewer_page(),
        &mut panel.student_page(),
        &mut panel.remote_page(),
    ] {
        for what in ["experiments", "experiment-results"] {
            assert!(other.ask(what, json!({})).is_err(), "{what}");
        }
        assert!(begin(other, "P01").is_err());
        assert!(!other.latest.contains_key("experiment"));
    }
    let error = begin(&mut panel.teacher_page(), "P01").unwrap_err();
    assert!(error.contains("take control first"), "{error}");
    for name in ["Anna", "", "../P01", "P 01"] {
        let error = begin(&mut page, name).unwrap_err();
        assert!(error.contains("such as P01"), "{error}");
    }
    let error = step(&mut page, "leave", json!({})).unwrap_err();
    assert!(error.contains("begin one first"), "{error}");
    let other = json!({ "file": "../torque.toml", "participant": "P01" });
    assert!(step(&mut page, "begin", other).is_err());
    // Without a folder there is nothing to begin.
    let plain = Panel::new(&["--device", "sim"]);
    let mut page = plain.controlling();
    for error in [
        page.ask("experiments", json!({})).unwrap_err(),
        begin(&mut page, "P01").unwrap_err(),
    ] {
        assert!(error.contains("--experiments FOLDER"), "{error}");
    }
}
