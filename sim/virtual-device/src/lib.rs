//! # A device without silicon
//!
//! The real programs of both controllers, natively, with a leg that moves as
//! a scene says; the link between them, the USB cable to the host, and the
//! faults of each.
//!
//! | to find | look in |
//! |---|---|
//! | the two controllers and their lines | [`board`] |
//! | motor, encoder and leg, moved by a scene or by a hand | [`leg`] |
//! | the link, and its faults | [`wire`], [`faults`] |
//! | the device at the end of a USB cable | [`virtual_device`] |
//! | a software USB bus, and what is at its host's end | [`usb`] |
//! | flash whose power fails | [`nor_flash`] |
//!
//! Real: every line of `device`, `protocol` and `model`, and the USB stack.
//! Virtual: silicon, bus, leg and time, which advances only tick by tick.
#![forbid(unsafe_code)]

pub mod board;
pub mod faults;
pub mod leg;
pub mod nor_flash;
mod storage;
pub mod usb;
pub mod virtual_device;
pub mod wire;

pub use board::{Board, Controller, Start};
pub use faults::{FaultInjector, Faults};
pub use leg::{HandInput, Leg};
pub use virtual_device::{VirtualDevice, VirtualError};
