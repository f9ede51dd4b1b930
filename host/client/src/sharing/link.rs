//! The connection of a program to the hub.

use crate::sharing::frames::Frames;
use crate::sharing::note::Note;
use crate::sharing::socket::Stream;
use crepitus_protocol::Decoder;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

/// Timeout of sending: longer than a port takes nothing.
const SEND: Duration = Duration::from_millis(500);

/// Reads of what a system keeps for a program that does not read.
const MOST_UNREAD: usize = 256;

/// The connection of a program to the hub.
#[derive(Debug)]
pub(crate) struct Link {
    stream: Stream,
    frames: Frames,
    /// Frames of the device that were received and not read.
    unread: VecDeque<u8>,
    notes: VecDeque<Note>,
    /// Subscription and lease of the program that serves, unless it has ended in order.
    heir: Option<Note>,
    /// The hub has closed its end.
    is_cut: bool,
}

impl Link {
    pub(crate) fn new(stream: Stream) -> Self {
        Self {
            stream,
            frames: Frames::default(),
            unread: VecDeque::new(),
            notes: VecDeque::new(),
            heir: None,
            is_cut: false,
        }
    }

    /// Subscription and lease that the program that serves has left open so far.
    #[cfg(test)]
    pub(crate) fn heir(&self) -> Option<&Note> {
        self.heir.as_ref()
    }

    /// Subscription and lease that the program that served has left open, if it was killed: it has
    /// closed its end without a word. One that hangs has not, and may go on.
    pub(crate) fn into_heir(mut self) -> Option<Note> {
        // The word may be unread.
        for _ in 0..MOST_UNREAD {
            if !self.fill(Duration::ZERO).unwrap_or(false) {
                break;
            }
        }
        self.heir.filter(|_| self.is_cut)
    }

    /// Sends bytes.
    ///
    /// # Errors
    /// The hub has gone, or was stopped: it takes nothing, and the last frame may be torn.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.set_nonblocking(false)?;
        self.stream.set_write_timeout(Some(SEND))?;
        self.stream.write_all(bytes)
    }

    /// Moves bytes of the device to the buffer.
    pub(crate) fn take(&mut self, buffer: &mut [u8]) -> usize {
        self.unread.read(buffer).unwrap_or(0)
    }

    /// The next note of the hub.
    pub(crate) fn note(&mut self) -> Option<Note> {
        self.notes.pop_front()
    }

    /// Waits for bytes; false on a timeout. With zero it does not wait.
    ///
    /// # Errors
    /// The hub has gone.
    pub(crate) fn fill(&mut self, patience: Duration) -> io::Result<bool> {
        let mut buffer = [0; 4_096];
        // The shortest timeout would wait for a tick of the system's clock, in
        // which more bytes arrive.
        self.stream.set_nonblocking(patience.is_zero())?;
        if !patience.is_zero() {
            self.stream.set_read_timeout(Some(patience))?;
        }
        let count = match self.stream.read(&mut buffer) {
            Ok(0) => {
                self.is_cut = true;
                return Err(ErrorKind::UnexpectedEof.into());
            }
            Ok(count) => count,
            Err(error) => {
                return match error.kind() {
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {
                        Ok(false)
                    }
                    _ => {
                        self.is_cut = true;
                        Err(error)
                    }
                };
            }
        };
        let (unread, notes, heir) = (&mut self.unread, &mut self.notes, &mut self.heir);
        let bytes = buffer.get(..count).unwrap_or_default();
        self.frames.push(bytes, |frame| match note_of(frame) {
            Some(note @ Note::Heir { .. }) => *heir = Some(note),
            Some(note) => {
                if note == Note::Leaving {
                    *heir = None;
                }
                notes.push_back(note);
            }
            None => unread.extend(frame),
        });
        Ok(true)
    }
}

/// The note of a frame that is one.
fn note_of(frame: &[u8]) -> Option<Note> {
    let mut decoder = Decoder::new();
    frame.iter().find_map(|byte| match decoder.push(*byte) {
        Some(Ok(body)) => Note::of(&body),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sharing::socket::{Listener, arrival, connect};
    use std::thread;
    use std::time::Instant;

    /// A hub that was stopped takes what the system keeps for it, and no more.
    #[test]
    fn sending_to_a_program_that_was_stopped_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let listener = Listener::at(&path).unwrap();
        let stopped = thread::spawn(move || arrival(|| listener.accept()).enter().unwrap());
        let mut link = Link::new(connect(&path).unwrap());
        let stopped = stopped.join().unwrap();
        let begun = Instant::now();
        let error = (0..1_000_000).find_map(|_| link.send(&[0; 1_000]).err());
        assert!(error.is_some());
        assert!(begun.elapsed() < Duration::from_secs(5));
        drop(stopped);
    }

    /// There is something to end only of a program that has closed its end without a word.
    #[test]
    fn who_hangs_or_leaves_in_order_has_no_heir() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let listener = Listener::at(&path).unwrap();
        let heir = Note::Heir {
            open: crate::sharing::left_open::LeftOpen::default(),
            is_armed: true,
        };
        for (leaves, is_cut, is_left) in [
            (false, true, true),
            (true, true, false),
            (false, false, false),
        ] {
            // On a loopback, each waits for the other's proof.
            let served = thread::scope(|scope| {
                let served = scope.spawn(|| arrival(|| listener.accept()).enter().unwrap());
                let link = Link::new(connect(&path).unwrap());
                (served.join().unwrap(), link)
            });
            let (mut served, link) = served;
            served.write_all(&heir.frame().unwrap()).unwrap();
            if leaves {
                served.write_all(&Note::Leaving.frame().unwrap()).unwrap();
            }
            let kept = (!is_cut).then_some(served);
            assert_eq!(link.into_heir().is_some(), is_left, "{leaves} {is_cut}");
            drop(kept);
        }
    }
}
