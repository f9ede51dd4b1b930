//! Every number of every law in a quick study: equal in three runs, and what is recorded.
//!
//! `law_numbers.csv` is the first of the runs. A change that moves a number by a thousandth of its scale
//! is noticed, whether a law or a task was changed; where it is meant,
//! `CREPITUS_BLESS=1 cargo test -p crepitus-studies --test law_numbers` writes the file.

use crepitus_studies::laws::task::Extent;
use crepitus_studies::laws::{ENTRIES, Plan, Row, TASKS, run};
use crepitus_studies::{Cancelled, Watcher};
use std::fs;
use std::path::Path;

const RECORDED: &str = include_str!("law_numbers.csv");

/// Largest change of a number beside its scale. Other computers have other sines in the last digit.
const MOST: f64 = 1e-3;

struct Nobody;

impl Watcher for Nobody {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// The controller's numbers: f32, one step a tick.
fn rows() -> Vec<Row> {
    let plan = Plan {
        repeats: 0,
        is_refined: false,
        ..Plan::of(Extent::Quick)
    };
    run(&plan, &mut Nobody).unwrap().rows
}

/// Law, quantity, and the number or the reason why there is none.
fn line(row: &Row) -> String {
    let value = match (row.value, row.failed) {
        (Some(value), None) => value.to_string(),
        (Some(value), Some(failed)) => format!("{value},{failed}"),
        (None, failed) => format!(",{}", failed.unwrap_or_default()),
    };
    format!("{},{},{value}", row.law, row.quantity)
}

#[test]
fn three_runs_are_equal_to_the_bit_and_as_recorded() {
    let [first, second, third] = [(); 3].map(|()| rows());
    assert_eq!(first, second);
    assert_eq!(first, third);
    let quantities: usize = TASKS.iter().map(|task| task.quantities().len()).sum();
    assert_eq!(first.len(), ENTRIES.len() * quantities);
    if std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0") {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/law_numbers.csv");
        let lines: Vec<_> = first.iter().map(line).collect();
        let text = format!("law,quantity,value,failed\n{}\n", lines.join("\n"));
        fs::write(path, text).unwrap();
        return;
    }
    let recorded: Vec<_> = RECORDED.lines().skip(1).collect();
    assert_eq!(recorded.len(), first.len());
    let mut moved = Vec::new();
    for (row, recorded) in first.iter().zip(recorded) {
        let found = line(row);
        let [mut now, mut before] = [&*found, recorded].map(|line| line.splitn(4, ','));
        let names = [now.next(), now.next()];
        assert_eq!(names, [before.next(), before.next()]);
        let [now_value, before_value] = [now.next(), before.next()].map(|v| v?.parse::<f64>().ok());
        let is_same = match (now_value, before_value) {
            (Some(a), Some(b)) => (a - b).abs() <= MOST * row.scale,
            (None, None) => true,
            _ => false,
        };
        if !is_same || now.next() != before.next() {
            moved.push(format!("{recorded} is now {found}"));
        }
    }
    assert!(moved.is_empty(), "{}", moved.join("\n"));
}
