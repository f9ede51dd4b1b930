//! Cycles of a task: from the entry into its exception to the end of
//! its return, without those of the tasks that interrupt it.
//!
//! Modelled cycles, 0 wait states: a load or a store is two, a branch that is
//! taken three, entry into an exception 12, the return 10, from one straight to
//! the next 6. A core on silicon is faster where it overlaps loads, and slower
//! where flash makes it wait.
//!
//! Modelled flash: the same, and the waits of
//! [`model_flash`](crate::Stm32f405::model_flash), which [`Cost::waits`] counts
//! separately too.

use crate::mcu::{Step, Watch};
use crate::time::Time;
use std::collections::BTreeMap;

/// Cost of a task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of runs.
    pub calls: u64,
    /// All cycles.
    pub cycles: u64,
    /// Cycles of them in which the core waited for flash or a register.
    pub waits: u64,
    /// Cycles of the worst run.
    pub worst_cycles: u64,
    /// All instructions.
    pub instructions: u64,
}

impl Cost {
    /// Mean cycles of a run.
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    pub fn mean_cycles(&self) -> f64 {
        self.cycles as f64 / self.calls.max(1) as f64
    }
}

#[derive(Clone, Copy, Debug)]
struct Run {
    exception: u16,
    cycles: u64,
    waits: u64,
    instructions: u64,
}

/// Cycle accounting.
#[derive(Clone, Debug, Default)]
pub struct Cycles {
    runs: Vec<Run>,
    costs: BTreeMap<u16, Cost>,
    /// Number of preemptions by pair of exceptions.
    preemptions: BTreeMap<(u16, u16), u64>,
    /// Cycles in exceptions, microsecond by microsecond from the first step on.
    busy: Vec<u64>,
    begin: Option<Time>,
}

/// Microseconds of a tick of the drive.
const TICK_US: usize = 50;

const MICROSECOND: Time = Time::from_us(1);

impl Cycles {
    /// The cost of each exception's task.
    pub fn costs(&self) -> &BTreeMap<u16, Cost> {
        &self.costs
    }

    /// Number of times that an exception (the second) has interrupted another (the
    /// first).
    pub fn preemptions(&self) -> &BTreeMap<(u16, u16), u64> {
        &self.preemptions
    }

    /// Cycles that all tasks have taken in a tick, in the mean.
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    pub fn mean_busy_cycles(&self) -> f64 {
        let ticks = self.busy.len().max(1) as f64 / TICK_US as f64;
        self.busy.iter().sum::<u64>() as f64 / ticks
    }

    /// Cycles that all tasks have taken in the worst 50 µs, wherever they begin.
    pub fn worst_busy_cycles(&self) -> u64 {
        let ticks = self.busy.windows(TICK_US);
        ticks.map(|tick| tick.iter().sum()).max().unwrap_or(0)
    }

    /// Clears all but the running tasks.
    pub fn clear(&mut self) {
        self.costs.clear();
        self.preemptions.clear();
        self.busy.clear();
        self.begin = None;
    }

    fn count_busy(&mut self, step: &Step) {
        let begin = *self.begin.get_or_insert(step.at);
        let at = (step.at - begin).units() / MICROSECOND.units();
        let at = usize::try_from(at).unwrap_or(usize::MAX);
        if self.busy.len() <= at {
            self.busy.resize(at + 1, 0);
        }
        // From the entry on, which is the step after which it is active, to the
        // return, after which it no longer is.
        if step.active > 0 || !self.runs.is_empty() {
            self.busy[at] += u64::from(step.cycles);
        }
    }

    fn begin(&mut self, step: &Step) {
        if let Some(below) = self.runs.last() {
            let pair = (below.exception, step.exception);
            *self.preemptions.entry(pair).or_default() += 1;
        }
        self.begin_run(step, u64::from(step.cycles), u64::from(step.waits));
    }

    fn begin_run(&mut self, step: &Step, cycles: u64, waits: u64) {
        self.runs.push(Run {
            exception: step.exception,
            cycles,
            waits,
            instructions: 0,
        });
    }

    fn end(&mut self) {
        let Some(run) = self.runs.pop() else { return };
        let cost = self.costs.entry(run.exception).or_default();
        cost.calls += 1;
        cost.cycles += run.cycles;
        cost.waits += run.waits;
        cost.worst_cycles = cost.worst_cycles.max(run.cycles);
        cost.instructions += run.instructions;
    }
}

impl Watch for Cycles {
    fn step(&mut self, step: &Step) {
        self.count_busy(step);
        let depth = step.active as usize;
        if depth > self.runs.len() {
            self.begin(step);
            return;
        }
        if let Some(run) = self.runs.last_mut() {
            run.cycles += u64::from(step.cycles);
            run.waits += u64::from(step.waits);
            run.instructions += 1;
        }
        while depth < self.runs.len() {
            self.end();
        }
        let top = self.runs.last();
        if top.is_some_and(|run| run.exception != step.exception) {
            // Tail-chaining, charged to the first.
            self.end();
            self.begin_run(step, 0, 0);
        }
    }
}
