//! # A device without silicon
//!
//! The real programs of both controllers, natively, with a leg that somebody
//! moves as a scene says; the link between them, the USB cable to the host,
//! and everything that can go wrong with any of it.
//!
//! | to find | look in |
//! |---|---|
//! | the two controllers and their lines | [`board`] |
//! | what their peripherals touch | [`leg`] |
//! | the link, and its faults | [`wire`], [`faults`] |
//! | the device at the end of a USB cable | [`virtual_device`] |
//! | the parameters that a scene calls for | [`values`] |
//!
//! Real: every line of `device`, `protocol` and `model`, and the USB stack.
//! Virtual: silicon, bus, leg and time, which goes on only as it is made to.
#![forbid(unsafe_code)]

pub mod board;
pub mod faults;
pub mod leg;
pub mod values;
pub mod virtual_device;
pub mod wire;

pub use board::{Board, Controller, Start};
pub use faults::{FaultInjector, Faults};
pub use leg::Leg;
pub use virtual_device::{VirtualDevice, VirtualError};
