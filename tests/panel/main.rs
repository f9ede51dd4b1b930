//! `crepitus panel`, through its WebSocket: who may do what, when torque ends, what a blind
//! trial hides. The page itself is tested in a browser: `tools/panel-browser`.
#![cfg(target_os = "linux")]

mod access;
mod class;
mod devices;
mod experiments;
mod hand;
mod lessons;
#[path = "../support/panel.rs"]
mod page;
mod recordings;
mod remote;
mod resumed;
#[path = "../support/mod.rs"]
mod support;
#[path = "../support/tunnel.rs"]
mod tunnel;

use page::{Page, Panel};
use serde_json::json;
use std::time::{Duration, Instant};
use support::{run, stderr};
use tunnel::Tunnel;

const SIM: [&str; 2] = ["--device", "sim"];

#[test]
fn one_page_controls_and_every_page_stops() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut second = panel.teacher_page();
    let mut first = panel.controlling();
    for what in [
        "arm",
        "zero",
        "take",
        "note",
        "recordings",
        "report",
        "release",
    ] {
        let error = viewer.ask(what, json!({ "text": "a" })).unwrap_err();
        assert!(error.contains("looking on"), "{what}: {error}");
    }
    for what in ["arm", "disarm", "save", "lesson-start"] {
        let error = second.ask(what, json!({})).unwrap_err();
        assert!(error.contains("take control first"), "{what}: {error}");
    }
    first.arm();
    viewer.ask("stop", json!({})).unwrap();
    first.until_state("disarmed");
    // What another page has armed is not inherited.
    first.arm();
    second.ask("take", json!({})).unwrap();
    second.until_state("disarmed");
    first.until("its loss", |page| page.latest["holder"]["yours"] == false);
    assert!(first.ask("arm", json!({})).is_err());
    second.arm();
    second.ask("release", json!({})).unwrap();
    second.until_state("disarmed");
    assert!(panel.end().success());
}

/// Time until a page sees that torque is off.
fn until_off(viewer: &mut Page) -> Duration {
    let begun = Instant::now();
    viewer.until("disarmed", |page| page.status("state") != "armed");
    begun.elapsed()
}

/// Returns whether torque ended because no answer came, and not because the page was gone.
fn by_watchdog(viewer: &Page) -> bool {
    let why = viewer.status("message").as_str().unwrap_or_default();
    why.contains("has not answered for 200 ms")
}

#[test]
fn torque_ends_with_the_page() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    // Other tests run beside this one: the best of a few tries is what the panel does.
    let most = Duration::from_millis(300);
    let closed = (0..5).any(|_| {
        let mut page = panel.controlling();
        page.arm();
        viewer.until_state("armed");
        drop(page);
        let took = until_off(&mut viewer);
        let is_late = by_watchdog(&viewer);
        viewer.until("no holder", |page| page.latest["holder"]["taken"] == false);
        took < most && !is_late
    });
    assert!(closed, "later than after {most:?}, or by the watchdog");
    // Hanging: it answers no frame.
    let mut page = panel.controlling();
    page.arm();
    viewer.until_state("armed");
    page.answers = false;
    let took = until_off(&mut viewer);
    assert!(took > Duration::from_millis(100), "{took:?}");
    assert!(took < Duration::from_millis(600), "{took:?}");
    let why = viewer.status("message").as_str().unwrap();
    assert!(why.contains("has not answered for 200 ms"), "{why}");
    // It has control still, and arms again once it has answered.
    page.answers = true;
    page.go_on(Duration::from_millis(300));
    page.ask("take", json!({})).unwrap();
    page.arm();
}

/// Through a tunnel that hangs, torque ends; what was ordered into it arrives late and is not
/// carried out, but a stop is.
#[test]
fn an_order_that_a_tunnel_has_delayed_is_rejected() {
    let panel = Panel::new(&SIM);
    let tunnel = Tunnel::to(&panel.host);
    let mut viewer = panel.viewer_page();
    let (_, token) = panel.teacher.split_once('#').unwrap();
    let mut page = Page::through(&tunnel.host, &panel.host, token);
    page.until("its first frame", |page| page.newest().is_some());
    page.ask("take", json!({})).unwrap();
    page.arm();
    viewer.until_state("armed");
    tunnel.hang(true);
    let took = until_off(&mut viewer);
    assert!(took < Duration::from_millis(600), "{took:?}");
    let cause = &viewer.status("torque_end")["cause"];
    assert_eq!(cause, "watchdog");
    let newest = page.newest();
    for (id, what) in [(901, "arm"), (902, "reset"), (903, "stop"), (904, "arm")] {
        page.send(&json!({ "id": id, "do": what, "newest": newest }).to_string());
    }
    viewer.go_on(Duration::from_millis(1_500));
    tunnel.hang(false);
    for (id, is_done) in [(901, false), (902, false), (903, true), (904, false)] {
        let reply = page.reply(id);
        let error = reply["error"].as_str().unwrap_or_default();
        assert_eq!(error.contains("s late"), !is_done, "{id}: {reply}");
    }
    viewer.go_on(Duration::from_millis(300));
    assert_eq!(viewer.status("state"), "disarmed");
    // When the connection is back, so is the page.
    page.go_on(Duration::from_millis(300));
    page.arm();
}

#[test]
fn nothing_that_a_page_sends_breaks_it() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    for text in [
        r#"{"id":900,"do":"explode"}"#,
        r#"{"id":901,"do":"set","changes":[[0,"a"]]}"#,
        r#"{"id":902,"do":"target","target":{"low_deg_per_s":-1}}"#,
        r#"{"id":903,"do":"trace","recording":9,"from_s":0,"to_s":1,"points":9}"#,
    ] {
        page.send(text);
    }
    page.go_on(Duration::from_millis(100));
    assert!(!page.is_closed);
    let error = page
        .ask("apply", json!({ "preset": "../../etc/passwd" }))
        .unwrap_err();
    assert!(error.contains("there is no preset"), "{error}");
    let error = page
        .ask("set", json!({ "changes": [[6, 1e9]] }))
        .unwrap_err();
    assert!(error.contains("encoder"), "{error}");
    assert!(
        page.ask("record", json!({ "running": true, "name": "a" }))
            .is_err()
    );
    assert!(
        page.ask("note", json!({ "text": "x".repeat(501) }))
            .is_err()
    );
    // What is no message of a page ends it, and its control. Other tests run beside this one:
    // in one of a few tries the watchdog is not sooner.
    let at_once = (0..5).any(|_| {
        let mut page = panel.controlling();
        page.arm();
        page.send("nonsense");
        page.until("its close", |page| page.is_closed);
        let mut viewer = panel.viewer_page();
        until_off(&mut viewer);
        !by_watchdog(&viewer)
    });
    assert!(at_once, "torque waits for the watchdog");
    let mut viewer = panel.viewer_page();
    // Neither does one that is too long, whatever it says: shorter, it would only be rejected.
    let mut page = panel.teacher_page();
    let note = json!({ "id": 904, "do": "note", "text": "x".repeat(100_000) });
    page.send(&note.to_string());
    page.until("its close", |page| page.is_closed);
    viewer.go_on(Duration::from_millis(100));
    assert!(!viewer.is_closed);
}

#[test]
fn changes_are_one_commit_and_presets_are_kept() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.until("parameters", |page| page.latest.contains_key("parameters"));
    let revision = |page: &Page| page.latest["parameters"]["revision"].as_u64().unwrap();
    let value = |page: &Page, name: &str| {
        let table = page.latest["hello"]["parameters"].as_array().unwrap();
        let id = &table.iter().find(|p| p["name"] == name).unwrap()["id"];
        let values = page.latest["parameters"]["values"].as_array().unwrap();
        values.iter().find(|v| v[0] == *id).unwrap()[1]
            .as_f64()
            .unwrap()
    };
    let before = revision(&page);
    page.ask("apply", json!({ "preset": "mas-2-catch" }))
        .unwrap();
    page.until("the preset", |page| {
        page.latest["parameters"]["preset"] == "mas-2-catch"
    });
    assert_eq!(revision(&page), before + 1);
    assert_eq!(value(&page, "spasticity.threshold_deg"), 75.0);
    assert_eq!(value(&page, "crepitus.render"), 0.0);
    let id = |name: &str| {
        let table = page.latest["hello"]["parameters"].as_array().unwrap();
        table.iter().find(|p| p["name"] == name).unwrap()["id"].clone()
    };
    let changes = json!([
        [id("spasticity.threshold_deg"), 60],
        [id("crepitus.render"), 1]
    ]);
    page.ask("set", json!({ "changes": changes })).unwrap();
    page.until("both", |page| {
        value(page, "spasticity.threshold_deg") == 60.0 && value(page, "crepitus.render") == 1.0
    });
    assert_eq!(revision(&page), before + 2);
    assert!(page.latest["parameters"]["preset"].is_null());
    let save = json!({ "name": "monday-knee", "title": "Monday", "disorder": "spasticity" });
    page.ask("save-preset", save.clone()).unwrap();
    page.until("its name", |page| {
        page.latest["parameters"]["preset"] == "monday-knee"
    });
    let own = |page: &Page| {
        let presets = page.latest["presets"].as_array().unwrap();
        presets
            .iter()
            .any(|preset| preset["name"] == "monday-knee" && preset["own"] == true)
    };
    page.until("the preset", own);
    assert!(
        page.ask("save-preset", save)
            .unwrap_err()
            .contains("exists")
    );
    let bad = json!({ "name": "../x" });
    assert!(
        page.ask("save-preset", bad)
            .unwrap_err()
            .contains("invalid name")
    );
    page.ask("apply", json!({ "preset": "healthy" })).unwrap();
    page.until("a healthy knee", |page| {
        value(page, "crepitus.render") == 0.0
    });
    page.ask("apply", json!({ "preset": "monday-knee" }))
        .unwrap();
    page.until("it again", |page| {
        value(page, "spasticity.threshold_deg") == 60.0
    });
    page.ask("reset", json!({})).unwrap();
    page.until("defaults", |page| value(page, "spasticity.render") == 0.0);
    assert_eq!(page.latest["parameters"]["preset"], "coarse");
}

/// Nothing resists there: the page says that it hurts.
#[test]
fn an_empty_end_hurts_where_it_is_crossed() {
    const HURTS: u32 = 1 << 8;
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("apply", json!({ "preset": "end-feel-empty" }))
        .unwrap();
    let table = page.latest["hello"]["parameters"].as_array().unwrap();
    let limit = table
        .iter()
        .find(|p| p["name"] == "range-limit.flexion_limit_deg");
    let changes = json!([[limit.unwrap()["id"], 60]]);
    page.ask("set", json!({ "changes": changes })).unwrap();
    page.arm();
    page.frames.clear();
    // A stroke to 80° and back takes four seconds.
    page.go_on(Duration::from_secs(5));
    let bins = (page.frames.iter()).flat_map(|frame| (0..frame.bins).map(move |bin| (frame, bin)));
    let (mut beyond, mut before) = (0, 0);
    for (frame, bin) in bins {
        let hurts = frame.marks(bin) & HURTS != 0;
        let [low_deg, high_deg] = [6, 7].map(|place| frame.value(bin, place).to_degrees());
        if low_deg > 61.0 {
            beyond += 1;
            assert!(hurts, "at {low_deg}°");
        } else if low_deg > 15.0 && high_deg < 59.0 {
            before += 1;
            assert!(!hurts, "at {low_deg}°");
        }
    }
    assert!(beyond > 50 && before > 50, "{beyond} and {before} bins");
}

#[test]
fn frames_join_and_all_samples_are_accounted_for() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.arm();
    // The leg is led to its motion at first.
    page.go_on(Duration::from_secs(6));
    let frames = &page.frames;
    assert!(frames.len() > 120, "{} frames in 6 s", frames.len());
    let with_bins: Vec<_> = frames.iter().filter(|frame| frame.bins > 0).collect();
    for pair in with_bins.windows(2) {
        let end_s = pair[0].begin_s + f64::from(pair[0].bins) * pair[0].bin_s;
        assert!((pair[1].begin_s - end_s).abs() < 1e-9);
    }
    // The torque is shown, and below its limit.
    let torques = with_bins
        .iter()
        .flat_map(|frame| (0..frame.bins).map(|bin| frame.value(bin, 1)));
    let highest = torques.fold(0.0, f32::max);
    assert!((0.2..1.0).contains(&highest), "{highest}");
    let count = |key: &str| page.status(key).as_u64().unwrap();
    assert!(count("produced") > 20_000);
    assert_eq!(
        count("produced"),
        count("received") + count("dropped") + count("lost")
    );
    assert_eq!(count("dropped") + count("lost"), 0);
}

#[test]
fn a_simulated_examiner_is_measured_and_not_scored() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("target", json!({ "target": "medium" })).unwrap();
    page.ask("score", json!({ "running": true })).unwrap();
    page.arm();
    // From straight to 80°.
    page.until("a stroke", |page| {
        page.latest["examination"]["measures"][0].as_f64() > Some(75.0)
    });
    page.ask("score", json!({ "running": false })).unwrap();
    let target = &page.latest["target"];
    assert_eq!(target["by_person"], false);
    assert_eq!(target["strokes"], 0);
    assert_eq!(target["seconds"], 0.0);
    assert!(target["score"].is_null() && target["share_slow"].is_null());
    let examination = &page.latest["examination"];
    assert_eq!(examination["by_person"], false);
    assert_eq!(examination["findings"][0]["outcome"], "shown");
    // Another one begins with nothing.
    page.ask("examine", json!({})).unwrap();
    page.until("another examination", |page| {
        page.latest["examination"]["measures"][0].as_f64() < Some(60.0)
    });
    for bad in [
        json!("quick"),
        json!({ "low_deg_per_s": 50, "high_deg_per_s": 40 }),
    ] {
        assert!(page.ask("target", json!({ "target": bad })).is_err());
    }
    page.ask("target", json!({ "target": null })).unwrap();
    assert!(page.ask("score", json!({ "running": true })).is_err());
}

#[test]
fn what_cannot_start_says_why() {
    let panel = Panel::new(&SIM);
    let port = panel.host.split_once(':').unwrap().1;
    for (arguments, expected) in [
        (
            vec!["panel", "--device", "sim", "--port", port],
            "choose another one with --port",
        ),
        (vec!["panel", "--replay", "no-such-file"], "cannot be read"),
        (vec!["panel", "--device", "nobody"], "unknown device"),
        (vec!["panel", "--replay", "Cargo.toml"], "not a recording"),
        (
            vec!["panel", "--device", "sim", "--sessions", "Cargo.toml"],
            "--sessions: cannot store anything there",
        ),
        (
            vec!["panel", "--device", "sim", "--experiments", "Cargo.toml"],
            "crepitus experiment new threshold",
        ),
        (
            vec!["panel", "--device", "sim", "--sessions", "/dev/full"],
            "--sessions: cannot store anything there",
        ),
        #[cfg(target_os = "linux")]
        (
            vec!["panel", "--device", "sim", "--sessions", "/sys/kernel"],
            "--sessions: cannot store anything there",
        ),
        (
            vec!["panel", "--device", "sim", "--lan", "192.0.2.1"],
            "this computer has no such address",
        ),
        (
            vec!["panel", "--replay", "a", "--device", "sim"],
            "cannot be used with",
        ),
        (
            vec!["panel", "--device", "sim", "--lan", "nowhere"],
            "invalid IP address",
        ),
    ] {
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}
