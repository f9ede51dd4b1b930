//! Work on all cores, with progress reported from one thread.

use crate::watcher::{Cancelled, Watcher};
use crepitus_model::Real;
use std::io;
use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// Interval at which the watcher is called while no item ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Capacity of the queue of results, per thread.
const WAITING: usize = 64;

/// Work done, and whether it was cancelled.
#[derive(Debug)]
pub(crate) struct Meter {
    total: f64,
    done: AtomicU64,
    stopped: AtomicBool,
}

impl Meter {
    /// A meter for this total of work.
    pub(crate) fn new(total: f64) -> Self {
        Self {
            total: total.max(1.0),
            done: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
        }
    }

    /// Adds work done.
    pub(crate) fn add(&self, amount: u64) {
        self.done.fetch_add(amount, Ordering::Relaxed);
    }

    /// Returns whether the watcher has cancelled the work.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Reports the progress to the watcher.
    pub(crate) fn report(&self, watcher: &mut dyn Watcher) -> Result<(), Cancelled> {
        let done = f64::from_whole(self.done.load(Ordering::Relaxed));
        watcher
            .progress((done / self.total).min(1.0))
            .inspect_err(|_| self.stopped.store(true, Ordering::Relaxed))
    }
}

/// Applies `work` to each of `items` on all cores; results in the order of the
/// items.
pub(crate) fn each<T: Sync, R: Send>(
    items: &[T],
    meter: &Meter,
    watcher: &mut dyn Watcher,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Cancelled> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let mut results: Vec<(usize, R)> = Vec::with_capacity(items.len());
    let take = |result: Option<(usize, R)>| {
        results.extend(result);
        meter.report(watcher)
    };
    let work = |(place, item)| (place, work(item));
    let threads = cores.min(items.len());
    let give = |item, give: &mut dyn FnMut((usize, R))| give(work(item));
    match pool(items.iter().enumerate(), threads, take, give) {
        Ok(ended) => {
            ended?;
        }
        // Not one thread: then here.
        Err(_) => {
            for (place, item) in items.iter().enumerate() {
                results.push(work((place, item)));
                meter.report(watcher)?;
            }
        }
    }
    results.sort_by_key(|(place, _)| *place);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// Applies `work` to the items on so many threads, or fewer where the system gives fewer. `work` gives its
/// results away one by one. `take` gets
/// each as it comes, and is called without one at least 20 times a second; once it fails no
/// further item is begun. Returns the number of threads, or the error of `take`.
///
/// # Errors
/// That of the system if not one thread could be started; nothing was done then.
pub(crate) fn pool<T: Send, R: Send, E>(
    items: impl Iterator<Item = T> + Send,
    threads: usize,
    mut take: impl FnMut(Option<R>) -> Result<(), E>,
    work: impl Fn(T, &mut dyn FnMut(R)) + Sync,
) -> io::Result<Result<usize, E>> {
    let items = Mutex::new(items);
    thread::scope(|scope| {
        let (sender, results) = mpsc::sync_channel(WAITING * threads.max(1));
        let mut running = 0;
        for _ in 0..threads {
            let (sender, items, work) = (sender.clone(), &items, &work);
            let started = thread::Builder::new().spawn_scoped(scope, move || {
                // A poisoned lock: another thread panicked outside of its work.
                let mut is_wanted = true;
                while is_wanted
                    && let Some(item) = items.lock().ok().and_then(|mut items| items.next())
                {
                    work(item, &mut |result| is_wanted &= sender.send(result).is_ok());
                }
            });
            match started {
                Ok(_) => running += 1,
                Err(error) if running == 0 => return Err(error),
                Err(_) => break,
            }
        }
        drop(sender);
        let taken = loop {
            let result = match results.recv_timeout(POLL_INTERVAL) {
                Ok(result) => Some(result),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break Ok(running),
            };
            if let Err(error) = take(result) {
                break Err(error);
            }
        };
        // Who waits to send ends, too.
        drop(results);
        Ok(taken)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct EndsAfter(u32);

    impl Watcher for EndsAfter {
        fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
            assert!((0.0..=1.0).contains(&fraction));
            self.0 = self.0.checked_sub(1).ok_or(Cancelled)?;
            Ok(())
        }
    }

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..100).collect();
        let meter = Meter::new(100.0);
        let squares = each(&items, &meter, &mut EndsAfter(u32::MAX), |x| {
            thread::sleep(Duration::from_micros(u64::from(x % 3 == 0) * 200));
            meter.add(1);
            x * x
        })
        .unwrap();
        assert_eq!(squares, items.iter().map(|x| x * x).collect::<Vec<_>>());
        assert_eq!(meter.done.into_inner(), 100);
        let none: Vec<u64> = Vec::new();
        let meter = Meter::new(0.0);
        assert_eq!(
            each(&none, &meter, &mut EndsAfter(1), |x| *x),
            Ok(Vec::new())
        );
    }

    #[test]
    fn a_watcher_ends_it() {
        let items: Vec<u64> = (0..1000).collect();
        let meter = Meter::new(1000.0);
        let done = AtomicU64::new(0);
        let ended = each(&items, &meter, &mut EndsAfter(5), |_| {
            thread::sleep(Duration::from_millis(1));
            done.fetch_add(1, Ordering::Relaxed);
        });
        assert_eq!(ended, Err(Cancelled));
        assert!(meter.is_stopped() && done.into_inner() < 1000);
    }
}
