//! Watchdog of the page that controls the device.
//!
//! The page answers every frame. The thread that has the lease looks here before it
//! renews: without an answer for [`TIMEOUT`] it disarms. So neither a page that hangs nor
//! a server that hangs keeps torque on; if that thread hangs, the lease expires.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Longest time without an answer.
pub(crate) const TIMEOUT: Duration = Duration::from_millis(200);

/// There is no such time.
const NEVER: u64 = 0;

/// Frames whose times are kept: several seconds of them.
const FRAMES: usize = 256;

/// Watchdog of the controlling page: it expires when a frame waits too long for its answer.
/// Where no frame is made, because the device keeps its thread busy, no answer is missing.
#[derive(Debug)]
pub(crate) struct PageWatchdog {
    begun: Instant,
    /// Time at which the oldest frame without an answer was made, ms.
    waiting_ms: AtomicU64,
    /// Number of the last frame.
    latest: AtomicU32,
    /// Times at which the last frames were made, ms.
    made_ms: [AtomicU64; FRAMES],
}

impl PageWatchdog {
    pub(crate) fn new() -> Self {
        Self {
            begun: Instant::now(),
            waiting_ms: AtomicU64::new(NEVER),
            latest: AtomicU32::new(0),
            made_ms: [const { AtomicU64::new(NEVER) }; FRAMES],
        }
    }

    /// A frame of this number was made now.
    pub(crate) fn made(&self, number: u32) {
        let now_ms = self.now_ms();
        if let Some(place) = self.place(number) {
            place.store(now_ms, Ordering::Relaxed);
        }
        self.latest.store(number, Ordering::Relaxed);
        if self.waiting_ms.load(Ordering::Relaxed) == NEVER {
            self.waiting_ms.store(now_ms, Ordering::Relaxed);
        }
    }

    /// The controlling page has answered this frame, and with it those before.
    pub(crate) fn answered(&self, number: u32) {
        let behind = self.latest.load(Ordering::Relaxed).wrapping_sub(number);
        let next_ms = |number: u32| {
            let next = self.place(number.wrapping_add(1))?.load(Ordering::Relaxed);
            (next != NEVER).then_some(next)
        };
        let waiting_ms = match usize::try_from(behind) {
            Ok(0) => Some(NEVER),
            Ok(1..FRAMES) => next_ms(number),
            _ => None,
        };
        // An answer to a frame that there was not, or long ago, is none.
        let Some(waiting_ms) = waiting_ms else {
            return;
        };
        self.waiting_ms.store(waiting_ms, Ordering::Relaxed);
    }

    /// A page has taken control.
    pub(crate) fn begin(&self) {
        self.waiting_ms.store(NEVER, Ordering::Relaxed);
    }

    /// Returns whether an answer is missing for so long that torque must end.
    pub(crate) fn has_expired(&self) -> bool {
        let waiting_ms = self.waiting_ms.load(Ordering::Relaxed);
        waiting_ms != NEVER && self.now_ms().saturating_sub(waiting_ms) > timeout_ms()
    }

    /// Age of a request whose page had seen this frame when it was made: the time since the
    /// next frame was made, which the page had not seen. Zero if there is no later frame; none
    /// if the frame is too old to be known, or does not exist.
    ///
    /// No clock of the page is needed: frames are the clock.
    pub(crate) fn age(&self, newest: u32) -> Option<Duration> {
        let behind = self.latest.load(Ordering::Relaxed).wrapping_sub(newest);
        match usize::try_from(behind) {
            Ok(0) => Some(Duration::ZERO),
            Ok(1..FRAMES) => {
                let made_ms = self.place(newest.wrapping_add(1))?.load(Ordering::Relaxed);
                let age_ms = self.now_ms().saturating_sub(made_ms);
                (made_ms != NEVER).then_some(Duration::from_millis(age_ms))
            }
            _ => None,
        }
    }

    fn place(&self, number: u32) -> Option<&AtomicU64> {
        self.made_ms.get(usize::try_from(number).ok()? % FRAMES)
    }

    /// Time since the watchdog began, plus 1 ms: at least 1.
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
        watchdog.begin();
        watchdog.made(1);
        assert!(!watchdog.has_expired());
        sleep(TIMEOUT + Duration::from_millis(20));
        assert!(watchdog.has_expired());
    }

    #[test]
    fn an_answer_to_an_old_frame_is_none() {
        let watchdog = PageWatchdog::new();
        watchdog.begin();
        for number in 1..=3 {
            watchdog.made(number);
        }
        sleep(TIMEOUT + Duration::from_millis(20));
        // As a page that hung answers what has piled up.
        watchdog.answered(1);
        watchdog.answered(2);
        assert!(watchdog.has_expired());
        // Nor is one to a frame that there has not been.
        watchdog.answered(4);
        watchdog.answered(u32::MAX);
        assert!(watchdog.has_expired());
        watchdog.answered(3);
        assert!(!watchdog.has_expired());
    }

    #[test]
    fn where_nothing_is_asked_no_answer_is_missing() {
        let watchdog = PageWatchdog::new();
        watchdog.begin();
        watchdog.made(1);
        watchdog.answered(1);
        // Arming an emulated device takes longer than the timeout.
        sleep(TIMEOUT + Duration::from_millis(20));
        assert!(!watchdog.has_expired());
        watchdog.made(2);
        assert!(!watchdog.has_expired());
    }

    #[test]
    fn the_age_of_a_request_is_that_of_the_first_frame_that_its_page_missed() {
        let watchdog = PageWatchdog::new();
        watchdog.made(1);
        sleep(Duration::from_millis(50));
        // While no frame is made, none is missed.
        assert_eq!(watchdog.age(1), Some(Duration::ZERO));
        watchdog.made(2);
        assert!(watchdog.age(1) < Some(Duration::from_millis(40)));
        sleep(Duration::from_millis(50));
        watchdog.made(3);
        assert!(watchdog.age(1) >= Some(Duration::from_millis(50)));
        assert_eq!(watchdog.age(3), Some(Duration::ZERO));
        // Frames that do not exist, and frames long ago.
        assert_eq!(watchdog.age(4), None);
        for number in 4..=400 {
            watchdog.made(number);
        }
        assert_eq!(watchdog.age(3), None);
        assert!(watchdog.age(300).is_some());
    }
}
