//! # The real images, on emulated silicon
//!
//! The ELF files that are flashed run instruction by instruction, with the
//! simulator's leg.
//!
//! | to find | look in |
//! |---|---|
//! | the drive with leg, link and comms | [`drive_board`] |
//! | comms with link and USB | [`comms_board`] |
//! | both, at a host's USB cable | [`pair`] |
//! | the microcontroller | [`stm32f405`] |
//! | its resets, accesses and observers | [`mcu`] |
//! | setup of pins | [`pins`] |
//! | cycles of a task | [`cycles`] |
//! | uses that the reference manual forbids | [`refusal`] |
//! | wait states and caches of flash | [`flash_interface`] |
//! | cost of a step of each solver | [`ladder`] |
//! | building and reading images | [`firmware`], [`image`] |
//! | the ladder as an optional feature | [`on_target`] |
//!
//! Time is exact and virtual: nothing reads a clock, and runs are reproducible
//! to the last bit of memory.
//!
//! # What is not modelled
//! By default, wait states of flash and registers: cycles are then *modelled,
//! 0 wait states*. [`Stm32f405::model_flash`] adds them: *modelled flash*, an
//! estimate from the reference manual, not measured on hardware. In both,
//! contention with the DMA, the write buffer and the core's own fetches ahead
//! are left out. Start-up of crystal and PLL is shortened.
//!
//! [`Stm32f405::not_modelled`] lists features that a program has used although they
//! are not modelled.
#![forbid(unsafe_code)]

#[cfg(feature = "core")]
mod character;
#[cfg(feature = "core")]
mod chip;
#[cfg(feature = "core")]
pub mod comms_board;
#[cfg(feature = "core")]
pub mod cycles;
#[cfg(feature = "core")]
mod devices;
#[cfg(feature = "core")]
pub mod drive_board;
#[cfg(feature = "core")]
pub mod firmware;
#[cfg(feature = "core")]
pub mod flash_interface;
#[cfg(feature = "core")]
pub mod image;
#[cfg(feature = "core")]
pub mod ladder;
#[cfg(feature = "core")]
pub mod mcu;
#[cfg(feature = "core")]
mod observed_ram;
pub mod on_target;
#[cfg(feature = "core")]
pub mod pair;
#[cfg(feature = "core")]
pub mod pins;
#[cfg(feature = "core")]
pub mod refusal;
#[cfg(feature = "core")]
mod state_hash;
#[cfg(feature = "core")]
pub mod stm32f405;
#[cfg(feature = "core")]
pub mod time;

#[cfg(feature = "core")]
pub use character::Character;
#[cfg(feature = "core")]
pub use comms_board::CommsBoard;
#[cfg(feature = "core")]
pub use drive_board::DriveBoard;
#[cfg(feature = "core")]
pub use image::Image;
#[cfg(feature = "core")]
pub use mcu::{Pin, Reset};
#[cfg(feature = "core")]
pub use pair::Pair;
#[cfg(feature = "core")]
pub use stm32f405::Stm32f405;
#[cfg(feature = "core")]
pub use time::Time;
