//! Code that gated interrupts must not reach.

use super::allowances::unknown_calls;
use super::findings::Findings;
use super::layout::Root;
use super::{Gate, finding};
use crate::image::body::{Leave, Step, Target};
use crate::image::decode::{Flow, Stack};
use crate::image::panics::is_panic;
use crate::image::program::Function;
use crate::image::reach::Reach;
use crate::image::report::Report;
use std::collections::BTreeSet;

impl Gate<'_> {
    /// Everything that a function reaches, up to panics.
    pub(super) fn reach(&self, root: u32) -> Reach {
        let allowances = |function: &Function| self.allowances.targets(function);
        let ends = |function: &Function| panics(function) || self.allowances.ends(function);
        Reach::new(self.program, root, &allowances, &ends)
    }

    pub(super) fn check_code(&self, roots: &[Root<'_>], report: &mut Report) {
        let mut found = Findings::new(report);
        let mut reached = BTreeSet::new();
        for root in roots.iter().filter(|root| root.interrupt.gated) {
            let reach = self.reach(root.function);
            for address in reach.functions() {
                let Some(function) = self.program.functions.get(&address) else {
                    continue;
                };
                if address == root.function || !panics(function) && !self.allowances.ends(function)
                {
                    self.check_function(root, &reach, function, &mut found);
                    reached.insert(address);
                }
            }
            self.check_recursion(root, &reach, &mut found);
        }
        self.check_panics(&mut found);
        self.check_bounds(&mut found);
        self.note_dissolved(&reached, &mut found);
        self.check_ends(&mut found);
        found.report.failures.extend(self.allowances.stale());
        found.report.shared_loops = self.allowances.shared_loops();
    }

    fn check_function(
        &self,
        root: &Root<'_>,
        reach: &Reach,
        function: &Function,
        found: &mut Findings<'_>,
    ) {
        let handler = &root.interrupt.handler;
        let path = |site: u32| self.path(reach, function, site);
        for (site, callee) in self.program.calls(function) {
            let callee = callee.and_then(|callee| self.program.functions.get(&callee));
            if let Some(callee) = callee.filter(|f| panics(f)) {
                self.note_panic(handler, callee, site, &path, found);
            }
        }
        for step in function.body.live() {
            let site = step.it.address;
            if let Some(what) = fault(step) {
                let what = || {
                    finding(
                        "fault",
                        format!("{handler} can reach {what}"),
                        path(site),
                        "make sure that control cannot get there",
                    )
                };
                found.fail(site, what, "fault");
            }
        }
        self.check_indirect(handler, function, &path, found);
        self.note_loops(root, function, &path, found);
        self.check_stack_pointer(handler, function, &path, found);
    }

    fn check_indirect(
        &self,
        handler: &str,
        function: &Function,
        path: &dyn Fn(u32) -> Vec<String>,
        found: &mut Findings<'_>,
    ) {
        let allowed = self.allowances.targets(function).len();
        let count = unknown_calls(function);
        if count > 0
            && let Some(entry) = self.allowances.indirect(function)
            && entry.calls == count
            && allowed > 0
        {
            return;
        }
        for step in function.body.live() {
            let ((Some(to), _) | (_, Some(Leave::Tail(to)))) = (step.call, step.leave) else {
                continue;
            };
            let strange = match to {
                Target::Unknown => format!("{handler} calls through a pointer"),
                Target::Known(to) if self.program.at(to).is_none() => {
                    format!("{handler} calls {to:#010x}, which is no function")
                }
                Target::Known(_) => continue,
            };
            let what = || {
                finding(
                    "indirect",
                    strange,
                    path(step.it.address),
                    &format!(
                        "call directly; or, if all targets are known, list them:\n\
                         [[images.{}.indirect]]\nfunction = \"{}\"\ncalls = {count}\n\
                         targets = [\"…\"]\nreason = \"…\"",
                        self.name_of_image,
                        function.name()
                    ),
                )
            };
            found.fail(step.it.address, what, "indirect");
        }
    }

    fn check_stack_pointer(
        &self,
        handler: &str,
        function: &Function,
        path: &dyn Fn(u32) -> Vec<String>,
        found: &mut Findings<'_>,
    ) {
        let frame = self.program.frames.get(&function.address);
        let Some(&site) = frame.and_then(|frame| frame.dynamic.first()) else {
            return;
        };
        let computed = function.body.live().any(|s| s.it.stack == Stack::Dynamic);
        if computed && self.allowances.dynamic(function).is_some() {
            return;
        }
        let name = function.name();
        let what = || {
            finding(
                "stack",
                format!("{handler} reaches {name}, whose stack cannot be counted"),
                path(site),
                &format!(
                    "keep frames of a fixed size; or say how much it takes:\n\
                     [[images.{}.dynamic_stack]]\nfunction = \"{name}\"\nbytes = …\nreason = \"…\"",
                    self.name_of_image
                ),
            )
        };
        found.fail(site, what, "stack");
    }

    /// A function listed in `ends` must not return.
    fn check_ends(&self, found: &mut Findings<'_>) {
        for function in self.program.functions.values() {
            if self.allowances.ends(function) && self.program.returning.contains(&function.address)
            {
                found.report.failures.push(finding(
                    "budget",
                    format!("{} is listed in `ends`, but can return", function.name()),
                    vec![self.place(function.address)],
                    "remove the entry",
                ));
            }
        }
    }

    fn check_recursion(&self, root: &Root<'_>, reach: &Reach, found: &mut Findings<'_>) {
        let allowances = |function: &Function| self.allowances.targets(function);
        for circle in reach.recursion(self.program, &allowances) {
            let first = circle.first().copied().unwrap_or_default();
            let what = || {
                finding(
                    "recursion",
                    format!(
                        "{} reaches functions that call themselves",
                        root.interrupt.handler
                    ),
                    circle.iter().map(|&f| self.place(f)).collect(),
                    "write it as a loop with a bound",
                )
            };
            found.fail(first, what, "recursion");
        }
    }

    /// The shortest way to an instruction: a call a line.
    fn path(&self, reach: &Reach, function: &Function, site: u32) -> Vec<String> {
        let way = reach.path(function.address);
        let mut lines: Vec<String> = Vec::new();
        for pair in way.windows(2) {
            if let [caller, callee] = *pair {
                let site = reach.site(callee).unwrap_or(caller);
                lines.push(self.place(site));
            }
        }
        lines.push(self.place(site));
        lines
    }
}

fn panics(function: &Function) -> bool {
    function.names.iter().any(|name| is_panic(name))
}

/// An instruction that an interrupt should never meet.
fn fault(step: &Step) -> Option<&'static str> {
    match (step.it.flow, step.leave) {
        (Flow::Undefined, _) => Some("an undefined instruction"),
        (Flow::Breakpoint, _) => Some("a breakpoint, a fault without a debugger"),
        (_, Some(Leave::RunsOut)) => Some("the end of code without a return"),
        _ => None,
    }
}
