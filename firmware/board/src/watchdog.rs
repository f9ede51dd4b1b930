//! The watchdog, and the per-task check-in flags.
//!
//! A task feeds the watchdog once all tasks have checked in, and only if the idle
//! loop, which may prepare parameters for some milliseconds, has checked in
//! within its timeout.
//!
//! The watchdog has its own oscillator of 17 to 47 kHz: 20 ms are 13.6 to 37.6 ms. A
//! debugger that halts the core does not halt the watchdog: a motor must not
//! stay driven at a breakpoint.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;

/// Counts of an eighth of a millisecond, at 32 kHz.
const RELOAD: u16 = 160;

/// Check-in flags of `N` tasks.
#[derive(Debug)]
pub struct TaskCheckins<const N: usize> {
    /// Tasks that have run since the watchdog was fed. One flag each, as a
    /// store takes a third of the time of an addition.
    tasks: [AtomicBool; N],
    /// Runs of the feeding task since the idle loop checked in.
    without_idle: AtomicU32,
}

impl<const N: usize> Default for TaskCheckins<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> TaskCheckins<N> {
    /// No task has checked in.
    pub const fn new() -> Self {
        Self {
            tasks: [const { AtomicBool::new(false) }; N],
            without_idle: AtomicU32::new(0),
        }
    }

    /// Checks in the task with this number, from 0 on.
    pub fn check_in(&self, task: usize) {
        if let Some(ran) = self.tasks.get(task) {
            ran.store(true, Ordering::Relaxed);
        }
    }

    /// Returns whether all tasks have checked in; if so, clears the flags.
    fn take(&self) -> bool {
        let all = self.tasks.iter().all(|ran| ran.load(Ordering::Relaxed));
        if all {
            // A check-in meanwhile may be lost; that task runs again.
            for ran in &self.tasks {
                ran.store(false, Ordering::Relaxed);
            }
        }
        all
    }

    /// Checks in the idle loop.
    pub fn idle_checks_in(&self) {
        self.without_idle.store(0, Ordering::Relaxed);
    }
}

/// The watchdog.
pub struct Watchdog {
    timer: IWDG,
    idle_timeout_runs: u32,
}

impl Watchdog {
    /// Starts the watchdog; only a reset stops it. The idle loop has to check
    /// in within `idle_timeout_runs` runs of the feeding task.
    ///
    /// The watchdog's registers take some of its own clocks to load, so the first period
    /// may be the longest, half a second.
    pub fn start(timer: IWDG, idle_timeout_runs: u32) -> Self {
        timer.kr().write(|w| w.key().start());
        timer.kr().write(|w| w.key().unlock());
        timer.pr().write(|w| w.pr().divide_by4());
        timer.rlr().write(|w| w.rl().set(RELOAD));
        timer.kr().write(|w| w.key().feed());
        Self {
            timer,
            idle_timeout_runs,
        }
    }

    /// Feeds the watchdog if all tasks have checked in.
    pub fn feed<const N: usize>(&mut self, checkins: &TaskCheckins<N>) {
        let waited = checkins.without_idle.fetch_add(1, Ordering::Relaxed);
        if checkins.take() && waited < self.idle_timeout_runs {
            self.timer.kr().write(|w| w.key().feed());
        }
    }
}
