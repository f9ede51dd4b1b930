//! A device of any version: who is there, stop, reboot.

use crate::client::Client;
use crate::errors::Error;
use crate::handshake::Handshake;
use crate::session::Options;
use crate::transport::Transport;

/// Speaks the lane that never changes, and nothing else: it works with a
/// device of any version.
#[derive(Debug)]
pub struct Management<T>(Client<T>);

impl<T: Transport> Management<T> {
    /// On a line that is open. Nothing is asked yet.
    pub fn new(transport: T) -> Self {
        Self::with(transport, Options::default())
    }

    /// The same, with a session of one's own.
    pub fn with(transport: T, options: Options) -> Self {
        Self(Client::unchecked(transport, options))
    }

    /// Who is there. A device that has just started is given some time to
    /// hear its drive.
    ///
    /// # Errors
    /// [`Error::NoAnswer`], [`Error::Transport`].
    pub fn identify(&mut self) -> Result<Handshake, Error> {
        self.0.identify()
    }

    /// No more torque, at once and whoever is speaking with the device.
    ///
    /// # Errors
    /// [`Error::NoAnswer`], [`Error::Transport`]: whether it was heard is not
    /// known. The lease ends all torque within 250 ms of its holder's silence.
    pub fn stop(&mut self) -> Result<(), Error> {
        self.0.stop()
    }

    /// Starts the device anew.
    ///
    /// # Errors
    /// [`Error::NotDone`] while there is torque; [`Error::NoAnswer`],
    /// [`Error::Transport`].
    pub fn reboot(&mut self) -> Result<(), Error> {
        self.0.reboot()
    }

    /// All that a device of this side's language can.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if comms speaks another one; [`Error::NoAnswer`],
    /// [`Error::Transport`].
    pub fn into_client(self, handshake: Handshake) -> Result<Client<T>, Error> {
        self.0.checked(handshake)
    }

    /// Gives the transport back.
    pub fn into_transport(self) -> T {
        self.0.into_transport()
    }
}
