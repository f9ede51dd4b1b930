//! CPU time that the pair takes.

use crate::host::{Host, arm, connected, run};
use crepitus_scene::cpu_time::{CLOCK, now, since};
use std::time::Duration;

const MEASURED_MS: u64 = 200;

/// Seconds that a second of the pair takes.
fn cost(host: &mut Host) -> f64 {
    let begin = now();
    run(host, MEASURED_MS);
    since(begin).as_secs_f64() / Duration::from_millis(MEASURED_MS).as_secs_f64()
}

#[test]
fn a_second_of_the_pair_is_timed() {
    let Some(mut host) = connected() else { return };
    arm(&mut host);
    let quiet = cost(&mut host);
    host.subscribe().expect("a subscription");
    run(&mut host, 20);
    let streaming = cost(&mut host);
    println!(
        "a second of the armed pair: {quiet:.1} s without telemetry, {streaming:.1} s with \
         20 kHz to the host ({CLOCK})"
    );
}
