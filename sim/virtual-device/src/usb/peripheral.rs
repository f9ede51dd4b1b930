//! State of a USB peripheral, shared by the two ends of a software bus.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::usb::endpoint::{ENDPOINTS, InEndpoint, OutEndpoint};
use crate::usb::wire::Token;

/// The peripheral, seen from the device stack and from the wire.
#[derive(Debug, Default)]
pub(crate) struct Peripheral {
    /// The device stack has switched the pull-up on: a hub sees a device.
    pub(crate) enabled: bool,
    pub(crate) plugged: bool,
    pub(crate) suspended: bool,
    pub(crate) reset: ResetStage,
    /// Event not yet reported to the device stack.
    pub(crate) line_event: Option<LineEvent>,
    pub(crate) address: u8,
    /// A SETUP packet the device stack has not read yet.
    pub(crate) setup: Option<[u8; 8]>,
    pub(crate) in_endpoints: [InEndpoint; ENDPOINTS],
    pub(crate) out_endpoints: [OutEndpoint; ENDPOINTS],
}

/// Progress of a bus reset. Until it is done the device does not answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ResetStage {
    /// The host has reset the bus; not yet reported to the device stack.
    Pending,
    /// Reported; the device stack has yet to set its endpoints up. Initial state at power-on.
    #[default]
    Reported,
    /// The endpoints are set up: the device answers at address 0.
    Done,
}

/// Frames have stopped or resumed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LineEvent {
    Suspend,
    Resume,
}

/// One bit an endpoint, as `usb-device` wants them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct EndpointEvents {
    pub(crate) out_received: u16,
    pub(crate) in_complete: u16,
    pub(crate) setup: u16,
}

impl Peripheral {
    /// The device stack has set its endpoints up, unless a further reset came in the meantime.
    pub(crate) fn endpoints_set_up(&mut self) {
        if self.reset == ResetStage::Reported {
            self.reset = ResetStage::Done;
        }
    }

    pub(crate) fn is_connected(&self) -> bool {
        self.plugged && self.enabled
    }

    pub(crate) fn answers(&self, token: Token) -> bool {
        self.is_connected()
            && self.reset == ResetStage::Done
            && !self.suspended
            && token.address == self.address
    }

    pub(crate) fn suspend(&mut self) {
        if !self.suspended {
            self.suspended = true;
            self.line_event = Some(LineEvent::Suspend);
        }
    }

    pub(crate) fn endpoint_events(&self) -> EndpointEvents {
        let mut events = EndpointEvents {
            setup: u16::from(self.setup.is_some()),
            ..EndpointEvents::default()
        };
        for (index, endpoint) in self.out_endpoints.iter().enumerate() {
            events.out_received |= u16::from(endpoint.packet.is_some()) << index;
        }
        for (index, endpoint) in self.in_endpoints.iter().enumerate() {
            events.in_complete |= u16::from(endpoint.complete) << index;
        }
        events
    }
}

/// A lock that another thread's panic does not poison: each call leaves it consistent.
pub(crate) fn lock(peripheral: &Mutex<Peripheral>) -> MutexGuard<'_, Peripheral> {
    peripheral.lock().unwrap_or_else(PoisonError::into_inner)
}
