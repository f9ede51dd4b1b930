//! A client's socket that never blocks, with bounded buffers.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Result, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use rustix::net::sockopt::{
    set_socket_keepalive, set_tcp_keepcnt, set_tcp_keepidle, set_tcp_keepintvl,
};

/// Limit of what a client has not read yet, bytes: above it, nothing more is done for the client.
const OUTGOING_LIMIT: usize = 256 * 1024;

/// Largest amount that one call reads, bytes.
const CHUNK: usize = 16 * 1024;

/// A client whose machine has vanished is noticed after this long without an answer, and then this
/// many questions a second apart.
const KEEPALIVE_IDLE: Duration = Duration::from_secs(10);
const KEEPALIVE_INTERVAL: Duration = Duration::from_secs(1);
const KEEPALIVE_COUNT: u32 = 5;

/// A connection.
#[derive(Debug)]
pub(crate) struct Connection {
    stream: TcpStream,
    pub(crate) peer: SocketAddr,
    incoming: Vec<u8>,
    /// Bytes at the front of `incoming` that have been used.
    used: usize,
    outgoing: VecDeque<u8>,
    /// The client sends no more.
    pub(crate) has_ended: bool,
}

impl Connection {
    pub(crate) fn new(stream: TcpStream, peer: SocketAddr) -> Result<Self> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        set_socket_keepalive(&stream, true)?;
        set_tcp_keepidle(&stream, KEEPALIVE_IDLE)?;
        set_tcp_keepintvl(&stream, KEEPALIVE_INTERVAL)?;
        set_tcp_keepcnt(&stream, KEEPALIVE_COUNT)?;
        Ok(Self {
            stream,
            peer,
            incoming: Vec::new(),
            used: 0,
            outgoing: VecDeque::new(),
            has_ended: false,
        })
    }

    /// Reads what has arrived, until there are `limit` bytes to use.
    pub(crate) fn receive(&mut self, limit: usize) -> Result<()> {
        self.incoming.drain(..self.used);
        self.used = 0;
        let mut bytes = [0; CHUNK];
        while self.incoming.len() < limit && !self.has_ended {
            let room = (limit - self.incoming.len()).min(CHUNK);
            match self.stream.read(&mut bytes[..room]) {
                Ok(0) => self.has_ended = true,
                Ok(count) => self.incoming.extend(&bytes[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// The bytes that have arrived and are not used yet.
    pub(crate) fn received(&self) -> &[u8] {
        self.incoming.get(self.used..).unwrap_or_default()
    }

    /// The first `count` bytes of [`received`](Self::received) have been used.
    pub(crate) fn consume(&mut self, count: usize) {
        self.used = (self.used + count).min(self.incoming.len());
    }

    /// Returns whether the client reads what it is sent. If not, the rest has to wait.
    pub(crate) fn has_room(&self) -> bool {
        self.outgoing.len() < OUTGOING_LIMIT
    }

    /// Takes a message for the client.
    pub(crate) fn send(&mut self, message: &[u8]) {
        self.outgoing.extend(message);
    }

    /// Passes on as much as the client takes; returns whether that is all.
    pub(crate) fn flush(&mut self) -> Result<bool> {
        while !self.outgoing.is_empty() {
            match self.stream.write(self.outgoing.as_slices().0) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => drop(self.outgoing.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(false),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(true)
    }
}
