//! The connection of two programs of one user: a Unix socket, or, on a system without, one of
//! the loopback with a secret.
//!
//! Both are streams of the standard library, with its timeouts. Either way a [`Listener`] is
//! found by a path in a folder of this user alone, and nobody else gets past [`Arrival::enter`].

#[cfg(any(test, not(unix)))]
mod loopback;
#[cfg(unix)]
mod unix;

#[cfg(not(unix))]
pub(crate) use loopback::{Arrival, Listener, Stream, connect};
#[cfg(unix)]
pub(crate) use unix::{Arrival, Listener, Stream, connect};

/// Waits for a program that connects.
#[cfg(test)]
pub(crate) fn arrival<T>(accept: impl Fn() -> std::io::Result<T>) -> T {
    loop {
        match accept() {
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            arrived => return arrived.unwrap(),
        }
    }
}
