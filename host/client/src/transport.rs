//! The transport: bytes and clock.

use std::fmt;
use std::time::Duration;

/// A serial port, or a simulated device in this process. Its clock is the
/// device's time: a simulated device may run faster than real time.
pub trait Transport {
    /// Sends all bytes.
    ///
    /// # Errors
    /// [`TransportError::Stalled`] on a timeout: the frame may be truncated,
    /// and the transport sends a delimiter before the next one.
    /// [`TransportError::Lost`] if the connection is lost.
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError>;

    /// Waits at most `patience` for bytes; returns 0 on a timeout. With zero it
    /// does not wait.
    ///
    /// # Errors
    /// [`TransportError::Lost`] if the connection is lost.
    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError>;

    /// Monotonic time since any origin.
    fn now(&self) -> Duration;

    /// Waits, connected or not.
    fn wait(&mut self, time: Duration);

    /// Tries once to reopen a lost connection.
    ///
    /// # Errors
    /// [`TransportError`] if it does not open.
    fn reopen(&mut self) -> Result<(), TransportError>;

    /// Name for people.
    fn name(&self) -> String;
}

/// A process that has a port open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Process id.
    pub pid: u32,
    /// Program name.
    pub program: String,
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`, process {}", self.program, self.pid)
    }
}

/// Errors of a transport.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TransportError {
    /// There is no such port.
    #[error(
        "cannot open {port}: there is no such port; plug the device in, or look for its name with `crepitus devices`"
    )]
    NotFound {
        /// The port.
        port: String,
    },
    /// Another process holds the port.
    #[error("cannot open {port}: {} has it open; end that program first", holder_text(.holder.as_ref()))]
    Busy {
        /// The port.
        port: String,
        /// The process, if it can be determined.
        holder: Option<Holder>,
    },
    /// The process that serves the port to others does not respond.
    #[error(
        "{port}: {} serves it to other programs and does not respond; continue that \
         program (`fg`), or end it; torque ends without it after 250 ms",
        holder_text(.holder.as_ref())
    )]
    Hangs {
        /// The port.
        port: String,
        /// The process, if it can be determined.
        holder: Option<Holder>,
    },
    /// Permission denied.
    #[error(
        "cannot open {port}: permission denied; \
         run `sudo usermod -aG {group} $USER`, then log in again"
    )]
    Denied {
        /// The port.
        port: String,
        /// The group whose members have permission.
        group: String,
    },
    /// A simulated device that another user serves.
    #[error(
        "cannot open {port}: permission denied; a program of another user serves it, and no group gives access: \
         let that user run this command, or serve a device of your own with `crepitus serve-sim`"
    )]
    OthersTerminal {
        /// The port.
        port: String,
    },
    /// Not a serial port.
    #[error("cannot open {port}: it is no serial port; `crepitus devices` lists those of devices")]
    NotSerial {
        /// The port.
        port: String,
    },
    /// Another error of the system.
    #[error("cannot open {port}: {detail}")]
    Open {
        /// The port.
        port: String,
        /// Error of the system.
        detail: String,
    },
    /// Programs cannot meet at the port: the folder of their socket cannot be used.
    #[error("cannot open {port}: it cannot be shared with other programs: {detail}")]
    Unshared {
        /// The port.
        port: String,
        /// Error of the system.
        detail: String,
    },
    /// Timeout of sending.
    #[error(
        "timeout: {port} accepts no bytes for {} ms, the device hangs; unplug it and plug it in again",
        .patience.as_millis()
    )]
    Stalled {
        /// The port.
        port: String,
        /// Time waited.
        patience: Duration,
    },
    /// The device has restarted, or more programs are connected than it can
    /// remember.
    #[error(
        "{port}: the device does not know this session any more: it has restarted, or more than 32 programs are \
         connected to it"
    )]
    Forgotten {
        /// The port.
        port: String,
    },
    /// The connection is lost.
    #[error(
        "connection to {port} lost ({detail}): the device was unplugged, switched off or rebooted"
    )]
    Lost {
        /// The port.
        port: String,
        /// Error of the system.
        detail: String,
    },
}

fn holder_text(holder: Option<&Holder>) -> String {
    holder.map_or_else(|| "another program".to_owned(), Holder::to_string)
}
