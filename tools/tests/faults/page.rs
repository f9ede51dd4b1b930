//! The page in the book is that of the patches, and no fault is a hole.

use crepitus_tools::faults::page::{COMMAND, FILE, is_hole, line, page};
use crepitus_tools::faults::patch::all;
use std::fs;
use std::path::Path;

#[test]
fn the_page_is_that_of_the_patches_and_has_no_hole() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let faults = all(&root).unwrap_or_else(|error| panic!("{error}"));
    let holes: Vec<String> = faults
        .iter()
        .filter(|fault| is_hole(fault))
        .map(line)
        .collect();
    assert!(holes.is_empty(), "{}", holes.join("\n"));
    let text = fs::read_to_string(root.join(FILE)).expect("the page");
    let is_current = text == page(&faults);
    assert!(is_current, "{FILE}: `{COMMAND} -- --missing` writes it");
}
