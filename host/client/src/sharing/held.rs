//! A hub's part of the place where programs meet: its lock and its socket.

use crate::sharing::place::Place;
use crate::sharing::socket::{Arrival, Listener};
use std::fs::File;
use std::io;

/// Lock and socket of a hub.
#[derive(Debug)]
pub(crate) struct Held {
    place: Place,
    listener: Listener,
    lock: File,
}

impl Held {
    /// Listens at a place, whose lock this is.
    ///
    /// # Errors
    /// Of the system, as of [`Listener::at`].
    pub(crate) fn at(place: &Place, lock: File) -> io::Result<Self> {
        Ok(Self {
            place: place.clone(),
            listener: Listener::at(&place.socket)?,
            lock,
        })
    }

    /// A program that has connected. It does not wait for one.
    ///
    /// # Errors
    /// As [`Listener::accept`].
    pub(crate) fn accept(&self) -> io::Result<Arrival> {
        self.listener.accept()
    }

    /// Makes again what others do not find any more: somebody has removed it, or the system has, when
    /// its user logged out. What fails is for the next time.
    pub(crate) fn restore(&mut self) {
        let is_locked = self.place.has(&self.lock);
        if is_locked && self.listener.is_found() {
            return;
        }
        if !is_locked {
            let Ok(place) = self.place.again() else {
                return;
            };
            // Another program may just be trying to open the port.
            let Ok(Some(lock)) = place.lock() else {
                return;
            };
            (self.place, self.lock) = (place, lock);
        }
        if let Ok(listener) = Listener::at(&self.place.socket) {
            self.listener = listener;
        }
    }

    /// Listens no longer.
    pub(crate) fn into_lock(self) -> File {
        self.lock
    }
}
