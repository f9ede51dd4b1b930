//! Limits on connections that have shown no token yet.
//!
//! Anybody who reaches the port may open connections and say nothing, or half a request.
//! Such a connection is closed after [`TIMEOUT`] without an answer to it, and beyond
//! [`MOST`] the oldest one makes room for the newest. Connections of pages with a token
//! are not counted and never closed here.

use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Instant, Sleep, sleep};

/// Longest time between the opening of a connection, or what was last written to it, and
/// its next complete request.
pub(crate) const TIMEOUT: Duration = Duration::from_secs(5);

/// Most connections without a token.
pub(crate) const MOST: usize = 128;

/// Connections without a token, the oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pending(Arc<Mutex<VecDeque<Arc<Entry>>>>);

/// One of them.
#[derive(Debug)]
struct Entry {
    peer: SocketAddr,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    is_admitted: bool,
    is_evicted: bool,
    waker: Option<Waker>,
}

impl Pending {
    /// Counts a connection; the oldest is closed where there are too many.
    pub(crate) fn limit<S>(&self, stream: S, peer: SocketAddr) -> Limited<S> {
        let entry = Arc::new(Entry {
            peer,
            state: Mutex::default(),
        });
        let mut entries = lock(&self.0);
        if entries.len() >= MOST
            && let Some(oldest) = entries.pop_front()
        {
            let mut state = lock(&oldest.state);
            state.is_evicted = true;
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        }
        entries.push_back(entry.clone());
        Limited {
            stream,
            entry,
            pending: self.clone(),
            deadline: Box::pin(sleep(TIMEOUT)),
        }
    }

    /// Lifts the limits from a connection: it has shown a token.
    pub(crate) fn admit(&self, peer: SocketAddr) {
        let mut entries = lock(&self.0);
        if let Some(place) = entries.iter().position(|entry| entry.peer == peer)
            && let Some(entry) = entries.remove(place)
        {
            lock(&entry.state).is_admitted = true;
        }
    }

    fn remove(&self, gone: &Arc<Entry>) {
        lock(&self.0).retain(|entry| !Arc::ptr_eq(entry, gone));
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A connection under the limits.
#[derive(Debug)]
pub(crate) struct Limited<S> {
    stream: S,
    entry: Arc<Entry>,
    pending: Pending,
    deadline: Pin<Box<Sleep>>,
}

impl<S> Limited<S> {
    /// Returns an error if the connection must end; otherwise the task is woken when it must.
    fn check(&mut self, context: &mut Context<'_>) -> io::Result<()> {
        let mut state = lock(&self.entry.state);
        if state.is_admitted {
            return Ok(());
        }
        if state.is_evicted {
            return Err(io::Error::other("too many connections without a token"));
        }
        if self.deadline.as_mut().poll(context).is_ready() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        state.waker = Some(context.waker().clone());
        Ok(())
    }
}

impl<S> Drop for Limited<S> {
    fn drop(&mut self) {
        self.pending.remove(&self.entry);
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Limited<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.check(context)?;
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Limited<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.check(context)?;
        let written = ready!(Pin::new(&mut self.stream).poll_write(context, bytes))?;
        self.deadline.as_mut().reset(Instant::now() + TIMEOUT);
        Poll::Ready(Ok(written))
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.check(context)?;
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

/// Address of the other end of a connection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peer(pub(crate) SocketAddr);

/// A listener whose connections are under the limits.
pub(crate) struct Listener {
    pub(crate) listener: tokio::net::TcpListener,
    pub(crate) pending: Pending,
}

impl axum::serve::Listener for Listener {
    type Io = Limited<tokio::net::TcpStream>;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Self::Io, Self::Addr) {
        let (stream, peer) = axum::serve::Listener::accept(&mut self.listener).await;
        (self.pending.limit(stream, peer), peer)
    }

    fn local_addr(&self) -> io::Result<Self::Addr> {
        self.listener.local_addr()
    }
}

impl axum::extract::connect_info::Connected<axum::serve::IncomingStream<'_, Listener>> for Peer {
    fn connect_info(stream: axum::serve::IncomingStream<'_, Listener>) -> Self {
        Self(*stream.remote_addr())
    }
}

impl axum::extract::connect_info::Connected<SocketAddr> for Peer {
    fn connect_info(peer: SocketAddr) -> Self {
        Self(peer)
    }
}

#[cfg(feature = "lan")]
impl<S> axum_server::accept::Accept<tokio::net::TcpStream, S> for Pending {
    type Stream = Limited<tokio::net::TcpStream>;
    type Service = S;
    type Future = std::future::Ready<io::Result<(Self::Stream, S)>>;

    fn accept(&self, stream: tokio::net::TcpStream, service: S) -> Self::Future {
        let limited = stream
            .peer_addr()
            .map(|peer| (self.limit(stream, peer), service));
        std::future::ready(limited)
    }
}
