//! Sockets of the loopback, for a system whose standard library has none of Unix.
//!
//! Any program of the computer can connect to them, so each side proves that it has read the
//! file at the path, which is in a folder of this user alone:
//!
//! ```text
//! file: PORT SECRET ANSWER
//! connecting program ──── SECRET ───> listening program
//!                    <─── ANSWER ────
//! ```

use crepitus_files::input;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A connection, in blocking mode.
pub(crate) type Stream = TcpStream;

/// Timeout of a proof: the other side has nothing else to do.
const PROOF: Duration = Duration::from_millis(500);

/// Timeout of connecting. Windows tries a port that nobody has for two seconds.
const CONNECT: Duration = Duration::from_millis(100);

/// Characters of a proof: 128 random bits.
const PROOF_BYTES: usize = 32;

/// Longest file that is read, bytes.
const MEETING_BYTES: u64 = 4_096;

/// Content of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Meeting {
    port: u16,
    secret: String,
    answer: String,
}

impl Meeting {
    fn draw(port: u16) -> io::Result<Self> {
        Ok(Self {
            port,
            secret: random()?,
            answer: random()?,
        })
    }

    fn read(path: &Path) -> io::Result<Self> {
        let text = input::read_to_string(path, MEETING_BYTES)?;
        let words: Vec<&str> = text.split_whitespace().collect();
        let is_proof = |word: &str| word.len() == PROOF_BYTES;
        match *words.as_slice() {
            [port, secret, answer] if is_proof(secret) && is_proof(answer) => Ok(Self {
                port: port.parse().map_err(|_| ErrorKind::InvalidData)?,
                secret: secret.to_owned(),
                answer: answer.to_owned(),
            }),
            _ => Err(ErrorKind::InvalidData.into()),
        }
    }

    /// The file appears whole or not at all.
    fn write(&self, path: &Path) -> io::Result<()> {
        let new = path.with_extension("new");
        let Self {
            port,
            secret,
            answer,
        } = self;
        fs::write(&new, format!("{port} {secret} {answer}\n"))?;
        fs::rename(&new, path)
    }
}

fn random() -> io::Result<String> {
    let mut bytes = [0; PROOF_BYTES / 2];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    let mut text = String::with_capacity(PROOF_BYTES);
    for byte in bytes {
        // A string takes everything.
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}

/// Listens on the loopback; the file at its path, which it removes in the end, says where.
#[derive(Debug)]
pub(crate) struct Listener {
    socket: TcpListener,
    path: PathBuf,
    meeting: Meeting,
}

impl Listener {
    /// Listens; `path` says where. What an earlier program has left there is replaced: the caller
    /// has the lock.
    ///
    /// # Errors
    /// Of the system: the folder is gone, no port is left.
    pub(crate) fn at(path: &Path) -> io::Result<Self> {
        let socket = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        socket.set_nonblocking(true)?;
        // An empty folder: no file replaces it.
        let _ = fs::remove_dir(path);
        let meeting = Meeting::draw(socket.local_addr()?.port())?;
        meeting.write(path)?;
        Ok(Self {
            socket,
            path: path.to_owned(),
            meeting,
        })
    }

    /// Returns whether the file still leads here.
    pub(crate) fn is_found(&self) -> bool {
        Meeting::read(&self.path).is_ok_and(|found| found == self.meeting)
    }

    /// A program that has connected. It does not wait for one.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`] if there is none; those of the system, as too many open files.
    pub(crate) fn accept(&self) -> io::Result<Arrival> {
        let (stream, _) = self.socket.accept()?;
        // On Windows it is as the listener is.
        stream.set_nonblocking(false)?;
        Ok(Arrival {
            stream,
            meeting: self.meeting.clone(),
        })
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        // What another has put there is not this one's to remove.
        if self.is_found() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A program that has connected, of whatever user.
#[derive(Debug)]
pub(crate) struct Arrival {
    stream: TcpStream,
    meeting: Meeting,
}

impl Arrival {
    /// Lets it in if it knows the secret.
    ///
    /// # Errors
    /// The program does not know the secret, or says nothing.
    pub(crate) fn enter(self) -> io::Result<Stream> {
        let Self {
            mut stream,
            meeting,
        } = self;
        stream.set_nodelay(true)?;
        expect(&mut stream, &meeting.secret)?;
        stream.write_all(meeting.answer.as_bytes())?;
        Ok(stream)
    }
}

/// Connects to the program that listens at `path`.
///
/// # Errors
/// No program does, or another one has got the port since.
pub(crate) fn connect(path: &Path) -> io::Result<Stream> {
    let meeting = Meeting::read(path)?;
    let address = (Ipv4Addr::LOCALHOST, meeting.port).into();
    // A timeout is not that of a program that hangs: nobody is there.
    let mut stream =
        TcpStream::connect_timeout(&address, CONNECT).map_err(|_| ErrorKind::ConnectionRefused)?;
    stream.set_nodelay(true)?;
    stream.write_all(meeting.secret.as_bytes())?;
    expect(&mut stream, &meeting.answer)?;
    Ok(stream)
}

/// Reads a proof.
fn expect(stream: &mut TcpStream, proof: &str) -> io::Result<()> {
    stream.set_read_timeout(Some(PROOF))?;
    let mut read = [0; PROOF_BYTES];
    stream.read_exact(&mut read)?;
    stream.set_read_timeout(None)?;
    if read == proof.as_bytes() {
        Ok(())
    } else {
        Err(ErrorKind::PermissionDenied.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sharing::socket::arrival;
    use std::thread;

    fn listening() -> (tempfile::TempDir, PathBuf, Listener) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knee.socket");
        let listener = Listener::at(&path).unwrap();
        (folder, path, listener)
    }

    #[test]
    fn a_program_that_has_read_the_file_gets_in() {
        let (_folder, path, listener) = listening();
        let inside = thread::spawn(move || {
            let mut stream = arrival(|| listener.accept()).enter().unwrap();
            stream.write_all(b"welcome").unwrap();
            listener
        });
        let mut stream = connect(&path).unwrap();
        let mut read = [0; 7];
        stream.read_exact(&mut read).unwrap();
        assert_eq!(&read, b"welcome");
        drop(inside.join().unwrap());
        assert!(!path.exists());
        assert!(connect(&path).is_err());
    }

    #[test]
    fn a_wrong_secret_or_none_stays_outside() {
        let (_folder, _, listener) = listening();
        let port = listener.meeting.port;
        for said in [&[b'0'; PROOF_BYTES][..], b"", &[b'0'; PROOF_BYTES - 1]] {
            let mut stranger = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
            stranger.write_all(said).unwrap();
            assert!(arrival(|| listener.accept()).enter().is_err(), "{said:?}");
            let mut heard = Vec::new();
            // A reset is as good as an end: it hears nothing.
            let _ = stranger.read_to_end(&mut heard);
            assert!(heard.is_empty());
        }
    }

    #[test]
    fn a_file_that_leads_elsewhere_is_noticed_and_left() {
        let (_folder, path, listener) = listening();
        assert!(listener.is_found());
        let nobody = listener.accept().unwrap_err();
        assert_eq!(nobody.kind(), ErrorKind::WouldBlock);
        fs::remove_file(&path).unwrap();
        assert!(!listener.is_found());
        fs::create_dir(&path).unwrap();
        assert!(!listener.is_found());
        let next = Listener::at(&path).unwrap();
        assert!(next.is_found() && !listener.is_found());
        drop(listener);
        assert!(next.is_found());
    }

    /// The file of a killed program, whose port another one has got.
    #[test]
    fn a_stranger_behind_an_old_file_is_noticed() {
        let (_folder, path, listener) = listening();
        let mut other = listener.meeting.clone();
        other.answer = random().unwrap();
        assert_ne!(other.answer, listener.meeting.answer);
        other.write(&path).unwrap();
        let inside = thread::spawn(move || arrival(|| listener.accept()).enter());
        assert_eq!(
            connect(&path).unwrap_err().kind(),
            ErrorKind::PermissionDenied
        );
        inside.join().unwrap().unwrap();
        let proof = "0".repeat(PROOF_BYTES);
        for port in ["", "1 2", "x", "70000", "-1"] {
            fs::write(&path, format!("{port} {proof} {proof}")).unwrap();
            assert!(Meeting::read(&path).is_err(), "{port}");
        }
        fs::write(&path, format!("1 {proof} {}", &proof[1..])).unwrap();
        assert!(Meeting::read(&path).is_err());
    }
}
