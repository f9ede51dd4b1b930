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
//! | where the images come from | [`firmware`], [`image`] |
//! | the same for a program that can do without | [`on_target`] |
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

#[cfg(feature = "core")]
mod chip;
#[cfg(feature = "core")]
pub mod cycles;
#[cfg(feature = "core")]
mod devices;
#[cfg(feature = "core")]
pub mod drive_board;
#[cfg(feature = "core")]
pub mod firmware;
#[cfg(feature = "core")]
pub mod image;
#[cfg(feature = "core")]
pub mod ladder;
#[cfg(feature = "core")]
pub mod mcu;
pub mod on_target;
#[cfg(feature = "core")]
pub mod stm32f405;
#[cfg(feature = "core")]
pub mod time;

#[cfg(feature = "core")]
pub use devices::usart::Character;
#[cfg(feature = "core")]
pub use drive_board::DriveBoard;
#[cfg(feature = "core")]
pub use image::Image;
#[cfg(feature = "core")]
pub use mcu::{Mcu, Pin, Reset};
#[cfg(feature = "core")]
pub use stm32f405::Stm32f405;
#[cfg(feature = "core")]
pub use time::Time;
