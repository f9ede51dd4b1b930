//! Hubs whose socket is removed, which are stopped and go on, or which are killed.

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

fn start(place: &Place, lock: File, [pause, send_pause]: [u64; 2]) -> (Hub, Arc<Mutex<Vec<u8>>>) {
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
