//! Flash, RAM and stack against the record.

use super::{Gate, finding};
use crate::image::elf::Section;
use crate::image::report::{RECORD, Report, Size};
use crate::image::text::grouped;

/// Change, in percent, below which the record should follow.
const SHRUNK_PERCENT: f64 = -5.0;

impl Gate<'_> {
    pub(super) fn check_sizes(&self, report: &mut Report) {
        let flash = self.image.segments.iter().map(|s| s.file_size).sum();
        let in_flash = |address| self.flash().any(|r| r.holds(address, 0));
        let ram = self.image.sections.iter();
        let ram = ram.filter(|s| !in_flash(s.address)).map(|s| s.size).sum();
        let room = |flash: bool| {
            let memories = self.memory.iter();
            let memories = memories.filter(|r| self.budget.flash.contains(&r.name) == flash);
            memories.fold(0_u32, |sum, r| {
                let reserved = self.budget.reserved.iter();
                let reserved = reserved.filter(|taken| r.holds(taken.from, 0));
                let reserved: u32 = reserved.map(|taken| taken.to - taken.from).sum();
                sum.saturating_add(r.length.saturating_sub(reserved))
            })
        };
        let recorded = &self.budget.recorded;
        let levels = report.levels.iter();
        let stack = levels.map(|level| level.exception + level.bytes).sum();
        let open = report.levels.iter().any(|level| level.at_least);
        let size = |what, used, recorded, available, at_least| Size {
            what,
            used,
            recorded,
            available,
            at_least,
        };
        let sizes = [
            size("flash", flash, *recorded.flash.get_ref(), room(true), false),
            size("ram", ram, *recorded.ram.get_ref(), room(false), false),
            size(
                "stack",
                stack,
                *recorded.stack.get_ref(),
                self.stack_room(),
                open,
            ),
        ];
        for size in sizes {
            self.compare(&size, report);
            report.sizes.push(size);
        }
    }

    fn compare(&self, size: &Size, report: &mut Report) {
        let Size {
            what,
            used,
            recorded,
            available,
            ..
        } = *size;
        let (now, record) = (grouped(used, ','), grouped(recorded, ','));
        if used > available {
            report.failures.push(finding(
                "room",
                format!(
                    "{what} needs {now} bytes, there are {}",
                    grouped(available, ',')
                ),
                Vec::new(),
                "make it smaller; the worst path of the stack is in the table above",
            ));
        }
        let change = size.change_percent();
        let with_percent = |more: f64| f64::from(recorded) * (100.0 + more) / 100.0;
        if recorded == 0 && used > 0 {
            report.failures.push(finding(
                RECORD,
                format!("{what} is {now} bytes, and not on record"),
                Vec::new(),
                "record it: check --bless",
            ));
        } else if f64::from(used) > with_percent(self.tolerance_percent) {
            report.failures.push(finding(
                RECORD,
                format!("{what} has grown from {record} to {now} bytes ({change:+.1} %)"),
                Vec::new(),
                "find out what made it grow; if it is worth it, record it: check --bless",
            ));
        } else if f64::from(used) < with_percent(SHRUNK_PERCENT) {
            report.hints.push(finding(
                RECORD,
                format!("{what} has shrunk from {record} to {now} bytes ({change:+.1} %)"),
                Vec::new(),
                "keep what was won: record it with check --bless",
            ));
        }
    }

    /// Returns the room from the stack's beginning down to the section below it, in bytes.
    fn stack_room(&self) -> u32 {
        let top = self.vectors.stack;
        let below = top.saturating_sub(1);
        let Some(region) = self.memory.iter().find(|r| r.holds(below, 1)) else {
            return 0;
        };
        let sections = self.image.sections.iter();
        let under = sections.filter(|s| region.holds(s.address, 0) && s.address < top);
        let floor = under.map(Section::end).max();
        top.saturating_sub(floor.unwrap_or(region.origin))
    }
}
