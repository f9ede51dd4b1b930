//! Load addresses against `memory.x`, and the vector table against the budget.

use super::{Gate, finding};
use crate::image::budget::Interrupt;
use crate::image::elf::Segment;
use crate::image::memory::Region;
use crate::image::report::Report;

/// An interrupt whose handler the vector table confirms.
pub(super) struct Root<'a> {
    pub(super) interrupt: &'a Interrupt,
    pub(super) function: u32,
}

/// `HardFault`, as CMSIS counts.
const HARD_FAULT: i16 = -13;

impl<'a> Gate<'a> {
    /// Every segment in a memory where it may be.
    pub(super) fn check_layout(&self, report: &mut Report) {
        for (n, one) in self.memory.iter().enumerate() {
            for other in self.memory.iter().skip(n + 1).filter(|r| r.overlaps(one)) {
                report.failures.push(finding(
                    "layout",
                    format!("memories {} and {} overlap", one.name, other.name),
                    vec![described(one), described(other)],
                    "correct memory.x",
                ));
            }
        }
        for name in &self.budget.flash {
            if !self.memory.iter().any(|r| r.name == *name) {
                report.failures.push(finding(
                    "layout",
                    format!("memory.x has no memory {name}"),
                    Vec::new(),
                    "correct `flash` in the budget file, or memory.x",
                ));
            }
        }
        for segment in &self.image.segments {
            self.check_segment(segment, report);
        }
        let start = self.vectors.address;
        if !self.flash().any(|r| r.origin == start) {
            report.failures.push(finding(
                "layout",
                format!("the vector table stands at {start:#010x}, where no flash memory begins"),
                Vec::new(),
                "the processor boots from the beginning of flash: put it there",
            ));
        }
    }

    /// The memories that are programmed.
    pub(super) fn flash(&self) -> impl Iterator<Item = &'a Region> {
        let (names, memory) = (&self.budget.flash, self.memory);
        memory.iter().filter(move |r| names.contains(&r.name))
    }

    fn check_segment(&self, segment: &Segment, report: &mut Report) {
        let mut fail = |what: &str, from: u32, size: u32| {
            let to = u64::from(from) + u64::from(size);
            report.failures.push(finding(
                "layout",
                format!("{size} bytes are {what}"),
                vec![format!("{from:#010x}..{to:#010x}")],
                "correct the linker scripts; `memory` in the budget names the layout that holds",
            ));
        };
        let (load, size) = (segment.load, segment.file_size);
        if size > 0 && !self.flash().any(|r| r.holds(load, size)) {
            fail("programmed outside the flash memories", load, size);
        }
        let (address, size) = (segment.address, segment.memory_size);
        if size > 0 && !self.memory.iter().any(|r| r.holds(address, size)) {
            fail("in no memory", address, size);
        }
        for reserved in &self.budget.reserved {
            let what = format!("where {} has its place", reserved.what);
            let touches = |from: u32, size: u32| {
                size > 0
                    && from < reserved.to
                    && u64::from(from) + u64::from(size) > reserved.from.into()
            };
            if touches(segment.load, segment.file_size) {
                fail(&what, segment.load, segment.file_size);
            } else if touches(segment.address, segment.memory_size) {
                fail(&what, segment.address, segment.memory_size);
            }
        }
    }

    /// The interrupts of the budget as far as the vector table agrees.
    pub(super) fn roots(&self, report: &mut Report) -> Vec<Root<'a>> {
        let mut roots = Vec::new();
        let default = self.program.named("DefaultHandler");
        let default = default.or_else(|| self.program.named("DefaultHandler_"));
        let default = default.map(|f| f.address);
        for interrupt in &self.budget.interrupts {
            let (name, irq) = (&interrupt.handler, interrupt.irq);
            let vector = self.vectors.handler(irq).filter(|v| Some(*v) != default);
            let symbol = self.program.named(name).map(|f| f.address);
            match vector {
                Some(function) if symbol == Some(function) => roots.push(Root {
                    interrupt,
                    function,
                }),
                vector => {
                    let found = vector.map_or("the default handler".to_owned(), |v| self.name(v));
                    report.failures.push(finding(
                        "vectors",
                        format!("interrupt {irq} starts {found}, not {name}"),
                        Vec::new(),
                        "correct handler and irq in the budget file, or bind the task",
                    ));
                }
            }
        }
        for (irq, function) in self.vectors.handlers() {
            let listed = self.budget.interrupts.iter().any(|i| i.irq == irq);
            if !listed && irq != HARD_FAULT && Some(function) != default {
                let name = self.name(function);
                report.failures.push(finding(
                    "vectors",
                    format!("interrupt {irq} starts {name}, which the budget does not know"),
                    vec![self.place(function)],
                    "add it to the interrupts of the budget file, with its priority",
                ));
            }
        }
        roots
    }
}

fn described(region: &Region) -> String {
    let end = u64::from(region.origin) + u64::from(region.length);
    format!("{}: {:#010x}..{end:#010x}", region.name, region.origin)
}
