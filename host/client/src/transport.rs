//! Where bytes go, and whose time it is.

use std::fmt;
use std::time::Duration;

/// Where bytes go: a serial port, or a simulated device in this process. Its
/// clock is the device's time: a simulated one may run faster than the wall.
pub trait Transport {
    /// Hands all of the bytes over.
    ///
    /// # Errors
    /// [`TransportError::Stalled`] if nothing takes them: what was sent may be
    /// torn, and the transport itself puts a delimiter before what it sends
    /// next. [`TransportError::Lost`] if the line is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError>;

    /// Waits at most `patience` for bytes; 0 bytes: nothing came in time. With
    /// no patience, gives what is there.
    ///
    /// # Errors
    /// [`TransportError::Lost`] if the line is gone.
    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError>;

    /// The time, from any beginning; never goes back.
    fn now(&self) -> Duration;

    /// Lets time go by, line or no line.
    fn wait(&mut self, time: Duration);

    /// After the line was lost: tries, once, to open it again.
    ///
    /// # Errors
    /// Why it does not open.
    fn reopen(&mut self) -> Result<(), TransportError>;

    /// Name for people.
    fn name(&self) -> String;
}

/// A process that has a port open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Number of the process.
    pub pid: u32,
    /// Name of its program.
    pub program: String,
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`, process {}", self.program, self.pid)
    }
}

/// Why bytes do not go to the device or come from it.
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
    /// Another process has the port.
    #[error("cannot open {port}: {} has it open; end that program first", holder_text(.holder.as_ref()))]
    Busy {
        /// The port.
        port: String,
        /// Who, if that can be seen.
        holder: Option<Holder>,
    },
    /// This user may not open the port.
    #[error(
        "cannot open {port}: this user may not; \
         run `sudo usermod -aG {group} $USER`, then log in again"
    )]
    Denied {
        /// The port.
        port: String,
        /// The group whose members may.
        group: String,
    },
    /// It is no serial port.
    #[error("cannot open {port}: it is no serial port; `crepitus devices` lists those of devices")]
    NotSerial {
        /// The port.
        port: String,
    },
    /// It does not open, for another reason.
    #[error("cannot open {port}: {detail}")]
    Open {
        /// The port.
        port: String,
        /// What the system says.
        detail: String,
    },
    /// Nothing takes the bytes.
    #[error(
        "{port} takes no bytes for {} ms: the device hangs; unplug it and plug it in again",
        .patience.as_millis()
    )]
    Stalled {
        /// The port.
        port: String,
        /// How long it was waited for.
        patience: Duration,
    },
    /// The line was there and is gone.
    #[error("{port} is gone ({detail}): the device was unplugged, switched off or started again")]
    Lost {
        /// The port.
        port: String,
        /// What the system says.
        detail: String,
    },
}

fn holder_text(holder: Option<&Holder>) -> String {
    holder.map_or_else(|| "another program".to_owned(), Holder::to_string)
}
