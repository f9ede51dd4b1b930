//! # What the two boards have on them
//!
//! Both are an STM32F405 with a crystal of 8 MHz. `docs/hardware.md` has the
//! wiring; the pins stand in [`drive_board`] and [`comms_board`], once.
//!
//! | part | on | file |
//! |---|---|---|
//! | 168 MHz from the crystal, 48 MHz for USB | both | [`clocks`] |
//! | why it has started, and which start this is | both | [`start`], [`reset_cause`], [`kept`] |
//! | who it is | both | [`who`] |
//! | what is done when a program cannot go on | both | [`stop`] |
//! | enable line, with read-back | both | [`enable_line`] |
//! | link: UART with DMA both ways | both | [`link`] |
//! | watchdog, fed when every task has run | both | [`watchdog`] |
//! | timers of the tasks | both | [`ticks`] |
//! | bridge: PWM with dead time and break | drive | [`bridge`] |
//! | converter: the motor's current | drive | [`converter`] |
//! | encoder: 32-bit counter | drive | [`encoder`] |
//! | USB | comms | [`usb`] |
//! | parameters in flash | comms | [`parameter_log`], [`parameter_record`], [`flash`] |
//!
//! What the compiler cannot check stands in `raw.rs`, one short file.
//! Nothing here waits without a bound but what stands before the first task.
#![cfg_attr(not(test), no_std)]

pub mod kept;
pub mod parameter_log;
pub mod parameter_record;
pub mod reset_cause;

#[cfg(target_os = "none")]
pub mod bridge;
#[cfg(target_os = "none")]
pub mod clocks;
#[cfg(target_os = "none")]
pub mod comms_board;
#[cfg(target_os = "none")]
pub mod converter;
#[cfg(target_os = "none")]
pub mod drive_board;
#[cfg(target_os = "none")]
pub mod enable_line;
#[cfg(target_os = "none")]
pub mod encoder;
#[cfg(target_os = "none")]
pub mod flash;
#[cfg(target_os = "none")]
pub mod link;
#[cfg(target_os = "none")]
mod raw;
#[cfg(target_os = "none")]
pub mod start;
#[cfg(target_os = "none")]
pub mod stop;
#[cfg(target_os = "none")]
pub mod ticks;
#[cfg(target_os = "none")]
pub mod usb;
#[cfg(target_os = "none")]
pub mod watchdog;
#[cfg(target_os = "none")]
pub mod who;
