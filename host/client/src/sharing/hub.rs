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
pub(crate) mod tests {
    use super::*;
    use crate::sharing::link::Link;
    use crate::sharing::note::Program;
    use crate::sharing::place::Place;
    use crate::sharing::socket::connect;
    use crepitus_protocol::host::{Operation, Request};
    use crepitus_protocol::{Lane, Nonce, Session, frame};
    use std::fs;
    use std::path::{Path, PathBuf};
    use std::sync::mpsc::channel;

    /// A port that keeps the threads for a while, as a signal would.
    struct Pausing {
        pause: Duration,
        send_pause: Duration,
        sent: Arc<Mutex<Vec<u8>>>,
    }

    impl Transport for Pausing {
        fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
            self.sent.lock().unwrap().extend(bytes);
            thread::sleep(self.send_pause);
            Ok(())
        }

        fn receive(&mut self, _: &mut [u8], _: Duration) -> Result<usize, TransportError> {
            thread::sleep(self.pause);
            Ok(0)
        }

        fn now(&self) -> Duration {
            Duration::ZERO
        }

        fn wait(&mut self, _: Duration) {}

        fn reopen(&mut self) -> Result<(), TransportError> {
            Ok(())
        }

        fn name(&self) -> String {
            "port".to_owned()
        }
    }

    /// A hub with a port of that pause, and what it sends there.
    fn served(pause_ms: u64) -> (tempfile::TempDir, Hub, Arc<Mutex<Vec<u8>>>) {
        sending(pause_ms, 0)
    }

    fn sending(pause_ms: u64, send_ms: u64) -> (tempfile::TempDir, Hub, Arc<Mutex<Vec<u8>>>) {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::in_folder(folder.path(), "knee");
        let (hub, sent) = start(&place, place.lock().unwrap().unwrap(), [pause_ms, send_ms]);
        (folder, hub, sent)
    }

    /// A hub at this place, and what it sends to its port.
    pub(crate) fn served_at(place: &Place, lock: File) -> (Hub, Arc<Mutex<Vec<u8>>>) {
        start(place, lock, [1, 0])
    }

    fn start(
        place: &Place,
        lock: File,
        [pause, send_pause]: [u64; 2],
    ) -> (Hub, Arc<Mutex<Vec<u8>>>) {
        let held = Held::at(place, lock).unwrap();
        let sent = Arc::new(Mutex::new(Vec::new()));
        let port = || Pausing {
            pause: Duration::from_millis(pause),
            send_pause: Duration::from_millis(send_pause),
            sent: sent.clone(),
        };
        let hub = Hub::start((port(), port()), held);
        (hub, sent)
    }

    fn socket_in(folder: &tempfile::TempDir) -> PathBuf {
        Place::in_folder(folder.path(), "knee").socket
    }

    /// Returns whether a program that connects is greeted.
    fn is_welcome(socket: &Path) -> bool {
        let Ok(mut link) = connect(socket).map(Link::new) else {
            return false;
        };
        let hello = Note::Hello(Program::this("other")).frame().unwrap();
        if link.send(&hello).is_err() {
            return false;
        }
        while link.fill(Duration::from_secs(1)).unwrap_or(false) {
            if link.note() == Some(Note::Welcome) {
                return true;
            }
        }
        false
    }

    /// Removal of the socket, as when the system removes the folder of a user who logs out.
    #[test]
    fn a_hub_whose_socket_was_removed_or_replaced_is_found_again_and_ends() {
        let (folder, hub, _) = served(1);
        let socket = socket_in(&folder);
        for by in ["nothing", "a file", "a folder"] {
            assert!(is_welcome(&socket));
            let replace = || match by {
                "a file" => File::create_new(&socket).map(drop),
                "a folder" => fs::create_dir(&socket),
                _ => Ok(()),
            };
            fs::remove_file(&socket).unwrap();
            // The hub may be quicker.
            while replace().is_err() {
                let _ = fs::remove_file(&socket);
            }
            let deadline = Instant::now() + Duration::from_secs(5);
            while !is_welcome(&socket) {
                assert!(Instant::now() < deadline, "replaced by {by}");
                thread::sleep(Duration::from_millis(5));
            }
        }
        // A folder that is not empty stays.
        let full = folder.path().join("full");
        fs::create_dir_all(full.join("inside")).unwrap();
        while fs::rename(&full, &socket).is_err() {
            let _ = fs::remove_file(&socket);
        }
        let (ended, has_ended) = channel();
        thread::spawn(move || {
            drop(hub);
            ended.send(()).unwrap();
        });
        has_ended.recv_timeout(Duration::from_secs(5)).unwrap();
        assert!(socket.join("inside").is_dir());
    }

    /// Frames that have waited for a program that was stopped are not sent when it goes on: a request to
    /// arm would arm a device of which nobody thinks any more.
    #[test]
    fn what_has_waited_for_a_program_that_was_stopped_is_not_sent() {
        const FRAME: &[u8] = b"\x03ab\0";
        for (pause_ms, is_sent) in [(10, true), (900, false)] {
            let (folder, hub, sent) = served(pause_ms);
            let mut stream = &connect(&socket_in(&folder)).unwrap();
            thread::sleep(Duration::from_millis(600));
            stream.write_all(FRAME).unwrap();
            thread::sleep(Duration::from_millis(600));
            assert_eq!(hub.is_over(), !is_sent, "{pause_ms} ms");
            let sent = sent.lock().unwrap().clone();
            assert_eq!(sent.ends_with(FRAME), is_sent, "{pause_ms} ms: {sent:?}");
        }
    }

    /// Frames that the hub had taken before it was stopped are not sent when it goes on.
    #[test]
    fn what_has_waited_in_the_queue_of_a_program_that_was_stopped_is_not_sent() {
        const FRAME: &[u8] = b"\x03ab\0";
        for (pause_ms, is_sent) in [(10, true), (1_500, false)] {
            // The first bytes of the hub take the thread that sends for 600 ms.
            let (folder, hub, sent) = sending(pause_ms, 600);
            let mut stream = &connect(&socket_in(&folder)).unwrap();
            stream.write_all(FRAME).unwrap();
            thread::sleep(Duration::from_secs(1));
            assert_eq!(hub.is_over(), !is_sent, "{pause_ms} ms");
            let sent = sent.lock().unwrap().clone();
            assert_eq!(sent.ends_with(FRAME), is_sent, "{pause_ms} ms: {sent:?}");
        }
    }

    /// The program that served was killed: another one, to which it had said what it leaves open,
    /// gives that to the next hub, which ends it.
    #[test]
    fn what_a_killed_hub_has_left_open_is_ended_by_the_next() {
        let request = |number, operation| Request {
            session: Session(7),
            nonce: Nonce(9),
            number,
            operation,
        };
        let (folder, hub, sent_before) = served(1);
        let join = |program: Program| {
            let mut link = Link::new(connect(&socket_in(&folder)).unwrap());
            link.send(&Note::Hello(program).frame().unwrap()).unwrap();
            while link.note() != Some(Note::Welcome) {
                link.fill(Duration::from_secs(5)).unwrap();
            }
            link
        };
        // This process is the one that serves; the other is a stranger.
        let mut own = join(Program::this("serves"));
        let mut other = join(Program {
            pid: 0,
            ..Program::this("other")
        });
        for (number, operation) in [(1, Operation::Subscribe), (2, Operation::Arm)] {
            let frame = frame::encode(Lane::Request, &request(number, operation)).unwrap();
            own.send(&frame).unwrap();
        }
        // In order: this comes behind the note about both.
        let deadline = Instant::now() + Duration::from_secs(5);
        let armed = |link: &Link| matches!(link.heir(), Some(Note::Heir { is_armed: true, .. }));
        while !armed(&other) && Instant::now() < deadline {
            other.fill(Duration::from_millis(20)).unwrap();
        }
        let heir = other.heir().unwrap().frame().unwrap();
        // The program that serves lives: nothing is ended.
        other.send(&heir).unwrap();
        thread::sleep(Duration::from_millis(100));
        assert_eq!(requests_in(&sent_before.lock().unwrap()).len(), 2);
        drop(hub);
        let (folder, _hub, sent) = served(1);
        let mut stream = &connect(&socket_in(&folder)).unwrap();
        stream.write_all(&heir).unwrap();
        while sent.lock().unwrap().len() < 20 && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(5));
        }
        thread::sleep(Duration::from_millis(50));
        let found = requests_in(&sent.lock().unwrap());
        let expected = [
            request(3, Operation::Disarm),
            request(4, Operation::Unsubscribe),
        ];
        assert_eq!(found, expected);
    }
}
