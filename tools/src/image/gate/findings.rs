//! Findings about the code that gated interrupts reach.

use crate::image::report::{Finding, Report};
use std::collections::{BTreeMap, BTreeSet};

/// Place of a loop in its function.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Spot {
    /// Line, the place in a library, and how many loops of the same spot it
    /// is nested in.
    Line(u32, String, usize),
    /// Address of the loop, if there is no debug information.
    Address(u32),
}

/// The loops of one function of the source.
#[derive(Debug, Default)]
pub(super) struct Loops {
    pub(super) spots: BTreeMap<Spot, Copies>,
    /// Some line of them is in this repository.
    pub(super) is_own: bool,
    /// The first handler found to reach it, and the way.
    pub(super) handler: String,
    pub(super) path: Vec<String>,
}

/// One loop of the source, as often as it was inlined.
#[derive(Debug)]
pub(super) struct Copies {
    pub(super) place: String,
    pub(super) count: usize,
}

/// Loops by the function of the source.
pub(super) type Catalogue = BTreeMap<String, Loops>;

/// Allowed calls of panics that gated interrupts reach, by library: a place each.
pub(super) type Sites = BTreeMap<String, Vec<String>>;

/// Findings so far, each place once however many interrupts reach it.
pub(super) struct Findings<'r> {
    pub(super) report: &'r mut Report,
    pub(super) loops: Catalogue,
    pub(super) panics: Sites,
    seen: BTreeSet<(&'static str, u32, usize)>,
}

impl<'r> Findings<'r> {
    /// Returns an instance without findings.
    pub(super) fn new(report: &'r mut Report) -> Self {
        Self {
            report,
            loops: Catalogue::new(),
            panics: Sites::new(),
            seen: BTreeSet::new(),
        }
    }

    pub(super) fn is_new(&mut self, check: &'static str, address: u32, detail: usize) -> bool {
        self.seen.insert((check, address, detail))
    }

    pub(super) fn fail(
        &mut self,
        address: u32,
        finding: impl FnOnce() -> Finding,
        check: &'static str,
    ) {
        if self.is_new(check, address, 0) {
            self.report.failures.push(finding());
        }
    }
}
