//! The control endpoint with its pending URBs: one transfer after the other, each in three stages
//! (USB 2.0, 8.5.3).

use super::{ControlPipe, Urb, status};
use crate::usb::frame_time::FrameTime;
use crate::usb::usbip::messages::{Completion, Direction, Submit};
use crate::usb::wire::{Handshake, MAX_PACKET, Token, UsbWire};
use std::collections::VecDeque;

/// `bmRequestType` and `bRequest` of SET_ADDRESS.
const SET_ADDRESS: [u8; 2] = [0x00, 0x05];
/// The direction in `bmRequestType`.
const FROM_DEVICE: u8 = 0x80;

/// Stage of a control transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Setup,
    DataIn,
    DataOut,
    /// An empty packet to the device, after data from it.
    StatusOut,
    /// An empty packet from the device.
    StatusIn,
}

/// The control endpoint and its queue.
#[derive(Debug)]
pub(super) struct ControlTransfers {
    token: Token,
    max_packet: usize,
    queue: VecDeque<Urb>,
    /// Stage of the first transfer in the queue.
    stage: Stage,
}

impl ControlTransfers {
    pub(super) fn new(pipe: ControlPipe) -> Self {
        Self {
            token: Token {
                address: pipe.address,
                endpoint: 0,
            },
            max_packet: usize::from(pipe.max_packet).clamp(1, MAX_PACKET),
            queue: VecDeque::new(),
            stage: Stage::Setup,
        }
    }

    pub(super) fn urbs(&self) -> impl Iterator<Item = &Urb> {
        self.queue.iter()
    }

    /// Takes a transfer; returns it if it ends at once.
    pub(super) fn submit(&mut self, submit: Submit) -> Option<Completion> {
        let [request_type, request, ..] = submit.setup;
        // The address on this bus is the server's: the importer has one of its own for the device.
        if [request_type, request] == SET_ADDRESS {
            return Some(Urb::new(submit).complete(0));
        }
        if !is_consistent(&submit) {
            return Some(Urb::new(submit).complete(status::INVALID));
        }
        self.queue.push_back(Urb::new(submit));
        None
    }

    /// Withdraws a transfer; returns whether it was there. The next SETUP ends what the device has
    /// begun.
    pub(super) fn unlink(&mut self, victim: u32) -> bool {
        let is_victim = |urb: &Urb| urb.submit.sequence == victim;
        let Some(position) = self.queue.iter().position(is_victim) else {
            return false;
        };
        if position == 0 {
            self.stage = Stage::Setup;
        }
        self.queue.remove(position).is_some()
    }

    /// Performs at most one transaction; returns the transfer that ends with it.
    pub(super) fn poll<W: UsbWire>(
        &mut self,
        wire: &mut W,
        time: &mut FrameTime,
    ) -> Option<Completion> {
        let urb = self.queue.front_mut()?;
        if !time.has_room_for(self.max_packet) {
            return None;
        }
        let token = self.token;
        let rest = urb.submit.data.get(urb.sent..).unwrap_or_default();
        let packet = &rest[..rest.len().min(self.max_packet)];
        let answer = match self.stage {
            Stage::Setup => wire.setup_transaction(token, urb.submit.setup),
            Stage::DataIn | Stage::StatusIn => wire.in_transaction(token),
            Stage::DataOut => wire.out_transaction(token, packet),
            Stage::StatusOut => wire.out_transaction(token, &[]),
        };
        let end = match answer {
            Handshake::Nak => return None,
            Handshake::Stall => Some(status::STALLED),
            Handshake::Absent => Some(status::NO_ANSWER),
            Handshake::Ack(received) => {
                let sent = match self.stage {
                    Stage::Setup => urb.submit.setup.len(),
                    Stage::DataOut => packet.len(),
                    _ => 0,
                };
                time.spend(received.len() + sent);
                match self.stage {
                    Stage::DataOut => urb.sent += sent,
                    Stage::DataIn => urb.received.extend_from_slice(&received),
                    _ => {}
                }
                if urb.received.len() > urb.submit.length {
                    Some(status::OVERFLOW)
                } else {
                    let is_short = received.len() < self.max_packet;
                    let next = next_stage(self.stage, urb, is_short);
                    self.stage = next.unwrap_or(Stage::Setup);
                    next.is_none().then_some(0)
                }
            }
        };
        let status = end?;
        self.stage = Stage::Setup;
        Some(self.queue.pop_front()?.complete(status))
    }
}

/// The stage after this one, or `None` if the transfer is complete.
fn next_stage(stage: Stage, urb: &Urb, is_short: bool) -> Option<Stage> {
    match stage {
        Stage::Setup if urb.submit.length == 0 => Some(Stage::StatusIn),
        Stage::Setup => Some(match urb.submit.direction {
            Direction::In => Stage::DataIn,
            Direction::Out => Stage::DataOut,
        }),
        Stage::DataIn if is_short || urb.received.len() == urb.submit.length => {
            Some(Stage::StatusOut)
        }
        Stage::DataOut if urb.sent == urb.submit.data.len() => Some(Stage::StatusIn),
        Stage::DataIn | Stage::DataOut => Some(stage),
        Stage::StatusIn | Stage::StatusOut => None,
    }
}

/// Returns whether the SETUP packet says the same as the rest of the URB: the length of the data and, if
/// there is any, its direction.
fn is_consistent(submit: &Submit) -> bool {
    let [request_type, _, _, _, _, _, low, high] = submit.setup;
    let length = usize::from(u16::from_le_bytes([low, high]));
    let direction = if request_type & FROM_DEVICE == 0 {
        Direction::Out
    } else {
        Direction::In
    };
    length == submit.length && (length == 0 || direction == submit.direction)
}
