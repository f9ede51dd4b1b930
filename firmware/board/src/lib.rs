//! # Peripherals of the two boards
//!
//! Both are an STM32F405. Pins, crystal and values of the parts are those of `crepitus_device::board`;
//! [`drive_board`] and [`comms_board`] put the parts together.
//!
//! | part | on | file |
//! |---|---|---|
//! | 168 MHz from the crystal, 48 MHz for USB | both | [`clocks`] |
//! | frequency of the crystal, by the internal oscillator | both | [`crystal`] |
//! | reset cause and start counter | both | [`start`], [`reset_cause`], [`reset_record`] |
//! | post-mortem record | both | [`crash`] |
//! | identity | both | [`identity`] |
//! | fatal errors: outputs off, then reset | both | [`stop`] |
//! | memory protection: map, and write access to the outputs | both | [`mpu`] |
//! | enable line, with read-back | both | [`enable_line`] |
//! | link: UART with DMA both ways | both | [`link`] |
//! | cycles of the tasks, high-water mark of the stack | both | [`task_clock`], [`stack_mark`] |
//! | watchdog, fed when every task has run | both | [`watchdog`] |
//! | timers of the tasks | both | [`ticks`] |
//! | bridge: PWM with dead time and break | drive | [`bridge`] |
//! | converter: the motor's current | drive | [`converter`] |
//! | checksums of frames: CRC unit | both | [`crc_unit`] |
//! | encoder: 32-bit counter | drive | [`encoder`] |
//! | USB | comms | [`usb`] |
//! | parameters in flash | comms | [`flash`] |
//!
//! All `unsafe` code is in `raw.rs` and, for the entries of exceptions, in `exceptions.rs`.
//! Every wait is bounded, except before the first task.
#![cfg_attr(not(test), no_std)]

pub mod reset_cause;
pub mod reset_record;

#[cfg(target_os = "none")]
pub mod bridge;
#[cfg(target_os = "none")]
pub mod clocks;
#[cfg(target_os = "none")]
pub mod coil;
#[cfg(target_os = "none")]
pub mod comms_board;
#[cfg(target_os = "none")]
pub mod converter;
#[cfg(target_os = "none")]
pub mod crash;
#[cfg(target_os = "none")]
mod crash_record;
#[cfg(target_os = "none")]
pub mod crc_unit;
#[cfg(target_os = "none")]
mod crystal;
#[cfg(target_os = "none")]
pub mod drive_board;
#[cfg(target_os = "none")]
pub mod enable_line;
#[cfg(target_os = "none")]
pub mod encoder;
#[cfg(target_os = "none")]
mod exceptions;
#[cfg(target_os = "none")]
pub mod flash;
#[cfg(target_os = "none")]
pub mod identity;
#[cfg(target_os = "none")]
pub mod link;
#[cfg(target_os = "none")]
pub mod mpu;
#[cfg(target_os = "none")]
mod pins;
#[cfg(target_os = "none")]
mod raw;
#[cfg(target_os = "none")]
pub use raw::sleep;
#[cfg(target_os = "none")]
pub mod stack_mark;
#[cfg(target_os = "none")]
pub mod start;
#[cfg(target_os = "none")]
pub mod stop;
#[cfg(target_os = "none")]
pub mod task_clock;
#[cfg(target_os = "none")]
pub mod ticks;
#[cfg(target_os = "none")]
pub mod usb;
#[cfg(target_os = "none")]
pub mod watchdog;
