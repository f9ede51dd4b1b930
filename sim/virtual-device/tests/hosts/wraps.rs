//! Every counter just below its wrap: nothing is noticed of it.

use crate::support::oracle::Oracle;
use crate::support::random_values;
use crate::support::{Host, examination};
use crepitus_protocol::State;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_virtual_device::Start;
use fastrand::Rng;

#[test]
fn counters_wrap_under_torque_and_between_commits() {
    const SECOND: u64 = 20_000;
    // The shaft moves by some 30,000 counts, to and fro.
    for count in [i32::MAX - 1_000, i32::MIN + 1_000, -1_000] {
        let start = Start {
            seed: 0,
            saved: None,
            tick: (1 << 32) - SECOND,
            sequence: u16::MAX - 1_000,
            count,
            counters: u32::MAX - 10,
            starts: u16::MAX - 1,
        };
        let mut host = Host::new(&examination(), &start);
        host.number = u32::from(u16::MAX) - 5;
        let kept = *host.device.board().comms().values();
        host.oracle = Some(Oracle::new(host.device.board(), kept));
        host.run(400);
        host.subscribe();
        host.samples = Some(Vec::new());
        host.arm();
        let mut rng = Rng::with_seed(3);
        for _ in 0..30 {
            let (base, values) = host.parameters();
            let values = random_values::allowed(&mut rng, &values);
            host.oracle.as_mut().expect("an oracle").propose(&values);
            let answer = host.ask(Operation::Commit { base, values });
            assert!(matches!(answer, Ok(Answer::Committed { .. })), "{answer:?}");
            host.run(SECOND / 10);
        }
        let status = host.status();
        assert_eq!(
            (status.state, status.drive_fault, status.comms_fault),
            (State::Armed, 0, 0)
        );
        assert!(status.tick > 1 << 32 && host.number > 1 << 16);
        assert!(
            host.comms_count(CommsCounter::ReceivedSamples) < 100_000,
            "has wrapped"
        );
        let accounting = host.accounting.expect("a subscription");
        assert!(accounting.received > 3 * SECOND && accounting.dropped == 0);
        assert_eq!(host.comms_count(CommsCounter::LostSamples), u32::MAX - 10);
        assert_eq!(host.drive_count(DriveCounter::LostSamples), 0);
        // Counts are counted from where the drive began.
        let samples = host.samples.take().expect("samples");
        assert!(
            samples
                .windows(2)
                .all(|w| (w[1].count - w[0].count).abs() < 10)
        );
        let block = host.last_block.expect("a block");
        assert!(block.first_tick > 1 << 32);
        assert!(block.sequence < 10_000, "has wrapped");
    }
}
