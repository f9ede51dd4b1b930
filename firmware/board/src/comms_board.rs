//! The board of comms: which part is on which pin.

use crate::clocks;
use crate::crc_unit::CrcUnit;
use crate::enable_line::EnableLine;
use crate::flash::ParameterSectors;
use crate::identity::identity;
use crate::link::{BUFFERS, DmaBuffer, Link};
use crate::pins::Ports;
use crate::pins::comms::Pins;
use crate::start::{Start, start};
use crate::ticks::Quarters;
use crate::usb::{self, PACKET_WORDS, UsbBusType};
use crepitus_device::parameter_log::ParameterLog;
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::management::{Identity, Role};
use stm32f4xx_hal::pac::{IWDG, Peripherals};
use stm32f4xx_hal::prelude::*;
use usb_device::bus::UsbBusAllocator;

/// Parts of the board of comms.
pub struct CommsBoard {
    /// Reset cause and start counter.
    pub start: Start,
    /// Identity for a hello.
    pub identity: Identity,
    /// Result of the self-test.
    pub self_test: SelfTest,
    /// Crystal as measured, Hz.
    pub crystal_hz: u32,
    /// Enable line.
    pub line: EnableLine,
    /// Link to the drive.
    pub link: Link,
    /// Checksums of what the link receives.
    pub crc_unit: CrcUnit,
    /// USB.
    pub bus: UsbBusAllocator<UsbBusType>,
    /// Sectors 2 and 3 of flash.
    pub log: ParameterLog<ParameterSectors>,
    /// Starts `tick`.
    pub quarters: Quarters,
    /// Started last.
    pub watchdog: IWDG,
}

impl CommsBoard {
    /// Sets up the board with outputs off. May erase a sector of flash, which
    /// takes up to a second.
    pub fn new(
        chip: Peripherals,
        packets: &'static mut [u32; PACKET_WORDS],
        buffers: [DmaBuffer; BUFFERS],
    ) -> Self {
        let (mut rcc, crystal_hz) = clocks::start(chip.RCC, &chip.TIM11);
        let start = start(&mut rcc, &chip.RNG);
        let pins = Pins::of(Ports {
            a: chip.GPIOA.split(&mut rcc),
            b: chip.GPIOB.split(&mut rcc),
            c: chip.GPIOC.split(&mut rcc),
        });
        let line = EnableLine::new(pins.line, pins.line_back);
        let wires = (pins.link_sends, pins.link_receives);
        let blocks = (chip.OTG_FS_GLOBAL, chip.OTG_FS_DEVICE, chip.OTG_FS_PWRCLK);
        let option_bytes = chip.FLASH.optcr().read().bits();
        let (identity, self_test) = identity(Role::Comms, &start, option_bytes, crystal_hz);
        Self {
            start,
            identity,
            self_test,
            crystal_hz,
            line,
            log: ParameterLog::open(ParameterSectors::new(chip.FLASH)),
            link: Link::new(&chip.USART6, chip.DMA2, wires, buffers, &mut rcc),
            crc_unit: CrcUnit::new(chip.CRC, &mut rcc),
            bus: usb::bus(blocks, pins.usb_minus, pins.usb_plus, packets, &rcc),
            quarters: Quarters::start(chip.TIM2, &mut rcc),
            watchdog: chip.IWDG,
        }
    }
}
