//! `crepitus sweep`: the rows are those of single runs, and the same whatever happens on
//! the way.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use support::{crepitus, names, number, stderr, stdout, table};

const TS: &str = "effects.crepitus.static_torque_nm";
const KR: &str = "effects.crepitus.stiffness_nm_per_rad";

/// A grid of 15 short runs.
const GRID: [&str; 6] = [
    "--vary",
    "effects.crepitus.static_torque_nm=1.6:4:lin5",
    "--vary",
    "effects.crepitus.stiffness_nm_per_rad=20:200:log3",
    "--set",
    "duration_s=0.5",
];

/// Sweep of so many short runs that on any computer a part is written before the last of them: after
/// 8192 rows, or two seconds.
const MANY: [&str; 11] = [
    "low-speed",
    "--latin",
    "16000",
    "--seed",
    "5",
    "--vary",
    "effects.crepitus.stiffness_nm_per_rad=60:300:log",
    "--vary",
    "effects.crepitus.preset=coarse,fine",
    "--set",
    "duration_s=5e-4",
];

fn sweep_in(home: &Path, arguments: &[&str]) -> Output {
    crepitus()
        .arg("sweep")
        .args(arguments)
        .current_dir(home)
        .output()
        .expect("the program starts")
}

fn done(home: &Path, arguments: &[&str]) -> String {
    let output = sweep_in(home, arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

fn refused(home: &Path, arguments: &[&str], code: i32) -> String {
    let output = sweep_in(home, arguments);
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    stderr(&output)
}

/// Number of whole parts in a folder; one that is being written has a name with a dot before it.
fn whole_parts(folder: &Path) -> usize {
    let names = names(&folder.join("parts"));
    names.iter().filter(|name| !name.starts_with('.')).count()
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
    let text = done(
        home,
        &[&["low-speed", "--out", "s", "--format", "csv"], &GRID[..]].concat(),
    );
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
        let set = [format!("{TS}={}", ts[row]), format!("{KR}={}", kr[row])];
        let ran = crepitus()
            .args([
                "run",
                "low-speed",
                "--no-trace",
                "--json",
                "--set",
                "duration_s=0.5",
            ])
            .args([
                "--out", "one", "--force", "--set", &set[0], "--set", &set[1],
            ])
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
fn rows_do_not_depend_on_cores_or_on_kills() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let sweep = [
        "everything",
        "--latin",
        "300",
        "--seed",
        "5",
        "--vary",
        "effects.cuff.stiffness_nm_per_rad=60:300:log",
        "--vary",
        "effects.crepitus.preset=coarse,fine",
        "--set",
        "duration_s=0.2",
    ];
    for format in ["csv", "parquet"] {
        for folder in ["one", "three", "whole", "killed"] {
            let _ = fs::remove_dir_all(home.join(folder));
        }
        let with = |sweep: &[&'static str], folder, threads| {
            let how = ["--out", folder, "--threads", threads, "--format", format];
            [&how[..], sweep].concat()
        };
        done(home, &with(&sweep, "one", "1"));
        done(home, &with(&sweep, "three", "3"));
        let read = |folder| fs::read(home.join(folder).join(format!("sweep.{format}"))).unwrap();
        assert!(read("one") == read("three"), "{format}: cores");

        // Killed each time that there is a new part, and begun again.
        done(home, &with(&MANY, "whole", "2"));
        let mut kills = 0;
        while !home.join("killed").join(format!("sweep.{format}")).exists() && kills < 3 {
            let mut child = crepitus()
                .arg("sweep")
                .args(with(&MANY, "killed", "1"))
                .current_dir(home)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let before = whole_parts(&home.join("killed"));
            let begun = Instant::now();
            while child.try_wait().unwrap().is_none()
                && whole_parts(&home.join("killed")) <= before
                && begun.elapsed() < Duration::from_mins(1)
            {
                std::thread::sleep(Duration::from_millis(5));
            }
            kills += u32::from(child.try_wait().unwrap().is_none());
            let _ = child.kill();
            let _ = child.wait();
        }
        assert!(kills > 0, "{format}: it was over before it was killed");
        done(home, &with(&MANY, "killed", "2"));
        assert!(
            read("whole") == read("killed"),
            "{format}: killed {kills} times"
        );
        let mut left = vec!["sweep.json".to_owned(), format!("sweep.{format}")];
        left.sort();
        assert_eq!(names(&home.join("killed")), left);
    }
}

#[test]
fn shards_together_are_the_whole() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let sweep =
        |more: &[&'static str]| [&["low-speed", "--format", "csv"], &GRID[..], more].concat();
    done(home, &sweep(&["--out", "whole"]));
    for part in ["3/4", "1/4", "2/4"] {
        let text = done(home, &sweep(&["--out", "parts", "--shard", part]));
        assert!(text.contains("--merge parts"), "{text}");
    }
    let text = refused(home, &["--merge", "parts"], 1);
    assert!(
        text.contains("4 of 15 runs are not there: points 11 to 14"),
        "{text}"
    );
    assert!(!home.join("parts/sweep.csv").exists());
    // One that ran elsewhere.
    done(home, &sweep(&["--out", "elsewhere", "--shard", "4/4"]));
    let text = done(home, &["--merge", "parts", "elsewhere", "--format", "csv"]);
    assert!(text.contains("all 15 runs are there"), "{text}");
    let read = |folder| fs::read_to_string(home.join(folder).join("sweep.csv")).unwrap();
    assert_eq!(read("whole"), read("parts"));
    // And again: it is there already.
    done(home, &["--merge", "parts"]);

    // Another sweep is not taken for a part of it.
    let other = [&GRID[..4], &["--set", "duration_s=0.6"]].concat();
    let other = |more: &[&'static str]| [&["low-speed"], &other[..], more].concat();
    done(home, &other(&["--out", "other", "--shard", "4/4"]));
    done(home, &sweep(&["--out", "again", "--shard", "1/4"]));
    let text = refused(home, &["--merge", "again", "other"], 2);
    assert!(text.contains("other has another sweep"), "{text}");
    let text = refused(home, &other(&["--out", "parts"]), 2);
    assert!(
        text.contains("parts has another sweep") && text.contains("--force"),
        "{text}"
    );
    done(home, &other(&["--out", "parts", "--force"]));
}

#[test]
fn a_run_that_fails_is_a_row_with_its_reason() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let output = sweep_in(
        home,
        &[
            "low-speed",
            "--out",
            "s",
            "--format",
            "csv",
            "--json",
            "--set",
            "duration_s=20",
            "--vary",
            "solver.kind=euler,exact",
            "--vary",
            "solver.step_s=5e-5,5e-2",
            "--vary",
            "effects.crepitus.kinetic_torque_nm=0.3,100",
            "--set",
            "effects.crepitus.convention=physical",
        ],
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let told: Value = serde_json::from_str(&stdout(&output)).unwrap();
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
    let arguments = [
        "low-speed",
        "--points",
        "points.csv",
        "--out",
        "s",
        "--format",
        "csv",
    ];
    done(home, &arguments);
    let (header, rows) = table(&home.join("s/sweep.csv"));
    assert_eq!(column(&header, &rows, TS), ["2.5", "3.5"]);
    assert_eq!(column(&header, &rows, "solver"), ["exact", "exact-events"]);
    // Other points, the same file name: another sweep.
    fs::write(
        home.join("points.csv"),
        format!("{TS},solver.kind\n2.5,exact\n3.6,exact\n"),
    )
    .unwrap();
    assert!(refused(home, &arguments, 2).contains("another sweep"));
    fs::write(home.join("points.csv"), format!("{TS},{TS}\n2.5,2\n")).unwrap();
    let text = refused(home, &arguments, 2);
    assert!(text.contains("points.csv: line 1: column 2"), "{text}");
}

#[test]
fn traces_are_those_of_single_runs() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(
        home,
        &[
            "low-speed",
            "--traces",
            "--out",
            "s",
            "--vary",
            "duration_s=0.1,0.3",
        ],
    );
    assert_eq!(
        names(&home.join("s/traces")),
        ["0000000000.csv", "0000000001.csv"]
    );
    let ran = crepitus()
        .args([
            "run",
            "low-speed",
            "--set",
            "duration_s=0.3",
            "--out",
            "one",
        ])
        .current_dir(home)
        .output()
        .unwrap();
    assert!(ran.status.success());
    let [a, b] =
        ["s/traces/0000000001.csv", "one/trace.csv"].map(|f| fs::read(home.join(f)).unwrap());
    assert!(a == b);
}

/// Two at once in one folder, and what becomes of a part that was damaged.
#[test]
fn one_program_runs_a_sweep_and_a_damaged_part_makes_no_table() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let arguments = [
        &["--out", "s", "--threads", "1", "--format", "csv"],
        &MANY[..],
    ]
    .concat();
    let child = crepitus()
        .arg("sweep")
        .args(&arguments)
        .current_dir(home)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let is_running = || {
        let names = names(&home.join("s/parts"));
        names.iter().any(|name| name.starts_with(".running-"))
    };
    while !is_running() {
        assert!(begun.elapsed() < Duration::from_mins(1), "it does not run");
        std::thread::sleep(Duration::from_millis(2));
    }
    for force in [&[][..], &["--force"]] {
        let text = refused(home, &[&arguments[..], force].concat(), 2);
        let words = "another program is running points 0 to 15999";
        assert!(text.contains(words) && text.contains("--out"), "{text}");
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert!(!is_running(), "{}", stderr(&output));

    let shard = |part| {
        let how = [
            "low-speed",
            "--format",
            "csv",
            "--out",
            "t",
            "--shard",
            part,
        ];
        done(home, &[&how[..], &GRID].concat());
    };
    shard("1/2");
    shard("2/2");
    let part = home.join("t/parts/0000000007-0000000015.csv");
    let mut bytes = fs::read(&part).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&part, bytes).unwrap();
    let text = refused(home, &["--merge", "t", "--format", "csv"], 1);
    assert!(
        text.contains("0000000007-0000000015.csv") && text.contains("move it away"),
        "{text}"
    );
    assert!(!home.join("t/sweep.csv").exists());
    fs::remove_file(part).unwrap();
    shard("2/2");
    done(home, &["--merge", "t", "--format", "csv"]);
    assert_eq!(names(&home.join("t")), ["sweep.csv", "sweep.json"]);
}

#[test]
fn an_interrupted_sweep_goes_on() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let how = ["--out", "s", "--threads", "1", "--format", "csv"];
    let arguments = [&how[..], &MANY].concat();
    let child = crepitus()
        .arg("sweep")
        .args(&arguments)
        .current_dir(home)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while whole_parts(&home.join("s")) == 0 {
        assert!(begun.elapsed() < Duration::from_mins(1), "there is no part");
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = stderr(&output);
    assert!(
        text.contains("interrupted after") && text.contains("goes on from there"),
        "{text}"
    );
    let parts = names(&home.join("s/parts"));
    assert!(!parts.is_empty() && parts.iter().all(|p| !p.starts_with('.')));
    // Only the others run.
    let again = [&arguments[..], &["--json"]].concat();
    let told: Value = serde_json::from_str(&done(home, &again)).unwrap();
    let ran = told["ran"].as_u64().unwrap();
    assert!((1..16_000).contains(&ran), "{told}");
    let (_, rows) = table(&home.join("s/sweep.csv"));
    assert_eq!(rows.len(), 16_000);
}

#[test]
fn the_cost_is_estimated() {
    let home = tempfile::tempdir().unwrap();
    let arguments = [&["low-speed", "--estimate=1e7", "--json"], &GRID[..]].concat();
    let told: Value = serde_json::from_str(&done(home.path(), &arguments)).unwrap();
    let number = |name: &str| told[name].as_f64().unwrap();
    assert_eq!(told["measured_runs"], 15);
    let ratio = number("wall_s") / number("measured_wall_s") / (1e7 / 15.0);
    assert!((ratio - 1.0).abs() < 1e-9, "{told}");
    assert!(number("bytes") > 1e7);
    assert_eq!(names(home.path()), Vec::<String>::new());
}

#[test]
fn what_is_wrong_is_said_before_anything_runs() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for (arguments, word) in [
        (&["low-speed"][..], "nothing is varied"),
        (
            &["low-speed", "--vary", "effects.crepitus.stifness=1,2"],
            "stifness",
        ),
        (&["low-speed", "--vary", "duration_s=0:1:log3"], "above 0"),
        (
            &["low-speed", "--vary", "duration_s=1:2"],
            "how many values",
        ),
        (
            &["nothing", "--vary", "duration_s=1,2"],
            "no such scene ships",
        ),
        (
            &["low-sped", "--vary", "duration_s=1,2"],
            "no such scene ships (did you mean low-speed?)",
        ),
        (
            &["low-speed", "--vary", "duration_s=1,2", "--shard", "4/3"],
            "no part 4 of 3",
        ),
        (
            &["low-speed", "--vary", "duration_s=1:2", "--latin", "0"],
            "at least one run",
        ),
        (
            &["low-speed", "--vary", "duration_s=1,2", "--threads", "0"],
            "expected at least 1, got 0",
        ),
        (
            &["low-speed", "--vary", "duration_s=1,2", "--seed", "7"],
            "--seed: only --latin and --sobol",
        ),
        (
            &[
                "low-speed",
                "--vary",
                "duration_s=1,2",
                "--set",
                "duration_s=1",
            ],
            "--set duration_s: it is varied, too",
        ),
        (
            &[
                "low-speed",
                "--vary",
                "duration_s=1,2",
                "--set",
                "title=a",
                "--set",
                "title=b",
            ],
            "`title` is set twice",
        ),
        (
            &["....toml", "--vary", "duration_s=1,2"],
            "no such scene ships",
        ),
        (&["--merge", "."], "sweep.json is missing"),
        (&["low-speed", "--points", "none.csv"], "none.csv"),
    ] {
        let text = refused(home, arguments, 2);
        assert!(text.contains(word), "{arguments:?}: {text}");
    }
    assert_eq!(names(home), Vec::<String>::new());
}

/// The numbers of a Latin hypercube are where they are said to be.
#[test]
fn sampled_points_fill_their_ranges() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for kind in ["--latin", "--sobol"] {
        done(
            home,
            &[
                "low-speed",
                kind,
                "64",
                "--seed",
                "3",
                "--force",
                "--out",
                "s",
                "--format",
                "csv",
                "--set",
                "duration_s=0.05",
                "--vary",
                "effects.crepitus.static_torque_nm=2:4",
            ],
        );
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
    let arguments = [
        "low-speed",
        "--vary",
        "duration_s=0.01,0.02",
        "--threads",
        "99999999",
    ];
    done(home.path(), &arguments);
}

#[test]
fn a_part_that_is_missing_is_told_even_if_the_table_is_there() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(home, &["low-speed", "--vary", "duration_s=0.01,0.02"]);
    let long = "x".repeat(300);
    for missing in ["nowhere", &long] {
        refused(home, &["--merge", "out/sweep-low-speed", missing], 2);
    }
}
