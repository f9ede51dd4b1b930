//! Counters that every priority may count on, without a lock.

use core::sync::atomic::{AtomicU32, Ordering};
use crepitus_protocol::counters::{CommsCounter, DRIVE_COUNT, DriveCounter};

/// The counters of a drive; they wrap.
#[derive(Debug, Default)]
pub struct Counters([AtomicU32; DRIVE_COUNT]);

impl Counters {
    /// All at zero.
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; DRIVE_COUNT])
    }

    /// One more.
    pub fn count(&self, counter: DriveCounter) {
        self.add(counter, 1);
    }

    /// So many more.
    pub fn add(&self, counter: DriveCounter, more: u32) {
        if let Some(place) = self.0.get(counter.index()) {
            place.fetch_add(more, Ordering::Relaxed);
        }
    }

    /// One of them.
    pub fn get(&self, counter: DriveCounter) -> u32 {
        self.0
            .get(counter.index())
            .map_or(0, |place| place.load(Ordering::Relaxed))
    }

    /// All of them, in the order of their table.
    pub fn all(&self) -> [u32; DRIVE_COUNT] {
        self.0.each_ref().map(|c| c.load(Ordering::Relaxed))
    }
}

/// The counters of comms; they wrap.
#[derive(Clone, Copy, Debug, Default)]
pub struct CommsCounters([u32; crepitus_protocol::counters::COMMS_COUNT]);

impl CommsCounters {
    /// One more.
    pub fn count(&mut self, counter: CommsCounter) {
        self.add(counter, 1);
    }

    /// So many more.
    pub fn add(&mut self, counter: CommsCounter, more: u32) {
        if let Some(place) = self.0.get_mut(counter.index()) {
            *place = place.wrapping_add(more);
        }
    }

    /// All begin with this, instead of zero.
    pub fn set_all(&mut self, value: u32) {
        self.0 = [value; crepitus_protocol::counters::COMMS_COUNT];
    }

    /// One of them.
    pub fn get(&self, counter: CommsCounter) -> u32 {
        self.0.get(counter.index()).copied().unwrap_or(0)
    }

    /// All of them, in the order of their table.
    pub fn all(&self) -> [u32; crepitus_protocol::counters::COMMS_COUNT] {
        self.0
    }
}
