//! Defects of a file.

use std::fmt::{self, Display, Formatter};

/// Findings that are listed; further ones are counted.
const LISTED: usize = 12;

/// Defects of a file, in the order in which they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    listed: Vec<String>,
    more: u64,
}

impl Findings {
    /// Adds one, a sentence without its full stop.
    pub(crate) fn add(&mut self, finding: String) {
        if self.listed.len() < LISTED {
            self.listed.push(finding);
        } else {
            self.more += 1;
        }
    }

    /// Adds others behind them.
    pub(crate) fn extend(&mut self, others: Self) {
        for finding in others.listed {
            self.add(finding);
        }
        self.more += others.more;
    }

    /// True if nothing was found.
    pub fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Sentences.
    pub fn sentences(&self) -> impl Iterator<Item = String> + '_ {
        let more = (self.more > 0).then(|| format!("And {} more like these.", self.more));
        self.listed
            .iter()
            .map(|finding| format!("{finding}."))
            .chain(more)
    }
}

impl Display for Findings {
    /// A line each.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.sentences()
            .try_for_each(|sentence| write!(f, "\n  {sentence}"))
    }
}
