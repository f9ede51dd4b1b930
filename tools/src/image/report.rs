//! Results of the check of an image, as data.

use serde::Serialize;
use std::collections::BTreeSet;

/// The check of sizes against the record.
pub(crate) const RECORD: &str = "record";

/// Everything about one image.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Report {
    /// The image's name in the budget.
    pub image: String,
    /// Sizes against the record.
    pub sizes: Vec<Size>,
    /// Levels of the worst stack, thread mode first.
    pub levels: Vec<Level>,
    /// The interrupts.
    pub interrupts: Vec<InterruptRow>,
    /// Loops that gated interrupts reach, with their bounds.
    pub loops: Vec<LoopRow>,
    /// Functions of the bounds for all images that this one needed.
    pub shared_loops: BTreeSet<String>,
    /// Calls of panics inside libraries that gated interrupts reach.
    pub panics: Vec<PanicRow>,
    /// Failures.
    pub failures: Vec<Finding>,
    /// Hints.
    pub hints: Vec<Finding>,
}

impl Report {
    /// Returns whether there are no failures.
    pub fn passes(&self) -> bool {
        self.failures.is_empty()
    }

    /// Records the current sizes.
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
    /// The current size.
    pub used: u32,
    /// The recorded size.
    pub recorded: u32,
    /// The available size.
    pub available: u32,
    /// The number is a lower bound only.
    pub at_least: bool,
}

impl Size {
    /// Difference from the record, %.
    pub fn change_percent(&self) -> f64 {
        match (self.used, self.recorded) {
            (0, 0) => 0.0,
            (used, recorded) => (f64::from(used) / f64::from(recorded) - 1.0) * 100.0,
        }
    }
}

/// The stack of one level of preemption.
#[derive(Debug, Clone, Serialize)]
pub struct Level {
    /// RTIC's priority; thread mode is 0.
    pub priority: u8,
    /// The first function of the level's worst path.
    pub root: String,
    /// Bytes pushed by the processor at its entry.
    pub exception: u32,
    /// Bytes used by its functions.
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
    /// Number of the interrupt.
    pub irq: i16,
    /// Priority of the interrupt.
    pub priority: u8,
    /// Whether it is checked.
    pub gated: bool,
    /// Number of functions that it reaches.
    pub functions: usize,
    /// Number of their instructions.
    pub instructions: usize,
    /// Number of their loops.
    pub loops: usize,
    /// Worst stack of the interrupt, in bytes.
    pub stack: u32,
    /// The stack is a lower bound only.
    pub at_least: bool,
}

/// A loop that a gated interrupt reaches.
#[derive(Debug, Clone, Serialize)]
pub struct LoopRow {
    /// The function that holds it in the source.
    pub function: String,
    /// Line of the loop in that function, and the line of the library that it comes from.
    pub place: String,
    /// Number of places where it was inlined.
    pub copies: usize,
    /// The most iterations, if the budget has a bound.
    pub bound: Option<u64>,
    /// The reason of the bound.
    pub reason: Option<String>,
}

/// Calls of panics inside a library.
#[derive(Debug, Clone, Serialize)]
pub struct PanicRow {
    /// The library's package.
    pub library: String,
    /// Number of instructions that call a panic.
    pub calls: usize,
    /// The number that the budget allows.
    pub at_most: usize,
    /// The reason of the allowance.
    pub reason: String,
}

/// A failure or a hint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The check that found it.
    pub check: &'static str,
    /// Description of the finding.
    pub what: String,
    /// Places of the finding, one a line, or the steps of a path.
    pub at: Vec<String>,
    /// Remedy of the finding.
    pub todo: String,
}
