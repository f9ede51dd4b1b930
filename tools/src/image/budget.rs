//! The budget file: limits of an image, and reviewed allowances.
//!
//! ```toml
//! tolerance_percent = 2.0                # what a recorded size may grow by
//!
//! [[loops]]                              # bounds for every image; some image needs each
//! function = "crepitus_protocol::frame::parse"
//! bounds = [64, 8]                       # most rounds of each, in the order of lines
//! reason = "a frame has at most 64 bytes of 8 bits"
//!
//! [images.drive]
//! elf = "target/thumbv7em-none-eabihf/release/drive"   # from the budget file
//! memory = "drive/memory.x"
//! flash = ["FLASH"]                      # memories that are programmed
//!
//! [images.drive.recorded]                # bytes; `check --bless` rewrites them
//! flash = 41_204
//! ram = 5_120
//! stack = 1_632
//!
//! [[images.drive.reserved]]              # addresses that no byte may touch
//! from = 0x0800_8000
//! to = 0x0801_0000
//! what = "parameter log"
//!
//! [[images.drive.interrupts]]            # every vector that is not the default
//! handler = "TIM3"                       # symbol, checked against the vector table
//! irq = 29                               # CMSIS number, exceptions below 0
//! priority = 3                           # RTIC's: higher preempts lower
//! gated = true                           # no panic, no unknown call, no unbounded loop
//!
//! [[images.drive.loops]]                 # loops that a gated interrupt of it reaches
//! function = "drive::app::link"
//! bounds = [10]
//! reason = "RUN_BYTES in a run"
//!
//! [[images.drive.loops]]                 # of a library, however many it has
//! function = "__aeabi_mem*"              # a last `*`: whatever begins like this
//! at_most = 512
//! reason = "bytes; nothing longer is copied"
//!
//! [[images.drive.panics]]                # calls of panics that a library contains
//! library = "usb-device"                 # its package
//! at_most = 3                            # so many instructions; one more fails
//! reason = "for each: what a host sends cannot lead there"
//!
//! [[images.drive.ends]]                  # control goes in and does not come back
//! function = "board::stop::stop"
//! reason = "resets the processor"
//!
//! [[images.drive.indirect]]              # calls through pointers
//! function = "<rtic::Executor>::run"
//! calls = 1                              # so many in this function
//! targets = ["app::link_task::poll"]     # all that they can reach
//! reason = "one task is ever spawned there"
//!
//! [[images.drive.dynamic_stack]]         # stack pointers that are computed
//! function = "core::aligned"
//! bytes = 12                             # at most on top of its frame
//! reason = "aligns to 16"
//! ```

use crate::image::error::ImageError;
use serde::Deserialize;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A budget file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Allowed growth of a recorded size, in percent.
    #[serde(default = "two")]
    pub tolerance_percent: f64,
    /// Loops that end, and why, for all images.
    #[serde(default)]
    pub loops: Vec<BoundedLoops>,
    /// Budgets by the image's name.
    pub images: BTreeMap<String, ImageBudget>,
}

/// The budget of one image.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageBudget {
    /// The built image, seen from the budget file.
    pub elf: PathBuf,
    /// The linker's memory layout, seen from the budget file.
    pub memory: PathBuf,
    /// Names of the memories that are programmed.
    #[serde(default = "flash")]
    pub flash: Vec<String>,
    /// Addresses that no segment may touch.
    #[serde(default)]
    pub reserved: Vec<Reserved>,
    /// Sizes on record.
    pub recorded: Recorded,
    /// Handlers of interrupts and exceptions.
    #[serde(default)]
    pub interrupts: Vec<Interrupt>,
    /// Loops that end, and why.
    #[serde(default)]
    pub loops: Vec<BoundedLoops>,
    /// Panics that libraries contain, and why nothing gets there.
    #[serde(default)]
    pub panics: Vec<LibraryPanics>,
    /// Functions that end an interrupt for good.
    #[serde(default)]
    pub ends: Vec<End>,
    /// Calls through pointers, and where they go.
    #[serde(default)]
    pub indirect: Vec<IndirectCalls>,
    /// Stack pointers that are computed, and by how much.
    #[serde(default)]
    pub dynamic_stack: Vec<DynamicStack>,
}

/// Sizes on record, in bytes, with their place in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Bytes that are programmed.
    pub flash: Spanned<u32>,
    /// Sections in RAM.
    pub ram: Spanned<u32>,
    /// The worst stack with all interrupts nested.
    pub stack: Spanned<u32>,
}

/// Addresses reserved for other uses than the program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reserved {
    /// The first.
    pub from: u32,
    /// The one behind the last.
    pub to: u32,
    /// Their use.
    pub what: String,
}

/// The handler of an interrupt.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interrupt {
    /// Symbol of the handler.
    pub handler: String,
    /// Number of the interrupt; exceptions below 0.
    pub irq: i16,
    /// Priority of the interrupt: higher preempts lower.
    pub priority: u8,
    /// Whether it must be free of panics, unknown calls and unbounded loops.
    #[serde(default = "yes")]
    pub gated: bool,
}

/// A function that control does not come back from, on purpose.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct End {
    /// The function; that it never returns is checked.
    pub function: String,
    /// Description of what happens instead.
    pub reason: String,
}

/// Loops of a function of the source.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoundedLoops {
    /// The function; for a library's, a last `*` stands for any end.
    pub function: String,
    /// The most iterations of each of its loops, in the order of their lines. If
    /// the compiler has removed some of them, the largest is for all others.
    #[serde(default)]
    pub bounds: Vec<u64>,
    /// Instead: the most iterations of any of its loops. Only for a library,
    /// whose lines are not in this repository.
    pub at_most: Option<u64>,
    /// Reason why the bounds hold.
    pub reason: String,
}

/// Calls of panics inside a library: in its own lines, or in a function of the
/// compiler's library that was inlined into them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LibraryPanics {
    /// The library's package.
    pub library: String,
    /// The most instructions that call a panic.
    pub at_most: usize,
    /// Reason why control gets to none of them, or what happens if it does.
    pub reason: String,
}

/// Calls through pointers in a function.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IndirectCalls {
    /// The function.
    pub function: String,
    /// Their number in it.
    #[serde(default = "one")]
    pub calls: usize,
    /// Every function that they can reach.
    pub targets: Vec<String>,
    /// Reason for these targets.
    pub reason: String,
}

/// A function that computes its stack pointer.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynamicStack {
    /// The function.
    pub function: String,
    /// The most that it takes on top of its frame.
    pub bytes: u32,
    /// Reason why that is enough.
    pub reason: String,
}

fn two() -> f64 {
    2.0
}

fn one() -> usize {
    1
}

fn yes() -> bool {
    true
}

fn flash() -> Vec<String> {
    vec!["FLASH".to_owned()]
}

impl Budget {
    /// Reads the text of a budget file; `path` is for messages.
    ///
    /// # Errors
    ///
    /// [`ImageError::Budget`] with the position of the error.
    pub fn parse(path: &Path, text: &str) -> Result<Self, ImageError> {
        let error = |what: String| ImageError::Budget {
            path: path.to_owned(),
            what,
        };
        let budget: Self = toml::from_str(text).map_err(|e| error(e.to_string()))?;
        if !(0.0..=100.0).contains(&budget.tolerance_percent) {
            return Err(error("tolerance_percent is not in 0..=100".to_owned()));
        }
        check_entries(budget.loops.iter().map(BoundedLoops::allowances)).map_err(error)?;
        check_bounds(&budget.loops).map_err(error)?;
        for (name, image) in &budget.images {
            if let Some(reserved) = image.reserved.iter().find(|r| r.from >= r.to) {
                let what = &reserved.what;
                return Err(error(format!(
                    "{name}: {what} is reserved from behind its end"
                )));
            }
            image
                .check(&budget.loops)
                .map_err(|what| error(format!("{name}: {what}")))?;
        }
        Ok(budget)
    }
}

impl BoundedLoops {
    /// Returns whether it is for this function of the source.
    pub fn is_for(&self, function: &str) -> bool {
        match self.function.strip_suffix('*') {
            Some(begin) if self.at_most.is_some() => function.starts_with(begin),
            _ => self.function == function,
        }
    }

    /// The most iterations of loop `n` of `count`.
    pub fn bound(&self, n: usize, count: usize) -> Option<u64> {
        let listed = match count.cmp(&self.bounds.len()) {
            Ordering::Less => self.bounds.iter().max(),
            Ordering::Equal => self.bounds.get(n),
            Ordering::Greater => None,
        };
        self.at_most.or(listed.copied())
    }

    fn allowances(&self) -> (&'static str, &str, &str) {
        ("loops", &self.function, &self.reason)
    }
}

impl ImageBudget {
    /// All allowances: the kind, the function or library, the reason.
    pub fn allowances(&self) -> impl Iterator<Item = (&'static str, &str, &str)> {
        let loops = self.loops.iter().map(BoundedLoops::allowances);
        let panics = self.panics.iter();
        let panics = panics.map(|e| ("panics", e.library.as_str(), e.reason.as_str()));
        let ends = self.ends.iter();
        let ends = ends.map(|e| ("ends", e.function.as_str(), e.reason.as_str()));
        let indirect = self.indirect.iter();
        let indirect = indirect.map(|e| ("indirect", e.function.as_str(), e.reason.as_str()));
        let stack = self.dynamic_stack.iter();
        let stack = stack.map(|e| ("dynamic_stack", e.function.as_str(), e.reason.as_str()));
        loops.chain(panics).chain(ends).chain(indirect).chain(stack)
    }

    /// One entry a function, each with a reason; the loops of all images count.
    fn check(&self, shared: &[BoundedLoops]) -> Result<(), String> {
        let shared = shared.iter().map(BoundedLoops::allowances);
        check_entries(shared.chain(self.allowances()))?;
        if let Some(entry) = self.panics.iter().find(|entry| entry.at_most == 0) {
            let library = &entry.library;
            return Err(format!(
                "{library} is in panics with `at_most = 0`: remove the entry"
            ));
        }
        check_bounds(&self.loops)
    }
}

fn check_entries<'a>(
    entries: impl Iterator<Item = (&'static str, &'a str, &'a str)>,
) -> Result<(), String> {
    let mut seen = BTreeSet::new();
    for (kind, what, reason) in entries {
        if reason.trim().is_empty() {
            return Err(format!("{what} is in {kind} without a reason"));
        }
        if !seen.insert((kind, what)) {
            return Err(format!("{what} is in {kind} twice"));
        }
    }
    Ok(())
}

fn check_bounds(loops: &[BoundedLoops]) -> Result<(), String> {
    let wrong = |entry: &&BoundedLoops| entry.at_most.is_some() != entry.bounds.is_empty();
    match loops.iter().find(wrong) {
        Some(BoundedLoops { function, .. }) => Err(format!(
            "{function} needs either `bounds` or `at_most` in loops"
        )),
        None => Ok(()),
    }
}

/// The text of a budget file with other recorded sizes, in place.
pub fn bless(text: &str, changes: &[(&Spanned<u32>, u32)]) -> String {
    let mut changes: Vec<_> = changes.iter().map(|(old, new)| (old.span(), new)).collect();
    changes.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let mut text = text.to_owned();
    for (span, new) in changes {
        text.replace_range(span, &underscored(*new));
    }
    text
}

/// A number as TOML with groups of digits.
fn underscored(number: u32) -> String {
    crate::image::text::grouped(number, '_')
}

#[cfg(test)]
mod tests;
