//! USB: the full-speed controller on PA11 and PA12.

use crepitus_device::usb_port::UsbIdentity;
use stm32f4xx_hal::gpio::alt::otg_fs::{Dm, Dp};
use stm32f4xx_hal::otg_fs::{USB, UsbBus};
use stm32f4xx_hal::pac::{OTG_FS_DEVICE, OTG_FS_GLOBAL, OTG_FS_PWRCLK};
use stm32f4xx_hal::rcc::Rcc;

pub use stm32f4xx_hal::otg_fs::UsbBusType;
pub use usb_device::bus::UsbBusAllocator;

/// Words of RAM for packets from the host: 64 bytes for control, 64 for data,
/// and some.
pub const PACKET_WORDS: usize = 64;

/// Digits of a serial number.
pub const DIGITS: usize = 24;

/// The controller's three register blocks.
pub type Blocks = (OTG_FS_GLOBAL, OTG_FS_DEVICE, OTG_FS_PWRCLK);

/// The bus.
pub fn bus(
    blocks: Blocks,
    minus: impl Into<Dm>,
    plus: impl Into<Dp>,
    packets: &'static mut [u32; PACKET_WORDS],
    rcc: &Rcc,
) -> UsbBusAllocator<UsbBusType> {
    let usb = USB::new(blocks, (minus, plus), &rcc.clocks);
    UsbBus::new(usb, packets)
}

/// Strings of the USB descriptors; the serial number as `crepitus info` has it.
pub fn identity<'a>(serial: &[u8; 12], digits: &'a mut [u8; DIGITS]) -> UsbIdentity<'a> {
    let digit = |value: u8| {
        if value < 10 {
            b'0' + value
        } else {
            b'a' + value - 10
        }
    };
    let all = serial.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    for (place, value) in digits.iter_mut().zip(all) {
        *place = digit(value);
    }
    UsbIdentity {
        manufacturer: "Crepitus",
        product: "Crepitus",
        serial_number: core::str::from_utf8(digits).unwrap_or_default(),
    }
}
