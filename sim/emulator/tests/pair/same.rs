//! The same run twice is the same, to the last bit of both memories.

use crate::host::{arm, connected, run};
use crepitus_client::Event;
use crepitus_protocol::parameters::id::STATIC_TORQUE;

/// Hash of both chips, of every block, and of the traffic.
fn session() -> Option<(u64, Vec<u64>, String)> {
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
    let pair = &mut host.transport_mut().pair;
    Some((pair.state_hash(), ticks, format!("{:?}", pair.traffic())))
}

#[test]
fn two_runs_are_one() {
    let Some(first) = session() else { return };
    assert!(first.1.len() >= 50, "{}", first.1.len());
    assert_eq!(Some(first), session());
}
