//! Runs on all cores; rows come as they end, nearly in the order of their points.

use crate::plan::Plan;
use crate::row::Row;
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Observer, run};
use std::io;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// How often the caller is asked while no run ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Rows that wait for the caller, per core.
const WAITING: usize = 64;

/// Who gets the rows.
pub trait Receiver {
    /// Why it cannot go on.
    type Error: From<io::Error>;

    /// A run that has ended.
    fn row(&mut self, row: Row) -> Result<(), Self::Error>;

    /// Called at least 20 times a second.
    fn poll(&mut self) -> Result<(), Self::Error>;
}

/// Why a run gave no row.
#[derive(Debug)]
pub enum Ended {
    /// [`Stop`] was set.
    Stopped,
    /// A file of its own could not be written.
    Failed(io::Error),
}

/// Runs the points of `ranges` on `threads` threads, by `run`.
///
/// # Errors
/// The receiver's, or of a run's own file; runs that have begun are abandoned then.
pub fn run_all<R: Receiver>(
    ranges: impl IntoIterator<Item = Range<u64>, IntoIter: Send>,
    threads: usize,
    receiver: &mut R,
    run: impl Fn(u64, &Stop) -> Result<Row, Ended> + Sync,
) -> Result<(), R::Error> {
    let points = Mutex::new(ranges.into_iter().flatten());
    let stop = Stop::default();
    thread::scope(|scope| {
        let (sender, rows) = mpsc::sync_channel(WAITING * threads.max(1));
        for _ in 0..threads.max(1) {
            let (sender, points, run, stop) = (sender.clone(), &points, &run, &stop);
            scope.spawn(move || {
                // A poisoned lock: another thread panicked outside of a run.
                while let Some(point) = points.lock().ok().and_then(|mut points| points.next()) {
                    let row = run(point, stop);
                    let is_last = row.is_err();
                    if sender.send(row).is_err() || is_last {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let outcome = receive(&rows, receiver);
        if outcome.is_err() {
            stop.0.store(true, Ordering::Relaxed);
        }
        // Who waits to send ends, too.
        drop(rows);
        outcome
    })
}

fn receive<R: Receiver>(
    rows: &mpsc::Receiver<Result<Row, Ended>>,
    receiver: &mut R,
) -> Result<(), R::Error> {
    loop {
        match rows.recv_timeout(POLL_INTERVAL) {
            Ok(Ok(row)) => receiver.row(row)?,
            Ok(Err(Ended::Failed(e))) => return Err(e.into()),
            Ok(Err(Ended::Stopped)) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        receiver.poll()?;
    }
}

/// Whether the runs are to end.
#[derive(Debug, Default)]
pub struct Stop(AtomicBool);

impl Stop {
    /// An error if they are.
    ///
    /// # Errors
    /// [`Ended::Stopped`].
    pub fn check(&self) -> Result<(), Ended> {
        if self.0.load(Ordering::Relaxed) {
            Err(Ended::Stopped)
        } else {
            Ok(())
        }
    }
}

/// Sees nothing of a run but whether it is to end.
struct Unseen<'s>(&'s Stop);

impl Observer for Unseen<'_> {
    type Error = Ended;
    const WANTS_ROWS: bool = false;

    fn row(&mut self, _: &[f64]) -> Result<(), Ended> {
        Ok(())
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Ended> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Ended> {
        self.0.check()
    }
}

/// Runs a point for its totals.
///
/// # Errors
/// [`Ended::Stopped`].
pub fn totals(plan: &Plan, point: u64, stop: &Stop) -> Result<Row, Ended> {
    stop.check()?;
    plan.run(point, |scene| run(scene, &mut Unseen(stop)))
}
