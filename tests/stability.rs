//! `crepitus stability` as a person or a script uses it.

mod support;

use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use support::{
    crepitus, csv, done, is_row, names, number, run, stderr, stdout, summary, table, words,
};

fn stability(out: &Path, arguments: &[&str]) -> Output {
    let out = ["--out", out.to_str().unwrap()];
    run(&[&["stability"], arguments, &out[..]].concat())
}

/// The fields of a line; texts may be in quotes.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

/// The header and the rows of `cases.csv`.
fn cells(folder: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(folder.join("cases.csv")).expect("cases");
    let mut lines = text.lines().map(fields);
    let header = lines.next().expect("a header");
    (header, lines.collect())
}

#[test]
fn one_case_is_printed_in_full_and_becomes_three_files() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("one");
    let output = stability(&out, &["--case", "reversal-in-stick", "--all"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&out), ["cases.csv", "report.html", "summary.json"]);
    let text = stdout(&output);
    for part in [
        "H05 reversal-in-stick: ",
        "why it is hard",
        "input",
        "criterion",
        "source",
        "frozen:",
        "physical:",
        "report: ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }

    let (header, rows) = cells(&out);
    assert_eq!(
        header.join(","),
        "case,name,convention,solver,precision,must_hold,verdict,flagged,measured,limit,unit,at_s,\
         detail"
    );
    let printed = text.lines().filter(|line| {
        let is_cell = line.starts_with("  ") && (line.contains(" f32 ") || line.contains(" f64 "));
        let verdicts = [" holds", " degrades", " fails"];
        is_cell && verdicts.iter().any(|verdict| line.contains(verdict))
    });
    assert_eq!(printed.count(), rows.len());
    for row in &rows {
        assert_eq!(row.len(), header.len(), "{row:?}");
        assert_eq!(row[..2], ["H05", "reversal-in-stick"]);
        match row[6].as_str() {
            "holds" => assert!(number(&row[8]) <= number(&row[9]), "{row:?}"),
            // A number above its limit, or none at all.
            "degrades" => assert!(
                number(&row[8]).is_nan() || number(&row[8]) > number(&row[9]),
                "{row:?}"
            ),
            "fails" => assert!(!row[12].is_empty(), "{row:?}"),
            other => panic!("{other} is no verdict"),
        }
        assert!(row[5] == "false" || row[6] == "holds", "{row:?}");
    }

    let summary = summary(&out);
    let counts = &summary["counts"];
    let of = |verdict: &str| rows.iter().filter(|row| row[6] == verdict).count();
    for verdict in ["holds", "degrades", "fails"] {
        assert_eq!(counts[verdict], of(verdict), "{verdict}");
    }
    assert_eq!(summary["cells"], rows.len());
    assert_eq!(summary["broken"], Value::Array(Vec::new()));
    let narrowest = &summary["cases"][0]["narrowest"];
    let margin = |name: &str| narrowest[name].as_f64().expect("a number");
    assert!(margin("measured") <= margin("limit"));

    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("id=\"H05\""));
    assert!(!report.contains("http://") && !report.contains("https://"));
}

/// Of the whole matrix only the long mode has time: `screen` cuts any text.
#[test]
fn the_first_screen_has_the_answer_and_no_more_than_a_screen_holds() {
    let home = tempfile::tempdir().unwrap();
    let cases: &[&str] = &["--case", "H01", "--case", "H05"];
    let long = std::env::var_os("CREPITUS_LONG").is_some();
    let output = stability(&home.path().join("some"), if long { &[] } else { cases });
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.lines().count() <= 25, "{text}");
    let answer = text.split("\n\n").next().unwrap().replace('\n', " ");
    for part in [
        "The solver that the device runs (exact-events, frozen, f32) holds in ",
        "Explicit Euler (f32) fails in ",
        "Implicit Euler (f32) fails in ",
        "must hold, and all do.",
    ] {
        assert!(answer.contains(part), "{part}: {text}");
    }
    let rows: Vec<_> = text
        .lines()
        .filter(|line| line.contains(" of ") && line.starts_with("exact-events"))
        .collect();
    assert_eq!(rows.len(), 1, "{text}");
    assert!(
        text.trim_end().ends_with("--all prints every case"),
        "{text}"
    );
}

#[test]
fn parts_of_the_matrix_can_be_asked_for() {
    let home = tempfile::tempdir().unwrap();
    let parts = "--json --pictures --case h02 --case H05 --case H05 --solver exact-events \
                 --solver rk4 --convention physical --precision f32";
    let output = stability(home.path(), &words(parts));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let printed: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let cases = printed["summary"]["cases"].as_array().unwrap();
    let ids: Vec<_> = cases.iter().map(|c| c["case"].as_str().unwrap()).collect();
    assert_eq!(ids, ["H02", "H05"]);
    assert_eq!(printed["summary"]["subjects"], 2);
    let (_, rows) = cells(home.path());
    assert!(!rows.is_empty());
    for row in &rows {
        assert_eq!((row[2].as_str(), row[4].as_str()), ("physical", "f32"));
        assert!(row[3] == "exact-events" || row[3] == "rk4", "{row:?}");
    }
    let files = names(home.path());
    for picture in ["matrix.svg", "implicit-euler.svg", "restick-rules.svg"] {
        assert!(files.iter().any(|name| name == picture), "{files:?}");
    }
    let matrix = fs::read_to_string(home.path().join("matrix.svg")).unwrap();
    assert!(matrix.contains("xmlns=") && matrix.contains("H02"));
}

#[test]
fn the_files_of_two_runs_are_the_same() {
    let home = tempfile::tempdir().unwrap();
    let once = |name: &str| {
        let out = home.path().join(name);
        let output = stability(&out, &["--case", "H05", "--precision", "f64"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        fs::read_to_string(out.join("cases.csv")).unwrap()
    };
    assert_eq!(once("first"), once("second"));
}

#[test]
fn what_cannot_be_is_refused_and_touches_nothing() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("report.html"), "mine").unwrap();
    for (arguments, words) in [
        (
            &["--case", "reversal-in-stik"][..],
            &["reversal-in-stik", "reversal-in-stick"][..],
        ),
        (&["--solver", "exakt"], &["exakt", "exact-events"]),
        (&["--convention", "ice"], &["ice", "frozen"]),
        (
            &["--solver", "rk4", "--convention", "frozen"],
            &["rk4", "frozen", "not integrated"],
        ),
        (&["--precision", "f16"], &["f16", "f32"]),
    ] {
        let output = stability(home.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        for word in words {
            assert!(stderr(&output).contains(word), "{}", stderr(&output));
        }
        assert!(stdout(&output).is_empty());
    }
    let output = stability(home.path(), &["--json", "--case", "nothing-like-it"]);
    assert_eq!(output.status.code(), Some(2));
    let printed: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(printed["error"]["exit_code"], 2);
    assert_eq!(names(home.path()), ["report.html"]);
    let kept = fs::read_to_string(home.path().join("report.html")).unwrap();
    assert_eq!(kept, "mine");
}

#[test]
fn a_folder_that_cannot_be_written_is_known_before_the_work() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("file");
    fs::write(&out, "mine").unwrap();
    let begun = Instant::now();
    let output = stability(&out, &[]);
    assert_eq!(output.status.code(), Some(2));
    // The matrix takes many times as long.
    let took = begun.elapsed();
    assert!(took < Duration::from_secs(5), "{took:?}");
    assert!(stderr(&output).contains("file"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&out).unwrap(), "mine");
}

#[test]
fn an_interrupt_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let child = crepitus()
        .args(["stability", "--long", "--out"])
        .arg(home.path().join("out"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Under way as soon as there is a folder to prepare the files in.
    while names(home.path()).is_empty() {
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(100));
    let interrupted = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .expect("kill");
    assert!(interrupted.success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("nothing was written"),
        "{}",
        stderr(&output)
    );
    // Neither the folder nor what was being prepared for it.
    assert!(names(home.path()).is_empty(), "{:?}", names(home.path()));
}

#[test]
fn the_catalogue_is_a_page_of_the_book() {
    let output = run(&["stability", "--list", "--long"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let page =
        fs::read_to_string(support::repository().join("docs/generated/hard-cases.md")).unwrap();
    assert!(
        stdout(&output) == page,
        "docs/generated/hard-cases.md is not what `crepitus stability --list --long` prints: run docs/figures.sh"
    );
    let output = run(&["--json", "stability", "--list", "--case", "H05"]);
    let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(printed["cases"][0]["name"], "reversal-in-stick");
}

/// The rows of a file of the map, by the names of its columns.
fn rows(folder: &Path, name: &str) -> Vec<HashMap<String, String>> {
    let (header, lines) = csv(&folder.join(name));
    let named = |line: Vec<String>| header.iter().cloned().zip(line).collect();
    lines.into_iter().map(named).collect()
}

/// In the long mode, `CREPITUS_LONG=1`: the whole map takes a minute. Single cells and what is predicted of
/// them are tested in `host/studies`.
#[test]
fn the_map_of_stiffness_keeps_what_theory_promises() {
    let output = run(&["stability", "--coupled", "--case", "H05"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--coupled"), "{}", stderr(&output));
    if std::env::var_os("CREPITUS_LONG").is_none() {
        return;
    }
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("map");
    let output = stability(&out, &["--coupled", "--pictures"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        names(&out),
        [
            "cells.csv",
            "margins.csv",
            "onsets.csv",
            "report.html",
            "scene.toml",
            "summary.json",
            "z-width.svg"
        ]
    );
    let value =
        |row: &HashMap<String, String>, name: &str| -> f64 { row[name].parse().expect("a number") };
    let onsets = rows(&out, "onsets.csv");
    let (mut found, mut linear) = (0, 0);
    for row in &onsets {
        let measured = value(row, "onset_nm_per_rad");
        let left = value(row, "friction_left_nm");
        if measured.is_nan() || left < 0.0 {
            continue;
        }
        found += 1;
        // Damping and counts together, or friction alone, keep a shaft quiet.
        let damped = value(row, "colgate_schenkel_nm_per_rad");
        let counted = value(row, "abbott_okamura_nm_per_rad");
        let rubbed = value(row, "diolaiti_nm_per_rad");
        assert!(measured > damped.min(counted).max(rubbed), "{row:?}");
        // Without any friction, and behind a motor, the linear system is right to
        // a step of the map or two: counts feed a swing, and torque is limited.
        if value(row, "gear_friction_nm") == 0.0 && value(row, "lag_s") > 1e-4 {
            let ratio = measured / value(row, "linear_nm_per_rad");
            assert!((0.35..2.0).contains(&ratio), "{ratio}: {row:?}");
            linear += 1;
        }
    }
    assert!(found > 15 && linear > 12, "{found}, {linear}");
    // The presets on the device as it is have at least twice their stiffness.
    let shipped: Vec<_> = rows(&out, "margins.csv")
        .into_iter()
        .filter(|row| row["with"] == "nothing else" && value(row, "gear_friction_nm") == 0.5)
        .collect();
    assert!(shipped.len() >= 12);
    for row in shipped {
        assert_eq!(row["verdict"], "quiet", "{row:?}");
        assert!(row["onset_over_stiffness"] == "nan", "{row:?}");
        assert!(value(&row, "most_over_stiffness") >= 2.0, "{row:?}");
    }
    // The summary has the names and numbers of the file.
    let summed = summary(&out);
    let joints = ["presets", "extras"].map(|list| summed[list].as_array().unwrap().clone());
    let (header, lines) = table(&out.join("margins.csv"));
    assert_eq!(joints.concat().len(), lines.len());
    for (joint, line) in joints.concat().iter().zip(&lines) {
        assert!(is_row(joint, &header, line), "{joint} {line:?}");
    }
    // Anybody can run a cell.
    let scene = out.join("scene.toml");
    let ran = home.path().join("ran");
    done(&format!("run {} --out {}", scene.display(), ran.display()));
    assert!(summary(&ran)["plant_energy"]["residual_relative"].is_number());
}
