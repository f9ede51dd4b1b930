//! Cycles on record in `docs/generated/cycles.md`, compared with what these tests measure.

use crate::budget::percent;
use crate::host::Flash;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Shares by which a figure may differ from the record. After a build in another folder code lies elsewhere in the flash,
/// and with it waits change: means by one or two in a hundred, the worst tick under a commit by eight.
const MOST_OF_MEAN: f64 = 0.04;
const MOST_OF_WORST: f64 = 0.1;

const BLESS: &str =
    "CREPITUS_BLESS=1 CREPITUS_LONG=1 cargo test -p crepitus-emulator --test drive_image";

/// Compares a row of the record with a mean, where there is one, and a worst number of cycles. With `CREPITUS_BLESS=1`
/// one that differs is written anew.
pub(crate) fn on_record(what: &str, flash: Flash, mean: Option<f64>, worst: u64) {
    static WRITING: Mutex<()> = Mutex::new(());
    let _one_at_a_time = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generated/cycles.md");
    let page = fs::read_to_string(&path).expect("the page");
    let key = format!("| {what} | {} |", flash.label());
    let shown = mean.map_or_else(String::new, |mean| format!("{mean:.0}"));
    let row = format!("{key} {shown} | {worst} | {:.1} % |", percent(worst));
    println!("{row}");
    let recorded = page.lines().find(|line| line.starts_with(&key));
    if recorded.is_some_and(|line| is_near(&line[key.len()..], mean, worst)) {
        return;
    }
    assert!(
        std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0"),
        "docs/generated/cycles.md has {recorded:?}, not {row}: {BLESS}"
    );
    let (head, rows) = page.split_at(page.find("|--").expect("a table"));
    let (rule, rows) = rows.split_once('\n').expect("its rule");
    let mut rows: Vec<_> = rows
        .lines()
        .filter(|line| !line.starts_with(&key))
        .collect();
    rows.push(&row);
    rows.sort_unstable();
    let text = format!("{head}{rule}\n{}\n", rows.join("\n"));
    fs::write(&path, text).expect("a page");
}

/// Returns whether the cells of a row, from the mean on, are these figures.
#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
fn is_near(cells: &str, mean: Option<f64>, worst: u64) -> bool {
    let mut cells = cells.split('|').map(|cell| cell.trim().parse::<f64>().ok());
    let mut near = |measured: Option<f64>, most: f64| match (cells.next().flatten(), measured) {
        (Some(recorded), Some(measured)) => (recorded - measured).abs() <= most * measured,
        (recorded, measured) => recorded.is_none() && measured.is_none(),
    };
    near(mean, MOST_OF_MEAN) && near(Some(worst as f64), MOST_OF_WORST)
}
