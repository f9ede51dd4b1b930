//! Hosts: those that vanish, those that do not read, two at once, and those
//! that talk nonsense.

#[path = "../support/mod.rs"]
mod support;

mod cable;
mod crash;
mod lent_cable;
mod nonsense;
mod reboot;
mod replay;
mod requests;
mod two_hosts;

use crepitus_virtual_device::Start;
use support::{Host, examination};

/// A host whose device has its parameters.
fn connected() -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host
}

/// One that renders torque, and streams.
fn streaming() -> Host {
    let mut host = connected();
    host.subscribe();
    host.arm();
    host.run(4_000);
    host
}
