//! Outcome of a fault, stored so that a run can be continued.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Outcome of a fault.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// This test failed, of its program: `energy: name`.
    Noticed(String),
    /// No test failed, or none is named.
    NotNoticed,
    /// The sources with the fault do not build.
    DoesNotBuild,
}

#[derive(Serialize, Deserialize)]
struct Known {
    fingerprint: u64,
    outcome: Outcome,
}

impl Outcome {
    /// Outcome of a fault in an earlier run, if its fingerprint was the same.
    pub fn load(folder: &Path, name: &str, fingerprint: u64) -> Option<Self> {
        let text = fs::read_to_string(file(folder, name)).ok()?;
        let known: Known = serde_json::from_str(&text).ok()?;
        (known.fingerprint == fingerprint).then_some(known.outcome)
    }

    /// Stores it.
    ///
    /// # Errors
    /// The file system's error.
    pub fn save(&self, folder: &Path, name: &str, fingerprint: u64) -> io::Result<()> {
        let known = Known {
            fingerprint,
            outcome: self.clone(),
        };
        fs::write(file(folder, name), serde_json::to_string(&known)?)
    }
}

fn file(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.json"))
}

/// The first failed test in the output of a test program.
pub fn failed_test(text: &str) -> Option<&str> {
    text.lines()
        .find_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
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
    fn an_outcome_is_known_until_something_changes() {
        let folder = tempfile::tempdir().unwrap();
        let noticed = Outcome::Noticed("energy: name".to_owned());
        noticed.save(folder.path(), "sign", 7).unwrap();
        assert_eq!(Outcome::load(folder.path(), "sign", 7), Some(noticed));
        assert_eq!(Outcome::load(folder.path(), "sign", 8), None);
        assert_eq!(Outcome::load(folder.path(), "other", 7), None);
    }

    #[test]
    fn a_failed_test_has_its_name() {
        let text = "test a::b ... ok\ntest c::d ... FAILED\ntest e ... FAILED\n";
        assert_eq!(failed_test(text), Some("c::d"));
        assert_eq!(failed_test("test a ... ok\n"), None);
        assert!(has_passed(text) && !has_passed("running 0 tests\n"));
    }
}
