//! Outcome of a fault, by the output of test programs.

/// Outcome of a fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// This test failed, of its program: `energy: name`.
    Noticed(String),
    /// No test failed, or none is named.
    NotNoticed,
}

/// The failed test in the output of a test program, of several the same one in every run.
pub fn failed_test(text: &str) -> Option<&str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
        .min()
}

/// Returns whether a test has passed, by the output of its program.
pub fn has_passed(text: &str) -> bool {
    text.lines()
        .any(|line| line.starts_with("test ") && line.ends_with(" ... ok"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_test_has_its_name() {
        let text = "test a::b ... ok\ntest e ... FAILED\ntest c::d ... FAILED\n";
        assert_eq!(failed_test(text), Some("c::d"));
        assert_eq!(failed_test("test a ... ok\n"), None);
        assert!(has_passed(text) && !has_passed("running 0 tests\n"));
    }
}
