//! Interface of a microcontroller that runs an image.
//!
//! The boards of this crate use this trait only; [`crate::Stm32f405`] is the
//! one implementation, with the library `rsemu` behind it.

use crate::character::Character;
use crate::pins::PinSetup;
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
    /// Time at which it began.
    pub at: Time,
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

/// A microcontroller.
pub trait Mcu {
    /// Runs until `until`, and at most one instruction beyond.
    fn run_until(&mut self, until: Time);

    /// Runs as [`Self::run_until`] does, passing every step to `watch`. Slower.
    fn watch_until(&mut self, until: Time, watch: &mut dyn Watch);

    /// Current time.
    fn now(&self) -> Time;

    /// The core's cycles since it was switched on; none pass while it sleeps.
    fn cycles(&self) -> u64;

    /// A word of memory or of a register, without side effects; `None` at an
    /// unmapped address.
    fn peek(&self, address: u32) -> Option<u32>;

    /// Writes a word as a debugger does.
    fn poke(&mut self, address: u32, value: u32);

    /// Records every access to these registers from now on.
    fn listen(&mut self, registers: &[u32]);

    /// Takes the accesses recorded since the last call, in order.
    fn take_accesses(&mut self) -> Vec<Access>;

    /// The level at a pin, as the chip sees it.
    fn pin(&self, pin: Pin) -> bool;

    /// Drives a pin from outside.
    fn drive_pin(&mut self, pin: Pin, level: bool);

    /// The setup of a pin.
    fn pin_setup(&self, pin: Pin) -> PinSetup;

    /// Sets the voltage at a pin, as share of the converters' reference.
    fn set_analog(&mut self, pin: Pin, share: f64);

    /// Takes the sampling intervals of the converters since the last call.
    fn take_samplings(&mut self) -> Vec<Sampling>;

    /// Puts a character on the wire to the link's receiver, in order. Lost unless its pin
    /// is connected to it when it arrives.
    fn link_feed(&mut self, character: Character);

    /// Takes the characters sent by the link since the last call: those at whose ends
    /// its pin was connected to it.
    fn link_take(&mut self) -> Vec<Character>;

    /// Units of time of a character on the link, as the program has set it.
    fn link_character_units(&self) -> u64;

    /// Resets the chip.
    fn reset(&mut self, reset: Reset);

    /// Takes the chip's own resets since the last call.
    fn take_resets(&mut self) -> Vec<(Time, Reset)>;

    /// Stops the core while all else runs: like a program that hangs with
    /// interrupts masked. A reset ends it.
    fn set_hung(&mut self, is_hung: bool);

    /// Returns whether the core is in lock-up.
    fn is_locked_up(&self) -> bool;

    /// A hash of memory, core and registers, for comparing two runs.
    fn state_hash(&self) -> u64;

    /// Features used by the program that are not modelled; unmapped addresses,
    /// parts whose clock was off. Empty if all is well.
    fn not_modelled(&self) -> Vec<String>;
}
