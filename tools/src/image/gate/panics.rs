//! Calls of panics: none in this repository's code, and in a library's no more
//! than the budget allows.

use super::findings::Findings;
use super::{Gate, finding};
use crate::image::program::Function;
use crate::image::report::PanicRow;

impl Gate<'_> {
    /// Counts a call of a panic where its library has an allowance; otherwise it
    /// is a failure.
    pub(super) fn note_panic(
        &self,
        handler: &str,
        panic: &Function,
        site: u32,
        path: &dyn Fn(u32) -> Vec<String>,
        found: &mut Findings<'_>,
    ) {
        let library = self.lines.library(site);
        if let Some(library) = &library
            && self.allowances.panics(library)
        {
            if found.is_new("panic", site, 0) {
                let place = format!("{}, to {}", self.place(site), panic.name());
                found.panics.entry(library.clone()).or_default().push(place);
            }
            return;
        }
        let what = || {
            let mut at = path(site);
            at.push(format!("panics in {}", panic.name()));
            let image = self.name_of_image;
            let allow = library.map_or_else(String::new, |library| {
                format!(
                    "; or, if it cannot occur, count it with the others of this library:\n\
                     [[images.{image}.panics]]\nlibrary = \"{library}\"\nat_most = …\nreason = \"…\""
                )
            });
            let todo =
                format!("make the failing case impossible or handle it without a panic{allow}");
            let what = format!("{handler} can reach {}", panic.name());
            finding("panic", what, at, &todo)
        };
        found.fail(site, what, "panic");
    }

    /// Compares the calls of panics with what is allowed.
    pub(super) fn check_panics(&self, found: &mut Findings<'_>) {
        for entry in &self.budget.panics {
            let library = &entry.library;
            // Without any, the entry is stale.
            let Some(sites) = found.panics.remove(library) else {
                continue;
            };
            let (calls, allowed) = (sites.len(), entry.at_most);
            found.report.panics.push(PanicRow {
                library: library.clone(),
                calls,
                at_most: allowed,
                reason: entry.reason.clone(),
            });
            let what =
                format!("{library} calls panics in {calls} places; the budget allows {allowed}");
            if calls > allowed {
                let todo = "find the new ones; if they cannot occur either, raise `at_most`";
                let failure = finding("panic", what, sites, todo);
                found.report.failures.push(failure);
            } else if calls < allowed {
                let todo = "lower `at_most`: left alone it would let something new through";
                let hint = finding("panic", what, Vec::new(), todo);
                found.report.hints.push(hint);
            }
        }
    }
}
