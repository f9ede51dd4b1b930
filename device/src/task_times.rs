//! Times of the hardware tasks: each task adds its own cycles, and the idle loop makes a report of
//! them once a second. Where nothing counts cycles there is no report.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use crepitus_protocol::task_times::{MEAN_PARTS, TASKS, TIMES_WORDS, TaskCycles, TaskTimes};

/// Most readings of a task that runs meanwhile.
const READINGS: u32 = 4;

/// Cycles of one task, which only this task changes.
#[derive(Debug, Default)]
pub struct CycleSums {
    runs: AtomicU32,
    /// Sum of all runs; wraps.
    sum: AtomicU32,
    worst: AtomicU32,
}

impl CycleSums {
    /// Sums without a run.
    pub const fn new() -> Self {
        Self {
            runs: AtomicU32::new(0),
            sum: AtomicU32::new(0),
            worst: AtomicU32::new(0),
        }
    }

    /// Adds a run.
    #[inline]
    pub fn add(&self, cycles: u32) {
        if cycles > self.worst.load(Relaxed) {
            self.worst.store(cycles, Relaxed);
        }
        self.sum
            .store(self.sum.load(Relaxed).wrapping_add(cycles), Relaxed);
        // Last: who reads sees by it whether something has changed.
        self.runs
            .store(self.runs.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Number of runs; wraps.
    pub fn runs(&self) -> u32 {
        self.runs.load(Relaxed)
    }

    /// Runs, sum and worst of the same runs; `None` if the task ran during each reading.
    fn read(&self) -> Option<(u32, u32, u32)> {
        (0..READINGS).find_map(|_| {
            let runs = self.runs();
            let (sum, worst) = (self.sum.load(Relaxed), self.worst.load(Relaxed));
            (runs == self.runs()).then_some((runs, sum, worst))
        })
    }
}

/// Measures of `sample_encoder`, which `command_motor` adds up: while the torque waits for a sample there is no time
/// for what can be done later.
#[derive(Debug)]
pub struct Sampling {
    /// Cycles of the last sample; 0 once they are added.
    cycles: AtomicU32,
    /// The instant of the last sample.
    instant: AtomicU32,
    earliest: AtomicU32,
    latest: AtomicU32,
}

impl Default for Sampling {
    fn default() -> Self {
        Self::new()
    }
}

impl Sampling {
    /// Without a sample.
    pub const fn new() -> Self {
        Self {
            cycles: AtomicU32::new(0),
            instant: AtomicU32::new(0),
            earliest: AtomicU32::new(u32::MAX),
            latest: AtomicU32::new(0),
        }
    }

    /// `sample_encoder`: stores the cycles that it took, and how many after the beginning of its tick it sampled.
    #[inline]
    pub fn store(&self, cycles: u32, instant: u32) {
        self.instant.store(instant, Relaxed);
        self.cycles.store(cycles, Relaxed);
    }

    /// `command_motor`: takes the cycles of this tick's sample, whose instant counts from now on.
    #[inline]
    pub fn take(&self) -> Option<u32> {
        let cycles = self.cycles.load(Relaxed);
        if cycles == 0 {
            return None;
        }
        self.cycles.store(0, Relaxed);
        let instant = self.instant.load(Relaxed);
        if instant < self.earliest.load(Relaxed) {
            self.earliest.store(instant, Relaxed);
        }
        if instant > self.latest.load(Relaxed) {
            self.latest.store(instant, Relaxed);
        }
        Some(cycles)
    }

    /// The earliest and the latest; zeros without a sample.
    pub fn span(&self) -> (u32, u32) {
        let latest = self.latest.load(Relaxed);
        (self.earliest.load(Relaxed).min(latest), latest)
    }
}

/// Sums of a task as far as they are in a report.
#[derive(Clone, Copy, Debug, Default)]
struct Reported {
    runs: u32,
    sum: u32,
    all_runs: u64,
    all_cycles: u64,
    worst: u32,
}

impl Reported {
    /// Adds what has come since the last report. Sums wrap after some minutes.
    fn add(&mut self, (runs, sum, worst): (u32, u32, u32)) {
        let more = u64::from(runs.wrapping_sub(self.runs));
        self.all_runs = self.all_runs.saturating_add(more);
        let more = u64::from(sum.wrapping_sub(self.sum));
        self.all_cycles = self.all_cycles.saturating_add(more);
        (self.runs, self.sum, self.worst) = (runs, sum, worst);
    }

    fn cycles(&self) -> TaskCycles {
        let parts = self.all_cycles.saturating_mul(u64::from(MEAN_PARTS));
        let mean = parts.checked_div(self.all_runs).unwrap_or(0);
        TaskCycles {
            runs: self.runs,
            worst: self.worst,
            mean_256: u32::try_from(mean).unwrap_or(u32::MAX),
        }
    }
}

/// Reports of the idle loop.
#[derive(Debug)]
pub struct Reports {
    tasks: [Reported; TASKS],
    /// Runs of the pacing task in a second.
    every: u32,
    /// Its runs at the last report.
    last: u32,
}

impl Reports {
    /// Reports after so many runs of the task that paces them.
    pub const fn new(every: u32) -> Self {
        const NOTHING: Reported = Reported {
            runs: 0,
            sum: 0,
            all_runs: 0,
            all_cycles: 0,
            worst: 0,
        };
        Self {
            tasks: [NOTHING; TASKS],
            every,
            last: 0,
        }
    }

    /// The cycles of all tasks if a report is due: after so many runs of `pacing`.
    pub fn poll(&mut self, tasks: &[CycleSums], pacing: usize) -> Option<[TaskCycles; TASKS]> {
        let runs = tasks.get(pacing)?.runs();
        if runs.wrapping_sub(self.last) < self.every {
            return None;
        }
        self.last = runs;
        for (reported, task) in self.tasks.iter_mut().zip(tasks) {
            if let Some(sums) = task.read() {
                reported.add(sums);
            }
        }
        Some(self.tasks.map(|task| task.cycles()))
    }
}

/// A report on its way from the idle loop to the link.
#[derive(Debug)]
pub struct PendingReport {
    words: [AtomicU32; TIMES_WORDS],
    is_pending: AtomicBool,
}

impl Default for PendingReport {
    fn default() -> Self {
        Self::new()
    }
}

impl PendingReport {
    /// Nothing on its way.
    pub const fn new() -> Self {
        Self {
            words: [const { AtomicU32::new(0) }; TIMES_WORDS],
            is_pending: AtomicBool::new(false),
        }
    }

    /// Hands a report over, unless the last one is still on its way.
    pub fn offer(&self, times: &TaskTimes) {
        if self.is_pending.load(Relaxed) {
            return;
        }
        for (place, word) in self.words.iter().zip(times.words()) {
            place.store(word, Relaxed);
        }
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::Release);
        self.is_pending.store(true, Relaxed);
    }

    /// Returns whether one is on its way.
    pub fn is_pending(&self) -> bool {
        self.is_pending.load(Relaxed)
    }

    /// Takes the report; the link interrupts the idle loop, never the other way round.
    pub fn take(&self, into: &mut [u32; TIMES_WORDS]) {
        for (place, word) in into.iter_mut().zip(&self.words) {
            *place = word.load(Relaxed);
        }
        self.is_pending.store(false, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_and_mean_are_those_of_all_runs() {
        let tasks = [const { CycleSums::new() }; 2];
        let mut reports = Reports::new(4);
        for cycles in [10, 40, 20] {
            tasks[0].add(cycles);
        }
        tasks[1].add(7);
        assert_eq!(reports.poll(&tasks, 0), None);
        tasks[0].add(11);
        let report = reports.poll(&tasks, 0).unwrap();
        let cycles = TaskCycles {
            runs: 4,
            worst: 40,
            mean_256: 81 * MEAN_PARTS / 4,
        };
        assert_eq!(report[0], cycles);
        assert_eq!((report[1].runs, report[1].worst), (1, 7));
        assert_eq!(report[2], TaskCycles::default());
        assert_eq!(reports.poll(&tasks, 0), None, "once");
    }

    #[test]
    fn sums_that_wrap_are_added_up() {
        let tasks = [CycleSums::new()];
        let mut reports = Reports::new(2);
        for _ in 0..6 {
            tasks[0].add(u32::MAX / 2);
            tasks[0].add(u32::MAX / 2);
            let report = reports.poll(&tasks, 0).unwrap();
            assert_eq!(report[0].worst, u32::MAX / 2);
            // A mean of so many cycles has no room.
            assert_eq!(report[0].mean_256, u32::MAX);
        }
        assert_eq!(reports.tasks[0].all_cycles, 12 * u64::from(u32::MAX / 2));
        assert_eq!(reports.tasks[0].all_runs, 12);
    }

    #[test]
    fn the_span_of_samples_is_from_the_earliest_to_the_latest() {
        let sampling = Sampling::new();
        assert_eq!(sampling.span(), (0, 0));
        for instant in [30, 28, 44, 31] {
            sampling.store(7, instant);
            assert_eq!(sampling.take(), Some(7));
            assert_eq!(sampling.take(), None, "a tick without a sample");
        }
        assert_eq!(sampling.span(), (28, 44));
    }

    #[test]
    fn a_report_is_not_changed_on_its_way() {
        let pending = PendingReport::new();
        let times = |late_ticks| TaskTimes {
            late_ticks,
            ..TaskTimes::default()
        };
        let mut words = [0; TIMES_WORDS];
        assert!(!pending.is_pending());
        pending.offer(&times(1));
        pending.offer(&times(2));
        assert!(pending.is_pending());
        pending.take(&mut words);
        assert_eq!(words, times(1).words());
        assert!(!pending.is_pending());
        pending.offer(&times(3));
        pending.take(&mut words);
        assert_eq!(words, times(3).words());
    }
}
