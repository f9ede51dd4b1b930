//! Client of a device of any version: identify, stop, reboot.

use crate::client::Client;
use crate::errors::Error;
use crate::handshake::Handshake;
use crate::session::Options;
use crate::transport::Transport;

/// Client that uses only the management lane, which all versions share.
#[derive(Debug)]
pub struct Management<T>(Client<T>);

impl<T: Transport> Management<T> {
    /// Creates a client on an open transport, without sending anything.
    pub fn new(transport: T) -> Self {
        Self::with(transport, Options::default())
    }

    /// [`Self::new`] with a given session.
    pub fn with(transport: T, options: Options) -> Self {
        Self(Client::unchecked(transport, options))
    }

    /// Reads the identities; waits a little for the drive's after a boot.
    ///
    /// # Errors
    /// [`Error::NoAnswer`], [`Error::Transport`].
    pub fn identify(&mut self) -> Result<Handshake, Error> {
        self.0.identify()
    }

    /// Turns torque off at once, whichever host has armed the device.
    ///
    /// # Errors
    /// [`Error::NoAnswer`], [`Error::Transport`]: the result is unknown. Torque
    /// ends anyway 250 ms after the holder of the lease is silent.
    pub fn stop(&mut self) -> Result<(), Error> {
        self.0.stop()
    }

    /// Reboots the device.
    ///
    /// # Errors
    /// [`Error::NotDone`] while armed; [`Error::NoAnswer`],
    /// [`Error::Transport`].
    pub fn reboot(&mut self) -> Result<(), Error> {
        self.0.reboot()
    }

    /// Upgrades to a full client, if the schema hashes match.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if they differ; [`Error::NoAnswer`],
    /// [`Error::Transport`].
    pub fn into_client(self, handshake: Handshake) -> Result<Client<T>, Error> {
        self.0.checked(handshake)
    }

    /// The transport.
    pub fn transport_mut(&mut self) -> &mut T {
        self.0.transport_mut()
    }
}
