//! Event counters; those of the drive are atomic, so any priority may use them. With them go the
//! reports of the tasks' times to the link.

use crate::task_times::PendingReport;
use core::sync::atomic::{AtomicU32, Ordering};
use crepitus_protocol::counters::{CommsCounter, DRIVE_COUNT, DriveCounter};

/// The counters of the drive; they wrap.
#[derive(Debug, Default)]
pub struct Counters {
    counts: [AtomicU32; DRIVE_COUNT],
    times: PendingReport,
}

impl Counters {
    /// All at zero.
    pub const fn new() -> Self {
        Self {
            counts: [const { AtomicU32::new(0) }; DRIVE_COUNT],
            times: PendingReport::new(),
        }
    }

    /// Report of the tasks' times on its way to the link.
    pub fn times(&self) -> &PendingReport {
        &self.times
    }

    /// Increments a counter.
    pub fn count(&self, counter: DriveCounter) {
        self.add(counter, 1);
    }

    /// Adds `more` to a counter.
    pub fn add(&self, counter: DriveCounter, more: u32) {
        if let Some(place) = self.counts.get(counter.index()) {
            place.fetch_add(more, Ordering::Relaxed);
        }
    }

    /// Returns one counter.
    pub fn get(&self, counter: DriveCounter) -> u32 {
        self.counts
            .get(counter.index())
            .map_or(0, |place| place.load(Ordering::Relaxed))
    }

    /// Reads all counters, in the order of their table.
    pub fn read(&self, into: &mut [u32; DRIVE_COUNT]) {
        for (count, counter) in into.iter_mut().zip(&self.counts) {
            *count = counter.load(Ordering::Relaxed);
        }
    }
}

/// The counters of comms; they wrap.
#[derive(Clone, Copy, Debug, Default)]
pub struct CommsCounters([u32; crepitus_protocol::counters::COMMS_COUNT]);

impl CommsCounters {
    /// Increments a counter.
    pub fn count(&mut self, counter: CommsCounter) {
        self.add(counter, 1);
    }

    /// Adds `more` to a counter.
    pub fn add(&mut self, counter: CommsCounter, more: u32) {
        if let Some(place) = self.0.get_mut(counter.index()) {
            *place = place.wrapping_add(more);
        }
    }

    /// Sets all counters to `value`.
    pub fn set_all(&mut self, value: u32) {
        self.0 = [value; crepitus_protocol::counters::COMMS_COUNT];
    }

    /// Returns one counter.
    pub fn get(&self, counter: CommsCounter) -> u32 {
        self.0.get(counter.index()).copied().unwrap_or(0)
    }

    /// Returns all counters, in the order of their table.
    pub fn all(&self) -> [u32; crepitus_protocol::counters::COMMS_COUNT] {
        self.0
    }
}
