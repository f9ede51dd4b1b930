//! `crepitus laws` as a person or a script uses it.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;
use support::{is_row, names, number, run, stderr, stdout, summary, table};

/// Two laws on two tasks: a second of work.
const SOME: &[&str] = &[
    "--quick",
    "--law",
    "frozen",
    "--law",
    "hayward-armstrong",
    "--task",
    "creep",
    "--task",
    "grating",
];

fn laws(out: &Path, arguments: &[&str]) -> Output {
    let out = ["--out", out.to_str().unwrap()];
    run(&[&["laws"], arguments, &out[..]].concat())
}

#[test]
fn the_answer_names_a_law_a_use_and_every_number_is_in_the_files() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("some");
    let output = laws(&out, &[SOME, &["--pictures"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.lines().count() <= 25, "{text}");
    let answer = text.split("\n\n").next().unwrap().replace('\n', " ");
    for part in [
        "For a joint that grates at 20 kHz take frozen: mean error ",
        "For rest and creep take ",
        " ns a step, ",
        " bytes",
    ] {
        assert!(answer.contains(part), "{part}: {text}");
    }
    assert!(
        text.trim_end().ends_with("--all prints every number"),
        "{text}"
    );
    assert_eq!(
        names(&out),
        [
            "costs.csv",
            "grating-cost.svg",
            "leaderboard.csv",
            "model-errors.svg",
            "numerical-errors.svg",
            "report.html",
            "summary.json",
            "two-errors.svg"
        ]
    );
    let summary = summary(&out);
    for (list, file) in [("rows", "leaderboard.csv"), ("costs", "costs.csv")] {
        let (header, lines) = table(&out.join(file));
        let rows = summary[list].as_array().unwrap();
        assert_eq!(rows.len(), lines.len(), "{list}");
        for (row, line) in rows.iter().zip(&lines) {
            assert!(is_row(row, &header, line), "{row} {line:?}");
        }
    }
    let row = |law: &str, quantity: &str| {
        let mut rows = summary["rows"].as_array().unwrap().iter();
        let row = rows.find(|row| row["law"] == law && row["quantity"] == quantity);
        row.unwrap()["relative_error"].as_f64().expect("an error")
    };
    assert!(row("frozen", "grating-frequency") < 1e-3);
    // It does not grate, and holds a load.
    assert!(row("hayward-armstrong", "creep") < 1e-3);
    assert_eq!(summary["answers"][0]["law"], "frozen");
    assert!(
        summary["machine"]["compiler"]
            .as_str()
            .unwrap()
            .starts_with("rustc ")
    );
    let report = fs::read_to_string(out.join("report.html")).unwrap();
    for part in ["How a law is chosen", "The fits", "creep", "frozen"] {
        assert!(report.contains(part), "{part}");
    }
    assert!(!report.contains("http://") && !report.contains("https://"));
    let picture = fs::read_to_string(out.join("model-errors.svg")).unwrap();
    assert!(picture.contains("xmlns=") && picture.contains("hayward-armstrong"));
}

#[test]
fn all_prints_every_number_with_both_errors() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("all");
    let output = laws(&out, &[SOME, &["--all"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "grating-frequency (steady grating)",
        "demanded, Hz",
        "model error, Hz",
        "numerical error, Hz",
        "break-away-slow",
        "The score of a law for a use",
        "shaft and ground",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let (_, lines) = table(&out.join("leaderboard.csv"));
    let printed = text.lines().filter(|line| line.contains("coarse "));
    // Each number, and two lines of fits.
    assert_eq!(printed.count(), lines.len() + 2, "{text}");
}

#[test]
fn two_runs_give_the_same_numbers() {
    let home = tempfile::tempdir().unwrap();
    let once = |name: &str| {
        let out = home.path().join(name);
        let output = laws(&out, &[SOME, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let printed: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        let mut summary = printed["summary"].clone();
        // Times, and what they decide.
        for part in ["wall_s", "costs", "answers"] {
            summary.as_object_mut().unwrap().remove(part).expect(part);
        }
        let leaderboard = fs::read(out.join("leaderboard.csv")).unwrap();
        let (header, costs) = table(&out.join("costs.csv"));
        let place = header.iter().position(|name| name == "grating_ns_per_step");
        for line in &costs {
            assert!(number(&line[place.unwrap()]) > 0.0, "{line:?}");
        }
        (leaderboard, summary)
    };
    assert_eq!(once("first"), once("second"));
}

#[test]
fn a_name_that_is_unknown_is_refused_with_the_nearest_and_touches_nothing() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("report.html"), "mine").unwrap();
    for (arguments, words) in [
        (&["--law", "lugr"][..], &["lugr", "did you mean lugre?"][..]),
        (&["--task", "crepe"], &["crepe", "did you mean creep?"]),
        (&["--joint", "coarze"], &["did you mean coarse?"]),
        (
            &["--preset", "catch"],
            &["--joint catch", "expected one of"],
        ),
        (&["--quick", "--long"], &["--quick", "--long"]),
    ] {
        let output = laws(home.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        for word in words {
            assert!(stderr(&output).contains(word), "{}", stderr(&output));
        }
        assert!(stdout(&output).is_empty());
    }
    assert_eq!(names(home.path()), ["report.html"]);
}

#[test]
fn the_list_has_laws_joints_and_tasks() {
    let output = run(&["laws", "--list"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["frozen", "lugre", "joints: coarse", "task creep: "] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let output = run(&["--json", "laws", "--list"]);
    let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(printed["laws"][0]["name"], "frozen");
    assert!(printed["tasks"].as_array().unwrap().len() >= 12);
}

#[test]
fn with_a_target_every_law_has_its_cycles_there() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("target");
    let to = out.to_str().unwrap();
    let some = ["laws", "--target", "--out", to];
    let output = run(&[&some, SOME].concat());
    let printed = stderr(&output);
    let has_none = printed.contains("rustup target add thumbv7em-none-eabihf")
        || printed.contains("built without the emulator");
    if has_none {
        assert!(std::env::var_os("CREPITUS_NEEDS_TARGET").is_none());
        // Refused before the work.
        assert_eq!(output.status.code(), Some(1));
        assert!(names(home.path()).is_empty());
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{printed}");
    let (header, rows) = table(&out.join("costs.csv"));
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    assert_eq!(rows.len(), 2);
    for row in &rows {
        let of = |name: &str| number(&row[column(name)]);
        let [instructions, mean, worst] =
            ["mean_instructions", "mean_cycles", "worst_cycles"].map(of);
        assert!(
            10.0 < instructions && instructions < mean && mean <= worst,
            "{row:?}"
        );
        // A fifth of a tick.
        assert!(worst < 1_680.0, "{row:?}");
    }
}
