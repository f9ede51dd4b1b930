//! What the examination of an image found, as data.

use serde::Serialize;

/// The check of sizes against the record.
pub(crate) const RECORD: &str = "record";

/// Everything about one image.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The image's name in the budget.
    pub image: String,
    /// Sizes against the record.
    pub sizes: Vec<Size>,
    /// How the worst stack adds up, thread mode first.
    pub levels: Vec<Level>,
    /// The interrupts.
    pub interrupts: Vec<InterruptRow>,
    /// Loops that gated interrupts reach, with their bounds.
    pub loops: Vec<LoopRow>,
    /// What is wrong.
    pub failures: Vec<Finding>,
    /// What is worth knowing.
    pub hints: Vec<Finding>,
}

impl Report {
    /// Whether nothing is wrong.
    pub fn passes(&self) -> bool {
        self.failures.is_empty()
    }

    /// Makes the sizes of now the ones on record.
    pub fn take_record(&mut self) {
        let of_sizes = |finding: &Finding| finding.check == RECORD;
        self.failures.retain(|finding| !of_sizes(finding));
        self.hints.retain(|finding| !of_sizes(finding));
        for size in &mut self.sizes {
            size.recorded = size.used;
        }
    }
}

/// A size, in bytes.
#[derive(Debug, Clone, Serialize)]
pub struct Size {
    /// `flash`, `ram` or `stack`.
    pub what: &'static str,
    /// What it is now.
    pub used: u32,
    /// What is on record.
    pub recorded: u32,
    /// What there is.
    pub available: u32,
    /// The number is a lower bound only.
    pub at_least: bool,
}

/// The stack of one level of preemption.
#[derive(Debug, Clone, Serialize)]
pub struct Level {
    /// RTIC's priority; thread mode is 0.
    pub priority: u8,
    /// Where the level's worst path begins.
    pub root: String,
    /// What the processor pushes when it begins.
    pub exception: u32,
    /// What its functions use.
    pub bytes: u32,
    /// The worst path: functions with their own share.
    pub path: Vec<(String, u32)>,
    /// The number is a lower bound only.
    pub at_least: bool,
}

/// An interrupt.
#[derive(Debug, Clone, Serialize)]
pub struct InterruptRow {
    /// The handler's symbol.
    pub handler: String,
    /// Its number.
    pub irq: i16,
    /// Its priority.
    pub priority: u8,
    /// Whether it is held to the rules.
    pub gated: bool,
    /// How many functions it reaches.
    pub functions: usize,
    /// How many instructions these have.
    pub instructions: usize,
    /// How many loops.
    pub loops: usize,
    /// Its worst stack, in bytes.
    pub stack: u32,
    /// The stack is a lower bound only.
    pub at_least: bool,
}

/// A loop that a gated interrupt reaches.
#[derive(Debug, Clone, Serialize)]
pub struct LoopRow {
    /// The function that holds it in the source.
    pub function: String,
    /// Its line there, and the line of the library that it comes from.
    pub place: String,
    /// In how many places it was inlined.
    pub copies: usize,
    /// The most rounds, if somebody said.
    pub bound: Option<u64>,
    /// Why.
    pub reason: Option<String>,
}

/// Something that is wrong, or worth knowing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The check that found it.
    pub check: &'static str,
    /// What it found.
    pub what: String,
    /// Where: one line a place, or the steps of a path.
    pub at: Vec<String>,
    /// What to do about it.
    pub todo: String,
}
