//! Commits that come faster than the joint settles: each waits for the one
//! before it.

use crate::host::{Flash, Host, examination, image};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::{Revision, TICK_S, Values, parameters};

/// Change of both limits of the joint, N·m, and the rate at which they may change:
/// a ramp of 50 ms.
const CHANGE_NM: f64 = 0.1;
const SLEW_NM_PER_S: f64 = 2.0;

fn id(name: &str) -> u8 {
    parameters::find(name).expect("a parameter").0
}

fn value(values: &Values, name: &str) -> f64 {
    values.get(id(name)).expect("a value")
}

/// Commits values with `added` to both limits of the joint, which keeps the
/// rest; the new revision.
fn commit(host: &mut Host, added: f64) -> Revision {
    let Ok(Answer::Parameters {
        revision,
        mut values,
    }) = host.ask(Operation::Parameters)
    else {
        panic!("no parameters");
    };
    for name in ["crepitus.static_torque_nm", "crepitus.kinetic_torque_nm"] {
        values.set(id(name), value(&values, name) + added);
    }
    values.set(id("limits.slew_nm_per_s"), SLEW_NM_PER_S);
    let asked = Operation::Commit {
        base: revision,
        values,
    };
    match host.ask(asked) {
        Ok(Answer::Committed { revision, .. }) => revision,
        other => panic!("not committed: {other:?}"),
    }
}

#[test]
fn a_commit_waits_until_the_one_before_has_settled() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.arm();
    host.run_until_torque();
    let ramp_ticks = CHANGE_NM / (SLEW_NM_PER_S * TICK_S);
    let first = commit(&mut host, CHANGE_NM);
    let second = commit(&mut host, -CHANGE_NM);
    let mut starts = [None; 2];
    for _ in 0..200 {
        host.run(20);
        for (start, revision) in starts.iter_mut().zip([first, second]) {
            let block = host.blocks.iter().find(|block| block.revision == revision);
            *start = block.map(|block| block.first_tick);
        }
        if let [Some(first), Some(second)] = starts {
            println!("applied at ticks {first} and {second}, ramp {ramp_ticks} ticks");
            #[expect(clippy::cast_precision_loss, reason = "ticks of a test")]
            let apart = (second - first) as f64;
            assert!(
                apart >= ramp_ticks - 1.0,
                "applied after {apart} ticks of a ramp of {ramp_ticks}"
            );
            return;
        }
    }
    panic!("not applied: {starts:?}");
}

/// The pieces of a commit take every second run of the link's task, and with its blocks
/// the link is nearly full: those that wait meanwhile have to find a place in the queue.
#[test]
fn a_commit_every_thirty_milliseconds_drops_no_block() {
    let Some(image) = image() else { return };
    let mut host = Host::timed(&image, &examination(), &[], Flash::Modelled);
    host.arm();
    host.run_until_torque();
    host.blocks.clear();
    for n in 0..10 {
        commit(&mut host, if n % 2 == 0 { 1e-3 } else { -1e-3 });
        host.run(500);
    }
    let [first, .., last] = &host.blocks[..] else {
        panic!("no blocks");
    };
    assert_eq!(last.dropped, first.dropped);
    let sequences = host.blocks.iter().map(|block| block.sequence);
    assert!(sequences.eq((first.sequence..).take(host.blocks.len())));
}
