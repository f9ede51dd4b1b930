//! Load of the core of comms: modelled, 0 wait states.

use crate::host::{boards, connected, run};

/// Cycles in a millisecond.
const CYCLES: f64 = 168_000.0;

const MEASURED_MS: u64 = 60;

/// Share of its time that the core does not sleep, in percent.
fn load(host: &mut crate::host::Host) -> f64 {
    let before = boards(host).comms().mcu().cycles();
    run(host, MEASURED_MS);
    let cycles = boards(host).comms().mcu().cycles() - before;
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    let share = cycles as f64 / MEASURED_MS as f64 / CYCLES;
    100.0 * share
}

#[test]
fn comms_has_time_left_while_it_streams() {
    let Some(mut host) = connected() else { return };
    run(&mut host, 20);
    let quiet = load(&mut host);
    host.subscribe().expect("a subscription");
    run(&mut host, 20);
    let streaming = load(&mut host);
    println!("comms: {quiet:.1} % of its core, {streaming:.1} % while it streams (0 wait states)");
    assert!(quiet < 39.0 && streaming < 56.5);
}
