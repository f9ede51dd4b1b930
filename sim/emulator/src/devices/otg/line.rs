//! The cable: reset, suspend, resume, unplugged.

use crate::time::Time;

/// Duration of a bus reset. A hub's takes 10 ms (USB 2.0, 7.1.7.5); the host here
/// waits so long in all, the recovery included.
const RESET: Time = Time::from_us(5_000);

/// An idle bus is a suspend after this time (USB 2.0, 7.1.7.6).
const IDLE: Time = Time::from_us(3_000);

/// Event that occurs on the cable by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// A bus reset has ended, and the speed is known.
    Reset,
    /// The bus has been idle for long.
    Suspend,
}

/// State of the cable, as the device sees it.
#[derive(Debug, Default)]
pub(super) struct Line {
    pub(super) is_plugged: bool,
    reset_ends: Option<u64>,
    suspend_at: Option<u64>,
    is_suspended: bool,
    /// No frames come.
    is_idle: bool,
}

impl Line {
    pub(super) fn next_event(&self) -> Option<u64> {
        [self.reset_ends, self.suspend_at]
            .into_iter()
            .flatten()
            .min()
    }

    /// The next event, if it is due.
    pub(super) fn take_event(&mut self, now: u64) -> Option<Event> {
        let is_due = |at: &mut u64| *at <= now;
        if self.reset_ends.take_if(is_due).is_some() {
            return Some(Event::Reset);
        }
        self.suspend_at.take_if(is_due)?;
        self.is_suspended = true;
        Some(Event::Suspend)
    }

    pub(super) fn is_suspended(&self) -> bool {
        self.is_suspended
    }

    /// Returns whether frames come.
    pub(super) fn is_alive(&self) -> bool {
        self.is_plugged && !self.is_idle && self.reset_ends.is_none()
    }

    pub(super) fn reset(&mut self, now: u64) {
        self.is_suspended = false;
        self.is_idle = false;
        self.suspend_at = None;
        self.reset_ends = Some(now + RESET.units());
    }

    /// Frames no longer come.
    pub(super) fn idle(&mut self, now: u64) {
        if !self.is_idle {
            self.is_idle = true;
            self.reset_ends = None;
            self.suspend_at = Some(now + IDLE.units());
        }
    }

    /// Frames come again; returns whether that ends a suspend.
    pub(super) fn resume(&mut self) -> bool {
        self.is_idle = false;
        self.suspend_at = None;
        std::mem::take(&mut self.is_suspended)
    }
}
