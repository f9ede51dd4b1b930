//! Cycles of the hardware tasks, by the cycle counter of the core (DWT).
//!
//! ```text
//! higher task        ┌ begin ─── end ┐
//! lower task  begin ─┘               └──── end
//! counter     0 ─── 40 ──── 70   back to 40 ── 90: the lower one took 90, the higher one 30
//! ```
//!
//! A task that ends turns the counter back to where it began, so one that was interrupted does not see
//! it, and nothing has to be masked. The counter stands while the core sleeps: it measures what tasks
//! take, not when they run. A run's cycles are those from `begin` to `end`; entry, return and these two
//! are not in them, but those of a task that interrupts it are, some 100 cycles.

use crate::raw;
use cortex_m::peripheral::{DCB, DWT};
use crepitus_device::task_times::CycleSums;

/// Cycles of so many tasks.
pub struct TaskClock<const TASKS: usize>([CycleSums; TASKS]);

/// A run of a task that has begun.
#[derive(Clone, Copy)]
pub struct Run(u32);

impl Run {
    /// A task has begun.
    #[inline]
    pub fn begin() -> Self {
        Self(DWT::cycle_count())
    }

    /// The task ends; returns its cycles. Once in a run.
    #[inline]
    pub fn end(self) -> u32 {
        let cycles = DWT::cycle_count().wrapping_sub(self.0);
        raw::set_cycle_count(self.0);
        cycles
    }
}

impl<const TASKS: usize> TaskClock<TASKS> {
    /// Starts the counter.
    pub fn start(control: &mut DCB, counter: &mut DWT) -> Self {
        control.enable_trace();
        counter.enable_cycle_counter();
        Self([const { CycleSums::new() }; TASKS])
    }

    /// Adds a run's cycles to the sums of its task.
    #[inline]
    pub fn add(&self, task: usize, cycles: u32) {
        if let Some(sums) = self.0.get(task) {
            sums.add(cycles);
        }
    }

    /// The task ends: adds its cycles to its sums.
    #[inline]
    pub fn end(&self, task: usize, run: Run) {
        self.add(task, run.end());
    }

    /// Sums of all tasks.
    pub fn tasks(&self) -> &[CycleSums] {
        &self.0
    }
}
