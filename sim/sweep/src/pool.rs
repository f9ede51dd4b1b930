//! Thread pool of a sweep; rows come as runs end, nearly in the order of their points.

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

/// Poll interval of the receiver while no run ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Capacity of the queue of finished rows, per thread.
const WAITING: usize = 64;

/// Receiver of rows.
pub trait Receiver {
    /// Error that ends the sweep.
    type Error: From<io::Error>;

    /// Takes the row of a run.
    fn row(&mut self, row: Row) -> Result<(), Self::Error>;

    /// Polls for events of the caller, at least 20 times a second.
    fn poll(&mut self) -> Result<(), Self::Error>;
}

/// Reason why a run gave no row.
#[derive(Debug)]
pub enum Ended {
    /// [`Stop`] was set.
    Stopped,
    /// A file of its own could not be written.
    Failed(io::Error),
}

/// Runs the points of `ranges` by `run` on `threads` threads, at least one.
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

/// Stop flag of the runs.
#[derive(Debug, Default)]
pub struct Stop(AtomicBool);

impl Stop {
    /// Returns an error if the flag is set.
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

/// Observer that only checks the stop flag.
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

/// Runs a point without a trace.
///
/// # Errors
/// [`Ended::Stopped`].
pub fn totals(plan: &Plan, point: u64, stop: &Stop) -> Result<Row, Ended> {
    stop.check()?;
    plan.run(point, |scene| run(scene, &mut Unseen(stop)))
}
