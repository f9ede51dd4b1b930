//! A device, its server, and a tap on the cable between them.

use crate::client::{Client, Record, Reply};
use crate::rig::IDENTITY;
use crepitus_device::usb_port::{HostBytes, UsbPort};
use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::usbip::{Event, Server};
use crepitus_virtual_device::usb::wire::{Handshake, Token, UsbWire};
use std::collections::VecDeque;
use std::thread::sleep;
use std::time::{Duration, Instant};
use usb_device::bus::UsbBusAllocator;

/// The endpoints of the device.
pub(crate) const BULK_OUT: u32 = 1;
pub(crate) const BULK_IN: u32 = 2;
pub(crate) const NOTIFICATIONS: u32 = 1;

/// Longest duration of anything that a computer under load does late.
const PATIENCE: Duration = Duration::from_secs(20);

/// A transaction that the device acknowledged or stalled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Transaction {
    Setup([u8; 8]),
    Out(u8, Vec<u8>),
    In(u8, Vec<u8>),
    Stall(u8),
}

/// The cable, with a record of what passes, and with forged answers.
pub(crate) struct Tap {
    pub(crate) cable: SoftCable,
    pub(crate) seen: Vec<Transaction>,
    /// Answers to IN transactions of the bulk endpoint, instead of the device's.
    pub(crate) forged: VecDeque<Handshake>,
    /// IN transactions of the notifications' endpoint, answered or not.
    pub(crate) notifications: usize,
    pub(crate) resets: usize,
    pub(crate) is_suspended: bool,
}

impl UsbWire for Tap {
    fn bus_reset(&mut self) {
        self.resets += 1;
        self.is_suspended = false;
        self.cable.bus_reset();
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        assert!(!self.is_suspended, "a transaction on an idle bus");
        let answer = self.cable.setup_transaction(token, request);
        if matches!(answer, Handshake::Ack(_)) {
            self.seen.push(Transaction::Setup(request));
        }
        answer
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        assert!(!self.is_suspended, "a transaction on an idle bus");
        let answer = self.cable.out_transaction(token, data);
        match answer {
            Handshake::Ack(_) => self
                .seen
                .push(Transaction::Out(token.endpoint, data.to_vec())),
            Handshake::Stall => self.seen.push(Transaction::Stall(token.endpoint)),
            _ => {}
        }
        answer
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        assert!(!self.is_suspended, "a transaction on an idle bus");
        self.notifications += usize::from(u32::from(token.endpoint) == NOTIFICATIONS);
        let is_bulk = u32::from(token.endpoint) == BULK_IN;
        let forged = is_bulk.then(|| self.forged.pop_front()).flatten();
        let answer = forged.unwrap_or_else(|| self.cable.in_transaction(token));
        match answer {
            Handshake::Ack(packet) => self
                .seen
                .push(Transaction::In(token.endpoint, packet.to_vec())),
            Handshake::Stall => self.seen.push(Transaction::Stall(token.endpoint)),
            _ => {}
        }
        answer
    }

    fn suspend(&mut self) {
        self.is_suspended = true;
        self.cable.suspend();
    }

    fn is_connected(&self) -> bool {
        self.cable.is_connected()
    }
}

/// A device with its server.
pub(crate) struct Bench<'b, E> {
    pub(crate) server: Server,
    pub(crate) tap: Tap,
    pub(crate) port: UsbPort<'b, SoftBus>,
    pub(crate) end: E,
    pub(crate) events: Vec<Event>,
    pub(crate) turns: u64,
}

/// Runs a test with a device that has this end.
pub(crate) fn with_bench<E: HostBytes>(end: E, test: impl FnOnce(&mut Bench<'_, E>)) {
    let (bus, cable) = SoftBus::new();
    let allocator = UsbBusAllocator::new(bus);
    let port = UsbPort::new(&allocator, &IDENTITY).expect("the identity is valid");
    let address = "127.0.0.1:0".parse().expect("an address");
    test(&mut Bench {
        server: Server::bind(address).expect("a free port"),
        tap: Tap {
            cable,
            seen: Vec::new(),
            forged: VecDeque::new(),
            notifications: 0,
            resets: 0,
            is_suspended: false,
        },
        port,
        end,
        events: Vec::new(),
        turns: 0,
    });
}

impl<E: HostBytes> Bench<'_, E> {
    pub(crate) fn connect(&self) -> Client {
        Client::connect(self.server.local_address().expect("it listens"))
    }

    /// One millisecond, without any client.
    pub(crate) fn frame(&mut self) {
        let Self {
            port, end, turns, ..
        } = self;
        let mut run = |_: &mut Tap| {
            *turns += 1;
            port.poll(end);
        };
        let events = self.server.frame(&mut self.tap, &mut run);
        self.events.extend(events);
    }

    pub(crate) fn frames(&mut self, count: usize) {
        for _ in 0..count {
            self.frame();
        }
    }

    /// Time in which the device does nothing: its program hangs.
    pub(crate) fn hang(&mut self, frames: usize) {
        for _ in 0..frames {
            let events = self.server.frame(&mut self.tap, &mut |_| ());
            self.events.extend(events);
        }
    }

    /// Time in which the device does nothing, until the client has this many bytes.
    pub(crate) fn hang_until(&mut self, client: &mut Client, count: usize) {
        let begun = Instant::now();
        while client.unread().len() < count {
            assert!(begun.elapsed() < PATIENCE, "no answer");
            self.hang(1);
            client.exchange();
        }
    }

    /// Lets time pass until there is a value. Frames are quick: the system may deliver what the other end
    /// did some of them later, so a pause comes after many.
    pub(crate) fn wait<T>(&mut self, mut what: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begun = Instant::now();
        for round in 0.. {
            if let Some(value) = what(self) {
                return value;
            }
            if round > 100 {
                sleep(Duration::from_micros(100));
            }
            assert!(begun.elapsed() < PATIENCE, "nothing happens");
            self.frame();
        }
        unreachable!("it counts for ever")
    }

    /// Lets time pass until the client has what it waits for.
    pub(crate) fn until<T>(
        &mut self,
        client: &mut Client,
        mut what: impl FnMut(&mut Client) -> Option<T>,
    ) -> T {
        self.wait(|_| {
            client.exchange();
            let value = what(client);
            assert!(
                value.is_some() || !client.is_closed,
                "the server closed the connection"
            );
            value
        })
    }

    /// Lets time pass until so much has happened in all.
    pub(crate) fn until_events(&mut self, count: usize) {
        self.wait(|bench| (bench.events.len() >= count).then_some(()));
    }

    /// The client goes, and the server notices.
    pub(crate) fn leave(&mut self, client: Client) {
        let count = self.events.len();
        drop(client);
        self.until_events(count + 1);
    }

    pub(crate) fn reply(&mut self, client: &mut Client) -> Reply {
        self.until(client, Client::reply)
    }

    /// Asserts that there is no reply for some frames.
    pub(crate) fn silence(&mut self, client: &mut Client, frames: usize) {
        for _ in 0..frames {
            client.exchange();
            self.frame();
        }
        client.exchange();
        assert_eq!(client.reply(), None);
        assert!(!client.is_closed);
    }

    /// Lets time pass until the server has closed the connection.
    pub(crate) fn until_closed(&mut self, client: &mut Client) {
        self.wait(|_| {
            client.exchange();
            client.is_closed.then_some(())
        });
    }

    /// A client that has the device.
    pub(crate) fn import(&mut self) -> (Client, Record) {
        let mut client = self.connect();
        client.request_import("1-1");
        let record = self.until(&mut client, Client::imported);
        (client, record.expect("it is free"))
    }

    /// A control transfer and its reply.
    pub(crate) fn control(&mut self, client: &mut Client, setup: [u8; 8], data: &[u8]) -> Reply {
        let sequence = client.submit_control(setup, data);
        let reply = self.reply(client);
        assert_eq!((reply.command, reply.sequence), (3, sequence));
        reply
    }

    /// A client that has the device, configured.
    pub(crate) fn configured(&mut self) -> Client {
        let (mut client, _) = self.import();
        let set_configuration = crate::client::setup(0x00, 9, 1, 0, 0);
        let reply = self.control(&mut client, set_configuration, &[]);
        assert_eq!(reply.status, 0);
        self.tap.seen.clear();
        client
    }

    /// Text of the last event.
    pub(crate) fn last_event(&self) -> String {
        match self.events.last() {
            Some(Event::Refused { cause, .. }) => format!("refused: {cause}"),
            Some(Event::Released { cause, .. }) => format!("released: {cause}"),
            other => format!("{other:?}"),
        }
    }
}
