//! A device that threads share: requests take turns, also while one of the threads streams.
//!
//! ```text
//! request   gate ─> client ─ work ─ free
//! stream    turn ─> (gate ─> client ─ one poll of at most 20 ms ─ free) … ─> turn is free
//! ```
//!
//! Who waits for the client holds the gate meanwhile, so that a stream which frees the client and wants it back comes after
//! the one that waits. Streams, recordings and waits take turns as a whole.

use crate::errors;
use crate::errors::failure;
use crate::signals::Signals;
use crate::timeline::Timeline;
use crepitus_client::connection::Connection;
use crepitus_client::{Client, Error};
use pyo3::prelude::*;
use std::process;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::Duration;

/// Interval at which a wait for a turn looks at signals.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// An open device.
pub(crate) struct Held {
    pub(crate) client: Client<Connection>,
    /// This program has armed the device, and not disarmed it: torque that is off has ended by itself.
    pub(crate) expects_torque: bool,
    pub(crate) timeline: Timeline,
}

/// Device of several threads.
pub(crate) struct Shared {
    gate: Mutex<()>,
    held: Mutex<Option<Held>>,
    /// The thread that streams, records or waits.
    follower: Mutex<Option<ThreadId>>,
    turn: Condvar,
    /// A call lets time pass: a device in real time does not run on by itself.
    is_followed: AtomicBool,
    /// Stops so far: what had begun before one ends.
    stops: AtomicU64,
    /// Id of the process that opened it.
    process: u32,
}

impl Shared {
    pub(crate) fn new(held: Held) -> Self {
        Self {
            gate: Mutex::new(()),
            held: Mutex::new(Some(held)),
            follower: Mutex::new(None),
            turn: Condvar::new(),
            is_followed: AtomicBool::new(false),
            stops: AtomicU64::new(0),
            process: process::id(),
        }
    }

    /// Locks the device, which is closed if there is none; callers must have released the GIL.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Option<Held>> {
        // A panic has ended a request; the lease then ends the torque.
        let _gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether this process has opened it.
    pub(crate) fn is_ours(&self) -> bool {
        process::id() == self.process
    }

    /// Fails in another process: its locks may be those of threads that it has not.
    fn check_process(&self) -> PyResult<()> {
        if self.is_ours() {
            return Ok(());
        }
        Err(errors::device(
            "this device was opened before a fork: open it in the process that uses it".to_owned(),
        ))
    }

    /// Does some work with an open device, without the GIL.
    pub(crate) fn work<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Held) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        py.detach(|| self.with(work))
    }

    /// Does some work with an open device.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut Held) -> PyResult<T>) -> PyResult<T> {
        self.check_process()?;
        let mut held = self.lock();
        let Some(held) = &mut *held else {
            return Err(errors::device(
                "this device is closed: open it again".to_owned(),
            ));
        };
        if !self.is_followed.load(Ordering::Relaxed) {
            held.client.transport_mut().run_on();
        }
        work(held)
    }

    /// Sends a request to an open device, without the GIL.
    pub(crate) fn request<T: Send>(
        &self,
        py: Python<'_>,
        request: impl FnOnce(&mut Client<Connection>) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        self.work(py, |held| request(&mut held.client).map_err(failure))
    }

    /// Notes a stop, before it is sent.
    pub(crate) fn note_stop(&self) {
        self.stops.fetch_add(1, Ordering::SeqCst);
    }

    /// Number of stops so far.
    pub(crate) fn stops(&self) -> u64 {
        self.stops.load(Ordering::SeqCst)
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let ours = self.is_ours();
        let held = self
            .held
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        let Some(Held { client, .. }) = held else {
            return;
        };
        if !ours {
            // The other process still uses the port.
            std::mem::forget(client);
        } else if client.is_connected() && client.is_armed() {
            // Without an answer its lease ends the torque.
            let _ = client.close();
        }
    }
}

/// Turn of a thread that streams, records or waits; it ends when dropped.
pub(crate) struct Turn {
    pub(crate) shared: Arc<Shared>,
    stops: u64,
}

impl Turn {
    /// Waits for the turn; callers must have released the GIL. Fails if this very thread has it.
    pub(crate) fn take(shared: &Arc<Shared>) -> PyResult<Self> {
        shared.check_process()?;
        let me = thread::current().id();
        let stops = shared.stops();
        let mut signals = Signals::new();
        let mut follower = shared
            .follower
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        while let Some(other) = *follower {
            if other == me {
                return Err(errors::device(
                    "this thread is in a loop over blocks() of this device, which lets time pass by itself: leave the loop \
                     before stream, record, wait or other blocks"
                        .to_owned(),
                ));
            }
            let waited = shared.turn.wait_timeout(follower, SIGNAL_INTERVAL);
            drop(waited);
            signals.check()?;
            follower = shared
                .follower
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
        }
        *follower = Some(me);
        drop(follower);
        let turn = Self {
            shared: shared.clone(),
            stops,
        };
        turn.shared.with(|held| {
            held.expects_torque = held.client.is_armed();
            Ok(())
        })?;
        Ok(turn)
    }

    /// Returns whether the device was stopped since the turn began.
    pub(crate) fn is_stopped(&self) -> bool {
        self.shared.stops() != self.stops
    }

    /// Marks that a call lets time pass, until the mark is dropped.
    pub(crate) fn follow(&self) -> Followed<'_> {
        self.shared.is_followed.store(true, Ordering::Relaxed);
        Followed(&self.shared)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        let follower = self.shared.follower.lock();
        *follower.unwrap_or_else(PoisonError::into_inner) = None;
        self.shared.turn.notify_all();
    }
}

/// Sign that a call lets time pass.
pub(crate) struct Followed<'s>(&'s Shared);

impl Drop for Followed<'_> {
    fn drop(&mut self) {
        self.0.is_followed.store(false, Ordering::Relaxed);
    }
}
