//! # The real images, on emulated silicon
//!
//! The ELF files that are flashed, instruction by instruction, with the same
//! simulated leg as everywhere.
//!
//! | to find | look in |
//! |---|---|
//! | the drive with leg, link and comms | [`drive_board`] |
//! | what a microcontroller is here | [`mcu`] |
//! | the one there is | [`stm32f405`] |
//! | which cycles a task takes | [`cycles`] |
//! | what a step of each solver costs | [`ladder`] |
//! | where the images come from | [`firmware`], [`elf`] |
//!
//! Time is exact and virtual: nothing reads a clock, and two runs of the same
//! are the same to the last bit of memory.
//!
//! # What is not modelled
//! Wait states of flash and its cache, contention on the bus, time that DMA
//! takes: cycles are *modelled, 0 wait states*, never measured. Start-up of
//! crystal and PLL is shortened. See [`mcu::Mcu::not_modelled`] for what a
//! program has used in vain.
#![forbid(unsafe_code)]

mod chip;
pub mod cycles;
mod devices;
pub mod drive_board;
pub mod elf;
pub mod firmware;
pub mod ladder;
pub mod mcu;
pub mod stm32f405;
pub mod time;

pub use devices::usart::Character;
pub use drive_board::DriveBoard;
pub use elf::Image;
pub use mcu::{Mcu, Pin, Reset};
pub use stm32f405::Stm32f405;
pub use time::Time;
