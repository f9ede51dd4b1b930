//! The watchdog, and the roll that every task answers.
//!
//! It is fed by a task, once all others have run; and the idle loop, which may
//! work on new parameters for some milliseconds, must have come round within a
//! number of feeds.
//!
//! It runs on an oscillator of its own, of 17 to 47 kHz: 20 ms are 13.6 to
//! 37.6 ms. A debugger that halts the core does not halt the watchdog: a motor
//! is no thing to leave at a breakpoint.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;

/// Counts of an eighth of a millisecond, at 32 kHz.
const RELOAD: u16 = 160;

/// Who has run, of `N` tasks.
#[derive(Debug)]
pub struct Roll<const N: usize> {
    /// Tasks, since the watchdog was fed last. Each has its own, as a store
    /// takes a third of the time of an addition.
    tasks: [AtomicBool; N],
    /// Feeds that were asked for since the idle loop came round.
    without_idle: AtomicU32,
}

impl<const N: usize> Default for Roll<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Roll<N> {
    /// Nobody yet.
    pub const fn new() -> Self {
        Self {
            tasks: [const { AtomicBool::new(false) }; N],
            without_idle: AtomicU32::new(0),
        }
    }

    /// The task with this number, from 0 on, has run.
    pub fn here(&self, task: usize) {
        if let Some(ran) = self.tasks.get(task) {
            ran.store(true, Ordering::Relaxed);
        }
    }

    /// Whether all of them have; if so, they have to run again.
    fn take(&self) -> bool {
        let all = self.tasks.iter().all(|ran| ran.load(Ordering::Relaxed));
        if all {
            // One that runs meanwhile may be forgotten, and runs again.
            for ran in &self.tasks {
                ran.store(false, Ordering::Relaxed);
            }
        }
        all
    }

    /// The idle loop has come round.
    pub fn idle_here(&self) {
        self.without_idle.store(0, Ordering::Relaxed);
    }
}

/// The watchdog.
pub struct Watchdog {
    timer: IWDG,
    patience: u32,
}

impl Watchdog {
    /// Starts it: from now on nothing stops it but a reset. `patience` is how
    /// many feeds the idle loop may take.
    ///
    /// Its registers take some of its own clocks to load, so the first period
    /// may be the longest, half a second.
    pub fn start(timer: IWDG, patience: u32) -> Self {
        timer.kr().write(|w| w.key().start());
        timer.kr().write(|w| w.key().unlock());
        timer.pr().write(|w| w.pr().divide_by4());
        timer.rlr().write(|w| w.rl().set(RELOAD));
        timer.kr().write(|w| w.key().feed());
        Self { timer, patience }
    }

    /// Feeds it, if everybody has run.
    pub fn feed<const N: usize>(&mut self, roll: &Roll<N>) {
        let waited = roll.without_idle.fetch_add(1, Ordering::Relaxed);
        if roll.take() && waited < self.patience {
            self.timer.kr().write(|w| w.key().feed());
        }
    }
}
