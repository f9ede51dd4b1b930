//! Accounting of a recording: every sample that the drive produced while a
//! program recorded it is a row, or missing with a cause.
//!
//! ```text
//! produced = received + dropped
//! dropped  = by the device + on the way + while not connected + damaged in the file
//! ```
//!
//! The accounting begins at the first tick of the subscription. How a gap is found, and
//! what of it the device counts, is in [`crepitus_protocol::accounting`]; what is missing beyond
//! that was lost after it.

mod recount;
#[cfg(feature = "parquet")]
mod row_count;

use crate::ending::Ending;
use crepitus_protocol::accounting::{Begin, Missing, StreamPosition, Taken};
use crepitus_protocol::telemetry::Block;
pub use recount::Recount;
#[cfg(feature = "parquet")]
pub(crate) use row_count::RowCount;
use serde::{Deserialize, Serialize};

/// Limit of listed gaps; further ones are only counted.
const LISTED_GAPS: usize = 1_000;

/// Cause of missing samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The device has not sent them, and says so.
    Device,
    /// They were lost between the device and the file.
    OnTheWay,
    /// Some of them one, some the other.
    Both,
    /// The connection was lost and opened again.
    NotConnected,
    /// That part of the file is damaged.
    Damaged,
}

impl Cause {
    /// Returns the cause in a few words.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Device => "dropped by the device",
            Self::OnTheWay => "lost on the way",
            Self::Both => "dropped by the device or lost on the way",
            Self::NotConnected => "not connected",
            Self::Damaged => "damaged in the file",
        }
    }
}

/// Consecutive missing samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Gap {
    /// Number of rows before it.
    pub row: u64,
    /// The first missing tick.
    pub first_tick: u64,
    /// Number of missing samples.
    pub samples: u64,
    /// Cause of the gap.
    pub cause: Cause,
}

/// Sums of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Totals {
    /// Produced by the drive from the first tick of the subscription to the last
    /// recorded one.
    pub produced: u64,
    /// Recorded.
    pub received: u64,
    /// Missing, for any reason.
    pub dropped: u64,
    /// Part of the missing samples that the device did not send.
    pub by_device: u64,
    /// Part of the missing samples that was produced while the connection was lost.
    pub not_connected: u64,
    /// Part of the missing samples that is damaged in the file.
    pub damaged: u64,
}

impl Totals {
    /// Returns the sums as text.
    pub(crate) fn text(&self) -> String {
        format!(
            "{} produced, {} received, {} missing ({} dropped by the device, {} not recorded while the \
             connection was lost, {} damaged)",
            self.produced,
            self.received,
            self.dropped,
            self.by_device,
            self.not_connected,
            self.damaged
        )
    }

    /// Missing samples that were lost between the device and the file.
    pub fn on_the_way(&self) -> u64 {
        self.dropped
            .saturating_sub(self.by_device)
            .saturating_sub(self.not_connected)
            .saturating_sub(self.damaged)
    }
}

/// Rows with increasing ticks: from a subscription, or a restart of the drive,
/// to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segment {
    /// Number of rows before it.
    pub first_row: u64,
    /// Tick at which its accounting begins.
    pub first_tick: u64,
    /// The lowest bits of the drive's boot counter.
    pub start: u8,
}

/// The accounting of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SampleAccounting {
    /// The sums.
    pub totals: Totals,
    /// Segments in order of their rows.
    pub segments: Vec<Segment>,
    /// The first thousand gaps.
    pub gaps: Vec<Gap>,
    /// Number of gaps.
    pub gap_count: u64,
    /// Samples after the last row that are known to be missing.
    #[serde(default)]
    pub missing_at_end: u64,
    /// Restarts of the drive; its ticks restart from 0.
    pub drive_restarts: u32,
}

impl SampleAccounting {
    fn gap(&mut self, first_tick: u64, samples: u64, cause: Cause) {
        if samples == 0 {
            return;
        }
        self.gap_count += 1;
        if self.gaps.len() < LISTED_GAPS {
            let row = self.totals.received;
            self.gaps.push(Gap {
                row,
                first_tick,
                samples,
                cause,
            });
        }
        // Numbers of a file may be any.
        self.totals.produced = self.totals.produced.saturating_add(samples);
        self.totals.dropped = self.totals.dropped.saturating_add(samples);
    }

    /// Records that so many samples before the first one are damaged.
    fn damaged_before(&mut self, samples: u64) {
        let Some(segment) = self.segments.first_mut() else {
            return;
        };
        let samples = samples.min(segment.first_tick);
        if samples == 0 {
            return;
        }
        segment.first_tick -= samples;
        let gap = Gap {
            row: 0,
            first_tick: segment.first_tick,
            samples,
            cause: Cause::Damaged,
        };
        self.gaps.insert(0, gap);
        self.gaps.truncate(LISTED_GAPS);
        self.gap_count += 1;
        self.totals.produced += samples;
        self.totals.dropped += samples;
        self.totals.damaged += samples;
    }

    fn segment(&mut self, first_tick: u64, start: u8) {
        let segment = Segment {
            first_row: self.totals.received,
            first_tick,
            start,
        };
        self.segments.push(segment);
    }
}

/// Keeps the accounting as blocks arrive.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ledger {
    accounting: SampleAccounting,
    /// Place in the current segment.
    position: Option<StreamPosition>,
    /// Beginnings of all segments, as they were reported.
    begins: Vec<Begin>,
    /// A part of the file before the next block is damaged.
    is_damaged: bool,
    /// The part that says where the first subscription begins is damaged, too.
    begin_is_unknown: bool,
}

impl Ledger {
    /// A subscription begins, the first one or after a lost connection.
    pub(crate) fn subscribed(&mut self, begin: Begin) {
        match self.position {
            Some(position)
                if position.start() == begin.start && begin.first_tick >= position.next_tick() =>
            {
                let missing = begin.first_tick - position.next_tick();
                self.accounting
                    .gap(position.next_tick(), missing, Cause::NotConnected);
                self.accounting.totals.not_connected += missing;
            }
            // Also with the same number, where its ticks have gone back: a device
            // that does not keep its count, or 32 restarts.
            Some(_) => self.accounting.drive_restarts += 1,
            None => {}
        }
        self.begin(begin);
    }

    fn begin(&mut self, begin: Begin) {
        self.accounting.segment(begin.first_tick, begin.start);
        self.position = Some(StreamPosition::at(begin));
        self.begins.push(begin);
    }

    /// True if a subscription that begins like this one is older than what was read last.
    pub(crate) fn has_passed(&self, begin: Begin) -> bool {
        let is_latest = self.position.is_some_and(|position| {
            position.start() == begin.start && position.next_tick() == begin.first_tick
        });
        !is_latest && self.begins.contains(&begin)
    }

    /// True if ticks of the same start go back with it.
    pub(crate) fn goes_back(&self, begin: Begin) -> bool {
        self.position.is_some_and(|position| {
            position.start() == begin.start && begin.first_tick < position.next_tick()
        })
    }

    /// Takes the next block; false, and nothing else, if it is not newer than
    /// the one before.
    #[must_use]
    pub(crate) fn block(&mut self, block: &Block) -> bool {
        let start = block.flags.start();
        let mut position = match self.position {
            Some(position) if position.start() != start && self.is_past(start) => return false,
            Some(position) => position,
            None => {
                // Where the subscription began is damaged: what the device has counted so far may
                // have been before it.
                self.begin_is_unknown = true;
                let begin = Begin {
                    first_tick: block.first_tick,
                    dropped: block.dropped,
                    start,
                };
                self.begin(begin);
                StreamPosition::at(begin)
            }
        };
        let missing = match position.take(block) {
            Taken::Next(missing) => missing,
            Taken::Restarted(missing) => {
                self.accounting.drive_restarts += 1;
                self.begin(Begin::after_restart(block));
                missing
            }
            Taken::Old => return false,
        };
        self.missing(missing);
        let totals = &mut self.accounting.totals;
        let samples = block.samples.len() as u64;
        totals.produced += samples;
        totals.received += samples;
        self.position = Some(position);
        self.is_damaged = false;
        true
    }

    /// Lists a gap by its cause.
    fn missing(&mut self, missing: Missing) {
        let by_device = missing.reported.min(missing.samples);
        let damaged = if self.is_damaged {
            missing.samples - by_device
        } else {
            0
        };
        let cause = match (damaged, by_device) {
            (1.., _) => Cause::Damaged,
            (_, 0) => Cause::OnTheWay,
            _ if by_device == missing.samples => Cause::Device,
            _ => Cause::Both,
        };
        self.accounting
            .gap(missing.first_tick, missing.samples, cause);
        self.accounting.totals.by_device += by_device;
        self.accounting.totals.damaged += damaged;
    }

    /// The recording has ended: samples up to that of the drive are missing.
    pub(crate) fn ended(&mut self, ending: &Ending) {
        let end = ending.produced_to_tick.unwrap_or(0);
        let first_tick = self.next_tick();
        let missing = match &mut self.position {
            Some(position) => position.skip_to(end),
            None => end,
        };
        self.accounting.gap(first_tick, missing, Cause::OnTheWay);
        self.accounting.missing_at_end = missing;
    }

    /// True if this start of the drive is over. Their numbers have five bits.
    fn is_past(&self, start: u8) -> bool {
        let mut latest = Vec::new();
        for segment in self.accounting.segments.iter().rev() {
            if latest.last() != Some(&segment.start) {
                latest.push(segment.start);
            }
            if latest.len() == 31 {
                break;
            }
        }
        latest.contains(&start)
    }

    /// Samples that are missing before the next block may be damaged in the file.
    pub(crate) fn damaged(&mut self) {
        self.is_damaged = true;
    }

    /// The recorder had received so many samples up to here.
    pub(crate) fn expect_received(&mut self, received: u64) {
        let totals = &mut self.accounting.totals;
        let absent = received.saturating_sub(totals.received);
        let most = totals.damaged + totals.on_the_way();
        totals.damaged = totals.damaged.max(absent.min(most));
        // If some are left it is not known which.
        if totals.on_the_way() == 0 {
            for gap in &mut self.accounting.gaps {
                if matches!(gap.cause, Cause::OnTheWay | Cause::Both) {
                    gap.cause = Cause::Damaged;
                }
            }
        }
        if core::mem::take(&mut self.begin_is_unknown) {
            self.accounting.damaged_before(absent.saturating_sub(most));
        }
    }

    pub(crate) fn accounting(&self) -> &SampleAccounting {
        &self.accounting
    }

    pub(crate) fn into_accounting(self) -> SampleAccounting {
        self.accounting
    }

    /// The tick after the last sample.
    pub(crate) fn next_tick(&self) -> u64 {
        self.position.map_or(0, |position| position.next_tick())
    }
}

#[cfg(test)]
mod tests;
