//! Loops that gated interrupts reach, against the bounds of the budget.

use super::findings::{Findings, Loops};
use super::{Gate, finding};
use crate::image::budget::BoundedLoops;
use crate::image::report::{Finding, LoopRow};
use std::collections::BTreeSet;

impl Gate<'_> {
    /// Compares the loops found with the bounds of the budget.
    pub(super) fn check_bounds(&self, found: &mut Findings<'_>) {
        let catalogue = std::mem::take(&mut found.loops);
        for (function, loops) in &catalogue {
            let entry = self.allowances.loops(function);
            let count = loops.spots.len();
            for (n, copies) in loops.spots.values().enumerate() {
                found.report.loops.push(LoopRow {
                    function: function.clone(),
                    place: copies.place.clone(),
                    copies: copies.count,
                    bound: entry.and_then(|e| e.bound(n, count)),
                    reason: entry.map(|e| e.reason.clone()),
                });
            }
            let wrong = match entry {
                None => Some(format!(
                    "{} reaches {} in {function} without a bound",
                    loops.handler,
                    counted(count)
                )),
                Some(entry) if entry.at_most.is_some() => loops.is_own.then(|| {
                    format!("{function} is no library's: its loops are bounded one by one")
                }),
                Some(entry) => {
                    let listed = entry.bounds.len();
                    if count < listed {
                        found.report.hints.push(dissolved(entry, count));
                    }
                    (count > listed).then(|| {
                        format!(
                            "{function} has {}; the budget bounds {listed}",
                            counted(count)
                        )
                    })
                }
            };
            if let Some(what) = wrong {
                let finding = self.unbounded(function, loops, what);
                found.report.failures.push(finding);
            }
        }
    }

    /// The missing entry for the loops of a function.
    fn unbounded(&self, function: &str, loops: &Loops, what: String) -> Finding {
        let mut at = loops.path.clone();
        at.extend(loops.spots.values().map(|c| format!("loop {}", c.place)));
        let bounds = if loops.is_own {
            format!("bounds = [{}]", vec!["…"; loops.spots.len()].join(", "))
        } else {
            "at_most = …".to_owned()
        };
        let image = self.name_of_image;
        let todo = format!(
            "see what bounds each; then write it down, in this order:\n\
             [[images.{image}.loops]]\nfunction = \"{function}\"\n\
             {bounds}\nreason = \"…\""
        );
        finding("loop", what, at, &todo)
    }

    /// Functions that still exist, but without any loop: the compiler may emit
    /// loops again as soon as something around them changes.
    pub(super) fn note_dissolved(&self, reached: &BTreeSet<u32>, found: &mut Findings<'_>) {
        let without = self.allowances.without_loops();
        if without.is_empty() {
            return;
        }
        let functions = reached.iter();
        let functions = functions.filter_map(|address| self.program.functions.get(address));
        let mut names = BTreeSet::new();
        for function in functions {
            names.extend(function.names.iter().cloned());
            let steps = function.body.live();
            let frames = steps.flat_map(|step| self.lines.frames(step.it.address));
            names.extend(frames.map(|frame| frame.function));
        }
        for entry in without {
            if names.iter().any(|name| entry.is_for(name)) {
                self.allowances.keep(entry);
                found.report.hints.push(dissolved(entry, 0));
            }
        }
    }
}

/// The compiler has left fewer loops than the budget bounds.
fn dissolved(entry: &BoundedLoops, count: usize) -> Finding {
    let (function, left) = (&entry.function, counted(count));
    let bounds = match entry.at_most {
        Some(_) => "any".to_owned(),
        None => entry.bounds.len().to_string(),
    };
    finding(
        "loop",
        format!("{function} has {left} left; the budget bounds {bounds}"),
        Vec::new(),
        "where the source has no such loop any more, correct the entry",
    )
}

fn counted(loops: usize) -> String {
    format!("{loops} loop{}", if loops == 1 { "" } else { "s" })
}
