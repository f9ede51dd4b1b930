//! Statuses: when one is sent, and its contents.

use super::*;
use crate::drive::Boot;
use crate::drive::prepare::Preparation;
use crepitus_protocol::ValueError;
use crepitus_protocol::frame::{FRAME_BYTES, SoftwareCrc};
use crepitus_protocol::link::{FromDrive, Heartbeat};
use std::vec::Vec;

struct Parts {
    command: Command,
    commits: Commits,
}

impl Shared for Parts {
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        work(&mut self.command)
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        work(&mut self.commits)
    }
}

struct Bench {
    task: LinkTask<FrameBuffer>,
    parts: Parts,
    counters: Counters,
}

impl Bench {
    fn new() -> Self {
        let (_, first) = Preparation::new().unwrap();
        let boot = Boot::default();
        Self {
            task: LinkTask::new(boot.identity, boot.start),
            parts: Parts {
                command: Command::new(&first.motor, &first.prepared.command, &boot),
                commits: Commits::default(),
            },
            counters: Counters::new(),
        }
    }

    /// The statuses in so many runs, in which the drive's clock stands still.
    fn statuses(&mut self, runs: u32) -> Vec<DriveStatus> {
        let mut statuses = Vec::new();
        for _ in 0..runs {
            let crash = |number| Part {
                number,
                words: None,
            };
            let spare = || Some([0; FRAME_BYTES]);
            let parts = &mut self.parts;
            let made = self
                .task
                .next_frame(&mut SoftwareCrc, crash, spare, parts, &self.counters);
            let Some(made) = made else { continue };
            let mut decoder = Decoder::new();
            let (_, frame) = decoder.extend(&made.buffer[..made.length]);
            match frame.unwrap().unwrap().message() {
                Some(FromDrive::Status(status)) => statuses.push(status),
                other => panic!("{other:?}"),
            }
        }
        statuses
    }
}

#[test]
fn a_status_is_sent_when_something_has_changed_and_not_before() {
    let mut bench = Bench::new();
    assert_eq!(bench.statuses(40).len(), 1, "the first one");
    assert_eq!(bench.statuses(40).len(), 0);
    let why = ValueError::NeedsDisarmed { id: 6 };
    let commits = &mut bench.parts.commits;
    commits.done((Revision(3), 0), Err(why), &bench.counters);
    let [status] = bench.statuses(40)[..] else {
        panic!("one status");
    };
    assert_eq!(status.refused, Some((Revision(3), why)));
    assert_eq!(bench.statuses(40).len(), 0);
    bench.parts.commits.restart(1);
    let [status] = bench.statuses(40)[..] else {
        panic!("one status");
    };
    assert_eq!(status.refused, None);
}

#[test]
fn a_status_has_what_is_in_force() {
    let (_, first) = Preparation::new().unwrap();
    let mut plan = first.prepared.command;
    (plan.revision, plan.comms_start) = (Revision(7), 3);
    let boot = Boot {
        start: 5,
        tick: 1_000,
        ..Boot::default()
    };
    let mut bench = Bench::new();
    bench.task = LinkTask::new(boot.identity, boot.start);
    bench.parts.command = Command::new(&first.motor, &plan, &boot);
    bench.parts.command.zero().unwrap();
    let hear = |bench: &mut Bench, start| {
        let heartbeat = Heartbeat {
            seen_tick: 1_000,
            start,
            ..Heartbeat::default()
        };
        let safety = bench.parts.command.safety_mut();
        safety.receive_heartbeat(1_000, &heartbeat, &bench.counters);
    };
    hear(&mut bench, 3);
    bench.counters.count(DriveCounter::Foreign);
    let [status] = bench.statuses(40)[..] else {
        panic!("one status");
    };
    let mut counters = [0; crepitus_protocol::counters::DRIVE_COUNT];
    bench.counters.read(&mut counters);
    let expected = DriveStatus {
        tick: 1_000,
        start: 5,
        comms_start: Some(3),
        revision: Revision(7),
        zeroed: true,
        counters,
        measured: status.measured,
        ..DriveStatus::default()
    };
    assert_eq!(status, expected);
    assert_eq!(counters.iter().sum::<u32>(), 2, "a heartbeat, and that");
    // To another boot of comms that number may be another commit's.
    hear(&mut bench, 4);
    bench.task.link.request_status();
    let [status] = bench.statuses(40)[..] else {
        panic!("one status");
    };
    let expected = (Some(4), Revision::NONE);
    assert_eq!((status.comms_start, status.revision), expected);
}

#[test]
fn what_is_measured_is_rounded() {
    let readings = SlowReadings {
        supply_v: 23.996,
        motor_c: 41.2,
        joint_span: Some(0.250_02),
    };
    let expected = Measured {
        supply_cv: 2_400,
        motor_c: 41,
        joint_cdeg: Some(9_001),
    };
    assert_eq!(measured(&readings), expected);
}
