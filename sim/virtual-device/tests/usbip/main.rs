//! The USB/IP server with the genuine USB port of the comms controller, and a client of its own over
//! the loopback interface. Both ends take turns in one thread; nothing depends on how
//! long the system takes between them.

mod bench;
mod capture;
mod client;
mod hostile;
mod import;
mod messages;
mod pending;
#[path = "../port/rig.rs"]
#[allow(dead_code)] // Shared with the tests of the port, which use all of it.
mod rig;
mod transfers;
