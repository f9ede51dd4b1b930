//! A bulk or interrupt endpoint with its pending URBs.

use super::{EndpointDescriptor, Urb, status};
use crate::usb::frame_time::FrameTime;
use crate::usb::usbip::messages::{Completion, Direction, Submit};
use crate::usb::wire::{Handshake, MAX_PACKET, Token, UsbWire};
use std::collections::VecDeque;

/// `URB_SHORT_NOT_OK`: fewer bytes than the buffer holds are an error.
const SHORT_NOT_OK: u32 = 1;
/// `URB_ZERO_PACKET`: a last packet that is full is followed by an empty one.
const ZERO_PACKET: u32 = 1 << 6;

/// An endpoint and its queue.
#[derive(Debug)]
pub(super) struct Pipe {
    endpoint: EndpointDescriptor,
    token: Token,
    queue: VecDeque<Urb>,
    /// An interrupt endpoint has its turn in this frame.
    is_due: bool,
}

impl Pipe {
    pub(super) fn new(device: u8, endpoint: EndpointDescriptor) -> Self {
        Self {
            endpoint,
            token: Token {
                address: device,
                endpoint: endpoint.number(),
            },
            queue: VecDeque::new(),
            is_due: false,
        }
    }

    /// Returns whether this is the endpoint of this address, with its direction in bit 7.
    pub(super) fn is(&self, address: u8) -> bool {
        self.endpoint.number() == address & 0x0f && self.endpoint.is_in() == (address & 0x80 != 0)
    }

    pub(super) fn urbs(&self) -> impl Iterator<Item = &Urb> {
        self.queue.iter()
    }

    pub(super) fn submit(&mut self, submit: Submit) {
        self.queue.push_back(Urb::new(submit));
    }

    /// Withdraws a URB; what it has received is lost. Returns whether it was there.
    pub(super) fn unlink(&mut self, victim: u32) -> bool {
        let is_victim = |urb: &Urb| urb.submit.sequence == victim;
        let position = self.queue.iter().position(is_victim);
        position.is_some_and(|position| self.queue.remove(position).is_some())
    }

    /// A new frame, counted from 1.
    pub(super) fn start_frame(&mut self, frame: u64) {
        self.is_due = frame.is_multiple_of(u64::from(self.endpoint.interval.max(1)));
    }

    /// Performs at most one transaction; returns the URB that ends with it.
    pub(super) fn poll<W: UsbWire>(
        &mut self,
        wire: &mut W,
        time: &mut FrameTime,
    ) -> Option<Completion> {
        let urb = self.queue.front_mut()?;
        // An interrupt endpoint is asked once in its interval.
        if self.endpoint.is_interrupt() && !std::mem::take(&mut self.is_due) {
            return None;
        }
        let largest = usize::from(self.endpoint.max_packet).clamp(1, MAX_PACKET);
        let end = match urb.submit.direction {
            Direction::In => receive(urb, self.token, largest, wire, time),
            Direction::Out => send(urb, self.token, largest, wire, time),
        };
        let status = end?;
        Some(self.queue.pop_front()?.complete(status))
    }
}

/// One IN transaction; the status if the URB ends with it.
fn receive<W: UsbWire>(
    urb: &mut Urb,
    token: Token,
    largest: usize,
    wire: &mut W,
    time: &mut FrameTime,
) -> Option<i32> {
    if !time.has_room_for(largest) {
        return None;
    }
    let packet = match wire.in_transaction(token) {
        Handshake::Ack(packet) => packet,
        Handshake::Nak => return None,
        Handshake::Stall => return Some(status::STALLED),
        Handshake::Absent => return Some(status::NO_ANSWER),
    };
    time.spend(packet.len());
    urb.received.extend_from_slice(&packet);
    let length = urb.submit.length;
    if urb.received.len() > length {
        Some(status::OVERFLOW)
    } else if urb.received.len() == length {
        Some(0)
    } else if packet.len() < largest {
        let is_error = urb.submit.flags & SHORT_NOT_OK != 0;
        Some(if is_error { status::SHORT } else { 0 })
    } else {
        None
    }
}

/// One OUT transaction; the status if the URB ends with it.
fn send<W: UsbWire>(
    urb: &mut Urb,
    token: Token,
    largest: usize,
    wire: &mut W,
    time: &mut FrameTime,
) -> Option<i32> {
    let rest = urb.submit.data.get(urb.sent..).unwrap_or_default();
    let packet = &rest[..rest.len().min(largest)];
    if !time.has_room_for(packet.len()) {
        return None;
    }
    match wire.out_transaction(token, packet) {
        Handshake::Ack(_) => {}
        Handshake::Nak => return None,
        Handshake::Stall => return Some(status::STALLED),
        Handshake::Absent => return Some(status::NO_ANSWER),
    }
    time.spend(packet.len());
    urb.sent += packet.len();
    let is_last = urb.sent == urb.submit.data.len();
    let owes_zero_packet = urb.submit.flags & ZERO_PACKET != 0 && packet.len() == largest;
    (is_last && !owes_zero_packet).then_some(0)
}
