//! The genuine USB port of the comms controller on the software bus, with a host that enumerates
//! it. Nothing sleeps and nothing is random: a turn is one poll of the device.

mod enumeration;
mod loss;
mod rig;
mod traffic;
