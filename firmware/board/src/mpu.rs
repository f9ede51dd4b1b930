//! Memory protection: what the program does not use it cannot access by mistake.
//!
//! | region of the drive | bytes | may |
//! |---|---|---|
//! | 0 flash | 1 M | read, execute |
//! | 1 RAM | 128 K | read, write |
//! | 2 CCM RAM, with the stack | 64 K | read, write |
//! | 3 peripherals of APB and AHB1 | 512 K | read, write |
//! | 4 TIM1 and TIM8 | 2 K | read |
//! | 5 ports A to H | 8 K | read |
//! | 6 both timers and ports | 2 × 32 K | write, while `command_motor` sets the outputs |
//! | 7 clocks and flash controller | 2 K | read |
//!
//! | region of comms | bytes | may |
//! |---|---|---|
//! | 0 flash | 1 M | read, execute |
//! | 1 parameter sectors | 32 K | read, write |
//! | 2, 3, 4 as 1, 2, 3 of the drive | | read, write |
//! | 5 bits of the clock controller, by alias | 32 K | read, write |
//! | 6 peripherals of AHB2: USB, random numbers | 512 K | read, write |
//! | 7 serial number and size of flash | 64 | read |
//!
//! The region with the highest number decides. Everything else faults, address 0 and
//! the aliases of the bits of the timers and the ports included: there is no default map.
//! Memory types are those of the default map. A violation is a `HardFault`, in which
//! the MPU is off.

use crate::raw;
use cortex_m::peripheral::MPU;

/// Enable bit of the control register. Without the others there is no default map, and
/// no MPU in `HardFault` and `NMI`.
const ON: u32 = 1;

/// Fields of a region: its enable bit, access permissions, no execution, memory type.
const ENABLED: u32 = 1;
const READ_WRITE: u32 = 0b001 << 24;
const READ_ONLY: u32 = 0b101 << 24;
const NO_EXECUTE: u32 = 1 << 28;
const WRITE_THROUGH: u32 = 0b10 << 16;
const WRITE_BACK: u32 = 0b1011 << 16;
const DEVICE: u32 = 0b01 << 16;

/// The number in a base address is valid.
const VALID: u32 = 1 << 4;

const CODE: u32 = READ_ONLY | WRITE_THROUGH;
const DATA: u32 = READ_WRITE | NO_EXECUTE | WRITE_BACK;
const CCM_DATA: u32 = READ_WRITE | NO_EXECUTE | WRITE_THROUGH;
const REGISTERS: u32 = READ_WRITE | NO_EXECUTE | DEVICE;
const READABLE_REGISTERS: u32 = READ_ONLY | NO_EXECUTE | DEVICE;

const REGIONS: usize = 8;

/// A region.
#[derive(Clone, Copy)]
struct Region {
    begin: u32,
    attributes: u32,
}

impl Region {
    const fn new(begin: u32, bytes: u32, attributes: u32) -> Self {
        assert!(bytes.is_power_of_two() && bytes >= 32 && begin.is_multiple_of(bytes));
        let size = bytes.trailing_zeros() - 1;
        Self {
            begin,
            attributes: attributes | size << 1 | ENABLED,
        }
    }

    /// Restricts the region to these eighths of it.
    const fn only(mut self, eighths: u32) -> Self {
        self.attributes |= (!eighths & 0xff) << 8;
        self
    }
}

const FLASH: Region = Region::new(0x0800_0000, 1 << 20, CODE);
const RAM: Region = Region::new(0x2000_0000, 128 << 10, DATA);
const CCM: Region = Region::new(0x1000_0000, 64 << 10, CCM_DATA);
const PERIPHERALS: Region = Region::new(0x4000_0000, 512 << 10, REGISTERS);

/// Number of the region that gives write access to the outputs.
const OUTPUTS: u32 = 6;

/// Eighths of 32 KB: from TIM1, and from port A on.
const WRITABLE_OUTPUTS: Region =
    Region::new(0x4000_0000, 256 << 10, REGISTERS).only(1 << 2 | 1 << 4);

const DRIVE: [Region; REGIONS] = [
    FLASH,
    RAM,
    CCM,
    PERIPHERALS,
    Region::new(0x4001_0000, 2 << 10, READABLE_REGISTERS),
    Region::new(0x4002_0000, 8 << 10, READABLE_REGISTERS),
    WRITABLE_OUTPUTS,
    Region::new(0x4002_3800, 2 << 10, READABLE_REGISTERS),
];

const COMMS: [Region; REGIONS] = [
    FLASH,
    // As far as the flash controller is unlocked.
    Region::new(0x0800_8000, 32 << 10, CCM_DATA),
    RAM,
    CCM,
    PERIPHERALS,
    // The HAL switches clocks by the alias of their bits.
    Region::new(0x4247_0000, 32 << 10, REGISTERS),
    Region::new(0x5000_0000, 512 << 10, REGISTERS),
    Region::new(0x1fff_7a00, 64, READABLE_REGISTERS),
];

/// Protects the memory of comms from now on.
pub fn protect_comms(mpu: &MPU) {
    protect(mpu, &COMMS);
}

fn protect(mpu: &MPU, map: &[Region; REGIONS]) {
    for (number, region) in (0..).zip(map) {
        raw::mpu_region(mpu, region.begin | VALID | number, region.attributes);
    }
    raw::mpu_control(mpu, ON);
}

/// Write access to the registers of bridge, coil and enable line.
pub struct OutputAccess {
    mpu: MPU,
}

impl OutputAccess {
    /// Protects the memory of the drive from now on, outputs included.
    pub fn protect(mpu: MPU) -> Self {
        protect(&mpu, &DRIVE);
        let access = Self { mpu };
        // Selects its region, so that one write opens and closes it.
        raw::mpu_region(&access.mpu, WRITABLE_OUTPUTS.begin | VALID | OUTPUTS, 0);
        access
    }

    /// Runs what writes to the outputs.
    pub fn write(&mut self, outputs: impl FnOnce()) {
        raw::mpu_attributes(&self.mpu, WRITABLE_OUTPUTS.attributes);
        outputs();
        raw::mpu_attributes(&self.mpu, WRITABLE_OUTPUTS.attributes & !ENABLED);
    }
}
