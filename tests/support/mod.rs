//! Shared by the system tests: running the program and reading its files.

#![allow(dead_code, reason = "each test program uses its part")]

#[cfg(target_os = "linux")]
pub(crate) mod served;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

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

/// Whether a JSON object has the names and values of a row of a CSV file.
pub(crate) fn is_row(object: &Value, header: &[String], row: &[String]) -> bool {
    header
        .iter()
        .zip(row)
        .all(|(name, cell)| match &object.get(name) {
            None => panic!("{name} is not in {object}"),
            Some(Value::Null) => ["", "nan", "inf", "-inf"].contains(&cell.as_str()),
            Some(Value::Bool(flag)) => cell.parse() == Ok(*flag),
            // The JSON parser of these tests is off by a last bit at times.
            Some(Value::Number(number)) => {
                let (x, y) = (number.as_f64().expect("a number"), self::number(cell));
                (x - y).abs() <= f64::EPSILON * x.abs()
            }
            Some(Value::String(text)) => cell == text,
            Some(Value::Array(list)) => {
                let texts: Vec<_> = list.iter().filter_map(Value::as_str).collect();
                *cell == texts.join(" ")
            }
            Some(Value::Object(_)) => false,
        })
}
