//! Every fault still applies to the sources as they are.

use crepitus_tools::faults::fault::all;
use crepitus_tools::faults::firmware;
use std::collections::HashSet;
use std::path::Path;

#[test]
fn every_fault_has_its_place_in_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let faults = all().expect("the list can be read");
    assert!(faults.len() >= 36, "{} faults", faults.len());
    let mut names = HashSet::new();
    let mut broken = Vec::new();
    for fault in &faults {
        assert!(names.insert(&fault.name), "{} is there twice", fault.name);
        assert!(!fault.what.trim().is_empty(), "{} says nothing", fault.name);
        let path = root.join(&fault.file);
        let source = std::fs::read_to_string(&path).expect("the file is there");
        // Tests stand below the code, and a fault in them is none.
        let code = source
            .find("#[cfg(test)]\nmod tests")
            .unwrap_or(source.len());
        match fault.place(&source) {
            Ok((start, end)) => {
                assert!(end < code, "{} is planted in a test", fault.name);
                assert_ne!(
                    source[start..end],
                    fault.with,
                    "{} changes nothing",
                    fault.name
                );
            }
            Err(error) => broken.push(error.to_string()),
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_fault_of_the_firmware_has_its_place_in_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let faults = firmware::all().expect("the list can be read");
    assert!(faults.len() >= 35, "{} faults", faults.len());
    let mut names = HashSet::new();
    for fault in &faults {
        assert!(names.insert(&fault.name), "{} is there twice", fault.name);
        let has_edit = !fault.edit.is_empty() || fault.image.is_some();
        assert!(has_edit, "{} changes nothing", fault.name);
        if let Err(error) = fault.sources(&root) {
            panic!("{error}");
        }
    }
}
