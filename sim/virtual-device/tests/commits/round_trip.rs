//! Duration of a commit, in time of the device.

use crate::rendering;
use crate::support::random_values;
use crate::support::set;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::{TICKS_PER_S, Values};
use fastrand::Rng;

const COMMITS: usize = 200;

/// Median and worst, ms.
fn measure(name: &str, mut change: impl FnMut(&mut Rng, &Values) -> Values) -> [f64; 2] {
    let mut host = rendering();
    let mut rng = Rng::with_seed(6);
    let mut ticks = Vec::new();
    for _ in 0..COMMITS {
        let (base, values) = host.parameters();
        let values = change(&mut rng, &values);
        host.run(rng.u64(0..400));
        let request = host.request(Operation::Commit { base, values });
        let begun = host.device.board().now();
        host.say(&request);
        // A long ramp of the change before takes longer than a host waits until
        // it asks again.
        let answer = host
            .answer_to(&request)
            .or_else(|| host.answer_to(&request));
        assert!(
            matches!(answer, Some(Ok(Answer::Committed { .. }))),
            "{answer:?}"
        );
        ticks.push(host.device.board().now() - begun);
    }
    ticks.sort_unstable();
    let ms =
        |ticks: u64| 1e3 * f64::from(u32::try_from(ticks).expect("short")) / f64::from(TICKS_PER_S);
    let [median, worst] = [ticks[COMMITS / 2], ticks[COMMITS - 1]].map(ms);
    println!("{COMMITS} commits, {name}: median {median:.2} ms, worst {worst:.2} ms");
    [median, worst]
}

#[test]
fn a_commit_is_in_force_and_answered_within_milliseconds() {
    let [median, worst] = measure("small changes", |rng, values| {
        let mut values = *values;
        set(
            &mut values,
            "crepitus.static_torque_nm",
            0.4 + 0.01 * rng.f64(),
        );
        values
    });
    assert!(median < 8.0 && worst < 10.0, "{median} {worst}");
    // A change waits until the one before has settled.
    let [median, worst] = measure("any changes", random_values::allowed);
    assert!(median < 20.0 && worst < 100.0, "{median} {worst}");
}
