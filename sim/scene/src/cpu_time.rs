//! The clock of every cost: CPU time of the calling thread.
//!
//! Wall time counts whatever else the machine runs. CPU time counts only this
//! thread's work; on a quiet machine both agree. Where the system has no such
//! clock, [`CLOCK`] says that it is wall time.

use std::time::Duration;

/// Name of the clock that the costs of this build come from.
pub const CLOCK: &str = if cfg!(any(target_os = "linux", target_os = "macos")) {
    "CPU time of the thread"
} else {
    "wall time"
};

/// CPU time of the calling thread since some fixed point of its life.
#[cfg(any(target_os = "linux", target_os = "macos"))]
pub fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    // The clock starts at zero with the thread.
    Duration::new(
        u64::try_from(time.tv_sec).unwrap_or(0),
        u32::try_from(time.tv_nsec).unwrap_or(0),
    )
}

/// Wall time since the first call.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub fn now() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// CPU time since `begun`, a reading of [`now`] on the same thread.
pub fn since(begun: Duration) -> Duration {
    now().saturating_sub(begun)
}

/// Time that one measurement with this clock adds to the time it measures: the
/// least of 100 differences of two readings. To be taken off where thousands
/// of short measurements are added up.
pub fn reading_cost() -> Duration {
    (0..100).map(|_| since(now())).min().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hint::black_box;
    use std::time::Instant;

    #[test]
    fn work_counts() {
        let begun = now();
        let mut x = 1.0_f64;
        while since(begun) < Duration::from_millis(5) {
            x = black_box(x * 1.000_001);
        }
        assert!(x > 1.0);
        assert!(reading_cost() < Duration::from_micros(100));
    }

    #[cfg(any(target_os = "linux", target_os = "macos"))]
    #[test]
    fn waiting_does_not() {
        let (begun, wall) = (now(), Instant::now());
        std::thread::sleep(Duration::from_millis(50));
        assert!(wall.elapsed() >= Duration::from_millis(50));
        assert!(since(begun) < Duration::from_millis(10));
    }
}
