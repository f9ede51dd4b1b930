//! A small crate whose faults are noticed, not noticed, or do not build.

use crate::write_crate;
use crepitus_tools::faults::outcome::Outcome;
use crepitus_tools::faults::patch::Fault;
use crepitus_tools::faults::trial::{TrialError, Workshop};
use std::fs;
use std::path::Path;

const SOURCE: &str = "//! Small.
pub fn sum(a: u32, b: u32) -> u32 {
    a + b
}
pub fn alone(a: u32) -> u32 {
    a + 2
}
#[cfg(test)]
mod tests {
    #[test]
    fn sums() {
        assert_eq!(super::sum(2, 3), 5);
    }
}
";

/// The fault that replaces a line of the source.
fn fault(header: &str, was: &str, now: &str) -> Fault {
    let text = format!(
        "What: wrong\n{header}\n\n--- a/small/src/lib.rs\n+++ b/small/src/lib.rs\n@@ -3 +3 @@\n-    {was}\n+    {now}\n"
    );
    Fault::parse(Path::new("tools/faults/small/wrong.patch"), &text).expect("a patch")
}

#[test]
fn each_fault_has_its_outcome() {
    const TESTS: &str = "Noticed-by: -p small --lib -- sums";
    let here = Path::new(env!("CARGO_TARGET_TMPDIR")).join("trial");
    let _ = fs::remove_dir_all(&here);
    let (root, scratch) = (here.join("root"), here.join("scratch"));
    write_crate(&root, SOURCE);
    let mut workshop = Workshop::open(&root, &scratch, "cargo").expect("a copy");
    let mut outcome = |header: &str, was: &str, now: &str| {
        let outcome = workshop.attempt(&fault(header, was, now));
        let left = fs::read_to_string(scratch.join("tree/small/src/lib.rs"));
        assert_eq!(left.expect("a file"), SOURCE, "{now}");
        outcome
    };
    let noticed = outcome(TESTS, "a + b", "a - b").expect("it runs");
    let sums = Outcome::Noticed("small: tests::sums".to_owned());
    assert_eq!(noticed, Some(sums));
    let alone = outcome(TESTS, "a + 2", "a + 3").expect("it runs");
    assert_eq!(alone, Some(Outcome::NotNoticed));
    let broken = outcome(TESTS, "a + b", "a + c").expect("it runs");
    assert_eq!(broken, None);
    let untried = outcome("Unseen: nobody looks", "a + b", "a").expect("it applies");
    assert_eq!(untried, Some(Outcome::NotNoticed));
    let nowhere = outcome(TESTS, "a + d", "a").expect_err("no such line");
    assert!(matches!(nowhere, TrialError::Patch(_)), "{nowhere}");
    let renamed = "Noticed-by: -p small --lib -- adds";
    let error = outcome(renamed, "a + b", "a - b").expect_err("no such test");
    assert!(matches!(error, TrialError::Baseline(_)), "{error}");
    // The sources themselves were never changed.
    let source = fs::read_to_string(root.join("small/src/lib.rs")).expect("a file");
    assert_eq!(source, SOURCE);
}
