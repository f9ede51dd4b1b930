//! Recordings on a page: full detail, broken files, and more of them than a page reads.

use crate::page::Panel;
use crate::support::{names, run, stderr};
use serde_json::json;
use std::time::Duration;

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
    for name in ["../x", "NUL"] {
        let error = page
            .ask("record", json!({ "running": true, "name": name }))
            .unwrap_err();
        assert!(error.contains("invalid name"), "{error}");
    }
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

/// One that is running may be looked at, and again when there is more of it.
#[test]
fn a_recording_that_grew_is_read_to_its_new_end() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().to_str().unwrap();
    let panel = Panel::new(&["--device", "sim", "--sessions", sessions]);
    let mut page = panel.controlling();
    page.ask("record", json!({ "running": true, "name": "grows" }))
        .unwrap();
    let [before, after] = [0.5, 1.5].map(|seconds| {
        page.until("more of it", |page| {
            page.status("recording")["seconds"].as_f64() > Some(seconds)
        });
        let files = page.ask("recordings", json!({})).unwrap();
        let id = files["files"][0]["id"].clone();
        page.ask("open", json!({ "recording": id })).unwrap()
    });
    for name in ["rows", "end_s"] {
        let [before, after] = [&before, &after].map(|facts| facts[name].as_f64());
        assert!(
            before.is_some() && after > before,
            "{name}: {before:?}, then {after:?}"
        );
    }
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
