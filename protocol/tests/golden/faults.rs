//! The parts of `docs/generated/faults.md` that are made from the table of faults.

use crate::pages;
use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::coil::COIL_FAULTS;
use crepitus_protocol::fault::{FAULTS, FaultSpec};
use std::fmt::Write;
use std::fs;
use std::path::Path;

#[test]
fn every_fault_is_on_its_page() {
    let mut parts = vec![("table".to_owned(), table()), ("coil".to_owned(), coil())];
    for spec in &FAULTS {
        parts.push((spec.name.to_owned(), section(spec)));
    }
    pages::hold("generated/faults.md", &parts);
}

/// Each has a section of its own, with a word on what to look at.
#[test]
fn every_fault_has_troubleshooting_steps() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/faults.md");
    let text = fs::read_to_string(page).expect("the page");
    for spec in &FAULTS {
        let heading = format!("### {} {}\n", spec.fault.code(), spec.name);
        let (_, rest) = text
            .split_once(&heading)
            .unwrap_or_else(|| panic!("docs/faults.md has no {heading}"));
        let section = rest.split("\n### ").next().unwrap_or(rest);
        assert!(section.contains("**Look at**"), "{heading}");
    }
}

fn within(spec: &FaultSpec) -> String {
    spec.within_ticks.map_or_else(
        || "floats already".to_owned(),
        |ticks| {
            let ms = f64::from(ticks) * 1e3 / f64::from(TICKS_PER_S);
            format!("{ticks} ticks, {ms} ms")
        },
    )
}

fn table() -> String {
    let mut text =
        "| code | name | noticed by | from the cause until the bridge floats |\n|---|---|---|---|\n"
            .to_owned();
    for spec in &FAULTS {
        let _ = writeln!(
            text,
            "| {code} | [{name}](#{code}-{name}) | {} | {} |",
            spec.detector.name(),
            within(spec),
            code = spec.fault.code(),
            name = spec.name,
        );
    }
    text
}

/// The faults of the coil, all in one table: they have no pages of their own.
fn coil() -> String {
    let mut text =
        "| code | name | cause | detection | within | to go on |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for spec in &COIL_FAULTS {
        let ms = f64::from(spec.within_ticks) * 1e3 / f64::from(TICKS_PER_S);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} ticks, {ms} ms | {} |",
            spec.fault.code(),
            spec.name,
            spec.cause,
            spec.detection,
            spec.within_ticks,
            spec.clear,
        );
    }
    text
}

fn section(spec: &FaultSpec) -> String {
    format!(
        "| | |\n|---|---|\n| cause | {} |\n| noticed by | {} |\n| detection | {} |\n| reaction | {} |\n\
         | within | {} |\n| to go on | {} |",
        spec.cause,
        spec.detector.name(),
        spec.detection,
        spec.reaction,
        within(spec),
        spec.clear
    )
}
