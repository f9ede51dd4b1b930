//! Output to stdout and stderr, which others read at their own pace.
//!
//! A pipe that nobody reads, or a terminal that was stopped by Ctrl-S, takes nothing more. A write would then wait
//! for it, whatever signal comes; here a requested stop ends the wait.

#[cfg(unix)]
use crate::interrupt;
use std::io::{self, ErrorKind, IsTerminal, Write};

/// A pipe that is writable takes so many bytes at once.
const PIPE_BYTES: usize = 4096;

/// A terminal that is writable takes at least so many.
const TERMINAL_BYTES: usize = 256;

/// Writes to stdout.
///
/// # Errors
/// Of the write; [`ErrorKind::BrokenPipe`] also if a stop is requested while nobody reads.
pub(crate) fn to_stdout(text: &str) -> io::Result<()> {
    let out = io::stdout();
    let bytes = most_bytes(&out);
    let mut out = out.lock();
    for part in text.as_bytes().chunks(bytes) {
        if !takes_more(&out) {
            return Err(ErrorKind::BrokenPipe.into());
        }
        out.write_all(part)?;
        out.flush()?;
    }
    Ok(())
}

/// Writes to stderr, and a newline. Without anybody who reads, what is done goes on.
pub(crate) fn to_stderr(line: &str) {
    let mut err = io::stderr().lock();
    let bytes = most_bytes(&err);
    for part in format!("{line}\n").as_bytes().chunks(bytes) {
        if !takes_more(&err) || err.write_all(part).is_err() {
            return;
        }
    }
}

fn most_bytes(out: &impl IsTerminal) -> usize {
    if out.is_terminal() {
        TERMINAL_BYTES
    } else {
        PIPE_BYTES
    }
}

/// Returns whether stderr takes more now.
#[cfg(unix)]
pub(crate) fn stderr_is_ready() -> bool {
    is_ready(&io::stderr(), 0)
}

/// Waits until it takes more; false if a stop is requested first.
#[cfg(unix)]
fn takes_more(out: &impl std::os::fd::AsRawFd) -> bool {
    /// Time between two looks at the request for a stop, ms.
    const LOOK_EVERY: i32 = 20;
    while !is_ready(out, LOOK_EVERY) {
        if interrupt::ever_requested() {
            return false;
        }
    }
    true
}

/// Returns whether a write would not wait, within this time; also if it would fail.
#[cfg(unix)]
fn is_ready(out: &impl std::os::fd::AsRawFd, ms: i32) -> bool {
    use nix::errno::Errno;
    use nix::poll::{PollFd, PollFlags, poll};
    let mut out = [PollFd::new(out.as_raw_fd(), PollFlags::POLLOUT)];
    !matches!(poll(&mut out, ms), Ok(0) | Err(Errno::EINTR))
}

#[cfg(not(unix))]
pub(crate) fn stderr_is_ready() -> bool {
    true
}

#[cfg(not(unix))]
fn takes_more<T>(_: &T) -> bool {
    true
}
