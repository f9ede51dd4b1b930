//! Devices that another program has armed or serves, and programs that are killed.

use crate::page::Panel;
use crate::support::served::{Served, signal};
use crate::support::stderr;
use serde_json::json;
use std::time::Duration;

/// As a double-click opens it.
#[test]
fn without_a_brace_there_is_a_simulated_knee() {
    let nothing = tempfile::tempdir().unwrap();
    let served = Served::new();
    for (runtime, is_simulated) in [(nothing.path(), true), (served.home.path(), false)] {
        let panel = Panel::at(&["--or-sim"], Some(runtime));
        let page = panel.teacher_page();
        assert_eq!(page.latest["hello"]["source"]["simulated"], is_simulated);
    }
}

#[test]
fn it_joins_a_device_that_another_program_has_armed() {
    let served = Served::new();
    let device = ["--device", "knee"];
    let first = Panel::at(&device, Some(served.home.path()));
    let mut page = first.controlling();
    page.ask("zero", json!({})).unwrap();
    page.arm();
    let second = Panel::at(&device, Some(served.home.path()));
    let mut other = second.controlling();
    other.until("the holder", |page| page.status("other").is_string());
    let holder = other.status("other").as_str().unwrap();
    assert!(holder.contains("crepitus panel"), "{holder}");
    let error = other.ask("arm", json!({})).unwrap_err();
    assert!(error.contains("has armed the device"), "{error}");
    other.ask("stop", json!({})).unwrap();
    page.until("disarmed", |page| page.status("state") != "armed");
    // The first one served the device: the other takes over.
    assert!(first.end().success());
    other.go_on(Duration::from_millis(500));
    other.frames.clear();
    other.until("frames", |page| {
        page.frames.iter().any(|frame| frame.bins > 0)
    });
}

#[test]
fn a_killed_panel_leaves_no_torque() {
    let served = Served::new();
    let device = ["--device", "knee"];
    let mut panel = Panel::at(&device, Some(served.home.path()));
    let mut page = panel.controlling();
    page.ask("zero", json!({})).unwrap();
    page.arm();
    panel.child.kill().unwrap();
    panel.child.wait().unwrap();
    page.until("its close", |page| page.is_closed);
    std::thread::sleep(Duration::from_millis(350));
    assert_ne!(served.info()["status"]["state"], "armed");
    // And one that is asked to end disarms by itself: no fault.
    let run = served.run(&["clear-fault", "--device", "knee"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let mut panel = Panel::at(&device, Some(served.home.path()));
    let mut page = panel.controlling();
    page.arm();
    signal(&panel.child, "-TERM");
    assert!(panel.child.wait().unwrap().success());
    assert_eq!(served.info()["status"]["state"], "disarmed");
}

#[test]
fn a_device_that_is_gone_is_said_and_found_again() {
    let served = Served::new();
    let panel = Panel::at(&["--device", "knee"], Some(served.home.path()));
    let mut page = panel.controlling();
    page.ask("zero", json!({})).unwrap();
    page.arm();
    let home = served.kill();
    page.until("the loss", |page| page.status("link") == "lost");
    let error = page.ask("arm", json!({})).unwrap_err();
    assert!(error.contains("not connected"), "{error}");
    // Frames go on, so that nobody takes the page for dead.
    page.frames.clear();
    page.until("frames", |page| page.frames.len() > 3);
    let _served = Served::at(home);
    page.until("the device", |page| page.status("link") == "connected");
    page.until("a state", |page| page.status("state") == "disarmed");
}
