//! A pseudo-terminal: the simulated device as a serial port for any program.
//!
//! ```text
//!   program ── /dev/pts/N ══ master (here) ── CdcHost ── bus ── device
//! ```
//! Both directions are bounded and nothing blocks. Unread data fills the pty's buffer, then the
//! host's queue, then the device's, which drops and counts. While no program has the port open,
//! the host fetches nothing at all, as with a real port.
//!
//! A pty is not quite a serial port: line coding, DTR and RTS that a program sets do not reach the
//! device.

use std::ffi::OsString;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::{Errno, FdFlags, fcntl_setfd};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use crate::usb::host::CdcHost;

/// Folder of the ends that programs open.
const DIRECTORY: &str = "/dev/pts";
/// The most bytes that one exchange moves from the program.
const CHUNK: usize = 4_096;

/// A pty whose other end a program opens as a serial port.
#[derive(Debug)]
pub struct Pty {
    master: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    was_open: bool,
}

impl Pty {
    /// Makes a pty in raw mode, and a symbolic link to it if a name is wanted.
    ///
    /// A link that points into `/dev/pts` is replaced: it is what an earlier simulator left.
    ///
    /// # Errors
    ///
    /// The system has no ptys left; or something else is at the link's place
    /// ([`io::ErrorKind::AlreadyExists`]), or the link cannot be made there.
    pub fn new(link: Option<&Path>) -> io::Result<Self> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        // At once, where the system can: another thread may be starting a program.
        #[cfg(target_os = "linux")]
        let flags = flags | OpenptFlags::CLOEXEC;
        let master = openpt(flags)?;
        fcntl_setfd(&master, FdFlags::CLOEXEC)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        fcntl_setfl(&master, OFlags::RDWR | OFlags::NONBLOCK)?;
        let name = ptsname(&master, Vec::new())?;
        let mut pty = Self {
            master,
            path: PathBuf::from(OsString::from_vec(name.into_bytes())),
            link: None,
            was_open: false,
        };
        // A new pty reports that no program has it open only after one has closed it.
        pty.clean()?;
        if let Some(link) = link {
            make_link(&pty.path, link)?;
            pty.link = Some(link.to_owned());
        }
        Ok(pty)
    }

    /// The path for a program: the link if there is one.
    pub fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// Returns whether a program has the port open.
    pub fn is_open(&self) -> io::Result<bool> {
        let mut fds = [PollFd::new(&self.master, PollFlags::empty())];
        let at_once = Timespec {
            tv_sec: 0,
            tv_nsec: 0,
        };
        poll(&mut fds, Some(&at_once))?;
        let [master] = fds;
        Ok(!master.revents().contains(PollFlags::HUP))
    }

    /// Moves bytes between the program and the host's queues, as far as there is room.
    ///
    /// Tells the host whether the port is open. What a program wrote before it closed the port is
    /// still delivered; what it did not read is discarded.
    ///
    /// # Errors
    ///
    /// The system's, other than "not now" and "nobody there".
    pub fn exchange(&mut self, host: &mut CdcHost) -> io::Result<()> {
        self.fetch_from_program(host)?;
        let is_open = self.is_open()?;
        if self.was_open && !is_open {
            self.clean()?;
        }
        self.was_open = is_open;
        host.set_open(is_open);
        self.pass_to_program(host)
    }

    fn fetch_from_program(&self, host: &mut CdcHost) -> io::Result<()> {
        let mut bytes = [0; CHUNK];
        let room = host.room().min(CHUNK);
        if room == 0 {
            return Ok(());
        }
        let count = idle_as_zero(rustix::io::read(&self.master, &mut bytes[..room]))?;
        host.queue(&bytes[..count]);
        Ok(())
    }

    fn pass_to_program(&self, host: &mut CdcHost) -> io::Result<()> {
        // The queue offers its content in two contiguous runs.
        for _ in 0..2 {
            if host.received().is_empty() {
                break;
            }
            let count = idle_as_zero(rustix::io::write(&self.master, host.received()))?;
            host.consume(count);
        }
        Ok(())
    }

    /// Raw mode, whatever the last program set, and nothing left to read from before.
    fn clean(&self) -> io::Result<()> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let slave = open(&self.path, flags, Mode::empty())?;
        let mut settings = tcgetattr(&slave)?;
        settings.make_raw();
        tcsetattr(&slave, OptionalActions::Now, &settings)?;
        tcflush(&slave, QueueSelector::IFlush)?;
        Ok(())
    }
}

/// The master's descriptor, for a caller that waits for several things at once.
impl AsFd for Pty {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.master.as_fd()
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && std::fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            // A link that stays behind is replaced by the next simulator.
            let _removed = std::fs::remove_file(link);
        }
    }
}

/// "Not now", an interruption, and "nobody has it open" (`EIO` on Linux) are no bytes.
fn idle_as_zero(result: rustix::io::Result<usize>) -> io::Result<usize> {
    match result {
        Ok(count) => Ok(count),
        Err(Errno::AGAIN | Errno::INTR | Errno::IO) => Ok(0),
        Err(error) => Err(error.into()),
    }
}

fn make_link(path: &Path, link: &Path) -> io::Result<()> {
    if std::fs::read_link(link).is_ok_and(|target| target.starts_with(DIRECTORY)) {
        std::fs::remove_file(link)?;
    }
    symlink(path, link)
}
