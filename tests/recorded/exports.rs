//! Exports: whole, on a full disk, and in the hands of other programs.

use crate::support::{self, check_accounting, names, recording, rows, run, stderr, stdout};
use crate::{recorded, recording_in_progress, text};
use crepitus_recording::{Damage, Recording};
use serde_json::Value;
use std::fs;
use std::process::Command;

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
        check_accounting(&recording).received
    );
}
