//! A serial port: USB, or a pty of a simulated device.

mod holder;

pub use holder::holder_of;

use crate::transport::{Transport, TransportError};
use crepitus_protocol::frame::DELIMITER;
use serialport::{ErrorKind, SerialPort};
use std::fmt;
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// USB has no baud rate, and a pty neither; a number has to be given.
const BAUD_RATE: u32 = 115_200;

/// Error text of the system for a character device that is no terminal, such as `/dev/null`.
const NO_TERMINAL: &str = "Not a typewriter";

/// Timeout after which a port without progress is stalled.
const SEND_PATIENCE: Duration = Duration::from_millis(250);

/// A serial port, opened exclusively. Its clock is real time.
///
/// A USB port that takes bytes at all takes a whole frame, so sending waits
/// 250 ms at most; on a pty it may wait for the simulator at its other end.
pub struct Serial {
    path: String,
    port: Option<Box<dyn SerialPort>>,
    began: Instant,
    /// The last frame was sent only in part.
    is_torn: bool,
}

impl fmt::Debug for Serial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Serial")
            .field("path", &self.path)
            .field("is_open", &self.port.is_some())
            .finish_non_exhaustive()
    }
}

impl Serial {
    /// Opens a port exclusively.
    ///
    /// # Errors
    /// [`TransportError`]: no such port, held by another program, permission
    /// denied.
    pub fn open(path: &str) -> Result<Self, TransportError> {
        Ok(Self {
            path: path.to_owned(),
            port: Some(open(path)?),
            began: Instant::now(),
            is_torn: false,
        })
    }

    /// Two ends of the same port, for a thread that receives and one that sends.
    ///
    /// # Errors
    /// [`TransportError::Lost`] if the port is gone.
    pub fn split(mut self) -> Result<(Self, Self), TransportError> {
        let port = self.port.as_ref().map(|port| port.try_clone());
        let sender = match port {
            Some(Ok(port)) => Self {
                path: self.path.clone(),
                port: Some(port),
                began: self.began,
                is_torn: self.is_torn,
            },
            Some(Err(error)) => return Err(self.lost(&error.into())),
            None => return Err(self.lost(&closed())),
        };
        Ok((self, sender))
    }

    /// Closes a lost port, so that the system can reuse its name for the device
    /// when it reappears.
    fn lost(&mut self, error: &io::Error) -> TransportError {
        self.port = None;
        TransportError::Lost {
            port: self.path.clone(),
            detail: error.to_string(),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let port = self.port.as_mut().ok_or_else(closed)?;
        port.set_timeout(SEND_PATIENCE)?;
        port.write(bytes)
    }

    fn send_all(&mut self, mut bytes: &[u8]) -> Result<(), TransportError> {
        while !bytes.is_empty() {
            match self.write(bytes) {
                Ok(count) if count > 0 => {
                    self.is_torn = true;
                    bytes = bytes.get(count..).unwrap_or_default();
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    return Err(TransportError::Stalled {
                        port: self.path.clone(),
                        patience: SEND_PATIENCE,
                    });
                }
                Ok(_) => return Err(self.lost(&io::ErrorKind::WriteZero.into())),
                Err(error) => return Err(self.lost(&error)),
            }
        }
        self.is_torn = false;
        Ok(())
    }
}

impl Transport for Serial {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        if self.is_torn {
            self.send_all(&[DELIMITER])?;
        }
        self.send_all(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let end = Instant::now() + patience;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let result = self.port.as_mut().ok_or_else(closed).and_then(|port| {
                port.set_timeout(left)?;
                port.read(buffer)
            });
            match result {
                Ok(0) => return Err(self.lost(&io::ErrorKind::UnexpectedEof.into())),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => return Ok(0),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(self.lost(&error)),
            }
        }
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn wait(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.port = None;
        self.is_torn = false;
        self.port = Some(open(&self.path)?);
        Ok(())
    }

    fn name(&self) -> String {
        self.path.clone()
    }
}

fn closed() -> io::Error {
    io::ErrorKind::NotConnected.into()
}

fn open(path: &str) -> Result<Box<dyn SerialPort>, TransportError> {
    #[cfg(target_os = "linux")]
    let own = pseudo_terminal(path);
    let port = serialport::new(path, BAUD_RATE)
        .timeout(SEND_PATIENCE)
        .open()
        .map_err(|error| why(path, &error))?;
    // The library also locks the port, which ends with this program. The terminal's own exclusive
    // mode would not: after a SIGKILL nobody but root could open it, the simulator included.
    #[cfg(target_os = "linux")]
    if let Some(own) = own {
        let _ = rustix::termios::ioctl_tiocnxcl(own);
    }
    Ok(port)
}

/// A pseudo terminal, once more: opened before it is exclusive.
#[cfg(target_os = "linux")]
fn pseudo_terminal(path: &str) -> Option<std::os::fd::OwnedFd> {
    use rustix::fs::{Mode, OFlags};
    let path = std::fs::canonicalize(path).ok()?;
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let is_one = path.starts_with("/dev/pts");
    is_one.then(|| rustix::fs::open(path, flags, Mode::empty()).ok())?
}

/// Returns whether the system lists a serial port of this name.
fn is_listed(path: &str) -> bool {
    let name = path.trim_start_matches(r"\\.\");
    let ports = serialport::available_ports().unwrap_or_default();
    (ports.iter()).any(|port| port.port_name.eq_ignore_ascii_case(name))
}

/// Converts an error of opening a port.
fn why(path: &str, error: &serialport::Error) -> TransportError {
    let port = path.to_owned();
    match error.kind() {
        ErrorKind::Io(io::ErrorKind::PermissionDenied) if holder::is_pseudo_terminal(path) => {
            TransportError::OthersTerminal { port }
        }
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => TransportError::Denied {
            port,
            group: holder::group_of(path).unwrap_or_else(|| "dialout".to_owned()),
        },
        // On Unix the library reports a locked port like this, on Windows one that is open, too.
        ErrorKind::NoDevice if cfg!(unix) || is_listed(path) => TransportError::Busy {
            port,
            holder: holder::holder_of(path),
        },
        ErrorKind::NoDevice | ErrorKind::Io(io::ErrorKind::NotFound) => {
            TransportError::NotFound { port }
        }
        _ if !holder::is_terminal(path) || error.description == NO_TERMINAL => {
            TransportError::NotSerial { port }
        }
        _ => TransportError::Open {
            port,
            detail: error.to_string(),
        },
    }
}
