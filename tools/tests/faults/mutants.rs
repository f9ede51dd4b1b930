//! A small crate whose mutants are noticed, missed, not reached, hang, or do not compile.

use crate::write_crate;
use crepitus_tools::faults::mutants::bench::{Bench, Fate};
use crepitus_tools::faults::mutants::read;
use std::fs;
use std::path::Path;

const SOURCE: &str = "//! Small.
pub struct Whole(pub u32);
pub fn sum(a: u32, b: u32) -> u32 {
    a + b
}
pub fn called(a: u32) -> u32 {
    a + 1
}
pub fn alone(a: u32) -> u32 {
    a + 2
}
pub fn whole() -> Whole {
    Whole(3)
}
pub fn ends() -> u32 {
    let mut n = 0;
    while n < 3 {
        n += 1;
    }
    n
}
#[cfg(test)]
mod tests {
    #[test]
    fn sums() {
        assert_eq!(super::sum(2, 3), 5);
        let _ = (super::called(1), super::whole().0, super::ends());
    }
}
";

/// Returns the mutant at this text as `cargo mutants` lists it.
fn listed(genre: &str, at: &str, replacement: &str) -> String {
    let before = &SOURCE[..SOURCE.find(at).expect("the text")];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').unwrap_or(0);
    format!(
        r#"{{"file": "small/src/lib.rs", "name": "{at}", "genre": "{genre}", "replacement": "{replacement}",
            "package": "small", "span": {{"start": {{"line": {line}, "column": {column}}}}}}}"#
    )
}

#[test]
fn each_mutant_has_its_fate() {
    let here = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mutants");
    let _ = fs::remove_dir_all(&here);
    let (root, scratch) = (here.join("root"), here.join("scratch"));
    write_crate(&root, SOURCE);
    fs::create_dir_all(&scratch).expect("a folder");
    let list = [
        listed("BinaryOperator", "+ b", "-"),
        listed("BinaryOperator", "+ 1", "*"),
        listed("BinaryOperator", "+ 2", "*"),
        listed("FnValue", "Whole(3)", "Default::default()"),
        listed("BinaryOperator", "+= 1", "*="),
    ];
    let mutants = read(&format!("[{}]", list.join(","))).expect("a list");
    let tests = ["-p small --lib".to_owned()];
    let bench = Bench::open(&root, &scratch, "small", &mutants, &tests).expect("it builds");
    assert_eq!(bench.unviable, [4].into());
    assert_eq!(bench.placed, [1, 2, 3, 5].into());
    let fate = |number| bench.judge(number, 0).expect("it runs");
    assert_eq!(fate(1), Fate::Noticed("small: small".to_owned()));
    assert_eq!(fate(2), Fate::Missed);
    assert_eq!(fate(3), Fate::Unreached);
    // Ended at its timeout.
    assert_eq!(fate(5), Fate::Noticed("small: small".to_owned()));
    // The sources themselves are as they were.
    let source = fs::read_to_string(root.join("small/src/lib.rs")).expect("a file");
    assert_eq!(source, SOURCE);
}
