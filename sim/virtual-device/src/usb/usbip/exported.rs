//! Description of the device by itself, as the protocol presents it to clients.

use super::messages::DeviceRecord;
use crate::usb::enumeration::{AddressedDevice, EnumerationError};
use crate::usb::wire::UsbWire;

/// The device's name in requests: port 1 of bus 1.
pub(crate) const BUS_ID: &str = "1-1";

/// Path of the device on the server, for people.
const PATH: &str = "/crepitus/1-1";

/// The number of the bus.
const BUS: u16 = 1;

/// The device with an address, and its record.
#[derive(Clone, Debug)]
pub(crate) struct Exported {
    pub(crate) device: AddressedDevice,
    pub(crate) record: DeviceRecord,
}

impl Exported {
    /// Resets the bus, gives the device an address and reads its descriptors. Takes at least 12 ms
    /// of device time.
    pub(crate) fn read<W: UsbWire>(
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Self, EnumerationError> {
        let addressed = AddressedDevice::find(wire, run)?;
        let AddressedDevice {
            control,
            device,
            configuration,
        } = &addressed;
        let record = DeviceRecord {
            path: PATH,
            bus_id: BUS_ID,
            bus: BUS,
            number: u16::from(control.address),
            vendor_id: device.vendor_id,
            product_id: device.product_id,
            release: device.device_release,
            class: [device.class, device.subclass, device.protocol],
            // The device has just been reset.
            configuration: 0,
            configurations: device.configurations,
            interfaces: configuration
                .interfaces
                .iter()
                .filter(|interface| interface.alternate == 0)
                .map(|interface| [interface.class, interface.subclass, interface.protocol])
                .collect(),
        };
        Ok(Self {
            device: addressed,
            record,
        })
    }
}
