//! The worst stack: thread mode, and every priority on top of it.

use super::layout::Root;
use super::{Gate, finding};
use crate::image::report::{InterruptRow, Level, Report};
use crate::image::stack::{Depths, Extra, Worst};
use std::collections::BTreeMap;

/// Bytes that the processor pushes: 8 words, 18 more where the FPU is in use, and
/// one to align (ARM DDI 0403E, B1.5.6 and B1.5.7).
fn exception_frame(fpu: bool) -> u32 {
    let words = if fpu { 8 + 18 } else { 8 };
    4 * (words + 1)
}

impl Gate<'_> {
    pub(super) fn check_stacks(&self, roots: &[Root<'_>], report: &mut Report) {
        let reset = self.vectors.reset();
        let extra = |address: u32| {
            let function = self.program.functions.get(&address);
            let mut extra = function.map_or_else(Extra::default, |f| self.allowances.extra(f));
            if address == reset {
                // The reset handler may set the stack pointer to its present value.
                extra.dynamic = extra.dynamic.or(Some(0));
            }
            extra
        };
        let mut depths = Depths::new(&self.program.frames, &extra);
        let thread = depths.worst(reset);
        report.levels.push(self.level(0, reset, 0, &thread));
        self.tell_open(0, &thread, report);
        let exception = exception_frame(self.program.uses_fpu);
        let mut levels: BTreeMap<u8, (u32, Worst)> = BTreeMap::new();
        for root in roots {
            let worst = depths.worst(root.function);
            report.interrupts.push(self.row(root, &worst));
            if !root.interrupt.gated {
                self.tell_open(root.interrupt.priority, &worst, report);
            }
            let level = levels.entry(root.interrupt.priority);
            let level = level.or_insert_with(|| (root.function, worst.clone()));
            if worst.bytes > level.1.bytes {
                *level = (root.function, worst);
            }
        }
        for (priority, (root, worst)) in levels {
            let level = self.level(priority, root, exception, &worst);
            report.levels.push(level);
        }
    }

    fn level(&self, priority: u8, root: u32, exception: u32, worst: &Worst) -> Level {
        let path = worst.path.iter();
        Level {
            priority,
            root: self.name(root),
            exception,
            bytes: worst.bytes,
            path: path.map(|&(f, bytes)| (self.name(f), bytes)).collect(),
            at_least: !worst.open.is_empty(),
        }
    }

    fn row(&self, root: &Root<'_>, worst: &Worst) -> InterruptRow {
        let reach = self.reach(root.function);
        let functions = reach.functions();
        let functions: Vec<_> = functions
            .filter_map(|address| self.program.functions.get(&address))
            .collect();
        InterruptRow {
            handler: root.interrupt.handler.clone(),
            irq: root.interrupt.irq,
            priority: root.interrupt.priority,
            gated: root.interrupt.gated,
            functions: functions.len(),
            instructions: functions.iter().map(|f| f.body.live().count()).sum(),
            loops: functions.iter().map(|f| f.loops.len()).sum(),
            stack: worst.bytes,
            at_least: !worst.open.is_empty(),
        }
    }

    /// A hint for each stack that is a lower bound without another finding.
    fn tell_open(&self, priority: u8, worst: &Worst, report: &mut Report) {
        if worst.open.is_empty() {
            return;
        }
        let root = worst.path.first().map_or(0, |&(root, _)| root);
        report.hints.push(finding(
            "stack",
            format!(
                "the stack from {} (priority {priority}) is a lower bound",
                self.name(root)
            ),
            worst.open.iter().map(|&f| self.place(f)).collect(),
            "these are recursive, call through pointers, or compute sp; \
             `indirect` and `dynamic_stack` of the budget file can close the gap",
        ));
    }
}
