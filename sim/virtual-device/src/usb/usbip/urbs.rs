//! Requests of a host's driver (URBs) as transactions on the bus.
//!
//! ```text
//!   control ── queue ── SETUP, data stage, status stage ┐
//!   bulk    ── queue ── packets                         ├─ a transaction each in a turn ── device
//!   interrupt  queue ── packets, every bInterval frames ┘
//! ```
//! As a host controller does it: the first URB of each endpoint has the bus, a NAK leaves it where it
//! is, and it ends with its last byte, a short packet, a stall or an unlink. There is no timeout here:
//! the driver that waits for a URB unlinks it.

use super::messages::{Completion, Direction, Submit};
use crate::usb::configuration::EndpointDescriptor;
use crate::usb::control::ControlPipe;
use crate::usb::enumeration::AddressedDevice;
use crate::usb::frame_time::FrameTime;
use crate::usb::wire::UsbWire;

mod control;
mod pipe;

use control::ControlTransfers;
use pipe::Pipe;

/// The most URBs that may be pending.
const MOST_URBS: usize = 256;

/// The most data that may wait for the device, bytes.
const MOST_DATA: usize = 1024 * 1024;

/// Errors of Linux, as the importer's drivers expect them.
pub(crate) mod status {
    /// `ENOENT`: there is no such endpoint.
    pub(crate) const NO_ENDPOINT: i32 = -2;
    /// `ENOMEM`: too much is pending.
    pub(crate) const NO_MEMORY: i32 = -12;
    /// `EINVAL`: a control request and its buffer do not match.
    pub(crate) const INVALID: i32 = -22;
    /// `EPIPE`: the device stalled the endpoint.
    pub(crate) const STALLED: i32 = -32;
    /// `EPROTO`: the device does not answer.
    pub(crate) const NO_ANSWER: i32 = -71;
    /// `EOVERFLOW`: the device sent more than the buffer holds.
    pub(crate) const OVERFLOW: i32 = -75;
    /// `ECONNRESET`: the URB was unlinked.
    pub(crate) const UNLINKED: i32 = -104;
    /// `EREMOTEIO`: fewer bytes than asked for, where the driver wants all.
    pub(crate) const SHORT: i32 = -121;
}

/// A URB that is pending.
#[derive(Debug)]
struct Urb {
    submit: Submit,
    /// Data received so far, in an IN transfer.
    received: Vec<u8>,
    /// Bytes sent so far, in an OUT transfer.
    sent: usize,
}

impl Urb {
    fn new(submit: Submit) -> Self {
        Self {
            submit,
            received: Vec::new(),
            sent: 0,
        }
    }

    /// The end of it.
    fn complete(mut self, status: i32) -> Completion {
        // What does not fit the buffer is lost.
        self.received.truncate(self.submit.length);
        Completion {
            sequence: self.submit.sequence,
            status,
            moved: match self.submit.direction {
                Direction::In => self.received.len(),
                Direction::Out => self.sent,
            },
            packets: self.submit.packets,
            data: self.received,
        }
    }
}

/// The URBs of one importer.
#[derive(Debug)]
pub(crate) struct Urbs {
    control: ControlTransfers,
    pipes: Vec<Pipe>,
    /// The pipe that comes first in this turn.
    first: usize,
    frame: u64,
    frame_time: FrameTime,
    completed: Vec<Completion>,
}

impl Urbs {
    /// None yet, for this device.
    pub(crate) fn new(device: &AddressedDevice) -> Self {
        let control = device.control;
        let endpoints = device.configuration.interfaces.iter();
        let mut pipes: Vec<Pipe> = Vec::new();
        for endpoint in endpoints.flat_map(|interface| &interface.endpoints) {
            // An endpoint may occur in several alternate settings.
            if !pipes.iter().any(|pipe| pipe.is(endpoint.address)) {
                pipes.push(Pipe::new(control.address, *endpoint));
            }
        }
        Self {
            control: ControlTransfers::new(control),
            pipes,
            first: 0,
            frame: 0,
            frame_time: FrameTime::default(),
            completed: Vec::new(),
        }
    }

    /// Takes a URB. One that cannot be done completes with an error.
    pub(crate) fn submit(&mut self, submit: Submit) {
        let data = self.waiting_data() + submit.data.len();
        if self.pending() >= MOST_URBS || data > MOST_DATA {
            self.refuse(submit, status::NO_MEMORY);
        } else if submit.endpoint == 0 {
            self.completed.extend(self.control.submit(submit));
        } else {
            let address = match submit.direction {
                Direction::Out => submit.endpoint,
                Direction::In => submit.endpoint | 0x80,
            };
            match self.pipes.iter_mut().find(|pipe| pipe.is(address)) {
                Some(pipe) => pipe.submit(submit),
                None => self.refuse(submit, status::NO_ENDPOINT),
            }
        }
    }

    fn refuse(&mut self, submit: Submit, status: i32) {
        self.completed.push(Urb::new(submit).complete(status));
    }

    /// Withdraws a URB; returns the status of the reply: 0 if it has completed already.
    pub(crate) fn unlink(&mut self, victim: u32) -> i32 {
        let was_pending =
            self.control.unlink(victim) || self.pipes.iter_mut().any(|pipe| pipe.unlink(victim));
        if was_pending { status::UNLINKED } else { 0 }
    }

    /// Starts a new frame of 1 ms with its bus time.
    pub(crate) fn start_frame(&mut self) {
        self.frame += 1;
        self.frame_time.start();
        for pipe in &mut self.pipes {
            pipe.start_frame(self.frame);
        }
    }

    /// Performs at most one transaction for each endpoint, as far as the frame's time goes. Let the device
    /// run between two calls.
    pub(crate) fn poll<W: UsbWire>(&mut self, wire: &mut W) {
        let Self {
            control,
            pipes,
            frame_time,
            completed,
            ..
        } = self;
        completed.extend(control.poll(wire, frame_time));
        let (last, first) = pipes.split_at_mut(self.first);
        for pipe in first.iter_mut().chain(last) {
            completed.extend(pipe.poll(wire, frame_time));
        }
        // The last packet of a frame goes to another pipe each time.
        self.first = (self.first + 1) % self.pipes.len().max(1);
    }

    /// The URBs that have ended since the last call, in order.
    pub(crate) fn take_completed(&mut self) -> Vec<Completion> {
        std::mem::take(&mut self.completed)
    }

    fn pending(&self) -> usize {
        self.control.urbs().count() + self.pipes.iter().flat_map(Pipe::urbs).count()
    }

    /// Bytes for the device that wait in URBs.
    fn waiting_data(&self) -> usize {
        let pipes = self.pipes.iter().flat_map(Pipe::urbs);
        let all = self.control.urbs().chain(pipes);
        all.map(|urb| urb.submit.data.len()).sum()
    }
}
