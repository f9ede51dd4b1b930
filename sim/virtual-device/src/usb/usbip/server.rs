//! The server: who is connected, who has the device.
//!
//! ```text
//!   accepted ── request ──┬─ list ──── reply, closed
//!                         ├─ import ── reply ── imported ── commands … closed, bus suspended
//!                         └─ refused ─ reply, closed
//! ```
//! One client at a time has the device. While none has, the bus is suspended; each list and each import
//! resets it and reads the descriptors from the device.
//!
//! Nothing here blocks, sleeps or reads a clock: [`Server::frame`] is one millisecond of device
//! time, and timeouts are counted in frames. What clients can make the server hold is bounded.

use super::connection::Connection;
use super::exported::{BUS_ID, Exported};
use super::messages::{
    BUS_ID_LENGTH, Command, DeviceRecord, HEADER_LENGTH, MAX_TRANSFER, MessageError, Operation,
    Refusal, import_reply, list_reply, unlink_reply,
};
use super::urbs::Urbs;
use crate::usb::control::TURNS_PER_FRAME;
use crate::usb::enumeration::EnumerationError;
use crate::usb::wire::UsbWire;
use std::io;
use std::net::{SocketAddr, TcpListener};

/// Clients that may be connected without having the device; more wait to be accepted.
const MOST_GUESTS: usize = 8;

/// Frames that such a client has to send its request and to read the reply: 5 s of device time.
const GUEST_FRAMES: u32 = 5_000;

/// Largest size of a client's request before an import, bytes.
const OPERATION_LIMIT: usize = 8 + BUS_ID_LENGTH;

/// Largest size of one command, bytes.
const COMMAND_LIMIT: usize = HEADER_LENGTH + MAX_TRANSFER;

/// Reason why a connection ended, or a request was refused.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// The client has closed the connection.
    #[error("the client closed the connection")]
    Closed,
    /// The client has closed the connection within a message.
    #[error("the client closed the connection after {bytes} bytes of a message")]
    Truncated {
        /// Bytes of the incomplete message.
        bytes: usize,
    },
    /// The connection failed.
    #[error("the connection failed: {0}")]
    Connection(String),
    /// A message that is not accepted.
    #[error(transparent)]
    Message(#[from] MessageError),
    /// The client sent no request, or did not read its reply.
    #[error("no complete request within {} s", GUEST_FRAMES / 1_000)]
    TimedOut,
    /// Another client has the device.
    #[error("the device is imported by another client already")]
    Busy,
    /// The client asked for a device that is not here.
    #[error("there is no device {bus_id:?}, only {BUS_ID:?}")]
    NoDevice {
        /// The bus id in the request.
        bus_id: String,
    },
    /// The device's descriptors could not be read.
    #[error("the device cannot be enumerated: {0}")]
    Device(#[from] EnumerationError),
    /// The device is no longer connected: its cable is out, or it has restarted.
    #[error("the device disconnected")]
    DeviceDisconnected,
}

impl From<io::Error> for Cause {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind::{BrokenPipe, ConnectionAborted, ConnectionReset};
        match error.kind() {
            // How a client ends that has not read everything.
            BrokenPipe | ConnectionAborted | ConnectionReset => Self::Closed,
            _ => Self::Connection(error.to_string()),
        }
    }
}

/// Event at the server, for a log.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Event {
    /// A client has the device now.
    Imported {
        /// Address of the client.
        client: SocketAddr,
    },
    /// The client no longer has the device.
    Released {
        /// Address of the client.
        client: SocketAddr,
        /// Cause of the release.
        cause: Cause,
    },
    /// A client did not get what it asked for.
    Refused {
        /// Address of the client.
        client: SocketAddr,
        /// Cause of the refusal.
        cause: Cause,
    },
}

/// A client without the device.
#[derive(Debug)]
struct Guest {
    connection: Connection,
    frames_left: u32,
    /// The client has its reply; nothing further is expected of it.
    is_answered: bool,
}

/// The client that has the device.
#[derive(Debug)]
struct Importer {
    connection: Connection,
    device_id: u32,
    urbs: Urbs,
}

/// A USB/IP server for one device.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    guests: Vec<Guest>,
    importer: Option<Importer>,
    events: Vec<Event>,
}

/// Fate of a client without the device.
enum Fate {
    Waits,
    Leaves,
    Imports(Box<Exported>),
    Fails(Cause),
}

impl Server {
    /// The name of the device in requests.
    pub const BUS_ID: &str = BUS_ID;

    /// Listens at this address; port 0 is any free one.
    ///
    /// # Errors
    ///
    /// The address is in use or not this machine's, or the port needs a privilege.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            guests: Vec::new(),
            importer: None,
            events: Vec::new(),
        })
    }

    /// The address with its real port.
    ///
    /// # Errors
    ///
    /// The system's.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// The client that has the device.
    pub fn importer(&self) -> Option<SocketAddr> {
        Some(self.importer.as_ref()?.connection.peer)
    }

    /// One millisecond: clients, transactions and turns of the device; returns what has happened.
    /// `run` lets the device run for one turn of 50 µs.
    ///
    /// A frame in which a client lists or imports the device takes some 15 ms more of device time: a
    /// bus reset, an address and the descriptors.
    pub fn frame<W: UsbWire>(&mut self, wire: &mut W, run: &mut impl FnMut(&mut W)) -> Vec<Event> {
        self.accept();
        self.serve_guests(wire, run);
        if let Some(importer) = &mut self.importer
            && let Err(cause) = importer.take_commands()
        {
            self.release(wire, cause);
        }
        if let Some(importer) = &mut self.importer {
            importer.urbs.start_frame();
        }
        for _ in 0..TURNS_PER_FRAME {
            if let Some(importer) = &mut self.importer
                && importer.connection.has_room()
            {
                importer.urbs.poll(wire);
                importer.send_replies();
            }
            run(wire);
            if self.importer.is_some() && !wire.is_connected() {
                self.release(wire, Cause::DeviceDisconnected);
            }
        }
        if let Some(importer) = &mut self.importer
            && let Err(error) = importer.connection.flush()
        {
            self.release(wire, error.into());
        }
        std::mem::take(&mut self.events)
    }

    fn accept(&mut self) {
        while self.guests.len() < MOST_GUESTS {
            // "Nobody there", and errors of a client that has already gone or of a system without
            // descriptors: the next frame tries again.
            let Ok((stream, peer)) = self.listener.accept() else {
                break;
            };
            match Connection::new(stream, peer) {
                Ok(connection) => self.guests.push(Guest {
                    connection,
                    frames_left: GUEST_FRAMES,
                    is_answered: false,
                }),
                Err(error) => self.refused(peer, error.into()),
            }
        }
    }

    fn serve_guests<W: UsbWire>(&mut self, wire: &mut W, run: &mut impl FnMut(&mut W)) {
        for mut guest in std::mem::take(&mut self.guests) {
            let client = guest.connection.peer;
            match self.serve(&mut guest, wire, run) {
                Ok(Fate::Waits) => self.guests.push(guest),
                Ok(Fate::Leaves) => {}
                Ok(Fate::Imports(exported)) => {
                    self.events.push(Event::Imported { client });
                    self.importer = Some(Importer {
                        connection: guest.connection,
                        device_id: exported.record.device_id(),
                        urbs: Urbs::new(&exported.device),
                    });
                }
                Ok(Fate::Fails(cause)) => {
                    self.refused(client, cause);
                    guest.is_answered = true;
                    self.guests.push(guest);
                }
                Err(cause) => self.refused(client, cause),
            }
        }
    }

    /// Serves a client without the device; an error ends the connection.
    fn serve<W: UsbWire>(
        &self,
        guest: &mut Guest,
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Fate, Cause> {
        guest.frames_left = guest.frames_left.checked_sub(1).ok_or(Cause::TimedOut)?;
        let connection = &mut guest.connection;
        if guest.is_answered {
            let is_all = connection.flush()?;
            return Ok(if is_all { Fate::Leaves } else { Fate::Waits });
        }
        connection.receive(OPERATION_LIMIT)?;
        let Some((operation, length)) = Operation::decode(connection.received())? else {
            return match connection.received().len() {
                _ if !connection.has_ended => Ok(Fate::Waits),
                // Somebody looked whether the port is open.
                0 => Ok(Fate::Leaves),
                bytes => Err(Cause::Truncated { bytes }),
            };
        };
        connection.consume(length);
        let fate = match operation {
            Operation::ListDevices => {
                guest.is_answered = true;
                connection.send(&list_reply(self.list(wire, run).as_ref()));
                Fate::Waits
            }
            Operation::Import { bus_id } => match self.import(&bus_id, wire, run) {
                Ok(exported) => {
                    connection.send(&import_reply(Ok(&exported.record)));
                    Fate::Imports(Box::new(exported))
                }
                Err((refusal, cause)) => {
                    connection.send(&import_reply(Err(refusal)));
                    Fate::Fails(cause)
                }
            },
        };
        connection.flush()?;
        Ok(fate)
    }

    /// The device, if it can be imported.
    fn list<W: UsbWire>(&self, wire: &mut W, run: &mut impl FnMut(&mut W)) -> Option<DeviceRecord> {
        if self.importer.is_some() {
            return None;
        }
        let exported = Exported::read(wire, run);
        wire.suspend();
        Some(exported.ok()?.record)
    }

    fn import<W: UsbWire>(
        &self,
        bus_id: &[u8; BUS_ID_LENGTH],
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Exported, (Refusal, Cause)> {
        let text = bus_id.split(|&byte| byte == 0).next().unwrap_or_default();
        if text != BUS_ID.as_bytes() {
            let bus_id = String::from_utf8_lossy(text).into_owned();
            return Err((Refusal::NoDevice, Cause::NoDevice { bus_id }));
        }
        if self.importer.is_some() {
            return Err((Refusal::Busy, Cause::Busy));
        }
        Exported::read(wire, run).map_err(|error| {
            wire.suspend();
            (Refusal::DeviceError, error.into())
        })
    }

    fn refused(&mut self, client: SocketAddr, cause: Cause) {
        self.events.push(Event::Refused { client, cause });
    }

    /// Ends the import: the connection is closed, the device sees an idle bus.
    fn release<W: UsbWire>(&mut self, wire: &mut W, cause: Cause) {
        wire.suspend();
        if let Some(mut importer) = self.importer.take() {
            // What is ready is still passed on, if the client takes it.
            let _is_all = importer.connection.flush();
            let client = importer.connection.peer;
            self.events.push(Event::Released { client, cause });
        }
    }
}

impl Importer {
    /// Takes the commands that have arrived. A client that does not read its replies has to wait.
    fn take_commands(&mut self) -> Result<(), Cause> {
        if !self.connection.has_room() {
            return Ok(());
        }
        self.connection.receive(COMMAND_LIMIT)?;
        while self.connection.has_room() {
            let decoded = Command::decode(self.connection.received(), self.device_id)?;
            let Some((command, length)) = decoded else {
                let bytes = self.connection.received().len();
                return match bytes {
                    _ if !self.connection.has_ended => Ok(()),
                    0 => Err(Cause::Closed),
                    _ => Err(Cause::Truncated { bytes }),
                };
            };
            self.connection.consume(length);
            match command {
                Command::Submit(submit) => {
                    self.urbs.submit(submit);
                    // One that is refused has its reply at once, which counts as unread.
                    self.send_replies();
                }
                Command::Unlink { sequence, victim } => {
                    let status = self.urbs.unlink(victim);
                    self.connection.send(&unlink_reply(sequence, status));
                }
            }
        }
        Ok(())
    }

    fn send_replies(&mut self) {
        for completion in self.urbs.take_completed() {
            self.connection.send(&completion.encode());
        }
    }
}
