//! The USB CDC-ACM port of the comms controller: bytes to and from the host.
//!
//! ```text
//!   HostBytes::to_send ──▶ transmit store ──▶ IN endpoint ──▶ host     512 bytes, 64 in flight
//!   HostBytes::received ◀── receive store ◀── OUT endpoint ◀── host     one packet at a time
//! ```
//! This code runs in the firmware, on the OTG_FS peripheral, and in the simulator, on a
//! software bus; only the [`UsbBus`] differs.
//!
//! [`UsbPort::poll`] is called from the USB interrupt and whenever there is something to send. It
//! handles at most one event of the bus, moves what fits and returns: it never blocks. Bytes that
//! a slow host does not read are dropped and counted by the [`HostBytes`] end.
//!
//! Properties of `usbd-serial` 0.2 that this file relies on or works around:
//! - A transfer ends with a short packet. After a full packet that empties the transmit store the
//!   next completion sends a zero-length packet, and every eleventh packet is a short one; so a
//!   host sees every byte promptly without a further write, at any length.
//! - Only a bus reset clears its stores. A host that unconfigures or suspends the device does
//!   not, so this port does that itself.
//! - The control endpoint's data is read only where a request expects it and there is room for it:
//!   see [`UsbPort::drop_control_leftover`].
//! - `write` reports an endpoint's error after it has stored the bytes; see [`UsbPort::poll`].
//! - DTR is ignored; the lease proves that the host is alive.
//!
//! A disconnect loses the bytes in flight: at most the transmit store and one packet. Frames
//! carry sequence numbers, so the gap is visible.

pub use crepitus_protocol::usb::{PRODUCT_ID, VENDOR_ID};
use usb_device::bus::{UsbBus, UsbBusAllocator};
use usb_device::class_prelude::UsbClass;
use usb_device::device::UsbRev;
use usb_device::endpoint::EndpointAddress;
use usb_device::prelude::{
    BuilderError, StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbError,
    UsbVidPid,
};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

/// Current that the bus supplies, mA: the host's side of the isolator.
const ISOLATOR_MA: usize = 20;

/// The largest packet of a full-speed bulk endpoint, bytes.
const MAX_PACKET: usize = 64;
/// Enough to keep the IN endpoint in full packets between two calls of `poll`, bytes.
const TRANSMIT_STORE: usize = 8 * MAX_PACKET;
/// `usb-device` writes a string's descriptor length into one byte without a check: 2 + 2·126.
const MAX_STRING_UNITS: usize = 126;
/// The control endpoint, from the host.
const CONTROL_OUT: u8 = 0;
/// A ring buffer offers its content in two contiguous runs.
const RUNS_PER_POLL: usize = 2;

/// Source and sink of the port's bytes, in the comms controller.
pub trait HostBytes {
    /// Bytes arrived from the host: one packet, at most 64 bytes.
    fn received(&mut self, bytes: &[u8]);

    /// The next bytes to send, contiguous; empty if there are none.
    fn to_send(&self) -> &[u8];

    /// The first `count` bytes of [`to_send`](Self::to_send) have been taken.
    fn sent(&mut self, count: usize);

    /// The host has disconnected (bus reset, unconfigured, suspended, unplugged): drop partial
    /// frames. Called once for each loss of a configured host.
    fn host_lost(&mut self);
}

/// Strings of the USB descriptors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UsbIdentity<'a> {
    /// Manufacturer.
    pub manufacturer: &'a str,
    /// Product; contains [`PRODUCT`](crepitus_protocol::usb::PRODUCT), for which a client searches.
    pub product: &'a str,
    /// Serial number; gives the serial port its stable name.
    pub serial_number: &'a str,
}

/// Errors of [`UsbPort::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum UsbPortError {
    /// A string of the identity has more than 126 UTF-16 units, the most a descriptor can hold.
    StringTooLong {
        /// The length of that string, UTF-16 units.
        units: usize,
    },
    /// The device stack rejected the descriptors.
    Description(BuilderError),
}

/// The USB port: device stack and serial class.
pub struct UsbPort<'b, B: UsbBus> {
    device: UsbDevice<'b, B>,
    serial: SerialPort<'b, B, [u8; MAX_PACKET], [u8; TRANSMIT_STORE]>,
    configured: bool,
}

impl<'b, B: UsbBus> UsbPort<'b, B> {
    /// Describes the device and enables the bus.
    ///
    /// `usb-device` panics if the allocator has already made a device or if the bus has too few
    /// endpoints (it takes two IN and one OUT besides the control endpoint): call this once, at
    /// start.
    ///
    /// # Errors
    ///
    /// A string of the identity that does not fit its descriptor.
    pub fn new(
        allocator: &'b UsbBusAllocator<B>,
        identity: &UsbIdentity<'b>,
    ) -> Result<Self, UsbPortError> {
        for string in [
            identity.manufacturer,
            identity.product,
            identity.serial_number,
        ] {
            let units = string.encode_utf16().count();
            if units > MAX_STRING_UNITS {
                return Err(UsbPortError::StringTooLong { units });
            }
        }
        let strings = StringDescriptors::default()
            .manufacturer(identity.manufacturer)
            .product(identity.product)
            .serial_number(identity.serial_number);
        // The interfaces and endpoints must exist before the device freezes the allocator.
        let serial = SerialPort::new_with_store(allocator, [0; MAX_PACKET], [0; TRANSMIT_STORE]);
        let mut device = UsbDeviceBuilder::new(allocator, UsbVidPid(VENDOR_ID, PRODUCT_ID))
            .device_class(USB_CLASS_CDC)
            // 2.0, not the default 2.1: a 2.1 device owes the host capability descriptors.
            .usb_rev(UsbRev::Usb200)
            // Comms has a supply of its own; the bus feeds the isolator's side only.
            .self_powered(true)
            // The default, 8 bytes, makes enumeration eight times as chatty.
            .max_packet_size_0(64)
            .and_then(|builder| builder.max_power(ISOLATOR_MA))
            .and_then(|builder| builder.strings(&[strings]))
            .map_err(UsbPortError::Description)?
            .build();
        // The builder's is for the descriptor, this one for GET_STATUS.
        device.set_self_powered(true);
        Ok(Self {
            device,
            serial,
            configured: false,
        })
    }

    /// Handles at most one event of the bus, then moves what fits in both directions.
    ///
    /// Bytes move only while the host has the device configured. When it no longer has, for
    /// whatever reason, both stores are cleared and `host_lost` is called once. An unplugged device
    /// with its own supply sees an idle bus, which is a suspend; so a suspend counts as a
    /// disconnect, also when the host only slept.
    ///
    /// After an unconfiguration or a suspend without a bus reset, the packet already in the IN
    /// endpoint (at most 64 bytes) still reaches the next reader: frames need a delimiter in front.
    pub fn poll(&mut self, end: &mut impl HostBytes) {
        self.device.poll(&mut [&mut self.serial]);
        let configured = self.is_configured();
        if self.configured && !configured {
            self.disconnect(end);
        }
        self.configured = configured;
        self.receive(end);
        if configured {
            self.send(end);
        }
    }

    /// Drops a packet that the device stack has left in the control endpoint: data that no request
    /// announced, or more than it announced, or more than the stack's buffer holds.
    ///
    /// For a bus that keeps such a packet and then has no room for the next request, as that of
    /// OTG_FS does; without this any host can stop the device. To be called after each
    /// [`poll`](Self::poll), and only for a bus that receives packets nowhere else than there, so
    /// that none is dropped that the stack has not seen.
    pub fn drop_control_leftover(&mut self) {
        let mut packet = [0; MAX_PACKET];
        // Mostly there is none.
        let _dropped = self
            .device
            .bus()
            .read(EndpointAddress::from(CONTROL_OUT), &mut packet);
    }

    /// Returns whether a host has configured the device, so that bytes can move.
    pub fn is_configured(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured
    }

    /// Takes the packet that has arrived, if any; the endpoint can then accept the next.
    fn receive(&mut self, end: &mut impl HostBytes) {
        let mut packet = [0; MAX_PACKET];
        let Ok(count) = self.serial.read(&mut packet) else {
            return;
        };
        // A driver may keep a packet across a bus reset in its own buffer: without a configured
        // host it is a leftover, taken only to free the endpoint.
        if let Some(bytes) = packet.get(..count)
            && self.configured
        {
            end.received(bytes);
        }
    }

    fn send(&mut self, end: &mut impl HostBytes) {
        for _ in 0..RUNS_PER_POLL {
            let run = end.to_send();
            if run.is_empty() {
                break;
            }
            match self.serial.write(run) {
                Ok(count) => end.sent(count),
                Err(UsbError::WouldBlock) => break,
                // The class may have stored bytes that it does not report as written. No endpoint
                // of this device can fail so; if one did, a gap is better than repeated bytes.
                Err(_) => {
                    self.disconnect(end);
                    return;
                }
            }
        }
        // Normally the completion of a packet starts the next. Asking again costs little and
        // restarts the chain where a completion was lost; "would block" is the usual answer.
        let _still_sending = self.serial.flush();
    }

    fn disconnect(&mut self, end: &mut impl HostBytes) {
        UsbClass::<B>::reset(&mut self.serial);
        end.host_lost();
    }
}
