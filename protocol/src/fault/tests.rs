//! Completeness and order of the table.

use super::*;

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
