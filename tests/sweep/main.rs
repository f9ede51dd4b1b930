//! `crepitus sweep`: the rows are those of single runs, and the same whatever happens on
//! the way.

mod again;
mod killed;
#[path = "../support/mod.rs"]
mod support;
mod usage;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;
use support::{crepitus, names, number, stderr, stdout, table};

const TS: &str = "effects.crepitus.static_torque_nm";
const KR: &str = "effects.crepitus.stiffness_nm_per_rad";

/// A grid of 15 short runs.
const GRID: &str = "low-speed --vary effects.crepitus.static_torque_nm=1.6:4:lin5 \
                    --vary effects.crepitus.stiffness_nm_per_rad=20:200:log3 --set duration_s=0.5";

/// A sweep with these arguments, none of which has a space.
fn sweep(home: &Path, arguments: &str) -> Command {
    let mut command = crepitus();
    command.arg("sweep").args(arguments.split(' '));
    command.current_dir(home);
    command
}

fn done(home: &Path, arguments: &str) -> String {
    let output = sweep(home, arguments).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

fn refused(home: &Path, arguments: &str, code: i32) -> String {
    let output = sweep(home, arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    stderr(&output)
}

/// The cell of a column in each row.
fn column(header: &[String], rows: &[Vec<String>], name: &str) -> Vec<String> {
    let place = header
        .iter()
        .position(|column| column == name)
        .unwrap_or_else(|| panic!("no column {name} in {header:?}"));
    rows.iter().map(|row| row[place].clone()).collect()
}

#[test]
fn a_row_has_every_number_of_its_run() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let text = done(home, &format!("{GRID} --out s --format csv"));
    assert!(
        text.contains("15 runs in") && text.contains("s/sweep.csv"),
        "{text}"
    );
    assert_eq!(names(&home.join("s")), ["sweep.csv", "sweep.json"]);
    let (header, rows) = table(&home.join("s/sweep.csv"));
    assert_eq!(rows.len(), 15);
    assert_eq!(
        column(&header, &rows, "index"),
        (0..15).map(|i| i.to_string()).collect::<Vec<_>>()
    );
    let (ts, kr) = (column(&header, &rows, TS), column(&header, &rows, KR));
    assert_eq!(&kr[..4], ["20.0", "63.2455532034", "200.0", "20.0"]);
    assert_eq!(&ts[..4], ["1.6", "1.6", "1.6", "2.2"]);
    for row in [0, 7, 14] {
        let (ts, kr) = (&ts[row], &kr[row]);
        let line = format!(
            "run low-speed --no-trace --json --set duration_s=0.5 --out one --force \
             --set {TS}={ts} --set {KR}={kr}"
        );
        let ran = crepitus()
            .args(line.split(' '))
            .current_dir(home)
            .output()
            .unwrap();
        assert!(ran.status.success(), "{}", stderr(&ran));
        let summary = fs::read_to_string(home.join("one/summary.json")).unwrap();
        let mut seen = 0;
        for (name, cell) in header.iter().zip(&rows[row]) {
            // As text: the same digits are the same bits.
            let key = name.rsplit('.').next().unwrap();
            if let Some((_, value)) = summary.split_once(&format!("\"{key}\": "))
                && name.contains('.')
                && !name.starts_with("effects")
            {
                let value: String = value.chars().take_while(|c| !",\n".contains(*c)).collect();
                let value = if value == "null" { "" } else { value.as_str() };
                assert_eq!(cell, value, "{name}");
                seen += 1;
            }
        }
        assert!(seen > 20, "{seen}");
    }
}

#[test]
fn shards_together_are_the_whole() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let sweep = |more: &str| format!("{GRID} --format csv --out {more}");
    done(home, &sweep("whole"));
    for part in ["3/4", "1/4", "2/4"] {
        let text = done(home, &sweep(&format!("parts --shard {part}")));
        assert!(text.contains("--merge parts"), "{text}");
    }
    let text = refused(home, "--merge parts", 1);
    assert!(
        text.contains("4 of 15 runs are not there: points 11 to 14"),
        "{text}"
    );
    assert!(!home.join("parts/sweep.csv").exists());
    // One that ran elsewhere.
    done(home, &sweep("elsewhere --shard 4/4"));
    let text = done(home, "--merge parts elsewhere --format csv");
    assert!(text.contains("all 15 runs are there"), "{text}");
    let read = |folder| fs::read_to_string(home.join(folder).join("sweep.csv")).unwrap();
    assert_eq!(read("whole"), read("parts"));
    // And again: it is there already.
    done(home, "--merge parts");

    // Another sweep is not taken for a part of it.
    let longer = GRID.replace("duration_s=0.5", "duration_s=0.6");
    let other = |more: &str| format!("{longer} --out {more}");
    done(home, &other("other --shard 4/4"));
    done(home, &sweep("again --shard 1/4"));
    let text = refused(home, "--merge again other", 2);
    assert!(text.contains("other has another sweep"), "{text}");
    let text = refused(home, &other("parts"), 2);
    assert!(
        text.contains("parts has another sweep") && text.contains("--force"),
        "{text}"
    );
    done(home, &other("parts --force"));
}

#[test]
fn a_run_that_fails_is_a_row_with_its_reason() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let told = done(
        home,
        "low-speed --out s --format csv --json --set duration_s=20 --vary solver.kind=euler,exact \
         --vary solver.step_s=5e-5,5e-2 --vary effects.crepitus.kinetic_torque_nm=0.3,100 \
         --set effects.crepitus.convention=physical",
    );
    let told: Value = serde_json::from_str(&told).unwrap();
    let (header, rows) = table(&home.join("s/sweep.csv"));
    let failures = column(&header, &rows, "failure");
    assert_eq!(rows.len(), 8);
    let diverged = failures.iter().filter(|f| f.contains("diverged")).count();
    let refused = failures
        .iter()
        .filter(|f| f.contains("kinetic_torque_nm"))
        .count();
    assert_eq!((diverged, refused), (1, 4), "{failures:#?}");
    assert_eq!(told["failed"], 5);
    for (failure, mean) in failures
        .iter()
        .zip(column(&header, &rows, "torque.mean_nm"))
    {
        assert_eq!(failure.is_empty(), !mean.is_empty());
        assert!(failure.is_empty() || failure.len() > 20);
    }
}

#[test]
fn points_of_another_program() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    fs::write(
        home.join("points.csv"),
        format!("{TS},solver.kind\n2.5,exact\n3.5,exact-events\n"),
    )
    .unwrap();
    let arguments = "low-speed --points points.csv --out s --format csv";
    done(home, arguments);
    let (header, rows) = table(&home.join("s/sweep.csv"));
    assert_eq!(column(&header, &rows, TS), ["2.5", "3.5"]);
    assert_eq!(column(&header, &rows, "solver"), ["exact", "exact-events"]);
    // Other points, the same file name: another sweep.
    fs::write(
        home.join("points.csv"),
        format!("{TS},solver.kind\n2.5,exact\n3.6,exact\n"),
    )
    .unwrap();
    assert!(refused(home, arguments, 2).contains("another sweep"));
    fs::write(home.join("points.csv"), format!("{TS},{TS}\n2.5,2\n")).unwrap();
    let text = refused(home, arguments, 2);
    assert!(text.contains("points.csv: line 1: column 2"), "{text}");
}

#[test]
fn traces_are_those_of_single_runs() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(home, "low-speed --traces --out s --vary duration_s=0.1,0.3");
    assert_eq!(
        names(&home.join("s/traces")),
        ["0000000000.csv", "0000000001.csv"]
    );
    let ran = crepitus()
        .args("run low-speed --set duration_s=0.3 --out one".split(' '))
        .current_dir(home)
        .output()
        .unwrap();
    assert!(ran.status.success());
    let [a, b] =
        ["s/traces/0000000001.csv", "one/trace.csv"].map(|f| fs::read(home.join(f)).unwrap());
    assert!(a == b);
}

#[test]
fn the_cost_is_estimated() {
    let home = tempfile::tempdir().unwrap();
    let told = done(home.path(), &format!("{GRID} --estimate=1e7 --json"));
    let told: Value = serde_json::from_str(&told).unwrap();
    let number = |name: &str| told[name].as_f64().unwrap();
    assert_eq!(told["measured_runs"], 15);
    let ratio = number("wall_s") / number("measured_wall_s") / (1e7 / 15.0);
    assert!((ratio - 1.0).abs() < 1e-9, "{told}");
    assert!(number("bytes") > 1e7);
    assert_eq!(names(home.path()), Vec::<String>::new());
}

/// Runs that take long do not make an estimate take long: none is begun after 5 s.
#[test]
fn an_estimate_has_a_bound() {
    let home = tempfile::tempdir().unwrap();
    let begun = std::time::Instant::now();
    // Each run about a second of a debug build, and a thousand of them.
    let arguments = "everything --vary duration_s=1:2:lin1000 --estimate --json --threads 1";
    let told: Value = serde_json::from_str(&done(home.path(), arguments)).unwrap();
    let wall_s = begun.elapsed().as_secs_f64();
    let measured = told["measured_runs"].as_f64().unwrap();
    assert!((1.0..1000.0).contains(&measured), "{told}");
    let a_run_s = told["measured_wall_s"].as_f64().unwrap() / measured;
    assert!(
        wall_s < 5.0 + 0.5 + 3.0 * a_run_s + 3.0,
        "{wall_s} s: {told}"
    );
}

/// The numbers of a Latin hypercube are where they are said to be.
#[test]
fn sampled_points_fill_their_ranges() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for kind in ["--latin", "--sobol"] {
        let arguments = format!(
            "low-speed {kind} 64 --seed 3 --force --out s --format csv --set duration_s=0.05 \
             --vary {TS}=2:4"
        );
        done(home, &arguments);
        let (header, rows) = table(&home.join("s/sweep.csv"));
        let mut parts: Vec<_> = column(&header, &rows, TS)
            .iter()
            .map(|cell| ((number(cell) - 2.0) * 32.0).floor())
            .collect();
        parts.sort_by(f64::total_cmp);
        assert_eq!(parts, (0..64).map(f64::from).collect::<Vec<_>>(), "{kind}");
        assert!(
            column(&header, &rows, "design_seed")
                .iter()
                .all(|s| s == "3")
        );
    }
}

#[test]
fn more_threads_than_there_can_be_are_as_many_as_there_are_points() {
    let home = tempfile::tempdir().unwrap();
    let arguments = "low-speed --vary duration_s=0.01,0.02 --threads 99999999";
    done(home.path(), arguments);
}
