//! Enumeration: from a device just plugged in to a configured serial port (USB 2.0, 9.1.2).

use core::fmt;

use crate::usb::configuration::{ConfigurationDescriptor, SerialFunction};
use crate::usb::control::{ControlPipe, ControlRequest, TURNS_PER_FRAME, TransferError};
use crate::usb::descriptors::{
    DescriptorError, DeviceDescriptor, descriptor_type, parse_first_language, parse_string,
};
use crate::usb::wire::UsbWire;

/// The address this host gives: it has one port, so one device.
pub(crate) const ADDRESS: u8 = 5;

/// A device may need 10 ms after a bus reset (USB 2.0, 7.1.7.5).
const RESET_RECOVERY: u32 = 10 * TURNS_PER_FRAME;
/// A device may need 2 ms to take its new address (USB 2.0, 9.2.6.3).
const ADDRESS_RECOVERY: u32 = 2 * TURNS_PER_FRAME;

/// 115,200 baud, one stop bit, no parity, eight bits: the usual request of a serial program,
/// ignored by a device without a UART.
const LINE_CODING: [u8; 7] = [0x00, 0xc2, 0x01, 0x00, 0, 0, 8];
const CONTROL_LINES_DTR_RTS: u16 = 0b11;

mod request {
    pub(super) const SET_ADDRESS: u8 = 5;
    pub(super) const GET_DESCRIPTOR: u8 = 6;
    pub(super) const SET_CONFIGURATION: u8 = 9;
    pub(super) const SET_LINE_CODING: u8 = 0x20;
    pub(super) const SET_CONTROL_LINE_STATE: u8 = 0x22;
}

mod request_type {
    pub(super) const STANDARD_FROM_DEVICE: u8 = 0x80;
    pub(super) const STANDARD_TO_DEVICE: u8 = 0x00;
    pub(super) const CLASS_TO_INTERFACE: u8 = 0x21;
}

/// A step of the enumeration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Step {
    /// The first eight bytes of the device descriptor, for the size of control packets.
    GetPacketSize,
    /// Gives the device its address.
    SetAddress,
    /// The device descriptor.
    GetDeviceDescriptor,
    /// The configuration's own nine bytes, for the length of the whole.
    GetConfigurationLength,
    /// The configuration with its interfaces and endpoints.
    GetConfiguration,
    /// The languages of the strings.
    GetLanguages,
    /// The string of this index.
    GetString(u8),
    /// Switches the function on.
    SetConfiguration,
    /// Baud rate and format.
    SetLineCoding,
    /// DTR and RTS.
    SetControlLineState,
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::GetPacketSize => f.write_str("GET_DESCRIPTOR (device, 8 bytes)"),
            Self::SetAddress => f.write_str("SET_ADDRESS"),
            Self::GetDeviceDescriptor => f.write_str("GET_DESCRIPTOR (device)"),
            Self::GetConfigurationLength => f.write_str("GET_DESCRIPTOR (configuration, 9 bytes)"),
            Self::GetConfiguration => f.write_str("GET_DESCRIPTOR (configuration)"),
            Self::GetLanguages => f.write_str("GET_DESCRIPTOR (languages)"),
            Self::GetString(index) => write!(f, "GET_DESCRIPTOR (string {index})"),
            Self::SetConfiguration => f.write_str("SET_CONFIGURATION"),
            Self::SetLineCoding => f.write_str("SET_LINE_CODING"),
            Self::SetControlLineState => f.write_str("SET_CONTROL_LINE_STATE"),
        }
    }
}

/// Reason why a device could not be enumerated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EnumerationError {
    /// A request did not complete.
    #[error("{step}: {cause}")]
    Transfer {
        /// The request.
        step: Step,
        /// Cause of the failure.
        #[source]
        cause: TransferError,
    },
    /// The device's answer is invalid, or it is not a serial port.
    #[error("{step}: {cause}")]
    Descriptor {
        /// The request.
        step: Step,
        /// The error in the answer.
        #[source]
        cause: DescriptorError,
    },
}

/// A device with an address and its descriptors, not configured yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddressedDevice {
    /// Control endpoint of the device, for further requests.
    pub control: ControlPipe,
    /// The device descriptor.
    pub device: DeviceDescriptor,
    /// The first configuration.
    pub configuration: ConfigurationDescriptor,
}

impl AddressedDevice {
    /// Resets the bus, gives the device an address and reads its descriptors.
    ///
    /// `run` lets the device run for one turn of 50 µs; recovery times and time-outs of the
    /// standard are counted in turns.
    ///
    /// # Errors
    ///
    /// The first request that fails, and how.
    pub fn find<W: UsbWire>(
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Self, EnumerationError> {
        wire.bus_reset();
        recover(wire, run, RESET_RECOVERY);
        let mut asking = Enumerator {
            wire,
            run,
            pipe: ControlPipe {
                address: 0,
                max_packet: 8,
            },
        };

        let step = Step::GetPacketSize;
        let head = asking.descriptor(step, descriptor_type::DEVICE, 0, 0, 8)?;
        asking.pipe.max_packet = understand(step, DeviceDescriptor::parse_max_packet_0(&head))?;

        asking.set_address()?;

        let step = Step::GetDeviceDescriptor;
        let length = DeviceDescriptor::LENGTH;
        let bytes = asking.descriptor(step, descriptor_type::DEVICE, 0, 0, length)?;
        let device = understand(step, DeviceDescriptor::parse(&bytes))?;

        let step = Step::GetConfigurationLength;
        let length = ConfigurationDescriptor::LENGTH;
        let head = asking.descriptor(step, descriptor_type::CONFIGURATION, 0, 0, length)?;
        let total = understand(step, ConfigurationDescriptor::parse_total_length(&head))?;

        let step = Step::GetConfiguration;
        let bytes = asking.descriptor(step, descriptor_type::CONFIGURATION, 0, 0, total)?;
        let configuration = understand(step, ConfigurationDescriptor::parse(&bytes))?;

        Ok(Self {
            control: asking.pipe,
            device,
            configuration,
        })
    }
}

/// A configured serial port with its descriptors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CdcDevice {
    /// Control endpoint of the device, for further requests.
    pub control: ControlPipe,
    /// The device descriptor.
    pub device: DeviceDescriptor,
    /// The configuration in force.
    pub configuration: ConfigurationDescriptor,
    /// Place of the serial port.
    pub function: SerialFunction,
    /// Manufacturer.
    pub manufacturer: Option<String>,
    /// Product.
    pub product: Option<String>,
    /// Serial number.
    pub serial_number: Option<String>,
}

impl CdcDevice {
    /// Resets the bus and configures the device on it.
    ///
    /// `run` lets the device run for one turn of 50 µs, as in [`AddressedDevice::find`].
    ///
    /// # Errors
    ///
    /// The first request that fails, and how.
    pub fn enumerate<W: UsbWire>(
        wire: &mut W,
        run: &mut impl FnMut(&mut W),
    ) -> Result<Self, EnumerationError> {
        let AddressedDevice {
            control,
            device,
            configuration,
        } = AddressedDevice::find(wire, run)?;
        let function = understand(Step::GetConfiguration, configuration.serial_function())?;
        let mut asking = Enumerator {
            wire,
            run,
            pipe: control,
        };

        let [manufacturer, product, serial_number] =
            asking.strings([device.manufacturer, device.product, device.serial_number])?;

        asking.set_configuration(configuration.value)?;
        asking.set_up_line(function.control_interface)?;

        Ok(Self {
            control,
            device,
            configuration,
            function,
            manufacturer,
            product,
            serial_number,
        })
    }
}

/// The host in the middle of an enumeration.
struct Enumerator<'a, W, R> {
    wire: &'a mut W,
    run: &'a mut R,
    pipe: ControlPipe,
}

impl<W: UsbWire, R: FnMut(&mut W)> Enumerator<'_, W, R> {
    fn descriptor(
        &mut self,
        step: Step,
        kind: u8,
        number: u8,
        language: u16,
        length: u16,
    ) -> Result<Vec<u8>, EnumerationError> {
        let request = ControlRequest {
            request_type: request_type::STANDARD_FROM_DEVICE,
            request: request::GET_DESCRIPTOR,
            value: u16::from_be_bytes([kind, number]),
            index: language,
        };
        self.pipe
            .read(self.wire, self.run, request, length)
            .map_err(|cause| EnumerationError::Transfer { step, cause })
    }

    fn send(
        &mut self,
        step: Step,
        request: ControlRequest,
        data: &[u8],
    ) -> Result<(), EnumerationError> {
        self.pipe
            .write(self.wire, self.run, request, data)
            .map_err(|cause| EnumerationError::Transfer { step, cause })
    }

    fn set_address(&mut self) -> Result<(), EnumerationError> {
        let request = ControlRequest {
            request_type: request_type::STANDARD_TO_DEVICE,
            request: request::SET_ADDRESS,
            value: u16::from(ADDRESS),
            index: 0,
        };
        self.send(Step::SetAddress, request, &[])?;
        recover(self.wire, self.run, ADDRESS_RECOVERY);
        self.pipe.address = ADDRESS;
        Ok(())
    }

    /// The strings of these indices in the device's first language; index 0 is none.
    fn strings(&mut self, indices: [u8; 3]) -> Result<[Option<String>; 3], EnumerationError> {
        let mut strings = [None, None, None];
        if indices == [0; 3] {
            return Ok(strings);
        }
        let step = Step::GetLanguages;
        let bytes = self.descriptor(step, descriptor_type::STRING, 0, 0, 255)?;
        let language = understand(step, parse_first_language(&bytes))?;
        for (string, index) in strings.iter_mut().zip(indices) {
            if index != 0 {
                let step = Step::GetString(index);
                let bytes = self.descriptor(step, descriptor_type::STRING, index, language, 255)?;
                *string = Some(understand(step, parse_string(&bytes))?);
            }
        }
        Ok(strings)
    }

    fn set_configuration(&mut self, value: u8) -> Result<(), EnumerationError> {
        let request = ControlRequest {
            request_type: request_type::STANDARD_TO_DEVICE,
            request: request::SET_CONFIGURATION,
            value: u16::from(value),
            index: 0,
        };
        self.send(Step::SetConfiguration, request, &[])
    }

    /// Sets up the line as opening the port does: line coding, then DTR and RTS.
    fn set_up_line(&mut self, interface: u8) -> Result<(), EnumerationError> {
        let line_coding = ControlRequest {
            request_type: request_type::CLASS_TO_INTERFACE,
            request: request::SET_LINE_CODING,
            value: 0,
            index: u16::from(interface),
        };
        self.send(Step::SetLineCoding, line_coding, &LINE_CODING)?;
        let control_lines = ControlRequest {
            request: request::SET_CONTROL_LINE_STATE,
            value: CONTROL_LINES_DTR_RTS,
            ..line_coding
        };
        self.send(Step::SetControlLineState, control_lines, &[])
    }
}

fn understand<T>(step: Step, answer: Result<T, DescriptorError>) -> Result<T, EnumerationError> {
    answer.map_err(|cause| EnumerationError::Descriptor { step, cause })
}

fn recover<W: UsbWire>(wire: &mut W, run: &mut impl FnMut(&mut W), turns: u32) {
    for _ in 0..turns {
        run(wire);
    }
}
