//! The accounting, checked by the ticks of the rows.

use super::{Cause, Gap, LISTED_GAPS, SampleAccounting, Segment};

/// Counts rows and gaps in the ticks alone, to compare them with the accounting.
#[derive(Clone, Debug)]
pub struct Recount<'b> {
    accounting: &'b SampleAccounting,
    rows: u64,
    next_tick: u64,
    segments: usize,
    dropped: u64,
    gap_count: u64,
    /// The first thousand.
    gaps: Vec<Gap>,
    disordered: u64,
}

impl<'b> Recount<'b> {
    /// Begins before the first row.
    pub fn new(accounting: &'b SampleAccounting) -> Self {
        Self {
            accounting,
            rows: 0,
            next_tick: 0,
            segments: 0,
            dropped: 0,
            gap_count: 0,
            gaps: Vec::new(),
            disordered: 0,
        }
    }

    /// Takes the next row's tick.
    pub fn row(&mut self, tick: u64) {
        while let Some(segment) = self.accounting.segments.get(self.segments)
            && segment.first_row <= self.rows
        {
            self.enter(segment);
        }
        if tick < self.next_tick {
            self.rows += 1;
            self.disordered += 1;
            return;
        }
        self.missing(tick - self.next_tick);
        self.rows += 1;
        self.next_tick = tick.saturating_add(1);
    }

    fn missing(&mut self, samples: u64) {
        if samples == 0 {
            return;
        }
        self.dropped = self.dropped.saturating_add(samples);
        self.gap_count += 1;
        if self.gaps.len() < LISTED_GAPS {
            let (row, first_tick) = (self.rows, self.next_tick);
            let same = |gap: &&Gap| (gap.first_tick, gap.samples) == (first_tick, samples);
            let known = self.accounting.gaps.iter().find(same);
            self.gaps.push(Gap {
                row,
                first_tick,
                samples,
                cause: known.map_or(Cause::Damaged, |gap| gap.cause),
            });
        }
    }

    /// The accounting of these rows, of which others are damaged.
    #[cfg(feature = "parquet")]
    pub(crate) fn into_accounting(mut self) -> SampleAccounting {
        let mut accounting = self.accounting.clone();
        let totals = &mut accounting.totals;
        self.missing(
            totals
                .produced
                .saturating_sub(self.rows.saturating_add(self.dropped)),
        );
        totals.damaged += totals.received.saturating_sub(self.rows);
        totals.dropped = totals.produced.saturating_sub(self.rows);
        totals.received = self.rows;
        accounting.missing_at_end = match self.gaps.last() {
            Some(gap) if gap.row == self.rows => gap.samples,
            _ => 0,
        };
        // Of the last ones no row may be left.
        accounting
            .segments
            .retain(|segment| segment.first_row < self.rows);
        accounting.gap_count = self.gap_count;
        accounting.gaps = self.gaps;
        accounting
    }

    fn enter(&mut self, segment: &Segment) {
        let before = self
            .segments
            .checked_sub(1)
            .map(|last| self.accounting.segments[last]);
        // Both segments are of one start of the drive: samples were produced meanwhile.
        if before.is_some_and(|before| before.start == segment.start) {
            self.missing(segment.first_tick.saturating_sub(self.next_tick));
        }
        self.segments += 1;
        self.next_tick = segment.first_tick;
    }

    /// Differences from the accounting, in words; none if they agree.
    pub fn differences(mut self) -> Vec<String> {
        while let Some(segment) = self.accounting.segments.get(self.segments) {
            self.enter(segment);
        }
        self.missing(self.accounting.missing_at_end);
        let totals = &self.accounting.totals;
        let produced = self.rows.saturating_add(self.dropped);
        let counts = [
            ("samples produced", produced, totals.produced),
            ("rows", self.rows, totals.received),
            ("missing samples", self.dropped, totals.dropped),
            ("gaps", self.gap_count, self.accounting.gap_count),
            ("rows out of order", self.disordered, 0),
        ];
        counts
            .into_iter()
            .filter(|(_, counted, said)| counted != said)
            .map(|(what, counted, said)| {
                format!("{what}: {counted}, but its accounting say {said}")
            })
            .collect()
    }
}
