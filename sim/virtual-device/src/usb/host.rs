//! The host's end of a serial port: bytes in queues, packets on the bus.
//!
//! ```text
//!   queue ──▶ outgoing ──▶ OUT packets ──▶ device
//!   received ◀── incoming ◀── transfer ◀── IN packets ◀── device
//! ```
//! The bus is realistic in two respects that usually matter only on hardware:
//! - A frame of 1 ms carries 1,500 bytes. A bulk packet takes its data and 13 bytes (USB 2.0,
//!   table 5-9), so 19 full packets fit, both directions together: 1.2 MB/s at best.
//! - Bytes become readable when the transfer they came in ends: with a short packet, or when the
//!   host's buffer is full. A device that forgets the zero-length packet is detected.
//!
//! Not modelled: a NAK takes no time on the bus (a real host repeats it only in unused time), and
//! the notification endpoint is not polled (the device does not use it).

use std::collections::VecDeque;

use crate::usb::configuration::EndpointDescriptor;
use crate::usb::control::{TURNS_PER_FRAME, TransferError};
use crate::usb::enumeration::{CdcDevice, EnumerationError};
use crate::usb::frame_time::FrameTime;
use crate::usb::wire::{Handshake, MAX_PACKET, Packet, Token, UsbWire};

/// The buffer of one IN transfer, bytes. Drivers use 128 to some thousands; a large one is the
/// harder test for a device.
const TRANSFER_BYTES: usize = 4_096;
/// Capacity of the queue to the program, bytes; when full, the host stops fetching.
const INCOMING_BYTES: usize = 64 * 1024;
/// Capacity of the queue to the device, bytes.
const OUTGOING_BYTES: usize = 64 * 1024;

/// Traffic on the bus since enumeration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames begun.
    pub frames: u64,
    /// Packets to the device.
    pub packets_out: u64,
    /// Packets from the device, zero-length ones included.
    pub packets_in: u64,
    /// Bytes to the device.
    pub bytes_out: u64,
    /// Bytes from the device.
    pub bytes_in: u64,
    /// OUT packets the device had no room for.
    pub naks_out: u64,
    /// IN requests the device had nothing for.
    pub naks_in: u64,
}

impl Traffic {
    /// Adds the traffic of another connection.
    pub fn add(&mut self, other: Self) {
        self.frames += other.frames;
        self.packets_out += other.packets_out;
        self.packets_in += other.packets_in;
        self.bytes_out += other.bytes_out;
        self.bytes_in += other.bytes_in;
        self.naks_out += other.naks_out;
        self.naks_in += other.naks_in;
    }
}

/// A host with one serial port open.
///
/// When the device is disconnected ([`TransferError::Detached`]) the value is useless: enumerate
/// again for a new one. Queued or half received data is lost, as with a real port.
#[derive(Clone, Debug)]
pub struct CdcHost {
    device: CdcDevice,
    outgoing: VecDeque<u8>,
    transfer: Vec<u8>,
    incoming: VecDeque<u8>,
    fetching: bool,
    frame_time: FrameTime,
    in_first: bool,
    traffic: Traffic,
}

impl CdcHost {
    /// Enumerates the device on this wire. `run` lets the device run for one turn of 50 µs.
    pub fn enumerate<W: UsbWire>(
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Self, EnumerationError> {
        Ok(Self {
            device: CdcDevice::enumerate(wire, run)?,
            outgoing: VecDeque::new(),
            transfer: Vec::new(),
            incoming: VecDeque::new(),
            fetching: true,
            frame_time: FrameTime::default(),
            in_first: false,
            traffic: Traffic::default(),
        })
    }

    /// The device this port belongs to.
    pub fn device(&self) -> &CdcDevice {
        &self.device
    }

    /// Traffic on the bus.
    pub fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// Takes bytes for the device; returns how many there was room for.
    pub fn queue(&mut self, bytes: &[u8]) -> usize {
        let count = bytes.len().min(self.room());
        self.outgoing.extend(&bytes[..count]);
        count
    }

    /// Number of bytes that [`queue`](Self::queue) would take.
    pub fn room(&self) -> usize {
        OUTGOING_BYTES - self.outgoing.len()
    }

    /// Number of queued bytes that the device has not taken yet.
    pub fn unsent(&self) -> usize {
        self.outgoing.len()
    }

    /// Bytes from the device, as one contiguous run; empty if there are none.
    pub fn received(&self) -> &[u8] {
        self.incoming.as_slices().0
    }

    /// The first `count` bytes of [`received`](Self::received) have been used.
    pub fn consume(&mut self, count: usize) {
        self.incoming.drain(..count.min(self.incoming.len()));
    }

    /// Takes all bytes from the device.
    pub fn read_all(&mut self) -> Vec<u8> {
        self.incoming.drain(..).collect()
    }

    /// Sets whether a program has the port open. Without one the host fetches nothing, so the device
    /// has to queue or drop its data; data fetched and not read is discarded.
    pub fn set_open(&mut self, open: bool) {
        self.fetching = open;
        if !open {
            self.transfer.clear();
            self.incoming.clear();
        }
    }

    /// One millisecond: transactions and turns of the device in alternation.
    ///
    /// # Errors
    ///
    /// As [`poll`](Self::poll); the rest of the frame is skipped.
    pub fn frame<W: UsbWire>(
        &mut self,
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<(), TransferError> {
        self.start_frame();
        for _ in 0..TURNS_PER_FRAME {
            self.poll(wire)?;
            run(wire);
        }
        Ok(())
    }

    /// Starts a new frame with its bus time. For simulations that interleave
    /// [`poll`](Self::poll) with the device themselves.
    pub fn start_frame(&mut self) {
        self.frame_time.start();
        self.traffic.frames += 1;
        // 19 packets are an odd number: each direction gets the last one in turn.
        self.in_first = !self.in_first;
    }

    /// Performs at most one transaction in each direction, as far as the frame's time goes. Let the device
    /// run between two calls, it can hold only one packet each way.
    ///
    /// # Errors
    ///
    /// The device does not answer, or has halted a pipe.
    pub fn poll<W: UsbWire>(&mut self, wire: &mut W) -> Result<(), TransferError> {
        if self.in_first {
            self.poll_in(wire)?;
            self.poll_out(wire)
        } else {
            self.poll_out(wire)?;
            self.poll_in(wire)
        }
    }

    fn poll_out<W: UsbWire>(&mut self, wire: &mut W) -> Result<(), TransferError> {
        let pipe = self.device.function.bulk_out;
        let mut data = [0; MAX_PACKET];
        let mut count = 0;
        let largest = usize::from(pipe.max_packet);
        for (byte, queued) in data.iter_mut().zip(self.outgoing.iter().take(largest)) {
            *byte = *queued;
            count += 1;
        }
        if count == 0 || !self.frame_time.has_room_for(count) {
            return Ok(());
        }
        let answer = wire.out_transaction(self.token(pipe), &data[..count]);
        if accepted(answer, pipe)?.is_none() {
            self.traffic.naks_out += 1;
            return Ok(());
        }
        self.outgoing.drain(..count);
        self.frame_time.spend(count);
        self.traffic.packets_out += 1;
        self.traffic.bytes_out += count as u64;
        Ok(())
    }

    fn poll_in<W: UsbWire>(&mut self, wire: &mut W) -> Result<(), TransferError> {
        let pipe = self.device.function.bulk_in;
        let waiting = self.incoming.len() + self.transfer.len();
        if !self.fetching
            || waiting + MAX_PACKET > INCOMING_BYTES
            || !self.frame_time.has_room_for(usize::from(pipe.max_packet))
        {
            return Ok(());
        }
        let answer = wire.in_transaction(self.token(pipe));
        let Some(packet) = accepted(answer, pipe)? else {
            self.traffic.naks_in += 1;
            return Ok(());
        };
        self.transfer.extend_from_slice(&packet);
        let is_short = packet.len() < usize::from(pipe.max_packet);
        if is_short || self.transfer.len() >= TRANSFER_BYTES {
            self.incoming.extend(self.transfer.drain(..));
        }
        self.frame_time.spend(packet.len());
        self.traffic.packets_in += 1;
        self.traffic.bytes_in += packet.len() as u64;
        Ok(())
    }

    fn token(&self, pipe: EndpointDescriptor) -> Token {
        Token {
            address: self.device.control.address,
            endpoint: pipe.number(),
        }
    }
}

/// The packet, or `None` for NAK.
fn accepted(answer: Handshake, pipe: EndpointDescriptor) -> Result<Option<Packet>, TransferError> {
    match answer {
        Handshake::Ack(packet) => Ok(Some(packet)),
        Handshake::Nak => Ok(None),
        Handshake::Stall => Err(TransferError::Stalled {
            endpoint: pipe.number(),
        }),
        Handshake::Absent => Err(TransferError::Detached),
    }
}
