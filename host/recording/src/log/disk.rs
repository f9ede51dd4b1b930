//! Where a recording is written: appended, and now and then made durable.

use std::fs::File;
use std::io::{self, Write};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};

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

/// Appends that may wait: about 20 s of samples.
const WAITING: usize = 1_000;

enum Order {
    Append(Vec<u8>),
    Sync,
}

/// Writes on a thread of its own: a disk that stalls must not keep the program
/// from renewing its lease.
#[derive(Debug)]
pub struct Background {
    orders: Option<SyncSender<Order>>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl Background {
    /// Writes to this disk.
    pub fn new(disk: impl Disk + Send + 'static) -> Self {
        let (orders, due) = sync_channel(WAITING);
        Self {
            orders: Some(orders),
            thread: Some(thread::spawn(move || work(disk, &due))),
        }
    }

    fn order(&mut self, order: Order) -> io::Result<()> {
        let sent = self.orders.as_ref().map(|orders| orders.try_send(order));
        match sent {
            Some(Ok(())) => Ok(()),
            Some(Err(TrySendError::Full(_))) => Err(io::Error::new(
                io::ErrorKind::TimedOut,
                "the disk has stalled for 20 s",
            )),
            // The thread has ended, with an error.
            _ => self.finish(),
        }
    }
}

impl Disk for Background {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.order(Order::Append(bytes.to_vec()))
    }

    fn sync(&mut self) -> io::Result<()> {
        self.order(Order::Sync)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.orders = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            _ => Err(io::Error::other("writing has ended before")),
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        if self.thread.is_some() {
            // What was appended is written, whoever forgets to finish.
            let _ = self.finish();
        }
    }
}

fn work(mut disk: impl Disk, due: &Receiver<Order>) -> io::Result<()> {
    for order in due {
        match order {
            Order::Append(bytes) => disk.append(&bytes)?,
            Order::Sync => disk.sync()?,
        }
    }
    disk.finish()
}
