//! Every mutant that `cargo mutants` lists of a crate, in one build.
//!
//! ```text
//! cargo mutants --list ─> scratch copy of the sources, each mutant behind a switch
//!   ─> built without those that do not compile
//!   ─> each test program once, which says the mutants that it reaches
//!   ─> each mutant on the programs that reach it, the quickest first ─> a line a mutant
//! ```
//!
//! One build takes minutes and a program a fraction of a second, so that thousands of
//! mutants take an hour instead of a day. What stands in a constant context, or in a
//! chain with `let`, cannot be switched while it runs and is left out; so are deleted
//! fields.

pub mod bench;
pub mod plant;

use serde::Deserialize;
use std::path::PathBuf;

/// A mutant, as `cargo mutants --list --json` writes it.
#[derive(Clone, Debug, Deserialize)]
pub struct Mutant {
    /// The file, from the root of the repository.
    pub file: PathBuf,
    /// Place and mutation, for people.
    pub name: String,
    /// Kind of the mutation, in the terms of `cargo mutants`.
    pub genre: Genre,
    /// The text that replaces what is at `span`.
    pub replacement: String,
    /// The place.
    pub span: Span,
}

/// Kinds of mutations.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Hash)]
pub enum Genre {
    /// A function returns a constant at once.
    FnValue,
    /// Another operator between two operands.
    BinaryOperator,
    /// An operator before its operand is missing.
    UnaryOperator,
    /// An arm of a match is missing.
    MatchArm,
    /// The guard of an arm is a constant.
    MatchArmGuard,
    /// A field of a struct expression is missing.
    StructField,
}

/// The part of the file that a mutant replaces.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Span {
    /// Beginning of the part.
    pub start: Place,
}

/// Line and column in characters, both from 1 on.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Hash)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

/// Reads the list.
///
/// # Errors
/// If it is no such list.
pub fn read(json: &str) -> Result<Vec<Mutant>, serde_json::Error> {
    serde_json::from_str(json)
}

/// The module that is added to the crate: which mutant is in force, or a note of each that
/// is reached.
pub const MODULE: &str = r#"
/// The mutant that is in force.
#[allow(warnings)]
pub mod mutant {
    extern crate std;
    use std::io::Write;
    use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

    const NONE: u32 = 0;
    const REACH: u32 = u32::MAX - 1;
    const UNKNOWN: u32 = u32::MAX;
    static NOW: AtomicU32 = AtomicU32::new(UNKNOWN);
    static REACHED: [AtomicBool; 16384] = [const { AtomicBool::new(false) }; 16384];

    #[inline(always)]
    pub fn is(number: u32) -> bool {
        let now = NOW.load(Relaxed);
        if now < REACH { now == number } else { ask(number) }
    }

    #[cold]
    #[inline(never)]
    fn ask(number: u32) -> bool {
        if NOW.load(Relaxed) == UNKNOWN {
            let given = std::env::var("CREPITUS_MUTANT").ok();
            let file = std::env::var_os("CREPITUS_REACHED").is_some();
            let now = given.and_then(|text| text.parse().ok());
            NOW.store(now.unwrap_or(if file { REACH } else { NONE }), Relaxed);
            return is(number);
        }
        if !REACHED[number as usize].swap(true, Relaxed) {
            let path = std::env::var_os("CREPITUS_REACHED").unwrap();
            let mut file = std::fs::OpenOptions::new().append(true).create(true).open(path).unwrap();
            file.write_all(std::format!("{number}\n").as_bytes()).unwrap();
        }
        false
    }
}
"#;

/// The most mutants that the module can tell apart.
pub const MOST: usize = 16_383;
