//! Revision that each block carries.

use crate::connected;
use crate::support::random_values;
use crate::support::{Heard, Host};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{Block, SampleFlags};
use crepitus_protocol::{Revision, Values};
use crepitus_virtual_device::Controller;
use fastrand::Rng;

/// Commits, and what was heard until some blocks later; the tick in which the
/// drive took the values over.
fn commit(host: &mut Host, base: Revision, values: Values) -> (Revision, u64, Vec<Heard>) {
    let request = host.request(Operation::Commit { base, values });
    host.stream = Some(Vec::new());
    host.say(&request);
    let mut taken = None;
    for _ in 0..2_000 {
        let tick = host.device.board().drive().next_tick();
        host.tick();
        if host.device.board().drive().revision() != base {
            taken.get_or_insert(tick);
        }
    }
    let stream = host.stream.take().expect("a stream");
    let revision = stream
        .iter()
        .find_map(|heard| match heard {
            Heard::Reply(reply) => match reply.answer {
                Ok(Answer::Committed { revision }) => Some(revision),
                _ => None,
            },
            Heard::Block(_) => None,
        })
        .expect("a commit");
    (revision, taken.expect("in force"), stream)
}

fn is_settling(block: &Block) -> impl Iterator<Item = bool> {
    block
        .samples
        .iter()
        .map(|s| s.flags.has(SampleFlags::SETTLING))
}

#[test]
fn blocks_before_the_reply_have_the_old_revision_and_blocks_after_it_the_new_one() {
    // The controllers' clocks stand to each other as they like.
    for phase in 0..20 {
        let mut host = connected();
        let board = host.device.board_mut();
        board.reset_for(Controller::Drive, ResetCause::Requested, 200 + phase);
        host.run(1_000);
        host.arm();
        host.subscribe();
        echoed(host, phase);
    }
}

fn echoed(mut host: Host, phase: u64) {
    let mut rng = Rng::with_seed(phase);
    for _ in 0..20 {
        let (base, values) = host.parameters();
        let next = random_values::allowed(&mut rng, &values);
        host.run(rng.u64(0..60));
        let (revision, taken, stream) = commit(&mut host, base, next);
        assert_eq!(revision, base.next());
        let mut expected = base;
        let mut first_new: Option<&Block> = None;
        for heard in &stream {
            match heard {
                Heard::Reply(_) => expected = revision,
                Heard::Block(block) => {
                    assert_eq!(
                        block.revision, expected,
                        "phase {phase}, at {}",
                        block.first_tick
                    );
                    if block.revision == revision {
                        first_new.get_or_insert(block);
                    }
                }
            }
        }
        // The commit took effect with the first tick of a block: no block is mixed.
        let first = first_new.expect("a block");
        assert_eq!(first.first_tick, taken);
        let both_on = [&values, &next].map(|v| v.get(id::CREPITUS)) == [Some(1.0); 2];
        if both_on {
            assert!(
                is_settling(first).next().unwrap_or(false),
                "settles from its first tick on"
            );
        }
    }
}
