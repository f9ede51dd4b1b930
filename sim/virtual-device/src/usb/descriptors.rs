//! Descriptors of a device and its strings (USB 2.0 section 9.6), read from whatever it sends.
//!
//! Any bytes are either a value or a [`DescriptorError`]. A descriptor may be longer than the
//! standard says (later editions append fields); it may not be shorter.

/// `bDescriptorType` of the descriptors this host knows.
pub mod descriptor_type {
    /// The device.
    pub const DEVICE: u8 = 1;
    /// A configuration, followed by all that belongs to it.
    pub const CONFIGURATION: u8 = 2;
    /// A string in UTF-16LE, or the list of languages.
    pub const STRING: u8 = 3;
    /// An interface.
    pub const INTERFACE: u8 = 4;
    /// An endpoint.
    pub const ENDPOINT: u8 = 5;
}

/// An invalid descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptorError {
    /// The bytes end inside a descriptor, or its length byte is less than 2.
    #[error("the descriptor at byte {at} is cut short")]
    Truncated {
        /// Offset of that descriptor, bytes.
        at: usize,
    },
    /// Another descriptor than the one expected here.
    #[error("a descriptor of type {found} where one of type {expected} belongs")]
    WrongType {
        /// `bDescriptorType` that belongs here.
        expected: u8,
        /// `bDescriptorType` that is here.
        found: u8,
    },
    /// A descriptor of a known type is shorter than the standard says.
    #[error("a descriptor of type {kind} has {length} bytes, at least {expected} are needed")]
    TooShort {
        /// `bDescriptorType`.
        kind: u8,
        /// `bLength`.
        length: usize,
        /// The length of the standard.
        expected: usize,
    },
    /// An endpoint before the first interface.
    #[error("the endpoint at byte {at} belongs to no interface")]
    Orphan {
        /// Offset of the endpoint's descriptor, bytes.
        at: usize,
    },
    /// A control endpoint has packets of 8, 16, 32 or 64 bytes.
    #[error("a control endpoint cannot have packets of {size} bytes")]
    ControlPacketSize {
        /// `bMaxPacketSize0`.
        size: u8,
    },
    /// A string that is not UTF-16.
    #[error("the string is not UTF-16")]
    NotUtf16,
    /// No CDC-ACM interface with a data interface that has a bulk pipe each way.
    #[error("the device is not a CDC-ACM serial port")]
    NotSerial,
}

/// The device descriptor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceDescriptor {
    /// `bcdUSB`: 0x0200 is 2.0.
    pub usb_release: u16,
    /// `bDeviceClass`.
    pub class: u8,
    /// `bDeviceSubClass`.
    pub subclass: u8,
    /// `bDeviceProtocol`.
    pub protocol: u8,
    /// `bMaxPacketSize0`: 8, 16, 32 or 64 bytes.
    pub max_packet_0: u8,
    /// `idVendor`.
    pub vendor_id: u16,
    /// `idProduct`.
    pub product_id: u16,
    /// `bcdDevice`.
    pub device_release: u16,
    /// `iManufacturer`, 0 for none.
    pub manufacturer: u8,
    /// `iProduct`, 0 for none.
    pub product: u8,
    /// `iSerialNumber`, 0 for none.
    pub serial_number: u8,
    /// `bNumConfigurations`.
    pub configurations: u8,
}

impl DeviceDescriptor {
    /// `bLength`, bytes.
    pub const LENGTH: u16 = 18;

    /// Reads a whole device descriptor.
    pub fn parse(bytes: &[u8]) -> Result<Self, DescriptorError> {
        let [
            _,
            _,
            usb0,
            usb1,
            class,
            subclass,
            protocol,
            max_packet_0,
            vendor0,
            vendor1,
            product0,
            product1,
            device0,
            device1,
            manufacturer,
            product,
            serial_number,
            configurations,
        ] = *first(bytes, descriptor_type::DEVICE)?;
        Ok(Self {
            usb_release: u16::from_le_bytes([usb0, usb1]),
            class,
            subclass,
            protocol,
            max_packet_0: control_packet_size(max_packet_0)?,
            vendor_id: u16::from_le_bytes([vendor0, vendor1]),
            product_id: u16::from_le_bytes([product0, product1]),
            device_release: u16::from_le_bytes([device0, device1]),
            manufacturer,
            product,
            serial_number,
            configurations,
        })
    }

    /// Reads `bMaxPacketSize0` from the first eight bytes of a device descriptor: all that a host
    /// can ask for before it knows that size.
    pub fn parse_max_packet_0(bytes: &[u8]) -> Result<u8, DescriptorError> {
        match *bytes {
            [_, descriptor_type::DEVICE, _, _, _, _, _, size, ..] => control_packet_size(size),
            [_, descriptor_type::DEVICE, ..] | [] | [_] => {
                Err(DescriptorError::Truncated { at: 0 })
            }
            [_, found, ..] => Err(DescriptorError::WrongType {
                expected: descriptor_type::DEVICE,
                found,
            }),
        }
    }
}

fn control_packet_size(size: u8) -> Result<u8, DescriptorError> {
    match size {
        8 | 16 | 32 | 64 => Ok(size),
        _ => Err(DescriptorError::ControlPacketSize { size }),
    }
}

/// The first language of a device's strings (string descriptor 0).
pub fn parse_first_language(bytes: &[u8]) -> Result<u16, DescriptorError> {
    let [_, _, low, high] = *first(bytes, descriptor_type::STRING)?;
    Ok(u16::from_le_bytes([low, high]))
}

/// The text of a string descriptor.
pub fn parse_string(bytes: &[u8]) -> Result<String, DescriptorError> {
    let [_, _] = *first(bytes, descriptor_type::STRING)?;
    let text = descriptor_at(bytes, 0)?.get(2..).unwrap_or_default();
    let (units, rest) = text.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(DescriptorError::NotUtf16);
    }
    char::decode_utf16(units.iter().map(|&unit| u16::from_le_bytes(unit)))
        .collect::<Result<String, _>>()
        .map_err(|_| DescriptorError::NotUtf16)
}

/// The descriptor that starts at `at`, exactly as long as it says.
pub(crate) fn descriptor_at(bytes: &[u8], at: usize) -> Result<&[u8], DescriptorError> {
    let rest = bytes.get(at..).unwrap_or_default();
    rest.first()
        .map(|&length| usize::from(length))
        .filter(|&length| length >= 2)
        .and_then(|length| rest.get(..length))
        .ok_or(DescriptorError::Truncated { at })
}

/// The first `N` bytes of the first descriptor, which must be of this type.
pub(crate) fn first<const N: usize>(
    bytes: &[u8],
    expected: u8,
) -> Result<&[u8; N], DescriptorError> {
    let descriptor = descriptor_at(bytes, 0)?;
    match descriptor.get(1) {
        Some(&found) if found != expected => {
            return Err(DescriptorError::WrongType { expected, found });
        }
        _ => {}
    }
    descriptor.first_chunk().ok_or(DescriptorError::TooShort {
        kind: expected,
        length: descriptor.len(),
        expected: N,
    })
}
