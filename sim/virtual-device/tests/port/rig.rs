//! A device to test with: the genuine port and one of two simple ends.

use std::collections::VecDeque;

use crepitus_device::usb_port::{HostBytes, UsbIdentity, UsbPort};
use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::host::CdcHost;
use usb_device::bus::UsbBusAllocator;

pub(crate) const IDENTITY: UsbIdentity<'static> = UsbIdentity {
    manufacturer: "Crepitus project",
    product: "Crepitus",
    serial_number: "CR-0001-µ",
};

/// A device: its port, its end, and the cable a host holds.
pub(crate) struct Device<'b, E> {
    pub(crate) port: UsbPort<'b, SoftBus>,
    pub(crate) end: E,
}

impl<E: HostBytes> Device<'_, E> {
    /// One turn of the device.
    pub(crate) fn turn(&mut self) -> impl FnMut(&mut SoftCable) {
        |_| self.port.poll(&mut self.end)
    }
}

/// Runs a test with a device that has this end.
pub(crate) fn with_device<E: HostBytes>(end: E, test: impl FnOnce(Device<'_, E>, SoftCable)) {
    let (bus, cable) = SoftBus::new();
    let allocator = UsbBusAllocator::new(bus);
    let port = UsbPort::new(&allocator, &IDENTITY).expect("the identity is valid");
    test(Device { port, end }, cable);
}

/// Runs a test as [`with_device`] does, with the device enumerated.
pub(crate) fn with_host<E: HostBytes>(
    end: E,
    test: impl FnOnce(Device<'_, E>, SoftCable, CdcHost),
) {
    with_device(end, |mut device, mut cable| {
        let host = CdcHost::enumerate(&mut cable, &mut device.turn()).expect("it enumerates");
        test(device, cable, host);
    });
}

/// Lets some frames pass.
pub(crate) fn frames<E: HostBytes>(
    count: usize,
    host: &mut CdcHost,
    cable: &mut SoftCable,
    device: &mut Device<'_, E>,
) {
    for _ in 0..count {
        host.frame(cable, &mut device.turn())
            .expect("the bus works");
    }
}

/// Bytes that repeat only after 65,521 of them.
pub(crate) fn pattern(index: usize) -> u8 {
    let number = index % 65_521;
    u8::try_from((number ^ (number >> 8)) & 0xff).expect("masked")
}

pub(crate) fn pattern_bytes(count: usize) -> Vec<u8> {
    (0..count).map(pattern).collect()
}

/// Sends back what arrives; what does not fit its queue is dropped and counted.
#[derive(Default)]
pub(crate) struct Echo {
    pub(crate) queue: VecDeque<u8>,
    pub(crate) dropped: usize,
    pub(crate) hosts_lost: usize,
}

impl Echo {
    const CAPACITY: usize = 4_096;
}

impl HostBytes for Echo {
    fn received(&mut self, bytes: &[u8]) {
        let count = bytes.len().min(Self::CAPACITY - self.queue.len());
        self.queue.extend(&bytes[..count]);
        self.dropped += bytes.len() - count;
    }

    fn to_send(&self) -> &[u8] {
        self.queue.as_slices().0
    }

    fn sent(&mut self, count: usize) {
        self.queue.drain(..count);
    }

    fn host_lost(&mut self) {
        self.queue.clear();
        self.hosts_lost += 1;
    }
}

/// Always has the next byte of the pattern to send, up to a total.
pub(crate) struct Source {
    bytes: Vec<u8>,
    pub(crate) at: usize,
    pub(crate) hosts_lost: usize,
}

impl Source {
    pub(crate) fn new(total: usize) -> Self {
        Self {
            bytes: pattern_bytes(total),
            at: 0,
            hosts_lost: 0,
        }
    }
}

impl HostBytes for Source {
    fn received(&mut self, _bytes: &[u8]) {}

    fn to_send(&self) -> &[u8] {
        &self.bytes[self.at..]
    }

    fn sent(&mut self, count: usize) {
        self.at += count;
    }

    fn host_lost(&mut self) {
        self.hosts_lost += 1;
        self.at = 0;
    }
}
