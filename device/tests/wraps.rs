//! A device whose counters start just below their wrap.

mod support;

use crepitus_device::Drive;
use crepitus_device::drive::command::Inputs;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::link::{DriveStatus, FromDrive, Order, ToDrive};
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::{Decoder, Lane, Revision, State, Values, frame};
use support::{Bench, Boots};

fn boots() -> Boots {
    let mut boots = Boots::new();
    boots.drive.tick = (1 << 32) - 4_000;
    boots.drive.sequence = u16::MAX - 300;
    boots.drive.counter = 0x7fff_ffff - 40;
    boots.drive.start = u16::MAX;
    boots.comms.counters = u32::MAX - 3;
    boots.comms.start = u16::MAX;
    boots.comms.saved = Some((Revision(u32::MAX), Values::default()));
    boots
}

#[test]
fn a_device_works_through_every_wrap() {
    let mut bench = Bench::new(&boots());
    bench.number = u32::from(u16::MAX) - 3;
    bench.settle();
    assert_eq!(bench.drive.revision(), Revision(u32::MAX));
    let Ok(Answer::Subscribed {
        first_tick,
        dropped,
        ..
    }) = bench.ask(Operation::Subscribe)
    else {
        panic!("no subscription");
    };
    let mut values = Values::default();
    values.set(id::STATIC_TORQUE, 0.5);
    let commit = Operation::Commit {
        base: Revision(u32::MAX),
        values,
    };
    let committed = Answer::Committed {
        revision: Revision(1),
    };
    assert_eq!(bench.ask(commit), Ok(committed));
    assert_eq!(bench.ask(Operation::Zero), Ok(Answer::Done));
    assert_eq!(bench.ask(Operation::Arm), Ok(Answer::Done));
    bench.motor.hand_nm = 1.0;
    bench.run_leased(600);
    assert_eq!(bench.comms.state(), State::Armed);
    assert_eq!(bench.ask(Operation::Disarm), Ok(Answer::Done));
    assert!(bench.number > 1 << 16, "numbers of requests do not wrap");
    bench.run_leased(3);

    check_accounting(&bench.blocks, first_tick, dropped);
    let first = bench.blocks.first().unwrap();
    let last = bench.blocks.last().unwrap();
    assert!(first.first_tick < 1 << 32 && last.first_tick > 1 << 32);
    assert!(last.sequence < first.sequence);
    assert_eq!(last.revision, Revision(1));
    let counter = bench.motor.counter();
    assert!(counter > 0x8000_0000, "the count has wrapped: {counter:#x}");
    let comms = bench.comms.counters();
    for counter in [CommsCounter::FromDrive, CommsCounter::ReceivedSamples] {
        assert!(comms.get(counter) < 1_000_000, "{counter:?} has wrapped");
    }
    assert_eq!(comms.get(CommsCounter::Faults), u32::MAX - 3);
    assert_eq!(comms.get(CommsCounter::LostSamples), u32::MAX - 3);
    let drive = bench.drive.counters();
    assert_eq!(drive.get(DriveCounter::Faults), 0);
    assert_eq!(drive.get(DriveCounter::LostSamples), 0);
    assert_eq!(drive.get(DriveCounter::Armings), 1);
}

/// No sample is missing, and none jumps.
fn check_accounting(blocks: &[Block], first_tick: u64, dropped: u32) {
    let samples = BLOCK_SAMPLES as u64;
    let mut received = 0;
    for (block, next) in blocks.iter().zip(&blocks[1..]) {
        received += samples;
        assert_eq!(block.first_tick + samples - first_tick, received);
        assert_eq!(block.dropped, dropped);
        assert_eq!(next.sequence, block.sequence.wrapping_add(1));
    }
    let counts: Vec<_> = blocks
        .iter()
        .flat_map(|block| block.samples.map(|sample| sample.count))
        .collect();
    for pair in counts.windows(2) {
        assert!(pair[0].wrapping_sub(pair[1]).unsigned_abs() < 20);
    }
}

/// With a host that does not read, dropped samples are accounted for through the
/// wrap of ticks, sequence numbers and the counters of comms.
#[test]
fn dropped_samples_are_accounted_for_through_the_wrap() {
    let mut bench = Bench::new(&boots());
    bench.settle();
    let Ok(Answer::Subscribed {
        first_tick,
        dropped: before,
        ..
    }) = bench.ask(Operation::Subscribe)
    else {
        panic!("no subscription");
    };
    for n in 0..400 {
        if (50..250).contains(&n) {
            bench.device_millisecond();
        } else {
            bench.millisecond();
        }
    }
    let mut received = 0;
    for block in &bench.blocks {
        received += BLOCK_SAMPLES as u64;
        let produced = block.first_tick + BLOCK_SAMPLES as u64 - first_tick;
        let dropped = block.dropped.wrapping_sub(before);
        assert_eq!(produced, received + u64::from(dropped));
    }
    let last = bench.blocks.last().unwrap();
    let last_dropped = last.dropped.wrapping_sub(before);
    assert!(last_dropped > 2_000 && last.first_tick > 1 << 32);
    let counters = bench.comms.counters();
    let [sent, dropped] = [CommsCounter::SentSamples, CommsCounter::DroppedSamples]
        .map(|counter| u64::from(counters.get(counter).wrapping_sub(u32::MAX - 3)));
    assert_eq!((sent, dropped), (received, u64::from(last_dropped)));
}

/// Sequence numbers of commands wrap.
#[test]
fn command_sequence_numbers_wrap() {
    let mut drive = Drive::new(&boots().drive).unwrap();
    for number in [0xfffe, 0xffff, 0, 1] {
        for _ in 0..200 {
            drive.sample_encoder(0);
            drive.render_torque();
            drive.command_motor(&Inputs::default());
        }
        let command = ToDrive::Command {
            seen_tick: drive.next_tick(),
            number,
            order: Order::Zero,
        };
        // Sent twice, executed once.
        for _ in 0..2 {
            for byte in frame::encode(Lane::ToDrive, &command).unwrap() {
                drive.link_received(byte);
            }
        }
        let last = status(&mut drive).last.unwrap();
        assert_eq!((last.number, last.result), (number, Ok(())));
        assert_eq!(drive.counters().get(DriveCounter::StaleCommands), 0);
    }
}

/// The drive's last status.
fn status(drive: &mut Drive) -> DriveStatus {
    let mut decoder = Decoder::new();
    let mut last = None;
    for frame in (0..100).filter_map(|_| drive.link_to_send(true)) {
        for byte in frame {
            if let Some(Ok(body)) = decoder.push(byte)
                && body.lane() == Some(Lane::FromDrive)
            {
                let Some(FromDrive::Status(status)) = body.message() else {
                    panic!("no status");
                };
                last = Some(status);
            }
        }
    }
    last.unwrap()
}
