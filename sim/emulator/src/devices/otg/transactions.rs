//! The host's side: transactions, and what happens to the cable.

use super::endpoints::STUP;
use super::fifo::Kind;
use super::{ENDPOINTS, Otg, State, USBRST, WKUPINT};
use crate::chip::part::lock;
use crepitus_virtual_device::usb::wire::{Handshake, Packet, Token, UsbWire};

impl Otg {
    /// Returns whether a hub reports a device.
    pub(crate) fn is_connected(&self) -> bool {
        lock(&self.line).is_plugged && self.is_on_the_bus(&lock(&self.state))
    }

    /// The cable is plugged in. Nothing happens until the host resets the bus.
    pub(crate) fn plug_in(&self) {
        lock(&self.line).is_plugged = true;
    }

    /// The cable is pulled: to the device an idle bus, as it has its own supply.
    pub(crate) fn unplug(&self) {
        let now = self.now();
        let mut line = lock(&self.line);
        line.is_plugged = false;
        line.idle(now);
    }

    /// The host sends no more frames.
    pub(crate) fn suspend(&self) {
        lock(&self.line).idle(self.now());
    }

    /// The host sends frames again.
    pub(crate) fn resume(&self) {
        let is_over = {
            let mut line = lock(&self.line);
            line.is_plugged && line.resume()
        };
        if is_over {
            lock(&self.state).gintsts |= WKUPINT;
            self.update_interrupt();
        }
    }

    /// A transaction of a device that is there, and its interrupt.
    fn transact(
        &self,
        token: Token,
        transaction: impl FnOnce(&mut State, usize) -> Handshake,
    ) -> Handshake {
        let endpoint = usize::from(token.endpoint);
        let answer = {
            let mut state = lock(&self.state);
            let answers = lock(&self.line).is_alive()
                && self.is_on_the_bus(&state)
                && state.address == token.address
                && endpoint < ENDPOINTS;
            if !answers {
                return Handshake::Absent;
            }
            transaction(&mut state, endpoint)
        };
        self.update_interrupt();
        answer
    }
}

/// A packet that was received.
fn receive(state: &mut State, endpoint: usize, data: &[u8]) -> Handshake {
    let is_ready = {
        let endpoint = &state.endpoints.from_host[endpoint];
        if !endpoint.is_active() {
            return Handshake::Absent;
        }
        if endpoint.is_stalled() {
            return Handshake::Stall;
        }
        endpoint.is_ready()
    };
    if !is_ready || !state.received.has_room_for(data.len()) {
        return Handshake::Nak;
    }
    state.received.push(endpoint, Kind::Out, data);
    if state.endpoints.from_host[endpoint].packet_done(data.len()) {
        state.received.push(endpoint, Kind::OutDone, &[]);
    }
    state.in_request &= endpoint != 0 || !data.is_empty();
    Handshake::Ack(Packet::EMPTY)
}

/// A packet that is transmitted.
fn transmit(state: &mut State, endpoint: usize) -> Handshake {
    let next = &state.endpoints.into_host[endpoint];
    if !next.is_active() {
        return Handshake::Absent;
    }
    if next.is_stalled() {
        return Handshake::Stall;
    }
    if !next.is_ready() {
        return Handshake::Nak;
    }
    let bytes = next.next_packet();
    let Some(packet) = state.transmit.take(next.fifo(), bytes) else {
        return Handshake::Nak;
    };
    state.endpoints.into_host[endpoint].packet_done(bytes);
    if endpoint == 0 && packet.is_empty() {
        // The status stage of a request, which may have given an address.
        state.in_request = false;
        state.take_address();
    }
    Packet::new(&packet).map_or(Handshake::Absent, Handshake::Ack)
}

impl UsbWire for &Otg {
    fn bus_reset(&mut self) {
        if !self.is_connected() {
            return;
        }
        lock(&self.line).reset(self.now());
        {
            let mut state = lock(&self.state);
            state.gintsts |= USBRST;
            state.in_request = false;
            let endpoints = &mut state.endpoints;
            for endpoint in endpoints
                .into_host
                .iter_mut()
                .chain(&mut endpoints.from_host)
            {
                endpoint.bus_reset();
            }
        }
        self.update_interrupt();
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        self.transact(token, |state, endpoint| {
            // No answer: a device cannot refuse a SETUP, and has no room for it.
            if !state.received.has_room_for(request.len()) {
                return Handshake::Absent;
            }
            state.in_request = true;
            state.endpoints.into_host[endpoint].begin_request();
            let from_host = &mut state.endpoints.from_host[endpoint];
            from_host.begin_request();
            from_host.interrupts |= STUP;
            state.received.push(endpoint, Kind::Setup, &request);
            state.received.push(endpoint, Kind::SetupDone, &[]);
            Handshake::Ack(Packet::EMPTY)
        })
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        self.transact(token, |state, endpoint| receive(state, endpoint, data))
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        self.transact(token, transmit)
    }
}
