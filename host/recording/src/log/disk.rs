//! The disk under a recording: appended to, and now and then synced.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// A file that grows at its end.
pub trait Disk {
    /// Appends.
    ///
    /// # Errors
    /// Of the disk; a part may have been written.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Makes durable what was appended, soon.
    ///
    /// # Errors
    /// Of the disk.
    fn sync(&mut self) -> io::Result<()>;

    /// Makes durable what was appended, and returns when it is.
    ///
    /// # Errors
    /// Of the disk.
    fn finish(&mut self) -> io::Result<()> {
        self.sync()
    }
}

impl Disk for File {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.write_all(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// Bytes that may wait for the disk: three minutes of samples.
const MOST_WAITING: u64 = 64 << 20;

/// Number of waiting bytes beyond which a simulated device, which is faster than its time, has to wait.
const MANY_WAITING: u64 = 16 << 20;
const HOLD_UP: Duration = Duration::from_millis(20);

enum Order {
    Append(Vec<u8>),
    Sync,
}

/// Writes on a thread of its own: a disk that stalls must not keep the program
/// from renewing its lease.
#[derive(Debug)]
pub struct Background {
    orders: Option<Sender<Order>>,
    /// Bytes that wait.
    waiting: Arc<AtomicU64>,
    thread: Option<JoinHandle<io::Result<()>>>,
    /// Bytes were left out because too many waited: what follows them would be damage.
    has_left_out: bool,
    /// The error with which the thread has ended.
    cause: Option<(io::ErrorKind, String)>,
}

impl Background {
    /// Writes to this disk.
    pub fn new(disk: impl Disk + Send + 'static) -> Self {
        let (orders, due) = channel();
        let waiting = Arc::new(AtomicU64::new(0));
        let of_thread = waiting.clone();
        Self {
            orders: Some(orders),
            waiting,
            thread: Some(thread::spawn(move || work(disk, &due, &of_thread))),
            has_left_out: false,
            cause: None,
        }
    }

    fn order(&mut self, order: Order) -> io::Result<()> {
        match self.orders.as_ref().map(|orders| orders.send(order)) {
            Some(Ok(())) => Ok(()),
            // The thread has ended, with an error.
            _ => self.finish(),
        }
    }
}

impl Disk for Background {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let waiting = self
            .waiting
            .fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.has_left_out |= waiting > MOST_WAITING;
        if self.has_left_out {
            return Err(io::Error::new(
                io::ErrorKind::TimedOut,
                "the disk is too slow: three minutes of samples wait for it",
            ));
        }
        if waiting > MANY_WAITING {
            thread::sleep(HOLD_UP);
        }
        self.order(Order::Append(bytes.to_vec()))
    }

    fn sync(&mut self) -> io::Result<()> {
        self.order(Order::Sync)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.orders = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(Ok(()))) => return Ok(()),
            Some(Ok(Err(error))) => self.cause = Some((error.kind(), error.to_string())),
            _ => {}
        }
        // A caller that asks again gets the same.
        Err(match &self.cause {
            Some((kind, text)) => io::Error::new(*kind, text.clone()),
            None => io::Error::other("writing has ended before"),
        })
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        if self.thread.is_some() {
            // Pending bytes are written even if nobody called `finish`.
            let _ = self.finish();
        }
    }
}

fn work(mut disk: impl Disk, due: &Receiver<Order>, waiting: &AtomicU64) -> io::Result<()> {
    for order in due {
        match order {
            Order::Append(bytes) => {
                disk.append(&bytes)?;
                waiting.fetch_sub(bytes.len() as u64, Ordering::Relaxed);
            }
            Order::Sync => disk.sync()?,
        }
    }
    disk.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes nothing before it may.
    struct Stalls(Receiver<()>);

    impl Disk for Stalls {
        fn append(&mut self, _: &[u8]) -> io::Result<()> {
            let _ = self.0.recv();
            Ok(())
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn behind_bytes_that_were_left_out_nothing_is_written() {
        let (proceed, may) = channel();
        let mut disk = Background::new(Stalls(may));
        let piece = vec![0; 8 << 20];
        let taken = (0..20).take_while(|_| disk.append(&piece).is_ok()).count();
        assert!((8..=9).contains(&taken), "{taken}");
        // The disk recovers.
        for _ in 0..taken {
            proceed.send(()).unwrap();
        }
        while disk.waiting.load(Ordering::Relaxed) > 2 * piece.len() as u64 {
            thread::yield_now();
        }
        let error = disk.append(&[1]).expect_err("bytes are missing before it");
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(disk.finish().is_ok());
    }
}
