//! Records and observers of a microcontroller that runs an image:
//! [`crate::Stm32f405`].

use crate::time::Time;

pub use crate::pins::Pin;

/// Cause of a reset of a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reset {
    /// Power-on: memory is undefined.
    PowerOn,
    /// A brief drop of the supply: memory stays.
    BrownOut,
    /// The independent watchdog.
    Watchdog,
    /// The program has asked for it.
    Software,
    /// The pin.
    Pin,
}

/// Observer of the core: see [`crate::cycles`].
pub trait Watch {
    /// A step of the core has ended: an instruction, or the entry into an
    /// exception.
    fn step(&mut self, step: &Step);

    /// The core has accessed RAM that [`crate::Stm32f405::observe_ram`] names.
    fn ram_access(&mut self, _: &RamAccess) {}
}

/// An access of the core to observed RAM.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RamAccess {
    /// Address of the instruction.
    pub pc: u32,
    /// Address of the first byte.
    pub address: u32,
    /// Written, not read.
    pub is_write: bool,
    /// The exception being handled; 0 if none.
    pub exception: u16,
    /// Execution priority, with BASEPRI and PRIMASK: the lower, the more urgent;
    /// 256 without any exception.
    pub priority: i32,
    /// Time at which the instruction began.
    pub at: Time,
}

/// A step of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Program counter of the core before it.
    pub pc: u32,
    /// The exception being handled after it; 0 if none.
    pub exception: u16,
    /// Number of active exceptions after it.
    pub active: u32,
    /// Cycles that it took.
    pub cycles: u32,
    /// Cycles of them in which the core waited for flash or a register; 0 unless
    /// they are modelled.
    pub waits: u32,
    /// Its access to the core's cycle counter.
    pub counter: Option<CounterAccess>,
    /// Time at which it began.
    pub at: Time,
}

/// An access of an instruction to the core's cycle counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CounterAccess {
    /// It loads the counter.
    Load,
    /// It stores to it.
    Store,
}

/// An access of the program, or of the DMA, to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Time at which the instruction began.
    pub at: Time,
    /// Address of the register.
    pub address: u32,
    /// The value read or written.
    pub value: u32,
    /// Written, not read.
    pub is_write: bool,
}

/// A sampling interval of a converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// The converter, from 1 on.
    pub converter: u32,
    /// Input of the converter.
    pub channel: u32,
    /// The pin of that, if it has one.
    pub pin: Option<Pin>,
    /// Begin.
    pub begin: Time,
    /// End.
    pub end: Time,
    /// End of the conversion that follows.
    pub converted: Time,
}
