//! Times that the drive measures itself, by the cycle counter of its core: they are those of the
//! emulator's own books.

use crate::host::{Flash, Host, examination, image, judged};
use crate::tasks::{COMMAND, LINK, RENDER, SAMPLE};
use crepitus_emulator::cycles::Cycles;
use crepitus_emulator::mcu::{Access, CounterAccess, Step, Watch};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::task_times::{DRIVE_TASKS, MEAN_PARTS, TaskTimes};
use std::collections::BTreeMap;

/// Exceptions of the tasks, in the order of [`DRIVE_TASKS`].
const TASKS: [u16; 4] = [SAMPLE, COMMAND, RENDER, LINK];

/// Count of the timer that begins a tick.
const TIM4_CNT: u32 = 0x4000_0824;

/// Cycles of the core in a count of that timer, and in a tick.
const COUNT_CYCLES: u32 = 2;
const TICK_CYCLES: u64 = 8_400;

/// Units of time in a cycle.
const CYCLE_UNITS: u64 = 2;

/// Entry and return, with the registers that a task saves and the loads of the counter: cycles with
/// 0 wait states that are not in a task's own measure.
const FRAME_CYCLES: std::ops::RangeInclusive<f64> = 20.0..=110.0;

/// The stack's RAM, and its paint.
const CCM: std::ops::Range<u32> = 0x1000_0000..0x1001_0000;
const PAINT: u32 = 0xcccc_cccc;

/// A run of a task that has begun.
struct Open {
    exception: u16,
    begin: u64,
    /// Cycles of all runs that had ended then.
    ended: u64,
}

/// Sum and worst of the first so many runs of a task.
type Sums = Vec<(u64, u64)>;

/// Books of what the program measures: cycles between two loads of the counter, without those of
/// runs in between, each from its first load to its store.
#[derive(Default)]
pub(crate) struct Books {
    cycles: u64,
    open: Vec<Open>,
    ended: u64,
    runs: BTreeMap<u16, Sums>,
    /// Costs of whole tasks.
    costs: Cycles,
}

impl Watch for Books {
    fn step(&mut self, step: &Step) {
        self.costs.step(step);
        match step.counter {
            Some(CounterAccess::Load) => self.load(step.exception),
            Some(CounterAccess::Store) => self.store(step.exception),
            None => {}
        }
        self.cycles += u64::from(step.cycles);
    }
}

impl Books {
    fn own(&self, open: &Open) -> u64 {
        self.cycles - open.begin - (self.ended - open.ended)
    }

    fn load(&mut self, exception: u16) {
        let Some(open) = self.open.last().filter(|open| open.exception == exception) else {
            self.open.push(Open {
                exception,
                begin: self.cycles,
                ended: self.ended,
            });
            return;
        };
        let own = self.own(open);
        let sums = self.runs.entry(exception).or_default();
        let (sum, worst) = sums.last().copied().unwrap_or_default();
        sums.push((sum + own, worst.max(own)));
    }

    fn store(&mut self, exception: u16) {
        let open = self.open.pop().expect("a run that has begun");
        assert_eq!(open.exception, exception, "a run within another");
        self.ended += self.own(&open);
    }
}

fn times(host: &mut Host) -> Option<TaskTimes> {
    match host.ask(Operation::Times) {
        Ok(Answer::Times(times)) => {
            assert_eq!(times.comms, None, "native comms measures nothing");
            times.drive
        }
        other => panic!("no times but {other:?}"),
    }
}

/// Bytes of the stack that were written.
fn stack_used(host: &Host) -> u32 {
    let mcu = host.board.mcu();
    let lowest = CCM.step_by(4).find(|at| mcu.peek(*at) != Some(PAINT));
    CCM.end - lowest.unwrap_or(CCM.end)
}

/// Earliest and latest read of the timer in a tick, in cycles of the core, by the program and by the
/// time at which it was read.
fn samples(host: &mut Host) -> [(u64, u64); 2] {
    let accesses = host.board.mcu_mut().take_accesses();
    let reads: Vec<_> = accesses.iter().filter(|access| !access.is_write).collect();
    let first = reads.first().expect("a sample");
    let shown = |access: &Access| u64::from(access.value * COUNT_CYCLES);
    let begin = first.at.units();
    let timed =
        |access: &Access| ((access.at.units() - begin) / CYCLE_UNITS + shown(first)) % TICK_CYCLES;
    let span = |cycles: &dyn Fn(&Access) -> u64| {
        let all = reads.iter().map(|access| cycles(access));
        (all.clone().min().unwrap_or(0), all.max().unwrap_or(0))
    };
    [span(&shown), span(&timed)]
}

#[test]
fn they_are_those_of_the_books() {
    let Some(image) = image() else { return };
    for flash in judged(Flash::BOTH) {
        let mut host = Host::with_books(&image, &examination(), &[TIM4_CNT], flash);
        assert_eq!(times(&mut host), None, "none in the first second");
        host.arm();
        // Every half of a tick is in the books: `run_until_torque` may leave one out.
        let is_armed = (0..10_000).any(|_| {
            host.run(1);
            host.shows_torque()
        });
        assert!(is_armed, "no torque");
        let report = (0..400).find_map(|_| {
            host.run(100);
            times(&mut host)
        });
        let report = report.expect("a report");
        let books = host.books.take().expect("books");
        // As of a reading some ticks ago.
        let used = stack_used(&host);
        let shown = report.stack_used;
        assert!((used - 256..=used).contains(&shown), "{shown} of {used}");
        check(&report, &books, flash);
        let [shown, timed] = samples(&mut host);
        let reported = (report.earliest_sample, report.latest_sample);
        println!(
            "sampled {reported:?} cycles after the tick has begun ({})",
            flash.label()
        );
        assert_eq!((u64::from(reported.0), u64::from(reported.1)), shown);
        let jitter = timed.1 - timed.0;
        let off = jitter.abs_diff(report.sampling_jitter().into());
        assert!(off <= 2 * u64::from(COUNT_CYCLES), "{timed:?} by the clock");
        assert_eq!(report.late_ticks, 0);
        let preempted = books.costs.preemptions();
        assert!(!preempted.is_empty(), "no task has interrupted another");
        assert!(report.stack_bytes == CCM.end - CCM.start && report.stack_used > 1_000);
    }
}

/// Compares a report with the books as they were when it was made: after so many runs.
#[expect(clippy::cast_precision_loss, reason = "for people")]
fn check(report: &TaskTimes, books: &Books, flash: Flash) {
    for ((name, exception), task) in DRIVE_TASKS.iter().zip(TASKS).zip(report.tasks) {
        let sums = &books.runs[&exception];
        let (sum, worst) = sums[task.runs as usize - 1];
        println!("{name}: {task:?} ({})", flash.label());
        assert_eq!(u64::from(task.worst), worst, "{name}");
        let mean = sum * u64::from(MEAN_PARTS) / u64::from(task.runs);
        assert_eq!(u64::from(task.mean_256), mean, "{name}");
        // A whole task has its frame, too.
        let cost = &books.costs.costs()[&exception];
        let (all, _) = sums.last().expect("runs");
        let frame = cost.mean_cycles() - *all as f64 / sums.len() as f64;
        println!("{name}: {frame:.1} cycles of frame");
        if flash == Flash::ZeroWaitStates {
            assert!(FRAME_CYCLES.contains(&frame), "{name}: {frame}");
        }
    }
    assert!(
        report.tasks[1].runs >= 20_000,
        "a second of `command_motor`"
    );
}
