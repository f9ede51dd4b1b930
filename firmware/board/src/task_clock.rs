//! Cycles of the hardware tasks, by the cycle counter of the core (DWT).
//!
//! ```text
//! lower task    begin ────┐              ┌──── end: the span between, less what `spent` has grown by
//! higher task             └ begin ─ end ─┘         adds its own to `spent`
//! ```
//!
//! The counter stands while the core sleeps: it measures what tasks take, not when they run. A
//! run's cycles are those from `begin` to `end`; entry, return and these two are not in them, but
//! those of a task that interrupts it are, some 100 cycles.

use crate::raw;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::{DCB, DWT};
use crepitus_device::task_times::CycleSums;

/// Cycles of so many tasks.
pub struct TaskClock<const TASKS: usize> {
    tasks: [CycleSums; TASKS],
    /// Cycles of all tasks that have ended; wraps.
    spent: AtomicU32,
}

/// A run of a task that has begun.
#[derive(Clone, Copy)]
pub struct Run {
    at: u32,
    spent: u32,
}

impl<const TASKS: usize> TaskClock<TASKS> {
    /// Starts the counter.
    pub fn start(control: &mut DCB, counter: &mut DWT) -> Self {
        control.enable_trace();
        counter.enable_cycle_counter();
        Self {
            tasks: [const { CycleSums::new() }; TASKS],
            spent: AtomicU32::new(0),
        }
    }

    #[inline]
    fn now(&self) -> Run {
        Run {
            at: DWT::cycle_count(),
            spent: self.spent.load(Relaxed),
        }
    }

    /// Adds the run's own cycles to those of all tasks; returns them.
    #[inline]
    fn spend(&self, run: Run) -> u32 {
        let now = self.now();
        let span = now.at.wrapping_sub(run.at);
        let own = span.wrapping_sub(now.spent.wrapping_sub(run.spent));
        self.spent.store(now.spent.wrapping_add(own), Relaxed);
        own
    }

    /// A task has begun. Both words are of one instant: what came between would count twice, or
    /// not at all.
    #[inline]
    pub fn begin(&self) -> Run {
        raw::masked(|| self.now())
    }

    /// The task ends.
    #[inline]
    pub fn end(&self, task: usize, run: Run) {
        let own = raw::masked(|| self.spend(run));
        self.add(task, own);
    }

    /// The task of the highest priority has begun: nothing comes between.
    #[inline]
    pub fn begin_highest(&self) -> Run {
        self.now()
    }

    /// The task of the highest priority ends.
    #[inline]
    pub fn end_highest(&self, task: usize, run: Run) {
        let own = self.spend(run);
        self.add(task, own);
    }

    #[inline]
    fn add(&self, task: usize, cycles: u32) {
        if let Some(sums) = self.tasks.get(task) {
            sums.add(cycles);
        }
    }

    /// Sums of all tasks.
    pub fn tasks(&self) -> &[CycleSums] {
        &self.tasks
    }
}
