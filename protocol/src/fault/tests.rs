//! Completeness and order of the table.

use super::*;

/// The compiler does not ask for a row.
#[test]
fn every_fault_has_its_row() {
    let source = include_str!("../fault.rs");
    let (_, list) = source.split_once("pub enum Fault {").expect("the list");
    let (list, _) = list.split_once('}').expect("its end");
    let codes = list.lines().filter_map(|line| {
        let (_, code) = line.trim().strip_suffix(',')?.split_once(" = ")?;
        code.parse::<u8>().ok()
    });
    assert!(codes.eq(FAULTS.map(|spec| spec.fault.code())));
}

#[test]
fn every_code_and_every_name_stands_once_in_order() {
    for pair in FAULTS.windows(2) {
        assert!(pair[0].fault.code() < pair[1].fault.code());
    }
    for (i, spec) in FAULTS.iter().enumerate() {
        assert_eq!(Fault::find(spec.fault.code()), Some(spec));
        assert!(FAULTS[..i].iter().all(|other| other.name != spec.name));
    }
    assert_eq!(Fault::find(0), None);
}
