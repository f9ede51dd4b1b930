//! Recordings as their users meet them: names, hints, exports, damage.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "small numbers"
)]

mod support;

use crepitus_recording::{Damage, Recording};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;
use support::{
    check_books, crepitus, names, recording, refuses, rows, run, stderr, stdout, summary,
};

/// A recording of the simulated device, half a second long.
fn record(folder: &Path, name: &str) -> Output {
    crepitus()
        .current_dir(folder)
        .args([
            "record", "--device", "sim", "--for", "500ms", "--arm", "--zero", "--", name,
        ])
        .output()
        .unwrap()
}

fn recorded(folder: &Path, name: &str) -> PathBuf {
    let output = record(folder, name);
    assert!(output.status.success(), "{}", stderr(&output));
    folder.join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn any_name_works_and_the_hint_can_be_pasted() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    // A folder with `-report` in its name would be too long.
    let long = "n".repeat(250);
    let all = [
        long.as_str(),
        "x.json",
        "x.csv",
        "x.parquet",
        "x",
        "run.1",
        "noext",
        "two words",
        "it's",
        "-dash",
        "$HOME",
        "knie ö",
        "a\nb",
    ];
    for name in all {
        let output = record(folder, name);
        assert!(output.status.success(), "{name:?}: {}", stderr(&output));
        let said = stdout(&output);
        let hint = said.split('`').nth(1).unwrap();
        let program = env!("CARGO_BIN_EXE_crepitus");
        let hint = hint.replacen("crepitus", &format!("'{program}'"), 1);
        // As a person pastes it.
        let pasted = Command::new("bash")
            .current_dir(folder)
            .args(["-c", &hint])
            .output()
            .unwrap();
        assert!(pasted.status.success(), "{hint}: {}", stderr(&pasted));
    }
    // Each recording and each report stands, none wrote over another.
    assert_eq!(names(folder).len(), 2 * all.len(), "{:?}", names(folder));
    for name in all {
        let recording = recording(&folder.join(name));
        assert!(recording.is_complete());
        assert_eq!(check_books(&recording).dropped, 0);
        let again = record(folder, name);
        assert_eq!(again.status.code(), Some(2));
        assert!(stderr(&again).contains("already exists"));
    }
}

/// The device stops when the leg leaves the range of motion.
#[test]
fn a_recording_that_a_fault_has_ended_names_it() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a");
    let device = ["--device", "sim", "--scene", "high-speed"];
    let record = [
        &["record", text(&file), "--arm", "--zero", "--for", "20s"][..],
        &device,
    ]
    .concat();
    let output = run(&record);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("outside-range"),
        "{}",
        stderr(&output)
    );
    let out = home.path().join("out");
    let report = run(&["report", text(&file), "--out", text(&out), "--json"]);
    let report: Value = serde_json::from_str(&stdout(&report)).unwrap();
    let summary = support::summary(&out);
    for summary in [&report["summary"], &summary] {
        let summary = if summary.is_null() { &report } else { summary };
        assert_eq!(summary["ending"]["cause"], "fault", "{summary}");
        let fault = summary["ending"]["faults"][0].as_str().unwrap();
        assert!(fault.starts_with("outside-range"), "{fault}");
        let warnings = summary["warnings"].to_string();
        assert!(warnings.contains("ended early") && warnings.contains("outside-range"));
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("ended early") && page.contains("outside-range"));
    // One that ends in its time says nothing.
    let whole = recorded(home.path(), "b");
    let opened = recording(&whole);
    assert_eq!(opened.warnings(), [""; 0]);
    assert_eq!(
        opened.ending().unwrap().cause,
        crepitus_recording::EndCause::Time
    );
}

#[test]
fn a_report_replaces_nothing_but_its_own() {
    let home = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| recorded(home.path(), name));
    let out = home.path().join("out");
    let report = |file: &Path| run(&["report", text(file), "--out", text(&out)]);
    for _ in 0..2 {
        let output = report(&a);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let before = fs::read(out.join("report.html")).unwrap();
    let output = report(&b);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("written by `report "), "{said}");
    assert_eq!(fs::read(out.join("report.html")).unwrap(), before);
    // Somebody's own, and results of another kind.
    fs::write(out.join("summary.json"), "{}").unwrap();
    assert_eq!(report(&a).status.code(), Some(2));
}

/// Recordings of either format, also where only the end of the work tells the name.
#[test]
fn results_replace_no_recording() {
    let home = tempfile::tempdir().unwrap();
    let a = recorded(home.path(), "a");
    let scene = ["run", "fig6-ideal-cycle", "--set", "duration_s=0.1"];
    for (name, arguments) in [
        ("report.html", &["report", text(&a)][..]),
        ("summary.json", &["report", text(&a)]),
        ("torque.svg", &["report", text(&a), "--pictures"]),
        ("report.html", &scene),
        ("trace.csv", &scene),
    ] {
        let out = tempfile::tempdir().unwrap();
        let kept = recorded(out.path(), name);
        refuses(
            &[arguments, &["--out", text(out.path())]].concat(),
            2,
            &format!("{name} (not written by crepitus)"),
        );
        assert_eq!(names(out.path()), [name]);
        assert!(recording(&kept).is_complete());
    }
    let out = home.path().join("a-report");
    fs::create_dir(&out).unwrap();
    let log = recording_in_progress(&out.join("report.html"));
    refuses(
        &["report", text(&a)],
        2,
        "report.html (not written by crepitus)",
    );
    assert_eq!(fs::read(out.join("report.html")).unwrap(), log);
}

#[test]
fn a_refused_recording_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("a");
    // A device that is not there; `sharing.rs` has one that refuses to arm.
    let output = run(&[
        "record",
        text(&file),
        "--device",
        "none-of-this-name",
        "--arm",
        "--zero",
    ]);
    assert!(!output.status.success());
    assert_eq!(names(home.path()), [""; 0]);
    let folder = home.path().join("no folder").join("a");
    let output = run(&["record", text(&folder), "--device", "sim", "--for", "100ms"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("cannot be created"),
        "{}",
        stderr(&output)
    );
}

/// A recording that nobody can read is not reported as whole.
#[test]
fn a_recording_that_was_removed_while_it_ran_is_no_success() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("gone");
    let mut program = crepitus()
        .current_dir(home.path())
        .args(["record", "--device", "sim", "--for", "20s", "gone"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while fs::remove_file(&file).is_err() {
        assert!(program.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(1));
    }
    let output = program.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("was moved, removed or changed while it ran"),
        "{said}"
    );
    assert_eq!(stdout(&output), "");
}

/// Its end goes by the file's name, which another recording may have by then.
#[test]
fn a_recording_that_was_moved_while_it_ran_replaces_no_other() {
    let home = tempfile::tempdir().unwrap();
    let other = recorded(home.path(), "other");
    let file = home.path().join("a");
    let mut program = crepitus()
        .current_dir(home.path())
        .args(["record", "--device", "sim", "--for", "20s", "a"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !file.exists() {
        assert!(program.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(1));
    }
    let moved = home.path().join("moved");
    fs::rename(&file, &moved).unwrap();
    fs::copy(&other, &file).unwrap();
    let output = program.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("is another recording now"), "{said}");
    assert_eq!(fs::read(&file).unwrap(), fs::read(&other).unwrap());
    let recording = Recording::open(&moved, Damage::Refuse).unwrap();
    assert!(recording.is_complete());
    assert!(recording.accounting().totals.received > 0);
}

#[test]
fn exports_hold_every_sample_and_replace_nothing() {
    let home = tempfile::tempdir().unwrap();
    let file = recorded(home.path(), "a");
    let before = fs::read(&file).unwrap();
    let samples = rows(&recording(&file)).len();
    for format in ["csv", "mcap", "parquet"] {
        let arguments = ["export", text(&file), "--format", format];
        let output = run(&arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        // What is in the new file.
        let said = match format {
            "mcap" => format!(": {} rows, one a millisecond\n", samples.div_ceil(20)),
            _ => format!(": {samples} samples\n"),
        };
        assert!(stdout(&output).ends_with(&said), "{}", stdout(&output));
        let again = run(&arguments);
        assert_eq!(again.status.code(), Some(2));
        assert!(stderr(&again).contains("already exists"));
    }
    assert_eq!(names(home.path()), ["a", "a.csv", "a.mcap", "a.parquet"]);
    assert_eq!(fs::read(&file).unwrap(), before);
    let (header, lines) = support::csv(&home.path().join("a.csv"));
    let all = rows(&recording(&file));
    assert_eq!(lines.len(), all.len());
    let tick = header.iter().position(|name| name == "tick").unwrap();
    for (line, row) in lines.iter().zip(&all) {
        assert_eq!(line[tick], row.tick.to_string());
    }
    assert_eq!(rows(&recording(&home.path().join("a.parquet"))), all);
    // An exported file is no recording, and the error says so.
    let output = run(&["report", text(&home.path().join("a.csv"))]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("not one that was exported"));
}

/// A log of which the middle is missing, with a picture of that.
#[test]
fn what_is_missing_is_said_first_and_drawn() {
    let home = tempfile::tempdir().unwrap();
    let log = home.path().join("log");
    let damaged = home.path().join("damaged");
    let whole = recording_in_progress(&log);
    let mut bytes = whole.clone();
    let middle = bytes.len() / 2;
    bytes[middle..middle + 20_000].fill(0);
    fs::write(&damaged, &bytes).unwrap();
    let output = run(&["report", text(&damaged)]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    for part in ["damaged:", "bytes from byte", "--salvage"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(names(home.path()), ["damaged", "log"]);
    let output = run(&["report", text(&damaged), "--salvage"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    let (missing, length) = (
        said.find("are missing").unwrap(),
        said.find(" s of it armed").unwrap(),
    );
    assert!(missing < length, "{said}");
    let folder = home.path().join("damaged-report");
    let numbers = summary(&folder);
    let warnings = numbers["warnings"].as_array().unwrap();
    assert!(warnings[0].as_str().unwrap().contains("damaged"));
    let missing = numbers["telemetry"]["damaged"].as_u64().unwrap();
    assert!((1_000..1_400).contains(&missing), "{missing}");
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    let table = page.find("Missing samples").expect("a table");
    assert!(table < page.find("Parameters: revision").unwrap());
    assert!(page.contains("Blank between dotted lines"));
    // The same report without a gap has none.
    assert!(run(&["report", text(&log)]).status.success());
    let page = fs::read_to_string(home.path().join("log-report/report.html")).unwrap();
    assert!(!page.contains("Blank between") && !page.contains("Missing samples"));
    // What was salvaged can be kept as a whole file.
    let kept = home.path().join("kept.parquet");
    let export = [
        "export",
        text(&damaged),
        "--format",
        "parquet",
        "--out",
        text(&kept),
    ];
    assert_eq!(run(&export).status.code(), Some(2));
    let output = run(&[&export[..], &["--salvage"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let kept = recording(&kept);
    assert_eq!(check_books(&kept).damaged, missing);
}

/// The file as it was before it became Parquet: that of a full disk.
fn recording_in_progress(path: &Path) -> Vec<u8> {
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::telemetry::{Block, BlockFlags};
    use crepitus_protocol::{Revision, State, Values};
    use crepitus_recording::{Begin, Metadata, Recorder};
    let metadata = Metadata::new("a test", &Identity::default(), None);
    let mut recorder = Recorder::create(path, &metadata).unwrap();
    let begin = Begin {
        first_tick: 100,
        ..Begin::default()
    };
    recorder.subscribed(begin).unwrap();
    recorder.announce(Revision(1), &Values::default());
    for n in 0..1_500 {
        let first_tick = 100 + 20 * n;
        let mut block = Block {
            first_tick,
            revision: Revision(1),
            flags: BlockFlags::new(State::Armed, true, 0),
            ..Block::default()
        };
        for (at, sample) in block.samples.iter_mut().enumerate() {
            let t = (first_tick + at as u64) as f64 * 5e-5;
            sample.count = (2_000.0 * t.sin()) as i32;
            sample.model_torque_nm = (30.0 * t).sin() as f32;
        }
        recorder.block(&block).unwrap();
    }
    recorder.finish().unwrap();
    fs::read(path).unwrap()
}

/// Wherever the disk gets full while the Parquet file is made, the recording
/// stays; the new file appears whole or not at all.
#[cfg(unix)]
#[test]
fn a_disk_that_gets_full_at_the_end_costs_nothing() {
    let home = tempfile::tempdir().unwrap();
    let log = home.path().join("log");
    recording_in_progress(&log);
    let export = |kilobytes: u32, out: &str| {
        let script = format!(
            "trap '' XFSZ; ulimit -f {kilobytes}; exec '{}' export '{}' --format parquet --out '{out}'",
            env!("CARGO_BIN_EXE_crepitus"),
            log.display()
        );
        Command::new("bash")
            .current_dir(home.path())
            .args(["-c", &script])
            .output()
            .unwrap()
    };
    assert!(export(100_000, "whole").status.success());
    let whole = fs::read(home.path().join("whole")).unwrap();
    let most = u32::try_from(whole.len() / 1_024).unwrap();
    for kilobytes in (0..=most).step_by(9) {
        let output = export(kilobytes, "cut");
        assert_eq!(output.status.code(), Some(1), "{kilobytes} kB");
        assert!(
            stderr(&output).contains("cannot be written"),
            "{}",
            stderr(&output)
        );
        assert_eq!(names(home.path()), ["log", "whole"]);
    }
    assert!(recording(&log).is_complete());
}

/// Uses the libraries of `CREPITUS_PYTHON`, or of the usual Python. What is not installed is left
/// out, unless `CREPITUS_NEEDS_PYTHON` is set.
#[test]
fn pandas_polars_and_duckdb_open_the_file() {
    let home = tempfile::tempdir().unwrap();
    let file = recorded(home.path(), "a.parquet");
    let all = rows(&recording(&file));
    let sum: i64 = all.iter().map(|row| i64::from(row.count)).sum();
    let measured = all.iter().filter(|row| row.current_a.is_some()).count();
    let expected = format!("{} {sum} {measured} not-armed", all.len());
    let python = std::env::var("CREPITUS_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let path = text(&file);
    let programs = [
        (
            "pandas",
            format!(
                "import pandas; t = pandas.read_parquet('{path}')\n\
                 print(len(t), t['count'].sum(), t.current_a.notna().sum(), t.limit[0])"
            ),
        ),
        (
            "polars",
            format!(
                "import polars; t = polars.read_parquet('{path}')\n\
                 print(len(t), t['count'].cast(polars.Int64).sum(), t['current_a'].is_not_null().sum(), t['limit'][0])"
            ),
        ),
        (
            "duckdb",
            format!(
                "import duckdb; t = duckdb.sql(\"select count(*), sum(count), count(current_a), \
                 arg_min(\\\"limit\\\", tick) from '{path}'\").fetchall()[0]\nprint(*t)"
            ),
        ),
        (
            "pyarrow",
            format!(
                "import pyarrow.parquet as p, json; m = p.read_metadata('{path}')\n\
                 about = json.loads(m.metadata[b'crepitus'])\n\
                 t = p.read_table('{path}')\n\
                 assert about['columns']['torque_nm'].endswith('N·m')\n\
                 assert about['books']['totals']['received'] == len(t)\n\
                 assert about['parameters'][0]['values']['crepitus.static_torque_nm'] > 0\n\
                 assert len(about['comms']['serial']) == 24 and len(about['drive']['serial']) == 24\n\
                 print(len(t), sum(t['count'].to_pylist()), len(t) - t['current_a'].null_count, t['limit'][0])"
            ),
        ),
    ];
    for (library, program) in programs {
        let import = program.split(['.', ';', ' ']).nth(1).unwrap();
        let is_there = Command::new(&python)
            .args(["-c", &format!("import {import}")])
            .output()
            .is_ok_and(|output| output.status.success());
        if !is_there {
            let missing = format!("{library} is not installed for {python}");
            let is_needed = std::env::var_os("CREPITUS_NEEDS_PYTHON").is_some();
            assert!(
                !is_needed,
                "{missing}: name a Python that has python/tests/requirements.txt in CREPITUS_PYTHON"
            );
            eprintln!("left out: {missing}");
            continue;
        }
        let output = Command::new(&python)
            .args(["-c", &program])
            .output()
            .unwrap();
        assert_eq!(
            stdout(&output).trim(),
            expected,
            "{library}: {}",
            stderr(&output)
        );
        println!("{library} reads the file");
    }
}

/// The exported summary of what is wrong is for programs, too.
#[test]
fn findings_are_json_for_programs() {
    let home = tempfile::tempdir().unwrap();
    let log = home.path().join("log");
    let whole = recording_in_progress(&log);
    fs::write(&log, &whole[..whole.len() - 30_000]).unwrap();
    let output = run(&["export", text(&log), "--format", "csv", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert!(said["warnings"][0].as_str().unwrap().contains("incomplete"));
    let recording = Recording::open(&log, Damage::Refuse).unwrap();
    assert_eq!(
        said["telemetry"]["received"],
        check_books(&recording).received
    );
}

/// Cost of a program.
#[cfg(target_os = "linux")]
#[derive(Clone, Copy)]
struct Took {
    seconds: f64,
    /// Its highest memory, kB.
    kilobytes: u64,
}

#[cfg(target_os = "linux")]
impl std::fmt::Display for Took {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let megabytes = self.kilobytes / 1_000;
        write!(f, "{:.2} s, at most {megabytes} MB of memory", self.seconds)
    }
}

#[cfg(target_os = "linux")]
fn took(arguments: &[&str]) -> Took {
    let begun = std::time::Instant::now();
    let mut child = crepitus()
        .args(arguments)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut kilobytes = 0;
    let status = loop {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let highest = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let now = highest.and_then(|text| text.trim().strip_suffix(" kB")?.parse().ok());
        kilobytes = kilobytes.max(now.unwrap_or(0));
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None => std::thread::sleep(std::time::Duration::from_millis(2)),
        }
    };
    assert!(status.success(), "{arguments:?}");
    Took {
        seconds: begun.elapsed().as_secs_f64(),
        kilobytes,
    }
}

/// A symptom that was on is drawn: what a recording holds is enough.
#[test]
fn a_symptom_of_a_recording_is_drawn_with_its_limits() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    let scene = "version = 1\ntitle = \"Rigid\"\nduration_s = 3.0\ndevice = true\n\
                 [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.5\n\
                 [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n\
                 [effects.encoder]\n[effects.lead-pipe]\ntorque_nm = 0.8\n";
    fs::write(folder.join("rigid.toml"), scene).unwrap();
    let output = crepitus()
        .current_dir(folder)
        .args([
            "record",
            "rigid",
            "--device",
            "sim",
            "--scene",
            "rigid.toml",
            "--for",
            "2s",
            "--arm",
            "--zero",
        ])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let output = crepitus()
        .current_dir(folder)
        .args(["report", "rigid", "--pictures"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let report = folder.join("rigid-report");
    for picture in ["lead-pipe-1.svg", "lead-pipe-2.svg"] {
        let drawn = fs::read_to_string(report.join(picture)).unwrap();
        assert!(drawn.contains("limits of the rigidity"), "{picture}");
    }
    let page = fs::read_to_string(report.join("report.html")).unwrap();
    for words in [
        "even resistance",
        "On examination: lead-pipe rigidity",
        "0.80 N·m against bending",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Nothing else was on, crepitus neither.
    for words in ["Clasp-knife", "rendered together", "broke loose"] {
        assert!(!page.contains(words), "{words}");
    }
    // Before it is armed a symptom has no phase, which is no broken row.
    assert!(!page.contains("not finite"));
}

#[test]
fn the_current_of_the_actuators_coil_is_drawn_where_it_was_driven() {
    let home = tempfile::tempdir().unwrap();
    for (scene, is_drawn) in [("fig8-6-actuator", true), ("passive-examination", false)] {
        let output = crepitus()
            .current_dir(home.path())
            .args(["record", scene, "--device", "sim", "--scene", scene])
            .args(["--for", "600ms", "--arm", "--zero"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let output = crepitus()
            .current_dir(home.path())
            .args(["report", scene])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let page = home.path().join(format!("{scene}-report/report.html"));
        let page = fs::read_to_string(page).unwrap();
        assert_eq!(page.contains("Coil of the actuator"), is_drawn, "{scene}");
        assert!(!page.contains("not finite"), "{scene}");
    }
}

/// Time and size of each format, and memory over a long recording: a minute and
/// an hour of device time with `CREPITUS_LONG=1`, five and twenty seconds
/// without.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_recording() {
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let durations = if is_long {
        ["60s", "60m"]
    } else {
        ["5s", "20s"]
    };
    let home = tempfile::tempdir().unwrap();
    let mut highest = Vec::new();
    for duration in durations {
        let file = home.path().join(duration);
        let mut all = vec![took(&[
            "record",
            text(&file),
            "--device",
            "sim",
            "--arm",
            "--zero",
            "--for",
            duration,
        ])];
        println!("record --for {duration}: {}", all[0]);
        for format in ["csv", "parquet", "mcap"] {
            let out = home.path().join("out");
            let took = took(&[
                "export",
                text(&file),
                "--format",
                format,
                "--out",
                text(&out),
            ]);
            println!(
                "{duration} as {format}: {took}, {} bytes",
                support::length(&out)
            );
            fs::remove_file(out).unwrap();
            all.push(took);
        }
        all.push(took(&[
            "report",
            text(&file),
            "--out",
            text(&home.path().join(format!("report-{duration}"))),
        ]));
        println!("report of {duration}: {}", all[4]);
        highest.push(all);
    }
    // Fifteen seconds of samples are few: 14 bytes of each would be as much.
    let most = if is_long { 24_000 } else { 4_000 };
    for (short, long) in highest[0].iter().zip(&highest[1]) {
        assert!(long.kilobytes < short.kilobytes + most, "{short}; {long}");
    }
}
