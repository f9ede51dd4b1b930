//! The transport of a program that shares a device.

use crate::discovery::{self, PseudoTerminal, pseudo_terminal};
use crate::sharing::frames::Frames;
use crate::sharing::held::Held;
use crate::sharing::hub::{Hub, STOPPED_MS};
use crate::sharing::left_open::{LeftOpen, requests_in};
use crate::sharing::link::Link;
use crate::sharing::note::{Note, Program};
use crate::sharing::place::Place;
use crate::sharing::socket::connect;
use crate::{Serial, Transport, TransportError};
use crepitus_protocol::host::{Operation, Request};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

/// Time for which programs try to connect to each other: one of them may just be
/// opening or closing the port, which takes seconds on a computer that is busy.
const ATTACH: Duration = Duration::from_secs(10);

/// The longest time that a request may wait for a program to serve it, as in a hub that was stopped.
const STALE: Duration = Duration::from_millis(STOPPED_MS);

/// Interval of the tries.
const TRY_EVERY: Duration = Duration::from_millis(3);

/// Timeout of the hub's answer.
const ANSWER: Duration = Duration::from_millis(500);

/// A device at a serial port, shared with other programs of this user. Its clock
/// is real time.
#[derive(Debug)]
pub struct Shared {
    port: String,
    /// Pseudo-terminal that the port was when it was opened first.
    terminal: Option<PseudoTerminal>,
    program: Program,
    /// Subscription and lease of this program, which it tells the next hub.
    sent: Frames,
    open: LeftOpen,
    link: Option<Link>,
    /// Subscription and lease that a program that served and was killed has left open.
    heir: Option<Note>,
    /// Hub at which this program serves the others.
    hub: Option<Hub>,
    began: Instant,
}

impl Shared {
    /// Connects to the program that has this port open, or else opens it and
    /// serves it to others. `name` tells the others who this is.
    ///
    /// # Errors
    /// [`TransportError`]: no such port, permission denied, or a program that
    /// does not share holds it.
    pub fn open(port: &str, name: &str) -> Result<Self, TransportError> {
        let mut shared = Self {
            port: port.to_owned(),
            terminal: pseudo_terminal(Path::new(port)),
            program: Program::this(name),
            sent: Frames::default(),
            open: LeftOpen::default(),
            link: None,
            heir: None,
            hub: None,
            began: Instant::now(),
        };
        shared.attach()?;
        Ok(shared)
    }

    /// The programs that are connected, this one among them.
    ///
    /// # Errors
    /// [`TransportError::Lost`] if the connection is lost.
    pub fn programs(&mut self) -> Result<Vec<Program>, TransportError> {
        let Some(frame) = Note::Who.frame() else {
            return Ok(Vec::new());
        };
        self.send(&frame)?;
        let mut programs = Vec::new();
        let end = Instant::now() + ANSWER;
        while let Some(link) = &mut self.link {
            match link.note() {
                Some(Note::Member(program)) => programs.push(program),
                Some(Note::Leaving) => {
                    self.attach()?;
                    return self.programs();
                }
                Some(_) => break,
                None => {
                    let left = end.saturating_duration_since(Instant::now());
                    match link.fill(left) {
                        Ok(true) => {}
                        Ok(false) => break,
                        Err(_) => {
                            self.attach()?;
                            return self.programs();
                        }
                    }
                }
            }
        }
        Ok(programs)
    }

    /// The program through which this one is connected, if it does not respond.
    pub fn hanging(&mut self) -> Option<TransportError> {
        let is_hub = self.hub.as_ref().is_some_and(|hub| !hub.is_over());
        if is_hub || !self.programs().is_ok_and(|programs| programs.is_empty()) {
            return None;
        }
        Some(TransportError::Hangs {
            port: self.port.clone(),
            holder: crate::holder_of(&self.port),
        })
    }

    /// Connects to the hub, or becomes it.
    fn attach(&mut self) -> Result<(), TransportError> {
        if let Some(heir) = self.link.take().and_then(Link::into_heir) {
            self.heir = Some(heir);
        }
        if self.hub.as_ref().is_some_and(Hub::is_over) {
            self.hub = None;
        }
        let is_another =
            self.terminal.is_some() && pseudo_terminal(Path::new(&self.port)) != self.terminal;
        if is_another || discovery::is_stale(Path::new(&self.port)) {
            return Err(TransportError::NotFound {
                port: self.port.clone(),
            });
        }
        if let Some(elsewhere) = discovery::leads_elsewhere(Path::new(&self.port)) {
            return Err(TransportError::Open {
                port: self.port.clone(),
                detail: elsewhere.to_string(),
            });
        }
        let place = Place::of(&self.port).map_err(|error| self.cannot_meet(&error))?;
        for other in Place::others(&self.port) {
            if other.socket != place.socket && self.join(&other)? {
                return Ok(());
            }
        }
        let end = Instant::now() + ATTACH;
        loop {
            // First, as a connection that nobody takes may have to be waited for.
            match place.lock() {
                Ok(Some(lock)) => {
                    let ports = Serial::open(&self.port)?.split()?;
                    let held = Held::at(&place, lock).map_err(|error| self.cannot_meet(&error))?;
                    self.hub = Some(Hub::start(ports, held));
                }
                Ok(None) if self.join(&place)? => return Ok(()),
                // Another program is opening the port, or closing it.
                Ok(None) if Instant::now() < end => thread::sleep(TRY_EVERY),
                Ok(None) => {
                    return Err(TransportError::Busy {
                        port: self.port.clone(),
                        holder: None,
                    });
                }
                Err(error) => return Err(self.cannot_meet(&error)),
            }
        }
    }

    /// Connects to the hub at this place; false if there is none.
    fn join(&mut self, place: &Place) -> Result<bool, TransportError> {
        let greeted = match connect(&place.socket) {
            Ok(stream) => self.greet(Link::new(stream)),
            Err(error) if is_timeout(&error) && matches!(place.lock(), Ok(None)) => Err(error),
            // Nobody, or a stranger who has got an old port.
            Err(_) => return Ok(false),
        };
        match greeted {
            Ok(mut link) => {
                if let Some(frame) = self.heir.as_ref().and_then(Note::frame)
                    && link.send(&frame).is_ok()
                {
                    self.heir = None;
                }
                self.link = Some(link);
                Ok(true)
            }
            Err(error) if is_timeout(&error) => Err(TransportError::Hangs {
                port: self.port.clone(),
                holder: crate::holder_of(&self.port),
            }),
            // The hub has just ended.
            Err(_) => Ok(false),
        }
    }

    /// Says hello and waits for the answer: a program that was stopped accepts
    /// connections, and does nothing.
    fn greet(&self, mut link: Link) -> io::Result<Link> {
        let hello = Note::Hello(self.program.clone());
        for note in [Note::LeftOpen(self.open.clone()), hello] {
            link.send(&note.frame().unwrap_or_default())?;
        }
        let end = Instant::now() + ANSWER;
        loop {
            match link.note() {
                Some(Note::Welcome) => return Ok(link),
                Some(Note::Leaving) => return Err(ErrorKind::UnexpectedEof.into()),
                Some(_) => {}
                None => {
                    let left = end.saturating_duration_since(Instant::now());
                    if left.is_zero() || !link.fill(left)? && Instant::now() >= end {
                        return Err(ErrorKind::TimedOut.into());
                    }
                }
            }
        }
    }

    fn cannot_meet(&self, error: &io::Error) -> TransportError {
        TransportError::Unshared {
            port: self.port.clone(),
            detail: error.to_string(),
        }
    }
}

impl Transport for Shared {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        let Self { sent, open, .. } = self;
        sent.push(bytes, |frame| {
            for request in requests_in(frame) {
                open.requests(&request);
            }
        });
        let began = Instant::now();
        for _ in 0..2 {
            let link = self.link.as_mut().ok_or_else(|| lost(&self.port))?;
            let patience = began.elapsed();
            if patience > STALE && requests_in(bytes).iter().any(expires) {
                let port = self.port.clone();
                return Err(TransportError::Stalled { port, patience });
            }
            if link.send(bytes).is_ok() {
                return Ok(());
            }
            // The hub has ended.
            self.attach()?;
        }
        Err(lost(&self.port))
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let end = Instant::now() + patience;
        loop {
            let link = self.link.as_mut().ok_or_else(|| lost(&self.port))?;
            let count = link.take(buffer);
            if count > 0 {
                return Ok(count);
            }
            let is_leaving = match link.note() {
                Some(note) => note == Note::Leaving,
                None => match link.fill(end.saturating_duration_since(Instant::now())) {
                    Ok(true) => false,
                    Ok(false) => return Ok(0),
                    Err(_) => true,
                },
            };
            if is_leaving {
                self.attach()
                    .map_err(|error| not_again(&self.port, &error))?;
            }
        }
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn wait(&mut self, time: Duration) {
        thread::sleep(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.attach()
    }

    fn name(&self) -> String {
        self.port.clone()
    }
}

/// Returns whether a request must not be executed long after it was made: whoever has made it knows
/// no longer of it. What ends torque or a subscription is never too late.
fn expires(request: &Request) -> bool {
    !matches!(
        request.operation,
        Operation::Disarm | Operation::Unsubscribe
    )
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock)
}

fn not_again(port: &str, error: &TransportError) -> TransportError {
    TransportError::Lost {
        port: port.to_owned(),
        detail: format!("the program that had it open has ended, and then: {error}"),
    }
}

fn lost(port: &str) -> TransportError {
    TransportError::Lost {
        port: port.to_owned(),
        detail: "the program that had it open has ended, and it does not open again".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sharing::hub::tests::served_at;
    use crate::sharing::socket::{Listener, arrival};
    use crepitus_protocol::{Lane, Nonce, Session, frame};
    use std::io::Write;

    fn request(operation: Operation) -> frame::Frame {
        let request = Request {
            session: Session(7),
            nonce: Nonce(9),
            number: 1,
            operation,
        };
        frame::encode(Lane::Request, &request).unwrap()
    }

    /// While nobody serves, a person turns away: what they asked for is not carried out when another
    /// program serves at last, but for what ends torque.
    #[test]
    fn a_request_that_waited_for_a_handover_is_not_sent() {
        for (operation, wait_ms, is_sent) in [
            (Operation::Arm, 0, true),
            (Operation::Arm, 800, false),
            (Operation::Disarm, 800, true),
        ] {
            let port = format!("/dev/crepitus-late-{}-{wait_ms}", std::process::id());
            let place = Place::of(&port).unwrap();
            let lock = place.lock().unwrap().unwrap();
            let listener = Listener::at(&place.socket).unwrap();
            let mut shared = thread::scope(|scope| {
                let killed = scope.spawn(|| {
                    let mut stream = arrival(|| listener.accept()).enter().unwrap();
                    stream.write_all(&Note::Welcome.frame().unwrap()).unwrap();
                    stream
                });
                let shared = Shared::open(&port, "a test").unwrap();
                drop(killed.join().unwrap());
                shared
            });
            drop(listener);
            let next_place = place.clone();
            let next = thread::spawn(move || {
                thread::sleep(Duration::from_millis(wait_ms));
                served_at(&next_place, lock)
            });
            let result = shared.send(&request(operation));
            let (hub, sent) = next.join().unwrap();
            thread::sleep(Duration::from_millis(50));
            let found = requests_in(&sent.lock().unwrap());
            assert_eq!(
                found.len(),
                usize::from(is_sent),
                "{operation:?} {wait_ms}: {result:?}"
            );
            let is_stalled = matches!(result, Err(TransportError::Stalled { .. }));
            assert_eq!(is_stalled, !is_sent, "{operation:?} {wait_ms}: {result:?}");
            drop((shared, hub));
            std::fs::remove_file(place.socket.with_extension("lock")).unwrap();
        }
    }

    #[test]
    fn a_program_that_is_slow_to_let_go_of_the_port_is_waited_for() {
        let port = format!("/dev/crepitus-none-{}", std::process::id());
        let place = Place::of(&port).unwrap();
        let lock = place.lock().unwrap();
        let lock = lock.expect("nobody else has this port");
        let slow = Duration::from_millis(1_500);
        let other = thread::spawn(move || {
            thread::sleep(slow);
            drop(lock);
        });
        let began = Instant::now();
        // There is no such port, which is seen once the other program is gone.
        let error = Shared::open(&port, "a test").unwrap_err();
        assert!(matches!(error, TransportError::NotFound { .. }), "{error}");
        assert!(began.elapsed() >= slow);
        other.join().unwrap();
        std::fs::remove_file(place.socket.with_extension("lock")).unwrap();
    }
}
