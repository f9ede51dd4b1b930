//! `crepitus panel`, through its WebSocket: who may do what, when torque ends, what a blind
//! trial hides. The page itself is tested in a browser: `tools/panel-browser`.
#![cfg(target_os = "linux")]

#[path = "support/panel.rs"]
mod page;
mod support;
#[path = "support/tunnel.rs"]
mod tunnel;

use page::{Page, Panel};
use serde_json::{Value, json};
use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};
use support::served::{Served, signal};
use support::{names, run, stderr};
use tunnel::Tunnel;

const SIM: [&str; 2] = ["--device", "sim"];

/// Checks that the page is closed and has received the reason and nothing else.
fn is_refused(page: &mut Page) {
    page.until("its close", |page| page.is_closed);
    assert_eq!(page.latest["refused"], "wrong-token");
    assert!(page.frames.is_empty() && !page.latest.contains_key("hello"));
}

#[test]
fn only_a_link_opens_it() {
    let panel = Panel::new(&SIM);
    for wrong in ["", "0123456789abcdef0123456789abcdef", &panel.teacher] {
        is_refused(&mut Page::open(&panel.host, Some(wrong)));
    }
    // A page that says nothing is disconnected.
    is_refused(&mut Page::open(&panel.host, None));
    let mut viewer = panel.viewer_page();
    assert_eq!(viewer.latest["hello"]["role"], "viewer");
    viewer.until("frames", |page| page.frames.len() > 10);
}

/// Connections without a token are closed within seconds, and hinder nobody.
#[test]
fn half_open_requests_are_closed_and_others_served() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let half = format!("GET / HTTP/1.1\r\nHost: {}\r\n", panel.host);
    let is_open = |stream: &TcpStream| {
        let read = (&mut &*stream).read(&mut [0; 64]);
        read.is_err_and(|error| error.kind() == ErrorKind::WouldBlock)
    };
    let mut open = Vec::new();
    for nth in 0..1000 {
        let mut stream = TcpStream::connect(&panel.host).unwrap();
        if nth % 2 == 0 {
            stream.write_all(half.as_bytes()).unwrap();
        }
        stream.set_nonblocking(true).unwrap();
        open.push(stream);
        if nth % 100 == 99 {
            viewer.go_on(Duration::from_millis(10));
            open.retain(is_open);
        }
    }
    // The newest make room for others at once.
    assert_eq!(panel.status("/", &[]), 200);
    assert!(open.len() < 1000, "none of them is closed early");
    let begun = Instant::now();
    while !open.is_empty() {
        viewer.go_on(Duration::from_millis(100));
        open.retain(is_open);
        assert!(begun.elapsed() < Duration::from_secs(8), "{}", open.len());
    }
    // A page with a token outlasts them all, and another one is let in.
    let frames = viewer.frames.len();
    viewer.until("frames", |page| page.frames.len() > frames + 10);
    panel.teacher_page();
}

#[test]
fn other_sites_names_and_origins_are_refused() {
    let panel = Panel::new(&SIM);
    let host = panel.host.clone();
    let own = format!("http://{host}");
    let port = host.split_once(':').unwrap().1;
    let upgrade = |origin: &str| {
        let headers = [
            ("Upgrade", "websocket"),
            ("Sec-WebSocket-Version", "13"),
            ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
            ("Origin", origin),
        ];
        panel.status("/ws", &headers)
    };
    assert_eq!(panel.status("/", &[]), 200);
    assert_eq!(
        panel.status("/", &[("Host", &format!("localhost:{port}"))]),
        200
    );
    for rebound in [
        "evil.example",
        &format!("evil.example:{port}"),
        "127.0.0.1",
        "localhost:1",
    ] {
        assert_eq!(panel.status("/", &[("Host", rebound)]), 421, "{rebound}");
    }
    assert_ne!(upgrade(&own), 403);
    for origin in [
        "http://evil.example",
        "null",
        "http://localhost:1",
        &format!("https://{host}"),
    ] {
        assert_eq!(upgrade(origin), 403, "{origin}");
    }
    let cross = [
        ("Sec-Fetch-Site", "cross-site"),
        ("Sec-Fetch-Mode", "no-cors"),
    ];
    assert_eq!(panel.status("/main.js", &cross), 403);
    assert_eq!(panel.status("/../Cargo.toml", &[]), 404);
    assert_eq!(
        panel.status("/report/0123456789abcdef0123456789abcdef", &[]),
        404
    );
    let answer = panel.get("/", &[]);
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self';",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cross-origin-opener-policy: same-origin",
    ] {
        assert!(answer.contains(header), "{header}");
    }
    assert!(!answer.to_lowercase().contains("set-cookie"));
    assert!(!answer.contains("unsafe"));
}

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
}

#[test]
fn frames_join_and_all_samples_are_accounted_for() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.arm();
    page.go_on(Duration::from_secs(3));
    let frames = &page.frames;
    assert!(frames.len() > 60, "{} frames in 3 s", frames.len());
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
fn a_target_is_judged_and_scored() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    page.ask("target", json!({ "target": "medium" })).unwrap();
    page.ask("score", json!({ "running": true })).unwrap();
    // A stroke of the simulated leg takes two seconds.
    page.until("two strokes", |page| {
        page.latest["target"]["strokes"].as_u64() >= Some(2)
    });
    page.ask("score", json!({ "running": false })).unwrap();
    let target = page.latest["target"].clone();
    assert!(target["seconds"].as_f64().unwrap() > 2.0);
    // Up to 60 °/s, where 65 to 120 are asked for.
    assert_eq!(target["score"], 0.0);
    assert!(target["share_slow"].as_f64().unwrap() > 0.99);
    for bad in [
        json!("quick"),
        json!({ "low_deg_per_s": 50, "high_deg_per_s": 40 }),
    ] {
        assert!(page.ask("target", json!({ "target": bad })).is_err());
    }
    page.ask("target", json!({ "target": null })).unwrap();
    assert!(page.ask("score", json!({ "running": true })).is_err());
}

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
    assert!(report.contains("left out: torque for 0 % of the time"));
}

#[test]
fn a_recording_is_shown_in_full_detail() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let mut page = panel.controlling();
    page.arm();
    page.ask("record", json!({ "running": true, "name": "first" }))
        .unwrap();
    page.go_on(Duration::from_secs(2));
    let error = page
        .ask("record", json!({ "running": true, "name": "../x" }))
        .unwrap_err();
    assert!(error.contains("invalid name"), "{error}");
    page.ask("record", json!({ "running": false })).unwrap();
    let files = page.ask("recordings", json!({})).unwrap();
    let id = files["files"][0]["id"].as_u64().unwrap();
    let facts = page.ask("open", json!({ "recording": id })).unwrap();
    assert!(
        facts["seconds"].as_f64().unwrap() > 1.9 && facts["missing"] == 0,
        "{facts}"
    );
    assert_eq!(facts["warnings"], json!([]));
    let whole = page.trace(id, 0.0, 2.0, 500);
    assert!((400..=500).contains(&whole.bins), "{}", whole.bins);
    let detail = page.trace(id, 1.0, 1.01, 500);
    assert_eq!((detail.bins, detail.bin_s), (200, 5e-5));
    // One sample a bin: lowest and highest are the same.
    assert!((0..200).all(|bin| detail.value(bin, 0) == detail.value(bin, 1)));
    let error = page.ask("open", json!({ "recording": 77 })).unwrap_err();
    assert!(error.contains("no such recording"), "{error}");
    assert!(panel.end().success());
    // The same without a device.
    let file = folder.path().join(&names(folder.path())[0]);
    let output = run(&["report", file.to_str().unwrap(), "--out", sessions]);
    assert!(output.status.success(), "{}", stderr(&output));
    let replay = Panel::new(&["--replay", file.to_str().unwrap()]);
    let mut page = replay.teacher_page();
    assert_eq!(page.latest["hello"]["source"]["kind"], "replay");
    let facts_again = page.ask("open", json!({ "recording": 0 })).unwrap();
    assert_eq!(facts_again["rows"], facts["rows"]);
    page.ask("take", json!({})).unwrap();
    assert!(
        page.ask("arm", json!({}))
            .unwrap_err()
            .contains("no device")
    );
}

/// A recording with right checksums whose last block came centuries later, and a pipe that has the name
/// of a recording and that nobody writes to: the page goes on.
#[test]
fn no_recording_ends_the_panel() {
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::telemetry::{Block, BlockFlags};
    use crepitus_recording::{Begin, Metadata, Recorder};
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("centuries.crepitus");
    let metadata = Metadata::new("a gap", &Identity::default(), None);
    let mut recorder = Recorder::create(&file, &metadata).unwrap();
    let begin = Begin {
        start: 1,
        ..Begin::default()
    };
    recorder.subscribed(begin).unwrap();
    for first_tick in (0..1_000).map(|n| 20 * n).chain([1 << 47]) {
        let flags = BlockFlags::new(crepitus_protocol::State::Armed, true, 1);
        let block = Block {
            first_tick,
            flags,
            ..Block::default()
        };
        recorder.block(&block).unwrap();
    }
    recorder.finish().unwrap();
    let pipe = home.path().join("pipe.crepitus");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let panel = Panel::new(&[
        "--device",
        "sim",
        "--sessions",
        home.path().to_str().unwrap(),
    ]);
    let mut page = panel.controlling();
    let files = page.ask("recordings", json!({})).unwrap();
    let id = |name: &str| {
        let mut files = files["files"].as_array().unwrap().iter();
        files.find(|file| file["name"] == name).unwrap()["id"].clone()
    };
    let centuries = id("centuries.crepitus");
    let facts = page.ask("open", json!({ "recording": centuries })).unwrap();
    assert_eq!(facts["rows"], 20_020);
    let end_s = facts["end_s"].as_f64().unwrap();
    assert!(end_s > 7e9, "{facts}");
    let id_of_gap = centuries.as_u64().unwrap();
    assert!((1..=500).contains(&page.trace(id_of_gap, 0.0, end_s, 500).bins));
    let before = page.trace(id_of_gap, 0.0, 1.0, 500);
    assert!((400..=500).contains(&before.bins), "{}", before.bins);
    let error = page.ask("open", json!({ "recording": id("pipe.crepitus") }));
    assert!(error.unwrap_err().contains("a pipe"));
    page.ask("recordings", json!({})).unwrap();
    assert!(panel.end().success());
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

#[test]
fn a_page_that_reads_nothing_slows_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let stuck: Vec<_> = (0..3).map(|_| panel.viewer_page()).collect();
    let mut page = panel.controlling();
    page.arm();
    page.ask("record", json!({ "running": true, "name": "long" }))
        .unwrap();
    page.until("a second of it", |page| {
        page.status("recording")["seconds"].as_f64() > Some(1.0)
    });
    page.ask("record", json!({ "running": false })).unwrap();
    let files = page.ask("recordings", json!({})).unwrap();
    let recording = files["files"][0]["id"].as_u64().unwrap();
    let bins = page.trace(recording, 0.2, 0.7, 10_000).bins;
    assert!(bins > 9_000, "{bins}");
    // 24 MB, which no socket holds: without a reader the panel cannot send this page anything.
    let mut greedy = panel.teacher_page();
    for id in 1..=60 {
        let mut trace = json!({ "recording": recording, "from_s": 0.2, "to_s": 0.7 });
        trace["points"] = json!(10_000);
        trace["do"] = json!("trace");
        trace["id"] = json!(id);
        greedy.send(&trace.to_string());
    }
    page.go_on(Duration::from_secs(2));
    page.frames.clear();
    page.go_on(Duration::from_secs(2));
    assert!(
        page.frames.len() > 40,
        "{} frames in 2 s",
        page.frames.len()
    );
    assert_eq!(page.status("state"), "armed");
    // More than wait for a page, so that it has lost some, or it was given up.
    page.until("more frames", |page| page.frames.len() > 200);
    greedy.until("a gap or its close", |page| {
        let mut pairs = page.frames.windows(2);
        page.is_closed || pairs.any(|pair| pair[1].number != pair[0].number + 1)
    });
    drop(stuck);
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
