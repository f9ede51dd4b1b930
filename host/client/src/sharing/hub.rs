//! The hub: the port on one side, programs on the other.
//!
//! ```text
//!           ┌─ receive ──> members ──> outbox, write ──> program     a thread each
//!  port ──  │
//!           └─ send <──── one queue <───────── read <─── program
//! ```
//!
//! The hub ends with its owner, or when the port fails. Then every program is notified, and
//! the lock falls to one of them.

use crate::sharing::frames::Frames;
use crate::sharing::held::Held;
use crate::sharing::left_open::requests_in;
use crate::sharing::member::{Chunk, Member};
use crate::sharing::note::Note;
use crate::sharing::socket::{Arrival, Stream};
use crate::{Transport, TransportError};
use crepitus_protocol::Decoder;
use crepitus_protocol::frame::Frame;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Write};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Interval at which a thread that waits for bytes looks whether the hub has ended.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// The first pause of waiting for a program that connects, as this one does when the hub has begun;
/// each is twice as long as the one before, up to [`LOOK_EVERY`].
const SOON: Duration = Duration::from_millis(1);

/// The longest pause of the thread that receives. After a longer one this program was stopped,
/// and what has waited for it meanwhile is too old to be sent: those who have sent it know
/// no longer of it. Less than the timeout of a request.
pub(crate) const STOPPED_MS: u64 = 400;

/// Frames on their way to the port.
const QUEUE: usize = 64;

/// Chunks on their way to a program: several seconds of telemetry.
const OUTBOX: usize = 8_192;

/// A hub in threads of its own.
#[derive(Debug)]
pub(crate) struct Hub {
    state: Arc<State>,
    thread: Option<JoinHandle<()>>,
}

/// Shared by the threads.
#[derive(Debug)]
struct State {
    members: Mutex<BTreeMap<u64, Member>>,
    to_port: SyncSender<Chunk>,
    is_over: AtomicBool,
    began: Instant,
    /// Time from `began` at which the thread that receives was last seen at work, ms.
    at_work_ms: AtomicU64,
}

impl Hub {
    /// Serves a port. The lock is kept as long as the port is open.
    pub(crate) fn start(
        ports: (
            impl Transport + Send + 'static,
            impl Transport + Send + 'static,
        ),
        held: Held,
    ) -> Self {
        let (to_port, queue) = sync_channel(QUEUE);
        let state = Arc::new(State {
            members: Mutex::default(),
            to_port,
            is_over: AtomicBool::new(false),
            began: Instant::now(),
            at_work_ms: AtomicU64::new(0),
        });
        let (receiver, sender) = ports;
        let [for_accept, for_send, for_receive] = [(); 3].map(|()| state.clone());
        let acceptor = thread::spawn(move || for_accept.accept(held));
        let sending = thread::spawn(move || for_send.send_all(sender, &queue));
        let thread = thread::spawn(move || {
            for_receive.receive_all(receiver);
            for_receive.end();
            // A thread that has panicked has ended, too.
            let _ = sending.join();
            // The acceptor returns the lock, which ends last.
            drop(acceptor.join());
        });
        Self {
            state,
            thread: Some(thread),
        }
    }

    /// Returns whether it serves no longer: the port has failed.
    pub(crate) fn is_over(&self) -> bool {
        self.state.is_over()
    }
}

impl Drop for Hub {
    fn drop(&mut self) {
        self.state.end();
        if let Some(thread) = self.thread.take() {
            // The port is closed, and the lock free.
            let _ = thread.join();
        }
    }
}

impl State {
    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Acquire)
    }

    /// Returns whether this program was stopped, and goes on.
    fn was_stopped(&self) -> bool {
        let at_work_ms = self.at_work_ms.load(Ordering::Acquire);
        self.now_ms().saturating_sub(at_work_ms) > STOPPED_MS
    }

    fn now_ms(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX)
    }

    /// Ends all threads: those of programs when their queues close.
    fn end(&self) {
        self.is_over.store(true, Ordering::Release);
        self.members().clear();
    }

    fn members(&self) -> MutexGuard<'_, BTreeMap<u64, Member>> {
        // What a thread that has panicked has left is still a list of programs.
        self.members.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes of the port to all programs.
    fn receive_all(&self, mut port: impl Transport) {
        let (mut frames, mut buffer) = (Frames::default(), [0; 4_096]);
        while !self.is_over() && !self.was_stopped() {
            self.at_work_ms.store(self.now_ms(), Ordering::Release);
            let Ok(count) = port.receive(&mut buffer, LOOK_EVERY) else {
                return;
            };
            let mut whole = Vec::new();
            frames.push(buffer.get(..count).unwrap_or_default(), |frame| {
                whole.extend_from_slice(frame);
            });
            if whole.is_empty() {
                continue;
            }
            let chunk = Chunk::from(whole);
            for member in self.members().values() {
                member.pass(&chunk);
            }
        }
    }

    /// Frames of all programs to the port.
    fn send_all(&self, mut port: impl Transport, queue: &Receiver<Chunk>) {
        // Whatever the program before has left unfinished.
        let mut sent = port.send(&[0]);
        while !self.is_over() {
            match sent {
                // Lost frames are sent again by those who miss the answer.
                Ok(()) | Err(TransportError::Stalled { .. }) => {}
                Err(_) => return self.end(),
            }
            sent = match queue.recv_timeout(LOOK_EVERY) {
                // The frame has waited for this program to go on.
                Ok(_) if self.was_stopped() => return self.end(),
                Ok(frame) => port.send(&frame),
                Err(RecvTimeoutError::Timeout) => Ok(()),
                Err(RecvTimeoutError::Disconnected) => return,
            };
        }
    }

    /// Takes programs in until the hub ends; returns the lock. It never waits for a program, as
    /// none can connect to a socket that was removed.
    fn accept(self: &Arc<Self>, mut held: Held) -> File {
        let (mut number, mut pause) = (0, SOON);
        while !self.is_over() {
            held.restore();
            if let Ok(arrival) = held.accept() {
                let state = self.clone();
                // As many threads as the system gives: this program is not served, the others are.
                let _ = Builder::new().spawn(move || state.serve(number, arrival));
                (number, pause) = (number + 1, SOON);
            } else {
                // Nobody; or too many open files, of which some will be closed.
                thread::sleep(pause);
                pause = LOOK_EVERY.min(2 * pause);
            }
        }
        held.into_lock()
    }

    /// Serves a program until it closes its end.
    fn serve(&self, number: u64, arrival: Arrival) {
        let Ok(stream) = arrival.enter() else {
            return;
        };
        let stream = Arc::new(stream);
        let for_writing = stream.clone();
        let (outbox, inbox) = sync_channel(OUTBOX);
        if !self.admit(number, Member::new(outbox)) {
            return;
        }
        let writer = Builder::new().spawn(move || write_all(&for_writing, &inbox));
        if writer.is_ok() {
            self.read_all(number, &stream);
        }
        self.dismiss(number);
    }

    /// False when the hub has ended.
    fn admit(&self, number: u64, member: Member) -> bool {
        let mut members = self.members();
        if self.is_over() {
            return false;
        }
        members.insert(number, member);
        true
    }

    /// Frames of a program to the port, until it closes its end.
    fn read_all(&self, number: u64, mut stream: &Stream) {
        let (mut frames, mut buffer) = (Frames::default(), [0; 4_096]);
        while let Ok(count @ 1..) = stream.read(&mut buffer) {
            if self.was_stopped() {
                self.end();
            }
            if self.is_over() {
                return;
            }
            frames.push(buffer.get(..count).unwrap_or_default(), |frame| {
                if self.is_for_device(number, frame) {
                    // Fails only when the hub ends.
                    let _ = self.to_port.send(Chunk::from(frame));
                }
            });
        }
    }

    /// Takes note of a frame; false if it is for the hub alone.
    fn is_for_device(&self, number: u64, frame: &[u8]) -> bool {
        let mut decoder = Decoder::new();
        for byte in frame {
            if let Some(Ok(body)) = decoder.push(*byte)
                && let Some(note) = Note::of(&body)
            {
                self.note(number, note);
                return false;
            }
        }
        let mut members = self.members();
        if let Some(member) = members.get_mut(&number) {
            for request in requests_in(frame) {
                member.open.requests(&request);
            }
            if member.is_this()
                && let Some(heir) = heir_of(member)
            {
                for (_, other) in members.iter().filter(|(other, _)| **other != number) {
                    other.pass(&heir);
                }
            }
        }
        true
    }

    fn note(&self, number: u64, note: Note) {
        let mut members = self.members();
        match note {
            Note::Hello(program) => {
                if let Some(member) = members.get_mut(&number) {
                    member.introduce(program);
                    let welcome = Note::Welcome.frame();
                    member.pass(&Chunk::from(welcome.unwrap_or_default().as_slice()));
                }
                let mut others = members.iter().filter(|(other, _)| **other != number);
                let own = others.find(|(_, member)| member.is_this());
                if let Some(heir) = own.and_then(|(_, own)| heir_of(own))
                    && let Some(member) = members.get(&number)
                {
                    member.pass(&heir);
                }
            }
            Note::Heir { open, is_armed } => {
                // Of a program that is here nothing is to be ended.
                let lives = (members.values()).any(|m| m.open.session() == open.session());
                drop(members);
                if !lives {
                    self.send_will(open.will(is_armed));
                }
            }
            Note::LeftOpen(open) => {
                if let Some(member) = members.get_mut(&number) {
                    member.open = open;
                }
            }
            Note::Who => {
                let all = members.values().map(|m| Note::Member(m.program()));
                let answer: Vec<u8> = all
                    .chain([Note::End])
                    .filter_map(|note| note.frame())
                    .flatten()
                    .collect();
                if let Some(member) = members.get(&number) {
                    member.pass(&Chunk::from(answer));
                }
            }
            _ => {}
        }
    }

    /// A program has gone.
    fn dismiss(&self, number: u64) {
        let Some(member) = self.members().remove(&number) else {
            return;
        };
        self.send_will(member.open.last_will());
    }

    fn send_will(&self, will: Vec<Frame>) {
        for frame in will {
            // Fails only when the hub ends.
            let _ = self.to_port.send(Chunk::from(frame.as_slice()));
        }
    }
}

/// The note with this program's own subscription and lease, for the others to keep.
fn heir_of(member: &Member) -> Option<Chunk> {
    let heir = Note::Heir {
        open: member.open.clone(),
        is_armed: member.open.is_armed(),
    };
    heir.frame().map(|frame| Chunk::from(frame.as_slice()))
}

/// Chunks to a program, until the hub or the program ends.
fn write_all(mut stream: &Stream, inbox: &Receiver<Chunk>) {
    for chunk in inbox {
        if stream.write_all(&chunk).is_err() {
            return;
        }
    }
    if let Some(frame) = Note::Leaving.frame() {
        // A program that does not hear it has gone.
        let _ = stream.write_all(&frame);
    }
}

#[cfg(test)]
pub(crate) mod tests;
