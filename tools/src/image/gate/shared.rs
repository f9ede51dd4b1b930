//! Bounds of loops for all images, after all of them were examined.

use super::finding;
use crate::image::budget::BoundedLoops;
use crate::image::report::{Finding, Report};

/// Entries that no image needed.
pub fn needless_loops(shared: &[BoundedLoops], reports: &[Report]) -> Vec<Finding> {
    let needed = |entry: &&BoundedLoops| {
        let mut reports = reports.iter();
        reports.any(|report| report.shared_loops.contains(&entry.function))
    };
    let needless = shared.iter().filter(|entry| !needed(entry));
    needless
        .map(|entry| {
            finding(
                "budget",
                format!(
                    "the entry in loops for {} is needed by no image",
                    entry.function
                ),
                Vec::new(),
                "remove it: left alone it would let something new through",
            )
        })
        .collect()
}
