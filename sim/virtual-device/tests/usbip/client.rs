//! A small USB/IP client for tests, which shares nothing with the server: its own encoding, from the
//! protocol's description. It does not block; its owner decides when bytes move.

use std::collections::BTreeSet;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};

/// Bytes that went one way, for a capture.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    pub(crate) is_to_server: bool,
    pub(crate) bytes: Vec<u8>,
}

/// An answer to a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Reply {
    pub(crate) command: u32,
    pub(crate) sequence: u32,
    pub(crate) status: i32,
    pub(crate) actual: u32,
    pub(crate) packets: u32,
    pub(crate) data: Vec<u8>,
}

/// A device as the server describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Record {
    pub(crate) bus_id: String,
    pub(crate) bus: u32,
    pub(crate) number: u32,
    pub(crate) speed: u32,
    pub(crate) vendor: u16,
    pub(crate) product: u16,
    pub(crate) class: [u8; 3],
    /// Configuration in force, configurations, interfaces.
    pub(crate) counts: [u8; 3],
}

/// A client.
pub(crate) struct Client {
    stream: TcpStream,
    outgoing: Vec<u8>,
    incoming: Vec<u8>,
    pub(crate) is_closed: bool,
    pub(crate) device: u32,
    sequence: u32,
    /// The number of packets in transfers to the device: 0, as Linux sends it, or −1, as the protocol's
    /// description has it. Wireshark 4.0 takes −1 for a number.
    pub(crate) packets_out: u32,
    /// Transfers from the device that have not ended.
    reading: BTreeSet<u32>,
    pub(crate) chunks: Vec<Chunk>,
}

pub(crate) fn setup(kind: u8, request: u8, value: u16, index: u16, length: u16) -> [u8; 8] {
    let mut bytes = [kind, request, 0, 0, 0, 0, 0, 0];
    for (at, word) in [(2, value), (4, index), (6, length)] {
        bytes[at..at + 2].copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

impl Client {
    pub(crate) fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).expect("the server listens");
        stream.set_nonblocking(true).expect("a socket");
        stream.set_nodelay(true).expect("a socket");
        Self {
            stream,
            outgoing: Vec::new(),
            incoming: Vec::new(),
            is_closed: false,
            device: 0,
            sequence: 0,
            packets_out: 0,
            reading: BTreeSet::new(),
            chunks: Vec::new(),
        }
    }

    /// Moves what can be moved.
    pub(crate) fn exchange(&mut self) {
        self.write();
        let mut bytes = [0; 4_096];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => self.is_closed = true,
                Ok(count) => {
                    self.chunks.push(Chunk {
                        is_to_server: false,
                        bytes: bytes[..count].to_vec(),
                    });
                    self.incoming.extend(&bytes[..count]);
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(_) => self.is_closed = true,
            }
            break;
        }
    }

    /// Moves what the server takes, without reading.
    pub(crate) fn write(&mut self) {
        while !self.outgoing.is_empty() {
            match self.stream.write(&self.outgoing) {
                Ok(count) => {
                    let bytes = self.outgoing.drain(..count).collect();
                    self.chunks.push(Chunk {
                        is_to_server: true,
                        bytes,
                    });
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(_) => {
                    self.is_closed = true;
                    return;
                }
            }
        }
    }

    pub(crate) fn unsent(&self) -> usize {
        self.outgoing.len()
    }

    pub(crate) fn unread(&self) -> &[u8] {
        &self.incoming
    }

    /// Any bytes, valid or not.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.outgoing.extend(bytes);
    }

    /// Ends the sending half of the connection.
    pub(crate) fn end(&mut self) {
        self.write();
        let _ = self.stream.shutdown(std::net::Shutdown::Write);
    }

    pub(crate) fn request_list(&mut self) {
        self.send(&[0x01, 0x11, 0x80, 0x05, 0, 0, 0, 0]);
    }

    pub(crate) fn request_import(&mut self, bus_id: &str) {
        self.send(&[0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0]);
        let mut name = [0; 32];
        name[..bus_id.len()].copy_from_slice(bus_id.as_bytes());
        self.send(&name);
    }

    fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        (self.incoming.len() >= count).then(|| self.incoming.drain(..count).collect())
    }

    fn record(bytes: &[u8]) -> Record {
        let half = |at: usize| u16::from_be_bytes([bytes[at], bytes[at + 1]]);
        let name = bytes[256..288].split(|&byte| byte == 0).next();
        Record {
            bus_id: String::from_utf8(name.expect("a part").to_vec()).expect("text"),
            bus: word(bytes, 288),
            number: word(bytes, 292),
            speed: word(bytes, 296),
            vendor: half(300),
            product: half(302),
            class: [bytes[306], bytes[307], bytes[308]],
            counts: [bytes[309], bytes[310], bytes[311]],
        }
    }

    /// The reply to a list, once it is there: the devices with their interfaces.
    pub(crate) fn list(&mut self) -> Option<Vec<(Record, Vec<[u8; 4]>)>> {
        let head = self.incoming.get(..12)?;
        assert_eq!(head[..8], [0x01, 0x11, 0, 5, 0, 0, 0, 0]);
        let mut at = 12;
        let mut devices = Vec::new();
        for _ in 0..word(head, 8) {
            let record = Self::record(self.incoming.get(at..at + 312)?);
            at += 312;
            let mut interfaces = Vec::new();
            for _ in 0..record.counts[2] {
                let bytes = self.incoming.get(at..at + 4)?;
                interfaces.push(bytes.try_into().expect("four bytes"));
                at += 4;
            }
            devices.push((record, interfaces));
        }
        self.incoming.drain(..at);
        Some(devices)
    }

    /// The reply to an import, once it is there; or its status.
    pub(crate) fn imported(&mut self) -> Option<Result<Record, u32>> {
        let head = self.incoming.get(..8)?;
        assert_eq!(head[..4], [0x01, 0x11, 0, 3]);
        match word(head, 4) {
            0 => {
                let bytes = self.take(8 + 312)?;
                let record = Self::record(&bytes[8..]);
                self.device = record.bus << 16 | record.number;
                Some(Ok(record))
            }
            status => {
                self.take(8)?;
                Some(Err(status))
            }
        }
    }

    /// A command with the next number: five words of its own, a SETUP packet, data.
    fn command(
        &mut self,
        code: u32,
        [direction, endpoint]: [u32; 2],
        words: [u32; 5],
        setup: [u8; 8],
        data: &[u8],
    ) -> u32 {
        self.sequence += 1;
        let head = [code, self.sequence, self.device, direction, endpoint];
        for word in head.into_iter().chain(words) {
            self.send(&word.to_be_bytes());
        }
        self.send(&setup);
        self.send(data);
        self.sequence
    }

    /// A transfer from the device; returns its number.
    pub(crate) fn submit_in(&mut self, endpoint: u32, length: u32, flags: u32) -> u32 {
        let words = [flags, length, 0, 0, 0];
        let sequence = self.command(1, [1, endpoint], words, [0; 8], &[]);
        self.reading.insert(sequence);
        sequence
    }

    /// A transfer to the device; returns its number.
    pub(crate) fn submit_out(&mut self, endpoint: u32, data: &[u8], flags: u32) -> u32 {
        let length = u32::try_from(data.len()).expect("a small number");
        let words = [flags, length, 0, self.packets_out, 0];
        self.command(1, [0, endpoint], words, [0; 8], data)
    }

    /// A control transfer, in the direction of its SETUP packet; returns its number.
    pub(crate) fn submit_control(&mut self, setup: [u8; 8], data: &[u8]) -> u32 {
        let is_in = setup[0] & 0x80 != 0;
        let length = u32::from(u16::from_le_bytes([setup[6], setup[7]]));
        let words = [0, length, 0, 0, 0];
        let sequence = self.command(1, [is_in.into(), 0], words, setup, data);
        if is_in {
            self.reading.insert(sequence);
        }
        sequence
    }

    /// Withdraws a transfer; returns the number of the command.
    pub(crate) fn unlink(&mut self, victim: u32) -> u32 {
        self.command(2, [0, 0], [victim, 0, 0, 0, 0], [0; 8], &[])
    }

    /// The next reply, once it is there.
    pub(crate) fn reply(&mut self) -> Option<Reply> {
        let head = self.incoming.get(..48)?;
        let (command, sequence, actual) = (word(head, 0), word(head, 4), word(head, 24));
        assert!([3, 4].contains(&command), "command {command}");
        assert_eq!(head[8..20], [0; 12], "device, direction and endpoint");
        let length = if command == 3 && self.reading.contains(&sequence) {
            actual as usize
        } else {
            0
        };
        let mut reply = Reply {
            command,
            sequence,
            status: i32::from_be_bytes(head[20..24].try_into().expect("four bytes")),
            actual,
            packets: word(head, 32),
            data: Vec::new(),
        };
        reply.data = self.take(48 + length)?.split_off(48);
        if command == 3 {
            self.reading.remove(&sequence);
        }
        Some(reply)
    }
}
