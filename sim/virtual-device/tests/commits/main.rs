//! Parameters that change while the device runs: all or nothing, between two
//! blocks, and never faster than the slew limit.

#[path = "../support/mod.rs"]
mod support;

mod continuity;
mod echo;
mod refusals;
mod round_trip;

use crepitus_virtual_device::Start;
use support::{Host, examination};

fn connected() -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host
}

/// One that renders torque on a leg that moves.
fn rendering() -> Host {
    let mut host = connected();
    host.subscribe();
    host.arm();
    host.run(6_000);
    host
}
