//! Wires between parts.

use super::part::lock;
use rsemu::core::device::Device;
use rsemu::core::wire::{Level, Wire, WireId, WireIdAllocator, WireSink, WireSource};
use rsemu::cpu::arm::v7m::ArmV7m;
use rsemu::dev::stm32::rcc::Rcc;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// Makes wires to a core and to devices.
pub(crate) struct Nets<'a> {
    core: &'a ArmV7m,
    ids: WireIdAllocator,
    raised: Arc<Raised>,
    interrupts: Cell<u32>,
}

/// The interrupt lines that are high, one bit each.
#[derive(Debug, Default)]
pub(crate) struct Raised {
    lines: AtomicU64,
    /// The exception of each line.
    exceptions: Mutex<Vec<u16>>,
}

impl Raised {
    /// Returns whether one is.
    pub(crate) fn any(&self) -> bool {
        self.lines.load(Relaxed) != 0
    }

    /// Returns whether something holds for the exceptions of all that are.
    pub(crate) fn all(&self, mut holds: impl FnMut(u16) -> bool) -> bool {
        let lines = self.lines.load(Relaxed);
        if lines == 0 {
            return true;
        }
        let exceptions = lock(&self.exceptions);
        let mut raised = exceptions.iter().enumerate();
        raised.all(|(line, exception)| lines >> line & 1 == 0 || holds(*exception))
    }
}

impl WireSink for Raised {
    fn set_level(&self, _: WireId, line: u32, level: Level) {
        if level.is_high() {
            self.lines.fetch_or(1_u64 << line, Relaxed);
        } else {
            self.lines.fetch_and(!(1_u64 << line), Relaxed);
        }
    }
}

impl<'a> Nets<'a> {
    pub(crate) fn new(core: &'a ArmV7m) -> Self {
        Self {
            core,
            ids: WireIdAllocator::new(),
            raised: Arc::default(),
            interrupts: Cell::new(0),
        }
    }

    /// The interrupt lines that are high.
    pub(crate) fn raised(&self) -> Arc<Raised> {
        self.raised.clone()
    }

    /// A wire to an interrupt of the core.
    pub(crate) fn interrupt(&self, number: u16) -> WireSource {
        let id = self.ids.alloc();
        let pin = self.core.sink(&format!("irq{number}"), &[id]);
        let pin = pin.expect("the core has this interrupt");
        let place = self.interrupts.get();
        assert!(place < u64::BITS, "a bit for each line");
        lock(&self.raised.exceptions).push(16 + number);
        self.interrupts.set(place + 1);
        let wire = Wire::builder()
            .source(id)
            .sink(pin.sink, pin.line)
            .sink(self.raised.clone(), place)
            .build();
        WireSource::new(Arc::new(wire), id)
    }

    /// A wire to a pin of a device of the library.
    pub(crate) fn to_device(&self, device: &dyn Device, port: &str) -> WireSource {
        let id = self.ids.alloc();
        let pin = device.sink(port, &[id]).expect("the device has this pin");
        let wire = Wire::builder().source(id).sink(pin.sink, pin.line).build();
        WireSource::new(Arc::new(wire), id)
    }

    /// A wire to the same pin of several devices of the library.
    pub(crate) fn to_devices<D: Device>(&self, devices: &[Arc<D>], port: &str) -> WireSource {
        let id = self.ids.alloc();
        let wire = devices
            .iter()
            .fold(Wire::builder().source(id), |wire, device| {
                let pin = device.sink(port, &[id]).expect("the device has this pin");
                wire.sink(pin.sink, pin.line)
            });
        WireSource::new(Arc::new(wire.build()), id)
    }

    /// A wire to one of ours.
    pub(crate) fn to(&self, sink: Arc<dyn WireSink>, line: u32) -> WireSource {
        let id = self.ids.alloc();
        let wire = Wire::builder().source(id).sink(sink, line).build();
        WireSource::new(Arc::new(wire), id)
    }
}

/// Remembers that its wire was high.
#[derive(Debug, Default)]
pub(crate) struct Latch(Arc<AtomicBool>);

impl Latch {
    pub(crate) fn new() -> Arc<Self> {
        Arc::default()
    }

    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        self.0.clone()
    }
}

impl WireSink for Latch {
    fn set_level(&self, _: WireId, _: u32, level: Level) {
        if level.is_high() {
            self.0.store(true, Relaxed);
        }
    }
}

/// The inputs of the flags that say why a chip was reset.
pub(crate) struct Causes(Vec<(&'static str, WireSource)>);

impl Causes {
    pub(crate) fn new(nets: &Nets<'_>, rcc: &Rcc) -> Self {
        let pins = ["porrst", "borrst", "pinrst", "sftrst", "iwdgrst"];
        Self(pins.map(|pin| (pin, nets.to_device(rcc, pin))).into())
    }

    /// Sets a flag.
    pub(crate) fn set(&self, name: &str) {
        for (_, source) in self.0.iter().filter(|(pin, _)| *pin == name) {
            source.set(Level::High);
            source.set(Level::Low);
        }
    }
}
