//! Every fault still applies to the sources as they are.

use crepitus_tools::faults::patch::{Change, all};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Areas, and how many faults each has at least.
const LEAST: [(&str, usize); 6] = [
    ("model", 60),
    ("firmware", 75),
    ("host", 42),
    ("protocol", 10),
    ("sim", 26),
    ("panel", 12),
];

/// Returns whether a fault is planted in a test, where it is none.
fn is_in_a_test(file: &Path, change: &Change) -> bool {
    let is_test_file = file
        .iter()
        .any(|part| part == "tests" || part == "tests.rs");
    // Tests stand below the code.
    let below = change.was.find("#[cfg(test)]\nmod tests {");
    let tests = below.map_or("", |at| &change.was[at..]);
    is_test_file || !change.now.ends_with(tests)
}

#[test]
fn every_patch_applies_to_the_sources_as_they_are() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let faults = all(&root).unwrap_or_else(|error| panic!("{error}"));
    let (mut names, mut wrong) = (HashSet::new(), Vec::new());
    for fault in &faults {
        let patch = fault.file.display();
        if !names.insert(&fault.name) {
            wrong.push(format!("{patch}: another fault has this name: rename one"));
        }
        let changes = fault.apply(&root).unwrap_or_else(|error| {
            wrong.push(error.to_string());
            BTreeMap::new()
        });
        for (file, _) in (changes.iter()).filter(|(file, change)| is_in_a_test(file, change)) {
            let file = file.display();
            wrong.push(format!(
                "{patch}: {file}: plant it in the code, not in a test"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (area, least) in LEAST {
        let there = faults.iter().filter(|fault| fault.area == area).count();
        assert!(there >= least, "{there} faults in tools/faults/{area}");
    }
}

#[test]
fn a_change_of_a_test_is_none_of_the_code() {
    let was = "fn a() {}\n#[cfg(test)]\nmod tests {\n    one();\n}\n".to_owned();
    let change = |from: &str, to: &str| Change {
        was: was.clone(),
        now: was.replace(from, to),
    };
    let lib = Path::new("model/src/lib.rs");
    assert!(!is_in_a_test(lib, &change("a()", "b()")));
    assert!(is_in_a_test(lib, &change("one", "two")));
    let test = Path::new("model/tests/laws.rs");
    assert!(is_in_a_test(test, &change("a()", "b()")));
}
