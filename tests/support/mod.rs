//! Shared by the system tests: running the program and reading its files.

#![allow(dead_code, reason = "each test program uses its part")]

#[cfg(target_os = "linux")]
pub(crate) mod served;
#[cfg(target_os = "linux")]
pub(crate) mod terminal;

use crepitus_protocol::telemetry::{Block, TICKS_BYTES};
use crepitus_recording::{Damage, Recording, Row, Totals};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The program.
pub(crate) fn crepitus() -> Command {
    Command::new(env!("CARGO_BIN_EXE_crepitus"))
}

/// Runs the program.
pub(crate) fn run(arguments: &[&str]) -> Output {
    crepitus()
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Words of a line, none of which has a space.
pub(crate) fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// Runs the program with the words of a line.
pub(crate) fn run_line(line: &str) -> Output {
    run(&words(line))
}

/// stdout of a line that succeeds.
pub(crate) fn done(line: &str) -> String {
    let output = run_line(line);
    assert!(output.status.success(), "{line}: {}", stderr(&output));
    stdout(&output)
}

/// Runs the program without anything at stdin; asserts its exit code and a part of its error.
pub(crate) fn refuses(arguments: &[&str], code: i32, part: &str) {
    let output = crepitus()
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    assert!(text.contains(part), "{arguments:?}: {text}");
}

/// Weight of the scene `weight-in-the-brace`.
pub(crate) const WEIGHT_IN_THE_BRACE: [&str; 6] = [
    "--weight-kg",
    "2.44",
    "--lever-m",
    "0.2477",
    "--weight-inertia-kg-m2",
    "0.2202",
];

/// The top of the repository.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Data beside the repository, where it is there.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = repository().join("../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("left out: {name} is not beside the repository");
    None
}

/// stdout as text.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// stderr as text.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in a folder, in order; empty if there is none.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .map(|entries| {
            entries
                .map(|e| {
                    e.expect("an entry")
                        .file_name()
                        .to_string_lossy()
                        .into_owned()
                })
                .collect()
        })
        .unwrap_or_default();
    // The list of this program's files.
    names.retain(|name| name != ".crepitus.sha256");
    names.sort();
    names
}

/// The summary in a folder of results.
pub(crate) fn summary(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}

/// A CSV file without quotes: its header and its rows.
pub(crate) fn csv(file: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(file).expect("a CSV file");
    let mut lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    (header, lines.collect())
}

/// Bytes of a recording in progress that has half a second of samples: 500
/// blocks as long as one can be, each with what the file adds to it.
pub(crate) const HALF_A_SECOND: u64 = 500 * (TICKS_BYTES + Block::HEAD_BYTES + 16) as u64;

/// Bytes of a file, 0 if there is none.
pub(crate) fn length(file: &Path) -> u64 {
    fs::metadata(file).map_or(0, |data| data.len())
}

/// A recording that is not damaged.
pub(crate) fn recording(file: &Path) -> Recording {
    Recording::open(file, Damage::Refuse).unwrap_or_else(|error| panic!("{error}"))
}

/// Rows of a recording.
pub(crate) fn rows(recording: &Recording) -> Vec<Row> {
    let rows = recording.rows().expect("rows");
    rows.map(|row| row.expect("a row")).collect()
}

/// The accounting of a recording, recounted in its rows. The drive has not
/// restarted.
pub(crate) fn check_accounting(recording: &Recording) -> Totals {
    let totals = recording.accounting().totals;
    assert_eq!(totals.produced, totals.received + totals.dropped);
    let rows = rows(recording);
    assert_eq!(rows.len() as u64, totals.received);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return totals;
    };
    let begin = recording.accounting().segments[0].first_tick;
    assert_eq!(last.tick + 1 - begin, totals.produced);
    let mut missing = first.tick - begin;
    for pair in rows.windows(2) {
        let gap = pair[1]
            .tick
            .checked_sub(pair[0].tick + 1)
            .expect("growing ticks");
        assert_eq!(gap % 20, 0, "gaps of whole blocks");
        missing += gap;
    }
    assert_eq!(missing, totals.dropped);
    totals
}

/// A number in a CSV file.
pub(crate) fn number(cell: &str) -> f64 {
    cell.parse()
        .unwrap_or_else(|_| panic!("{cell} is no number"))
}

/// A CSV file: its header and its rows, unquoted.
pub(crate) fn table(file: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(file).expect("a CSV file");
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let header = cells(reader.headers().expect("a header"));
    let rows = reader.records().map(|row| cells(&row.expect("a row")));
    (header, rows.collect())
}

/// Returns whether a JSON object has the names and values of a row of a CSV file.
pub(crate) fn is_row(object: &Value, header: &[String], row: &[String]) -> bool {
    header
        .iter()
        .zip(row)
        .all(|(name, cell)| match &object.get(name) {
            None => panic!("{name} is not in {object}"),
            Some(Value::Null) => ["", "nan", "inf", "-inf"].contains(&cell.as_str()),
            Some(Value::Bool(flag)) => cell.parse() == Ok(*flag),
            // The JSON parser of these tests is off by last bits at times: by two below a power of two.
            Some(Value::Number(number)) => {
                let (x, y) = (number.as_f64().expect("a number"), self::number(cell));
                (x - y).abs() <= 2.0 * f64::EPSILON * x.abs()
            }
            Some(Value::String(text)) => cell == text,
            Some(Value::Array(list)) => {
                let texts: Vec<_> = list.iter().filter_map(Value::as_str).collect();
                *cell == texts.join(" ")
            }
            Some(Value::Object(_)) => false,
        })
}
