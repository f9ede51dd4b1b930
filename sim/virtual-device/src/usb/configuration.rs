//! A configuration: interfaces, endpoints, and the serial port among them (USB 2.0 section 9.6.3,
//! CDC 1.2 section 5.2).

use crate::usb::descriptors::{DescriptorError, descriptor_at, descriptor_type, first};

const CLASS_CDC: u8 = 0x02;
const CLASS_CDC_DATA: u8 = 0x0a;
const SUBCLASS_ACM: u8 = 0x02;

/// A configuration and what belongs to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigurationDescriptor {
    /// `bConfigurationValue`.
    pub value: u8,
    /// `bMaxPower`, milliamperes.
    pub max_power_ma: u16,
    /// The device has a supply of its own.
    pub is_self_powered: bool,
    /// The interfaces, each alternate setting apart.
    pub interfaces: Vec<InterfaceDescriptor>,
}

/// An interface and its endpoints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterfaceDescriptor {
    /// `bInterfaceNumber`.
    pub number: u8,
    /// `bAlternateSetting`.
    pub alternate: u8,
    /// `bInterfaceClass`.
    pub class: u8,
    /// `bInterfaceSubClass`.
    pub subclass: u8,
    /// `bInterfaceProtocol`.
    pub protocol: u8,
    /// Endpoints of the interface.
    pub endpoints: Vec<EndpointDescriptor>,
}

/// An endpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndpointDescriptor {
    /// `bEndpointAddress`: bit 7 is set for IN.
    pub address: u8,
    /// `bmAttributes`: 2 is bulk, 3 is interrupt.
    pub attributes: u8,
    /// `wMaxPacketSize`, bytes.
    pub max_packet: u16,
    /// `bInterval`, frames.
    pub interval: u8,
}

impl EndpointDescriptor {
    fn is_bulk(self) -> bool {
        self.attributes & 0b11 == 2 && (1..=64).contains(&self.max_packet)
    }

    /// Returns whether its packets come periodically: `bInterval` is how often.
    pub(crate) fn is_interrupt(self) -> bool {
        self.attributes & 0b11 == 3
    }

    pub(crate) fn is_in(self) -> bool {
        self.address & 0x80 != 0
    }

    /// The endpoint's number, without the direction.
    pub fn number(self) -> u8 {
        self.address & 0x0f
    }
}

/// The bit of a configuration's attributes.
const SELF_POWERED: u8 = 1 << 6;

impl ConfigurationDescriptor {
    /// The length of the configuration's own descriptor, bytes.
    pub const LENGTH: u16 = 9;

    /// `wTotalLength` of a configuration, bytes: what a host asks for next.
    pub fn parse_total_length(bytes: &[u8]) -> Result<u16, DescriptorError> {
        let [_, _, low, high, ..]: [u8; 9] = *first(bytes, descriptor_type::CONFIGURATION)?;
        Ok(u16::from_le_bytes([low, high]))
    }

    /// Reads a whole configuration. Descriptors of unknown types are passed over.
    pub fn parse(bytes: &[u8]) -> Result<Self, DescriptorError> {
        let [_, _, _, _, _, value, _, attributes, max_power] =
            *first(bytes, descriptor_type::CONFIGURATION)?;
        let mut interfaces: Vec<InterfaceDescriptor> = Vec::new();
        let mut at = 0;
        while at < bytes.len() {
            let descriptor = descriptor_at(bytes, at)?;
            match descriptor.get(1) {
                Some(&descriptor_type::INTERFACE) => {
                    let [_, _, number, alternate, _, class, subclass, protocol, _]: [u8; 9] =
                        *first(descriptor, descriptor_type::INTERFACE)?;
                    interfaces.push(InterfaceDescriptor {
                        number,
                        alternate,
                        class,
                        subclass,
                        protocol,
                        endpoints: Vec::new(),
                    });
                }
                Some(&descriptor_type::ENDPOINT) => {
                    let [_, _, address, attributes, size0, size1, interval] =
                        *first(descriptor, descriptor_type::ENDPOINT)?;
                    let interface = interfaces
                        .last_mut()
                        .ok_or(DescriptorError::Orphan { at })?;
                    interface.endpoints.push(EndpointDescriptor {
                        address,
                        attributes,
                        max_packet: u16::from_le_bytes([size0, size1]),
                        interval,
                    });
                }
                _ => {}
            }
            at += descriptor.len();
        }
        Ok(Self {
            value,
            is_self_powered: attributes & SELF_POWERED != 0,
            max_power_ma: u16::from(max_power) * 2,
            interfaces,
        })
    }

    /// The serial port among the interfaces: the first CDC-ACM control interface and the first
    /// CDC data interface with a bulk pipe each way.
    pub fn serial_function(&self) -> Result<SerialFunction, DescriptorError> {
        let control = self
            .interfaces
            .iter()
            .find(|interface| interface.class == CLASS_CDC && interface.subclass == SUBCLASS_ACM);
        let pipes = self
            .interfaces
            .iter()
            .filter(|interface| interface.class == CLASS_CDC_DATA)
            .find_map(|interface| {
                let mut bulk = interface.endpoints.iter().filter(|pipe| pipe.is_bulk());
                let bulk_in = bulk.clone().find(|pipe| pipe.is_in())?;
                let bulk_out = bulk.find(|pipe| !pipe.is_in())?;
                Some((*bulk_in, *bulk_out))
            });
        match (control, pipes) {
            (Some(control), Some((bulk_in, bulk_out))) => Ok(SerialFunction {
                control_interface: control.number,
                bulk_in,
                bulk_out,
            }),
            _ => Err(DescriptorError::NotSerial),
        }
    }
}

/// Place of the serial port in a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SerialFunction {
    /// The interface that takes line coding and control lines.
    pub control_interface: u8,
    /// The pipe from the device, packets of at most 64 bytes.
    pub bulk_in: EndpointDescriptor,
    /// The pipe to the device, packets of at most 64 bytes.
    pub bulk_out: EndpointDescriptor,
}
