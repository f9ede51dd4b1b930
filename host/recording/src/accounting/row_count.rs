//! Accounting of a recording whose own are lost, from its rows.

use super::{Cause, SampleAccounting};
use crate::row::{Row, Step};

/// Counts rows and gaps. By whom samples were dropped is lost: those that are not damaged in the
/// file count as lost on the way.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowCount {
    accounting: SampleAccounting,
    before: Option<Row>,
}

impl RowCount {
    /// Takes the next row, before which so many rows of the file are lost.
    pub(crate) fn row(&mut self, row: &Row, lost: u64) {
        let missing = match self.before.map(|before| row.step_from(&before)) {
            Some(Step::Next) => 0,
            Some(Step::Missing(samples)) => samples,
            begin @ (None | Some(Step::Restart)) => {
                self.accounting.drive_restarts += u32::from(begin.is_some());
                self.begin(row.tick, lost)
            }
        };
        let damaged = lost.min(missing);
        let cause = if damaged > 0 {
            Cause::Damaged
        } else {
            Cause::OnTheWay
        };
        self.accounting.gap(row.tick - missing, missing, cause);
        let totals = &mut self.accounting.totals;
        totals.damaged += damaged;
        totals.produced += 1;
        totals.received += 1;
        self.before = Some(*row);
    }

    /// Begins a segment with the lost rows before a tick, and returns their number.
    fn begin(&mut self, tick: u64, lost: u64) -> u64 {
        let missing = lost.min(tick);
        // Numbers of starts that differ from one to the next: the drive's own are lost.
        let start = u8::from(!self.accounting.segments.len().is_multiple_of(2));
        self.accounting.segment(tick - missing, start);
        missing
    }

    pub(crate) fn into_accounting(self) -> SampleAccounting {
        self.accounting
    }
}
