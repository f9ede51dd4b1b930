//! The checks that detect a fault, stored so that a run can be continued.

use crate::faults::fault::Fault;
use crate::faults::tree::write_if_changed;
use serde::{Deserialize, Serialize};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::Path;

/// The checks that detect a fault.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// The fault.
    pub name: String,
    /// Fingerprint of the sources and the fault.
    pub fingerprint: u64,
    /// Result of every hard case, in the order of the catalogue.
    pub cases: Vec<CaseOutcome>,
    /// Whether the model's tests were run.
    pub tested: bool,
    /// The first of them that failed: `energy: name`.
    pub test: Option<String>,
}

/// Result of a hard case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseOutcome {
    /// Number of the case.
    pub id: String,
    /// Finding of the case; `None` if it holds.
    pub found: Option<String>,
}

impl Outcome {
    /// The cases that detect the fault.
    pub fn noticed_by(&self) -> impl Iterator<Item = &CaseOutcome> {
        self.cases.iter().filter(|case| case.found.is_some())
    }

    /// The outcome of a fault in an earlier run on the same sources.
    pub fn load(folder: &Path, name: &str, fingerprint: u64) -> Option<Self> {
        let text = fs::read_to_string(folder.join(format!("{name}.json"))).ok()?;
        let known: Self = serde_json::from_str(&text).ok()?;
        (known.fingerprint == fingerprint).then_some(known)
    }

    /// Stores it.
    ///
    /// # Errors
    /// The file system's error.
    pub fn save(&self, folder: &Path) -> io::Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        write_if_changed(&folder.join(format!("{}.json", self.name)), text.as_bytes())
    }
}

/// A number that changes with the sources and with the fault.
pub fn fingerprint(sources: u64, fault: &Fault) -> u64 {
    let mut hasher = DefaultHasher::new();
    (sources, &fault.file, &fault.text, &fault.with).hash(&mut hasher);
    hasher.finish()
}

/// Reads the lines of `broken_cases`; a case without a line has hung or ended
/// the program.
pub fn read_cases(text: &str, ended: bool, all: &[String]) -> Vec<CaseOutcome> {
    let mut cases = Vec::new();
    for line in text.lines() {
        let Some((id, what)) = line.split_once(' ') else {
            continue;
        };
        if all.iter().any(|known| known == id) {
            cases.push(CaseOutcome {
                id: id.to_owned(),
                found: (what != "holds").then(|| what.to_owned()),
            });
        }
    }
    if !ended && let Some(next) = all.get(cases.len()) {
        cases.push(CaseOutcome {
            id: next.clone(),
            found: Some("the program hangs or ends in it".to_owned()),
        });
    }
    cases
}

/// The first failed test in the output of a test program.
pub fn failed_test(text: &str) -> Option<&str> {
    text.lines()
        .find_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_and_a_hang_is_its_cases() {
        let all = ["H01", "H02", "H03"].map(str::to_owned);
        let text = "H01 holds\nthread 'main' panicked\nH02 broken: 3 events instead of 4\n";
        let whole = read_cases(text, true, &all);
        assert_eq!(whole.len(), 2);
        assert_eq!(whole[0].found, None);
        assert_eq!(
            whole[1].found.as_deref(),
            Some("broken: 3 events instead of 4")
        );
        let hung = read_cases(text, false, &all);
        assert_eq!((hung.len(), hung[2].id.as_str()), (3, "H03"));
        assert!(hung[2].found.is_some());
    }

    #[test]
    fn a_failed_test_has_its_name() {
        let text = "test a::b ... ok\ntest c::d ... FAILED\ntest e ... FAILED\n";
        assert_eq!(failed_test(text), Some("c::d"));
        assert_eq!(failed_test("test a ... ok\n"), None);
    }
}
