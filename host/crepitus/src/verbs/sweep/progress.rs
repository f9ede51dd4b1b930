//! Rows of a sweep on their way into its folder, with a progress bar.

use crate::interrupt;
use crate::progress;
use crepitus_studies::sweep::{Ended, Receiver, Row, Store, StoreError};
use std::io;

/// Reason for the early end of a sweep.
#[derive(Debug)]
pub(super) enum End {
    /// Ctrl-C.
    Interrupted,
    /// Rows cannot be written.
    Store(StoreError),
    /// A trace cannot be written.
    Trace(io::Error),
    /// There is no thread.
    NoThread(io::Error),
}

impl From<Ended> for End {
    fn from(ended: Ended) -> Self {
        match ended {
            Ended::Stopped => Self::Interrupted,
            Ended::Failed(error) => Self::Trace(error),
            Ended::NoThread(error) => Self::NoThread(error),
        }
    }
}

/// Puts rows into the folder of a sweep.
pub(super) struct Progress<'s> {
    store: &'s mut Store,
    bar: progress::Progress,
    wanted: u64,
    ran: u64,
}

impl<'s> Progress<'s> {
    pub(super) fn new(store: &'s mut Store, wanted: u64) -> Self {
        Self {
            store,
            bar: progress::Progress::of_sweep(),
            wanted,
            ran: 0,
        }
    }

    /// Writes what is not written yet, also of a sweep that ended early; how many runs
    /// it were.
    pub(super) fn finish(self) -> Result<u64, StoreError> {
        self.store.flush()?;
        Ok(self.ran)
    }
}

impl Receiver for Progress<'_> {
    type Error = End;

    fn row(&mut self, row: Row) -> Result<(), End> {
        self.ran += 1;
        self.store.take(row).map_err(End::Store)
    }

    #[expect(clippy::cast_precision_loss, reason = "a share for people")]
    fn poll(&mut self) -> Result<(), End> {
        self.bar
            .reached(self.ran as f64 / self.wanted.max(1) as f64);
        if interrupt::requested() {
            return Err(End::Interrupted);
        }
        Ok(())
    }
}
