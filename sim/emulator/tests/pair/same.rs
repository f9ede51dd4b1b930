//! Repeated runs are equal, to the last bit of both memories.

use crate::host::{arm, connected, run};
use crepitus_client::Event;
use crepitus_protocol::parameters::id::STATIC_TORQUE;
use std::time::{Duration, Instant};

/// Hash of both chips, every block, the traffic, and the device's time.
fn session() -> Option<(u64, Vec<u64>, String, Duration)> {
    let mut host = connected()?;
    host.subscribe().expect("a subscription");
    host.set(&[(STATIC_TORQUE, 0.5)]).expect("a commit");
    arm(&mut host);
    let mut ticks = Vec::new();
    for event in run(&mut host, 60) {
        if let Event::Block(arrival) = event {
            let sample = &arrival.block.samples[0];
            ticks.push(arrival.block.first_tick << 32 | u64::from(sample.torque_nm.to_bits()));
        }
    }
    host.disarm().expect("disarmed");
    let now = host.now();
    let pair = &mut host.transport_mut().pair;
    let traffic = format!("{:?}", pair.traffic());
    Some((pair.state_hash(), ticks, traffic, now))
}

#[test]
fn two_runs_are_one() {
    let begin = Instant::now();
    let Some(first) = session() else { return };
    let (wall, device) = (begin.elapsed(), first.3);
    println!(
        "{:.1} s of wall time for a second of both images, leg and host",
        wall.as_secs_f64() / device.as_secs_f64()
    );
    let samples = first.1.iter().fold(0, |hash: u64, sample| {
        (hash ^ sample).wrapping_mul(0x0100_0000_01b3)
    });
    println!(
        "both chips: {:016x}, samples: {samples:016x}, {}",
        first.0, first.2
    );
    assert!(first.1.len() >= 50, "{}", first.1.len());
    assert_eq!(Some(first), session());
}
