//! Thread pool of a sweep; rows come as runs end, nearly in the order of their points.

use crate::parallel::pool;
use crate::sweep::row::Row;
use crepitus_scene::run::{Joined, step_count};
use crepitus_scene::{Observer, Scene};
use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most threads: more than any computer has cores.
const MOST_THREADS: usize = 4096;

/// Receiver of rows.
pub trait Receiver {
    /// Error that ends the sweep.
    type Error: From<Ended>;

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
    /// Not one thread could be started.
    NoThread(io::Error),
}

/// The most points that are run together: many times the lanes of a processor.
const MOST_TOGETHER: u64 = 32;

/// The most steps of all joints that are run together: what is lost if they are interrupted, half a second.
const MOST_STEPS: u64 = 1 << 26;

/// Returns the most points of a sweep that a thread takes at once, one of which has this scene.
pub(crate) fn most_at_once(scene: &Scene) -> u64 {
    if Joined::is_alone(scene) {
        (MOST_STEPS / step_count(scene).max(1)).clamp(1, MOST_TOGETHER)
    } else {
        1
    }
}

/// Threads of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    /// Number of threads: at least one, no more than points, and fewer where the system gives fewer.
    pub count: usize,
    /// The most points that a thread takes at once.
    pub at_once: u64,
}

/// Runs the points of `ranges` by `run`, which gives the row of each. Returns the number of threads.
///
/// # Errors
/// The receiver's, or of a run's own file; runs that have begun are abandoned then. Or there is
/// no thread.
pub fn run_all<R: Receiver>(
    ranges: impl IntoIterator<Item = Range<u64>, IntoIter: Send>,
    threads: Threads,
    receiver: &mut R,
    run: impl Fn(Range<u64>, &Stop, &mut dyn FnMut(Row)) -> Result<(), Ended> + Sync,
) -> Result<usize, R::Error> {
    let ranges: Vec<_> = ranges.into_iter().collect();
    let count: u64 = ranges.iter().map(|range| range.end - range.start).sum();
    let most = usize::try_from(count).unwrap_or(MOST_THREADS);
    let of_each = count.div_ceil(threads.count.clamp(1, MOST_THREADS) as u64);
    let at_once = threads.at_once.min(of_each).max(1);
    let threads = threads.count.min(most).clamp(1, MOST_THREADS);
    let stop = Stop::default();
    let mut receive = |row: Option<Result<Row, Ended>>| -> Result<(), R::Error> {
        match row {
            Some(Ok(row)) => receiver.row(row)?,
            Some(Err(Ended::Stopped)) | None => {}
            Some(Err(ended)) => return Err(ended.into()),
        }
        receiver.poll()
    };
    let take = |row| receive(row).inspect_err(|_| stop.0.store(true, Ordering::Relaxed));
    let points = ranges.into_iter().flat_map(|range| {
        let end = range.end;
        let starts = range.step_by(usize::try_from(at_once).unwrap_or(usize::MAX));
        starts.map(move |start| start..end.min(start.saturating_add(at_once)))
    });
    let run = |points, give: &mut dyn FnMut(Result<Row, Ended>)| {
        if let Err(ended) = run(points, &stop, &mut |row| give(Ok(row))) {
            give(Err(ended));
        }
    };
    match pool(points, threads, take, run) {
        Ok(outcome) => outcome,
        Err(error) => Err(Ended::NoThread(error).into()),
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
pub(crate) struct Unseen<'s>(pub(crate) &'s Stop);

impl Observer for Unseen<'_> {
    type Error = Ended;
    const WANTS_ROWS: bool = false;
    const NEEDS_STEPS: bool = false;

    fn progress(&mut self, _: f64) -> Result<(), Ended> {
        self.0.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::sync::Mutex;
    use std::thread;
    use std::time::Duration;

    /// Wants nothing.
    struct Nobody;

    impl Receiver for Nobody {
        type Error = Ended;

        fn row(&mut self, _: Row) -> Result<(), Ended> {
            Ok(())
        }

        fn poll(&mut self) -> Result<(), Ended> {
            Ok(())
        }
    }

    #[test]
    fn there_are_no_more_threads_than_points() {
        let seen = Mutex::new(BTreeSet::new());
        let ran = Mutex::new(BTreeSet::new());
        let threads = Threads {
            count: usize::MAX,
            at_once: 32,
        };
        let outcome = run_all([0..2, 5..6], threads, &mut Nobody, |points, _, give| {
            assert_eq!(points.end - points.start, 1);
            ran.lock().unwrap().insert(points.start);
            seen.lock()
                .unwrap()
                .insert(format!("{:?}", thread::current().id()));
            thread::sleep(Duration::from_millis(20));
            give(Row {
                index: points.start,
                cells: Vec::new(),
            });
            Ok(())
        });
        assert_eq!(outcome.ok(), Some(3));
        assert_eq!(ran.into_inner().unwrap(), BTreeSet::from([0, 1, 5]));
        assert!(seen.into_inner().unwrap().len() <= 3);
    }

    #[test]
    fn points_are_taken_at_once_and_none_twice() {
        let taken = Mutex::new(Vec::new());
        let threads = Threads {
            count: 2,
            at_once: 8,
        };
        let outcome = run_all([0..19, 30..31], threads, &mut Nobody, |points, _, _| {
            taken.lock().unwrap().push(points);
            Ok(())
        });
        assert_eq!(outcome.ok(), Some(2));
        let mut taken = taken.into_inner().unwrap();
        taken.sort_by_key(|points| points.start);
        assert_eq!(taken, [0..8, 8..16, 16..19, 30..31]);
    }
}
