//! The watchdog, and the roll that every task answers.
//!
//! It is fed by a task, once all others have run; and the idle loop, which may
//! work on new parameters for some milliseconds, must have come round within a
//! number of feeds.
//!
//! It runs on an oscillator of its own, of 17 to 47 kHz: 20 ms are 13.6 to
//! 37.6 ms. A debugger that halts the core does not halt the watchdog: a motor
//! is no thing to leave at a breakpoint.

use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;

/// Counts of an eighth of a millisecond, at 32 kHz.
const RELOAD: u16 = 160;

/// Who has run.
#[derive(Debug, Default)]
pub struct Roll {
    /// Tasks, since the watchdog was fed last.
    tasks: AtomicU32,
    /// Feeds that were asked for since the idle loop came round.
    without_idle: AtomicU32,
}

impl Roll {
    /// Nobody yet.
    pub const fn new() -> Self {
        Self {
            tasks: AtomicU32::new(0),
            without_idle: AtomicU32::new(0),
        }
    }

    /// The task with this bit has run.
    pub fn here(&self, task: u32) {
        self.tasks.fetch_or(task, Ordering::Relaxed);
    }

    /// The idle loop has come round.
    pub fn idle_here(&self) {
        self.without_idle.store(0, Ordering::Relaxed);
    }
}

/// The watchdog.
pub struct Watchdog {
    timer: IWDG,
    everyone: u32,
    patience: u32,
}

impl Watchdog {
    /// Starts it: from now on nothing stops it but a reset. `everyone` is the
    /// bits of all tasks, `patience` how many feeds the idle loop may take.
    ///
    /// Its registers take some of its own clocks to load, so the first period
    /// may be the longest, half a second.
    pub fn start(timer: IWDG, everyone: u32, patience: u32) -> Self {
        timer.kr().write(|w| w.key().start());
        timer.kr().write(|w| w.key().unlock());
        timer.pr().write(|w| w.pr().divide_by4());
        timer.rlr().write(|w| w.rl().set(RELOAD));
        timer.kr().write(|w| w.key().feed());
        Self {
            timer,
            everyone,
            patience,
        }
    }

    /// Feeds it, if everybody has run.
    pub fn feed(&mut self, roll: &Roll) {
        let waited = roll.without_idle.fetch_add(1, Ordering::Relaxed);
        let tasks_ran = roll
            .tasks
            .compare_exchange(self.everyone, 0, Ordering::Relaxed, Ordering::Relaxed)
            .is_ok();
        if tasks_ran && waited < self.patience {
            self.timer.kr().write(|w| w.key().feed());
        }
    }
}
