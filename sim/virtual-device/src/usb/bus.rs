//! A software full-speed bus for `usb-device`: the device's end.
//!
//! [`SoftBus`] goes into a `UsbBusAllocator` and the device stack drives it as it drives the real
//! peripheral. The other end is a [`SoftCable`]. The two may live in different threads; in one
//! thread, everything that happens is decided by the order of the calls.
//!
//! The bus behaves as an OTG_FS core whose device has its own supply and does not sense VBUS: a
//! pulled cable is an idle bus, which the core reports as a suspend; plugged in again, the device
//! stays suspended until the host resets it.

use std::sync::{Arc, Mutex};

use usb_device::bus::{PollResult, UsbBus};
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

use crate::usb::cable::SoftCable;
use crate::usb::endpoint::{ENDPOINTS, InEndpoint, OutEndpoint};
use crate::usb::peripheral::{EndpointEvents, LineEvent, Peripheral, ResetStage, lock};

/// The device end: a USB peripheral in software.
#[derive(Debug)]
pub struct SoftBus {
    peripheral: Arc<Mutex<Peripheral>>,
}

impl SoftBus {
    /// A bus and its cable, plugged in.
    #[allow(clippy::new_ret_no_self)] // The two ends are made together.
    pub fn new() -> (SoftBus, SoftCable) {
        let peripheral = Arc::new(Mutex::new(Peripheral {
            plugged: true,
            ..Peripheral::default()
        }));
        let cable = SoftCable::new(Arc::clone(&peripheral));
        (SoftBus { peripheral }, cable)
    }
}

impl UsbBus for SoftBus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        _kind: EndpointType,
        max_packet_size: u16,
        _interval: u8,
    ) -> Result<EndpointAddress> {
        let mut peripheral = lock(&self.peripheral);
        let max_packet = usize::from(max_packet_size);
        let is_free = |peripheral: &Peripheral, index: usize| match direction {
            UsbDirection::In => peripheral
                .in_endpoints
                .get(index)
                .is_some_and(|endpoint| endpoint.max_packet.is_none()),
            UsbDirection::Out => peripheral
                .out_endpoints
                .get(index)
                .is_some_and(|endpoint| endpoint.max_packet.is_none()),
        };
        let index = match address {
            Some(address) => Some(address.index()).filter(|&index| is_free(&peripheral, index)),
            None => (1..ENDPOINTS).find(|&index| is_free(&peripheral, index)),
        }
        .ok_or(match address {
            Some(_) => UsbError::InvalidEndpoint,
            None => UsbError::EndpointOverflow,
        })?;
        match direction {
            UsbDirection::In => peripheral.in_endpoints[index].max_packet = Some(max_packet),
            UsbDirection::Out => peripheral.out_endpoints[index].max_packet = Some(max_packet),
        }
        Ok(EndpointAddress::from_parts(index, direction))
    }

    fn enable(&mut self) {
        lock(&self.peripheral).enabled = true;
    }

    fn reset(&self) {
        let mut peripheral = lock(&self.peripheral);
        peripheral.address = 0;
        peripheral.setup = None;
        peripheral
            .in_endpoints
            .iter_mut()
            .for_each(InEndpoint::reset);
        peripheral
            .out_endpoints
            .iter_mut()
            .for_each(OutEndpoint::abandon);
        peripheral.endpoints_set_up();
    }

    fn set_device_address(&self, address: u8) {
        lock(&self.peripheral).address = address;
    }

    fn write(&self, address: EndpointAddress, data: &[u8]) -> Result<usize> {
        lock(&self.peripheral)
            .in_endpoints
            .get_mut(address.index())
            .filter(|_| address.is_in())
            .ok_or(UsbError::InvalidEndpoint)?
            .write(data)
    }

    fn read(&self, address: EndpointAddress, buffer: &mut [u8]) -> Result<usize> {
        let mut peripheral = lock(&self.peripheral);
        if address.index() == 0
            && let Some(request) = peripheral.setup.take()
        {
            buffer
                .get_mut(..request.len())
                .ok_or(UsbError::BufferOverflow)?
                .copy_from_slice(&request);
            return Ok(request.len());
        }
        peripheral
            .out_endpoints
            .get_mut(address.index())
            .filter(|_| address.is_out())
            .ok_or(UsbError::InvalidEndpoint)?
            .read(buffer)
    }

    fn set_stalled(&self, address: EndpointAddress, stalled: bool) {
        let mut peripheral = lock(&self.peripheral);
        if address.is_in() {
            if let Some(endpoint) = peripheral.in_endpoints.get_mut(address.index()) {
                endpoint.stalled = stalled;
            }
        } else if let Some(endpoint) = peripheral.out_endpoints.get_mut(address.index()) {
            endpoint.stalled = stalled;
        }
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        let peripheral = lock(&self.peripheral);
        if address.is_in() {
            (peripheral.in_endpoints.get(address.index())).is_some_and(|endpoint| endpoint.stalled)
        } else {
            (peripheral.out_endpoints.get(address.index())).is_some_and(|endpoint| endpoint.stalled)
        }
    }

    // The device keeps running in both: there is no supply current to save.
    fn suspend(&self) {}
    fn resume(&self) {}

    fn poll(&self) -> PollResult {
        let mut peripheral = lock(&self.peripheral);
        if peripheral.reset == ResetStage::Pending {
            peripheral.reset = ResetStage::Reported;
            return PollResult::Reset;
        }
        let events = peripheral.endpoint_events();
        if events == EndpointEvents::default() {
            // In the order of things: an idle bus becomes a suspend only after 3 ms.
            return match peripheral.line_event.take() {
                Some(LineEvent::Suspend) => PollResult::Suspend,
                Some(LineEvent::Resume) => PollResult::Resume,
                None => PollResult::None,
            };
        }
        for endpoint in &mut peripheral.in_endpoints {
            endpoint.complete = false;
        }
        PollResult::Data {
            ep_out: events.out_received,
            ep_in_complete: events.in_complete,
            ep_setup: events.setup,
        }
    }
}
