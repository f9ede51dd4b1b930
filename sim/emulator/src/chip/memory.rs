//! Memory map of the core and the DMA.
//!
//! | address | what | core | DMA |
//! |---|---|---|---|
//! | 0, 0x0800_0000 | flash, 1 MB | yes | yes |
//! | 0x1000_0000 | CCM RAM, 64 KB | yes | no |
//! | 0x1fff_7a10 | number of the chip, bytes of flash | yes | no |
//! | 0x2000_0000 | RAM, 128 KB | yes | yes |
//! | 0x4000_0000 | peripherals | yes | yes |
//! | 0x5000_0000 | peripherals of AHB2 | yes | no |

use super::Chip;
use super::bus::Window;
use super::timed_flash::TimedFlash;
use crate::image::FLASH;
use crate::observed_ram::ObservedRam;
use crepitus_protocol::management::EMULATED_SERIAL;
use rsemu::core::space::{AddressSpace, Mapping, RamStore, Region, RegionRef, RequesterId};
use std::ops::Range;
use std::sync::Arc;

const FLASH_BYTES: u64 = 1 << 20;
pub(crate) const RAM: u32 = 0x2000_0000;
pub(crate) const RAM_BYTES: u64 = 128 << 10;
pub(crate) const CCM: u32 = 0x1000_0000;
pub(crate) const CCM_BYTES: u64 = 64 << 10;

/// Address of the system memory with number and flash size.
const SYSTEM: u64 = 0x1fff_7a00;

/// The memories that a program can change.
pub(crate) struct Memory {
    pub(crate) space: Arc<AddressSpace>,
    /// Address space of the DMA; the controllers hold it weakly.
    _dma_space: Arc<AddressSpace>,
    pub(crate) ram: Arc<RamStore>,
    pub(crate) ccm: Arc<RamStore>,
    observed: Option<Arc<ObservedRam>>,
}

impl Memory {
    pub(crate) fn new(chip: &Chip) -> Self {
        let ram = Arc::new(RamStore::new(RAM_BYTES));
        let ccm = Arc::new(RamStore::new(CCM_BYTES));
        let flash = chip.flash.region();
        let ram_region: RegionRef = Arc::new(Region::ram("RAM", ram.clone()));
        let peripherals = window(chip, 0x4000_0000, 0x8_0000);
        let space = Arc::new(AddressSpace::new("core", 32));
        let dma_space = Arc::new(AddressSpace::new("DMA", 32));
        let system = Arc::new(RamStore::new(0x40));
        write(&system, 0x10, &EMULATED_SERIAL);
        write(&system, 0x22, &1024_u16.to_le_bytes());
        let shared = [
            (flash, 0x0800_0000),
            (ram_region, u64::from(RAM)),
            (peripherals, 0x4000_0000),
        ];
        let own = [
            (shared[0].0.clone(), 0),
            (Arc::new(Region::ram("CCM", ccm.clone())), u64::from(CCM)),
            (Arc::new(Region::ram("system", system)), SYSTEM),
            (window(chip, 0x5000_0000, 0x8_0000), 0x5000_0000),
        ];
        for (region, base) in shared.iter().chain(&own) {
            map(&space, region, *base);
        }
        for (region, base) in &shared {
            map(&dma_space, region, *base);
        }
        for (n, dma) in (1..).zip(&chip.dma) {
            dma.attach_bus(&dma_space, RequesterId(n));
        }
        Self {
            space,
            _dma_space: dma_space,
            ram,
            ccm,
            observed: None,
        }
    }

    /// Writes down accesses of the core to these addresses of RAM from now on.
    pub(crate) fn observe(&mut self, ranges: &[Range<u32>]) {
        let (ram, space) = (&self.ram, &self.space);
        let observed = self.observed.get_or_insert_with(|| {
            let observed = Arc::new(ObservedRam::new(ram.clone(), RAM));
            let region = Region::io("observed RAM", RAM_BYTES, observed.clone());
            let mapping = Mapping::new(region, u64::from(RAM)).with_priority(1);
            let mapped = space.topology().map_with(mapping);
            mapped.expect("a mapping of higher priority may overlap");
            observed
        });
        observed.observe(ranges);
    }

    /// Returns whether accesses are written down.
    pub(crate) fn is_observed(&self) -> bool {
        self.observed.is_some()
    }

    /// Takes the accesses since the last call: address, whether it was a write.
    pub(crate) fn take_accesses(&self) -> Vec<(u32, bool)> {
        let observed = self.observed.as_ref();
        observed.map_or_else(Vec::new, |observed| observed.take())
    }

    /// Counts waits of the core for flash from now on.
    pub(crate) fn time_flash(&self, chip: &Chip) {
        let array = AddressSpace::new("flash", 32);
        map(&array, &chip.flash.region(), 0);
        let timed = Arc::new(TimedFlash::new(array, chip.bus.waits.clone()));
        for base in [0, u64::from(FLASH)] {
            let region = Region::io("timed flash", FLASH_BYTES, timed.clone());
            let mapping = Mapping::new(region, base).with_priority(1);
            let mapped = self.space.topology().map_with(mapping);
            mapped.expect("a mapping of higher priority may overlap");
        }
    }

    /// Makes the content undefined, as after power was off.
    pub(crate) fn forget(&self) {
        let noise = |size: u64| -> Vec<u8> {
            let bytes = (0..size).map(|n| ((n * 167) >> 3).to_le_bytes()[0]);
            bytes.collect()
        };
        write(&self.ram, 0, &noise(RAM_BYTES));
        write(&self.ccm, 0, &noise(CCM_BYTES));
    }
}

fn window(chip: &Chip, base: u32, bytes: u64) -> RegionRef {
    let window = Window {
        bus: chip.bus.clone(),
        base,
    };
    Arc::new(Region::io("peripherals", bytes, Arc::new(window)))
}

fn map(space: &AddressSpace, region: &RegionRef, base: u64) {
    let mapped = space.topology().map(region.clone(), base);
    mapped.expect("regions do not overlap");
}

fn write(store: &RamStore, at: u64, bytes: &[u8]) {
    store.write_at(at, bytes).expect("within the memory");
}
