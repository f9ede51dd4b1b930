//! A hard case: what makes it hard, its exact inputs, and what must hold.

use super::subject::Subject;

/// A hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its number in the catalogue: `H01`.
    pub id: &'static str,
    /// Its name on the command line: `constant-speed`.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// What makes it hard.
    pub hard: &'static str,
    /// Where it and its number come from.
    pub source: &'static str,
    /// Hours of simulated time: only with `--long`.
    pub long: bool,
    /// Which subjects must hold; what the others do is shown.
    pub must: fn(Subject) -> bool,
}
