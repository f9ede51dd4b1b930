//! Watchdog of the page that controls the device.
//!
//! The page answers every frame. The thread that has the lease looks here before it
//! renews: without an answer for [`TIMEOUT`] it disarms. So neither a page that hangs nor
//! a server that hangs keeps torque on; if that thread hangs, the lease expires.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Longest time without an answer.
pub(crate) const TIMEOUT: Duration = Duration::from_millis(200);

/// No page controls the device.
const NOBODY: u64 = 0;

/// Frames whose times are kept: several seconds of them.
const FRAMES: usize = 256;

/// Watchdog of the controlling page.
#[derive(Debug)]
pub(crate) struct PageWatchdog {
    begun: Instant,
    /// Time of the last answer, ms.
    answered_ms: AtomicU64,
    /// When the last frames were made, ms: an answer to an old one is none.
    made_ms: [AtomicU64; FRAMES],
}

impl PageWatchdog {
    pub(crate) fn new() -> Self {
        Self {
            begun: Instant::now(),
            answered_ms: AtomicU64::new(NOBODY),
            made_ms: [const { AtomicU64::new(NOBODY) }; FRAMES],
        }
    }

    /// A frame of this number was made now.
    pub(crate) fn made(&self, number: u32) {
        if let Some(place) = self.place(number) {
            place.store(self.now_ms(), Ordering::Relaxed);
        }
    }

    /// The controlling page has answered this frame.
    pub(crate) fn answered(&self, number: u32) {
        let made_ms = self.place(number).map(|ms| ms.load(Ordering::Relaxed));
        let now_ms = self.now_ms();
        let is_new = made_ms.is_some_and(|made_ms| {
            made_ms != NOBODY && now_ms.saturating_sub(made_ms) <= timeout_ms()
        });
        // A page that has lost control does not get it back by an answer.
        if is_new && self.answered_ms.load(Ordering::Relaxed) != NOBODY {
            self.answered_ms.store(now_ms, Ordering::Relaxed);
        }
    }

    /// A page has taken control.
    pub(crate) fn begin(&self) {
        self.answered_ms.store(self.now_ms(), Ordering::Relaxed);
    }

    /// No page controls the device any more.
    pub(crate) fn revoke(&self) {
        self.answered_ms.store(NOBODY, Ordering::Relaxed);
    }

    /// Whether torque must end.
    pub(crate) fn has_expired(&self) -> bool {
        let answered_ms = self.answered_ms.load(Ordering::Relaxed);
        answered_ms == NOBODY || self.now_ms().saturating_sub(answered_ms) > timeout_ms()
    }

    fn place(&self, number: u32) -> Option<&AtomicU64> {
        self.made_ms.get(usize::try_from(number).ok()? % FRAMES)
    }

    /// At least 1.
    fn now_ms(&self) -> u64 {
        u64::try_from(self.begun.elapsed().as_millis()).map_or(u64::MAX, |ms| ms.saturating_add(1))
    }
}

fn timeout_ms() -> u64 {
    u64::try_from(TIMEOUT.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::sleep;

    #[test]
    fn it_expires_without_answers() {
        let watchdog = PageWatchdog::new();
        assert!(watchdog.has_expired(), "nobody controls it");
        watchdog.begin();
        assert!(!watchdog.has_expired());
        sleep(TIMEOUT + Duration::from_millis(20));
        assert!(watchdog.has_expired());
    }

    #[test]
    fn an_answer_to_an_old_frame_is_none() {
        let watchdog = PageWatchdog::new();
        watchdog.begin();
        watchdog.made(1);
        sleep(Duration::from_millis(150));
        watchdog.made(2);
        sleep(Duration::from_millis(100));
        // As a page that hung answers what has piled up.
        watchdog.answered(1);
        assert!(watchdog.has_expired());
        watchdog.answered(2);
        assert!(!watchdog.has_expired());
    }

    #[test]
    fn a_page_that_is_gone_does_not_answer() {
        let watchdog = PageWatchdog::new();
        watchdog.begin();
        watchdog.made(1);
        watchdog.revoke();
        watchdog.answered(1);
        assert!(watchdog.has_expired());
    }
}
