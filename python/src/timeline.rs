//! Time of a connection, over all of its streams, and the marks on it.

use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::telemetry::Block;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// A mark of the program.
#[derive(Clone, Debug)]
pub(crate) struct Mark {
    pub(crate) time_s: f64,
    pub(crate) text: String,
}

/// Device time since the connection was made.
pub(crate) struct Timeline {
    /// Tick at which time is zero; below zero after a restart of the drive.
    zero: i128,
    /// Number of the drive's start, once a block has come.
    start: Option<u8>,
    /// The transport's time of the zero.
    begun: Duration,
    /// Unix time of the zero, s.
    pub(crate) zero_unix_s: f64,
    /// Marks that no block has had yet.
    pub(crate) marks: Vec<Mark>,
}

impl Timeline {
    /// Starts at a tick, which is now.
    pub(crate) fn new(tick: u64, now: Duration) -> Self {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            zero: i128::from(tick),
            start: None,
            begun: now,
            zero_unix_s: unix.unwrap_or_default().as_secs_f64(),
            marks: Vec::new(),
        }
    }

    /// Takes in the next block, at this time of the transport: a drive that has restarted counts from zero again.
    pub(crate) fn see(&mut self, block: &Block, now: Duration) {
        let start = block.flags.start();
        if self.start.replace(start).is_some_and(|old| old != start) {
            let passed = now.saturating_sub(self.begun).as_nanos() * u128::from(TICKS_PER_S);
            let passed = i128::try_from(passed / 1_000_000_000).unwrap_or(i128::MAX);
            self.zero = i128::from(block.end_tick()).saturating_sub(passed);
        }
    }

    /// Time of a tick, s.
    #[expect(clippy::cast_precision_loss, reason = "centuries of ticks")]
    pub(crate) fn seconds(&self, tick: u64) -> f64 {
        (i128::from(tick) - self.zero) as f64 / f64::from(TICKS_PER_S)
    }

    /// Marks a tick; returns its time, s.
    pub(crate) fn mark(&mut self, tick: u64, text: String) -> f64 {
        let time_s = self.seconds(tick);
        self.marks.push(Mark { time_s, text });
        time_s
    }
}
