//! The post-mortem records, read by a host.

use crate::streaming;
use crate::support::Host;
use crepitus_protocol::crash::{Controller, End, Head, TICKS, Tick, ticks};
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_virtual_device::Controller as Board;

/// The words that a host reads.
fn read(host: &mut Host, controller: Controller) -> Vec<u32> {
    let mut words = Vec::new();
    for part in 0.. {
        match host.ask(Operation::ReadCrash { controller, part }) {
            Ok(Answer::CrashPart(answer)) => {
                assert_eq!(answer.number, part);
                match answer.words {
                    Some(part) => words.extend(part),
                    None => break,
                }
            }
            other => panic!("{other:?}"),
        }
    }
    words
}

#[test]
fn a_drive_that_hung_shows_its_last_ticks() {
    let mut host = streaming();
    assert_eq!(
        host.ask(Operation::ReadCrash {
            controller: Controller::Drive,
            part: 0
        }),
        Err(Refusal::Armed)
    );
    let before = host.device.board().drive().next_tick();
    let board = host.device.board_mut();
    board.reset(Board::Drive, ResetCause::Watchdog);
    host.run(4_000);
    let words = read(&mut host, Controller::Drive);
    let head = Head::of(&words).unwrap();
    assert_eq!((head.end, head.start), (End::Watchdog, 1));
    let ticks: Vec<Tick> = ticks(&words).collect();
    let numbers = ticks.iter().map(|tick| u64::from(tick.number));
    assert!(numbers.eq(before - TICKS as u64..before));
    let was_energised = |tick: &Tick| tick.sample.flags.has(SampleFlags::ENERGISED);
    assert!(ticks.iter().all(was_energised));
    assert_eq!(read(&mut host, Controller::Comms), [0; 0]);
}

#[test]
fn a_record_outlives_a_requested_restart_and_the_next_crash_replaces_it() {
    let mut host = streaming();
    host.disarm();
    for controller in [Board::Comms, Board::Drive] {
        let board = host.device.board_mut();
        board.reset(controller, ResetCause::Panic);
        host.run(2_000);
        host.reconnect();
    }
    let before = read(&mut host, Controller::Drive);
    assert_eq!(Head::of(&before).unwrap().end, End::Panic);
    let comms = read(&mut host, Controller::Comms);
    assert_eq!(Head::of(&comms).unwrap().end, End::Panic);
    assert_eq!(ticks(&comms).count(), 0);
    let board = host.device.board_mut();
    board.reset(Board::Drive, ResetCause::Requested);
    host.run(4_000);
    assert_eq!(read(&mut host, Controller::Drive), before);
    let board = host.device.board_mut();
    board.reset(Board::Drive, ResetCause::Watchdog);
    host.run(4_000);
    let after = read(&mut host, Controller::Drive);
    assert_eq!(Head::of(&after).unwrap().end, End::Watchdog);
    assert_ne!(after, before);
}
