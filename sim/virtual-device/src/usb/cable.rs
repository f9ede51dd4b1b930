//! The host's end of a software bus: a cable, with its host and hub.

use std::sync::{Arc, Mutex};

use crate::usb::peripheral::{EndpointEvents, LineEvent, Peripheral, ResetStage, lock};
use crate::usb::wire::{Handshake, Packet, Token, UsbWire};

/// The cable that comes out of a [`SoftBus`](crate::usb::bus::SoftBus): the [`UsbWire`] a host talks on.
#[derive(Debug)]
pub struct SoftCable {
    peripheral: Arc<Mutex<Peripheral>>,
}

impl SoftCable {
    pub(crate) fn new(peripheral: Arc<Mutex<Peripheral>>) -> Self {
        Self { peripheral }
    }

    /// Plugs the cable in. Nothing happens until a host resets the bus.
    pub fn plug_in(&mut self) {
        lock(&self.peripheral).plugged = true;
    }

    /// Unplugs the cable: the host gets no answer, the device an idle bus.
    pub fn unplug(&mut self) {
        let mut peripheral = lock(&self.peripheral);
        peripheral.plugged = false;
        peripheral.suspend();
    }

    /// The host starts the frames again.
    pub fn resume(&mut self) {
        let mut peripheral = lock(&self.peripheral);
        if peripheral.plugged && peripheral.suspended {
            peripheral.suspended = false;
            peripheral.line_event = Some(LineEvent::Resume);
        }
    }

    /// Returns whether the peripheral's interrupt line is active: the device has something to poll for.
    pub fn interrupt_pending(&self) -> bool {
        let peripheral = lock(&self.peripheral);
        peripheral.reset == ResetStage::Pending
            || peripheral.line_event.is_some()
            || peripheral.endpoint_events() != EndpointEvents::default()
    }
}

impl UsbWire for SoftCable {
    fn bus_reset(&mut self) {
        let mut peripheral = lock(&self.peripheral);
        if peripheral.is_connected() {
            peripheral.suspended = false;
            peripheral.line_event = None;
            peripheral.reset = ResetStage::Pending;
        }
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        let mut peripheral = lock(&self.peripheral);
        if !peripheral.answers(token) || token.endpoint != 0 {
            return Handshake::Absent;
        }
        // A SETUP ends whatever the control endpoint was doing, a stall included (8.5.3.4).
        let [in_endpoint, ..] = &mut peripheral.in_endpoints;
        in_endpoint.abandon();
        let [out_endpoint, ..] = &mut peripheral.out_endpoints;
        out_endpoint.abandon();
        peripheral.setup = Some(request);
        Handshake::Ack(Packet::EMPTY)
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        let mut peripheral = lock(&self.peripheral);
        if !peripheral.answers(token) {
            return Handshake::Absent;
        }
        // The data stage cannot overtake the SETUP it belongs to.
        if token.endpoint == 0 && peripheral.setup.is_some() {
            return Handshake::Nak;
        }
        match peripheral
            .out_endpoints
            .get_mut(usize::from(token.endpoint))
        {
            None => Handshake::Absent,
            Some(endpoint) => endpoint.transact(data),
        }
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        let mut peripheral = lock(&self.peripheral);
        if !peripheral.answers(token) {
            return Handshake::Absent;
        }
        match peripheral.in_endpoints.get_mut(usize::from(token.endpoint)) {
            None => Handshake::Absent,
            Some(endpoint) => endpoint.transact(),
        }
    }

    fn suspend(&mut self) {
        lock(&self.peripheral).suspend();
    }

    fn is_connected(&self) -> bool {
        lock(&self.peripheral).is_connected()
    }
}
