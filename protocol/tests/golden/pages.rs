//! Pages of the book of which some parts are made from the code. Each stands
//! between two marks; everything else is written by hand.

use crate::is_blessed;
use crate::vectors::BLESS;
use std::fs;
use std::path::Path;

const END: &str = "<!-- end -->";

/// Compares the parts of a page with the code, or rewrites them.
pub(crate) fn hold(page: &str, parts: &[(String, String)]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(page);
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert_eq!(
        text.matches("<!-- generated: ").count(),
        parts.len(),
        "docs/{page} has another number of generated parts"
    );
    let mut new = text.clone();
    for (name, part) in parts {
        let mark = format!("<!-- generated: {name} -->");
        let (before, rest) = new
            .split_once(&mark)
            .unwrap_or_else(|| panic!("docs/{page} has no {mark}"));
        let (_, after) = rest
            .split_once(END)
            .unwrap_or_else(|| panic!("docs/{page}: {mark} has no {END}"));
        new = format!("{before}{mark}\n\n{}\n\n{END}{after}", part.trim());
    }
    if is_blessed() {
        fs::write(&path, new).expect("the page is written");
    } else if let Some((now, should_be)) = text.lines().zip(new.lines()).find(|(a, b)| a != b) {
        panic!("\ndocs/{page} says\n  {now}\nand the code says\n  {should_be}\n{BLESS}\n");
    } else {
        assert!(
            text == new,
            "\ndocs/{page} is not what the code says\n{BLESS}\n"
        );
    }
}
