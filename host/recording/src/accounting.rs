//! Accounting of a recording: every sample that the drive produced while a
//! program recorded it is a row, or missing with a cause.
//!
//! ```text
//! produced = received + dropped
//! dropped  = by the device + on the way + while not connected + damaged in the file
//! ```
//!
//! The accounting begins at the first tick of the subscription. Each block carries the
//! number of samples that the device has not sent so far; what is missing
//! beyond that was lost after it.

mod recount;
#[cfg(feature = "parquet")]
mod row_count;

use crate::ending::Ending;
use crepitus_protocol::telemetry::Block;
pub use recount::Recount;
#[cfg(feature = "parquet")]
pub(crate) use row_count::RowCount;
use serde::{Deserialize, Serialize};

/// Limit of listed gaps; further ones are only counted.
const LISTED_GAPS: usize = 1_000;

/// Start of a subscription.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Begin {
    /// First tick of the subscription.
    pub first_tick: u64,
    /// Samples before it that the device has not sent.
    pub dropped: u32,
    /// The drive's start that counts them, as in the flags of its blocks.
    pub start: u8,
}

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
    books: SampleAccounting,
    /// Next tick of the current segment.
    next_tick: u64,
    start: Option<u8>,
    /// The device's own count.
    said: u32,
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
        if self.start == Some(begin.start) && begin.first_tick >= self.next_tick {
            let missing = begin.first_tick - self.next_tick;
            self.books.gap(self.next_tick, missing, Cause::NotConnected);
            self.books.totals.not_connected += missing;
        } else if self.start.is_some() {
            // Also with the same number, where its ticks have gone back: a device
            // that does not keep its count, or 32 restarts.
            self.books.drive_restarts += 1;
        }
        self.begin(begin);
    }

    fn begin(&mut self, begin: Begin) {
        self.books.segment(begin.first_tick, begin.start);
        self.next_tick = begin.first_tick;
        self.start = Some(begin.start);
        self.said = begin.dropped;
        self.begins.push(begin);
    }

    /// True if a subscription that begins like this one is older than what was read last.
    pub(crate) fn has_passed(&self, begin: Begin) -> bool {
        let is_latest = self.start == Some(begin.start) && self.next_tick == begin.first_tick;
        !is_latest && self.begins.contains(&begin)
    }

    /// True if ticks of the same start go back with it.
    pub(crate) fn goes_back(&self, begin: Begin) -> bool {
        self.start == Some(begin.start) && begin.first_tick < self.next_tick
    }

    /// Takes the next block; false, and nothing else, if it is not newer than
    /// the one before.
    #[must_use]
    pub(crate) fn block(&mut self, block: &Block) -> bool {
        let start = block.flags.start();
        if self.start != Some(start) {
            if self.is_past(start) {
                return false;
            }
            let begin = if self.start.is_some() {
                self.books.drive_restarts += 1;
                // The device counts from its start, too.
                Begin {
                    first_tick: block.first_tick.saturating_sub(u64::from(block.dropped)),
                    dropped: 0,
                    start,
                }
            } else {
                // Where the subscription began is damaged: what the device has counted so far may
                // have been before it.
                self.begin_is_unknown = true;
                Begin {
                    first_tick: block.first_tick,
                    dropped: block.dropped,
                    start,
                }
            };
            self.begin(begin);
        } else if block.first_tick < self.next_tick {
            return false;
        }
        let missing = block.first_tick - self.next_tick;
        let by_device = u64::from(block.dropped.wrapping_sub(self.said)).min(missing);
        let damaged = if self.is_damaged {
            missing - by_device
        } else {
            0
        };
        let cause = match (damaged, by_device) {
            (1.., _) => Cause::Damaged,
            (_, 0) => Cause::OnTheWay,
            _ if by_device == missing => Cause::Device,
            _ => Cause::Both,
        };
        self.books.gap(self.next_tick, missing, cause);
        let totals = &mut self.books.totals;
        totals.by_device += by_device;
        totals.damaged += damaged;
        let samples = block.samples.len() as u64;
        totals.produced += samples;
        totals.received += samples;
        self.next_tick = block.end_tick();
        self.said = block.dropped;
        self.is_damaged = false;
        true
    }

    /// The recording has ended: samples up to that of the drive are missing.
    pub(crate) fn ended(&mut self, ending: &Ending) {
        let end = ending.produced_to_tick.unwrap_or(0);
        let missing = end.saturating_sub(self.next_tick);
        self.books.gap(self.next_tick, missing, Cause::OnTheWay);
        self.books.missing_at_end = missing;
        self.next_tick += missing;
    }

    /// True if this start of the drive is over. Their numbers have five bits.
    fn is_past(&self, start: u8) -> bool {
        let mut latest = Vec::new();
        for segment in self.books.segments.iter().rev() {
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
        let totals = &mut self.books.totals;
        let absent = received.saturating_sub(totals.received);
        let most = totals.damaged + totals.on_the_way();
        totals.damaged = totals.damaged.max(absent.min(most));
        // If some are left it is not known which.
        if totals.on_the_way() == 0 {
            for gap in &mut self.books.gaps {
                if matches!(gap.cause, Cause::OnTheWay | Cause::Both) {
                    gap.cause = Cause::Damaged;
                }
            }
        }
        if core::mem::take(&mut self.begin_is_unknown) {
            self.books.damaged_before(absent.saturating_sub(most));
        }
    }

    pub(crate) fn accounting(&self) -> &SampleAccounting {
        &self.books
    }

    pub(crate) fn into_books(self) -> SampleAccounting {
        self.books
    }

    /// The tick after the last sample.
    pub(crate) fn next_tick(&self) -> u64 {
        self.next_tick
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::State;
    use crepitus_protocol::telemetry::BlockFlags;

    fn block(first_tick: u64, dropped: u32, start: u16) -> Block {
        Block {
            first_tick,
            dropped,
            flags: BlockFlags::new(State::Disarmed, false, start),
            ..Block::default()
        }
    }

    fn begin(first_tick: u64, dropped: u32, start: u8) -> Begin {
        Begin {
            first_tick,
            dropped,
            start,
        }
    }

    /// A device that nobody listened to for an hour has not sent 72 million samples.
    #[test]
    fn without_the_begin_of_the_subscription_nothing_is_missing_before_the_first_block() {
        let mut ledger = Ledger::default();
        ledger.damaged();
        assert!(ledger.block(&block(72_000_000, 72_000_000, 1)));
        assert!(ledger.block(&block(72_000_040, 72_000_020, 1)));
        let totals = ledger.accounting().totals;
        assert_eq!((totals.produced, totals.received), (60, 40));
        assert_eq!((totals.dropped, totals.by_device), (20, 20));
        // What the recorder had is known from then on.
        ledger.expect_received(100);
        let books = ledger.into_books();
        let totals = books.totals;
        assert_eq!((totals.produced, totals.received), (120, 40));
        assert_eq!(
            (totals.dropped, totals.by_device, totals.damaged),
            (80, 20, 60)
        );
        assert_eq!(books.segments[0].first_tick, 72_000_000 - 60);
        assert_eq!((books.gap_count, books.gaps[0].samples), (2, 60));
        let mut recount = Recount::new(&books);
        (72_000_000..72_000_020).for_each(|tick| recount.row(tick));
        (72_000_040..72_000_060).for_each(|tick| recount.row(tick));
        assert_eq!(recount.differences(), Vec::<String>::new());
    }

    /// Every cause once: sums, gaps, and the recount of the same rows.
    #[test]
    fn every_missing_sample_has_a_cause() {
        let mut ledger = Ledger::default();
        let mut ticks = Vec::new();
        let mut take = |ledger: &mut Ledger, block: &Block| {
            assert!(ledger.block(block));
            ticks.extend(block.first_tick..block.end_tick());
        };
        ledger.subscribed(begin(1_000, 60, 1));
        // 20 on the way before the first block.
        take(&mut ledger, &block(1_020, 60, 1));
        // 40 by the device.
        take(&mut ledger, &block(1_080, 100, 1));
        // 20 by the device, 20 on the way.
        take(&mut ledger, &block(1_140, 120, 1));
        assert!(!ledger.block(&block(1_140, 120, 1)), "doubled");
        ledger.damaged();
        take(&mut ledger, &block(1_200, 120, 1));
        // The connection is lost for 80 samples.
        ledger.subscribed(begin(1_300, 180, 1));
        take(&mut ledger, &block(1_300, 180, 1));
        // The drive restarts and drops its first block.
        take(&mut ledger, &block(20, 20, 2));
        take(&mut ledger, &block(40, 20, 2));
        let books = ledger.into_books();
        assert_eq!(
            books.totals,
            Totals {
                produced: 380,
                received: 140,
                dropped: 240,
                by_device: 80,
                not_connected: 80,
                damaged: 40,
            }
        );
        assert_eq!(books.totals.on_the_way(), 40);
        let causes: Vec<_> = books.gaps.iter().map(|gap| (gap.row, gap.cause)).collect();
        assert_eq!(
            causes,
            [
                (0, Cause::OnTheWay),
                (20, Cause::Device),
                (40, Cause::Both),
                (60, Cause::Damaged),
                (80, Cause::NotConnected),
                (100, Cause::Device),
            ]
        );
        assert_eq!((books.drive_restarts, books.segments.len()), (1, 3));
        let recount = |ticks: &[u64]| {
            let mut recount = Recount::new(&books);
            for tick in ticks {
                recount.row(*tick);
            }
            recount.differences()
        };
        assert_eq!(recount(&ticks), [""; 0]);
        for wrong in [0, 50, 139] {
            let mut fewer = ticks.clone();
            fewer.remove(wrong);
            assert!(!recount(&fewer).is_empty(), "row {wrong} is missing");
            let mut more = ticks.clone();
            more.insert(wrong, ticks[wrong]);
            assert!(!recount(&more).is_empty(), "row {wrong} is there twice");
        }
        let mut swapped = ticks.clone();
        swapped.swap(30, 31);
        assert!(!recount(&swapped).is_empty());
    }

    /// Damage by bytes out of order: no part of the file reads as damaged, what the recorder had says so.
    #[test]
    fn a_gap_of_samples_that_the_recorder_had_is_damaged() {
        let causes = |received| {
            let mut ledger = Ledger::default();
            ledger.subscribed(begin(0, 0, 1));
            assert!(ledger.block(&block(20, 0, 1)));
            // 20 by the device, 20 that are not there.
            assert!(ledger.block(&block(80, 20, 1)));
            ledger.expect_received(received);
            let books = ledger.into_books();
            let gaps: Vec<_> = books.gaps.iter().map(|gap| gap.cause).collect();
            (books.totals.damaged, gaps)
        };
        let [way, both] = [Cause::OnTheWay, Cause::Both];
        assert_eq!(causes(40), (0, vec![way, both]));
        assert_eq!(causes(60), (20, vec![way, both]), "which of them");
        assert_eq!(causes(80), (40, vec![Cause::Damaged; 2]));
    }

    #[test]
    fn a_restart_with_the_same_number_is_one() {
        let mut ledger = Ledger::default();
        ledger.subscribed(begin(1_000, 0, 1));
        assert!(ledger.block(&block(1_000, 0, 1)));
        ledger.subscribed(begin(200, 0, 1));
        assert!(ledger.block(&block(200, 0, 1)));
        let books = ledger.into_books();
        assert_eq!((books.drive_restarts, books.totals.dropped), (1, 0));
    }
}
