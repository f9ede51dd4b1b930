//! The catalogue of hard cases as text: for a terminal, and as a page of the
//! book, whose source this is.

use crate::stability::{Case, criterion};
use serde_json::{Value, json};
use std::fmt::Write;

/// The most inputs of a case that the text shows.
const MOST_INPUTS: usize = 6;

/// The cases in Markdown.
pub fn markdown(cases: &[Case]) -> String {
    let mut text = String::from(
        "# The hard cases\n\nMade by `crepitus stability --list`; `crepitus stability --case NAME` runs one and shows \
         every cell.\nUnder the parameters of the paper unless something else is said, in steps of 50 µs.\n\nIn every \
         step of every case:\n\n",
    );
    // Writing to a String cannot fail.
    for bound in criterion::common_bounds() {
        let _ = writeln!(text, "- {bound}");
    }
    for case in cases {
        let long = if case.long { " (with `--long`)" } else { "" };
        let _ = write!(
            text,
            "\n## {} {}{long}\n\n**{}.** {}\n\n",
            case.id, case.name, case.title, case.hard
        );
        entry(&mut text, "Input", &case.inputs(), MOST_INPUTS);
        entry(&mut text, "Criterion", &case.criteria(), usize::MAX);
        let _ = writeln!(text, "- Source: {}", case.source);
    }
    text
}

/// One line, or a list of at most so many.
fn entry(text: &mut String, name: &str, all: &[String], most: usize) {
    if let [only] = all {
        let _ = writeln!(text, "- {name}: {only}");
        return;
    }
    let _ = writeln!(text, "- {name}:");
    for one in all.iter().take(most) {
        let _ = writeln!(text, "  - {one}");
    }
    if let Some(more) = all.len().checked_sub(most).filter(|n| *n > 0) {
        let _ = writeln!(text, "  - … and {more} more of the kind");
    }
}

/// The cases for machines.
pub fn value(cases: &[Case]) -> Value {
    let cases: Vec<Value> = cases
        .iter()
        .map(|case| {
            json!({
                "case": case.id,
                "name": case.name,
                "title": case.title,
                "hard": case.hard,
                "inputs": case.inputs(),
                "criteria": case.criteria(),
                "source": case.source,
                "long": case.long,
            })
        })
        .collect();
    json!({ "common": criterion::common_bounds(), "cases": cases })
}
