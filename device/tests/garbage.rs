//! Invalid frames of any length change nothing but counters.

mod support;

use crepitus_device::comms::Inputs;
use crepitus_device::counters::Counters;
use crepitus_device::usb_port::HostBytes;
use crepitus_device::{Comms, Drive};
use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::frame::encode_body;
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::{Lane, State};
use support::{Bench, Boots};

/// Two packets and two bytes: every length at which USB or COBS could err.
const LONGEST: usize = 130;

/// Invalid bodies of this length: of an unknown lane, and of each lane with
/// invalid bytes.
fn bodies(length: usize) -> Vec<Vec<u8>> {
    let mut bodies = vec![vec![0; length], vec![0xff; length]];
    for lane in Lane::ALL {
        let mut body = vec![0x5a; length];
        for (place, byte) in body.iter_mut().zip([lane.byte(), lane.tag()]) {
            *place = byte;
        }
        bodies.push(body);
    }
    bodies
}

/// All bytes queued for the host.
fn sent(comms: &mut Comms) -> Vec<u8> {
    let mut all = Vec::new();
    while !comms.to_send().is_empty() {
        let run = comms.to_send().to_vec();
        comms.sent(run.len());
        all.extend(run);
    }
    all
}

fn sum(counters: &Counters) -> u32 {
    let mut all = [0; DRIVE_COUNT];
    counters.read(&mut all);
    all.iter().sum()
}

#[test]
fn bodies_of_every_length_do_nothing_to_comms() {
    let mut comms = Comms::new(&Boots::new().comms);
    let mut drive_side = Comms::new(&Boots::new().comms);
    assert_eq!(sent(&mut comms), [0]);
    let (mut short, mut foreign) = (0, 0);
    for length in 0..=LONGEST {
        for body in bodies(length) {
            let frame = encode_body(&body).unwrap();
            comms.received(&frame);
            for byte in frame {
                drive_side.link_received(byte);
            }
            *(if length < 2 { &mut short } else { &mut foreign }) += 1;
        }
        for comms in [&mut comms, &mut drive_side] {
            let outputs = comms.tick(&Inputs::default());
            assert!(!outputs.enable && !outputs.reboot && outputs.save.is_none());
        }
    }
    assert_eq!(sent(&mut comms), [], "nothing is answered");
    for (comms, discarded, frames) in [
        (
            &comms,
            CommsCounter::FromHostDiscarded,
            CommsCounter::FromHost,
        ),
        (
            &drive_side,
            CommsCounter::FromDriveDiscarded,
            CommsCounter::FromDrive,
        ),
    ] {
        let counters = comms.counters();
        assert_eq!(counters.get(discarded), short);
        assert_eq!(counters.get(CommsCounter::Foreign), foreign);
        assert_eq!(counters.get(frames), 0);
        assert_eq!(counters.all().iter().sum::<u32>(), short + foreign);
        assert_eq!(comms.state(), State::Disarmed);
        assert_eq!(comms.revision().0, 1);
    }
}

#[test]
fn bodies_of_every_length_do_nothing_to_the_drive() {
    let mut drive = Drive::new(&Boots::new().drive).unwrap();
    let (mut short, mut foreign) = (0, 0);
    for length in 0..=LONGEST {
        for body in bodies(length) {
            for byte in encode_body(&body).unwrap() {
                drive.link_received(byte);
            }
            *(if length < 2 { &mut short } else { &mut foreign }) += 1;
        }
        drive.prepare();
    }
    let counters = drive.counters();
    assert_eq!(counters.get(DriveCounter::Discarded), short);
    assert_eq!(counters.get(DriveCounter::Foreign), foreign);
    assert_eq!(sum(counters), short + foreign);
    assert_eq!((drive.state(), drive.revision().0), (State::Disarmed, 0));
    assert!(!drive.take_reboot());
}

/// Arming waits until the drive has reported its version: another one might take a frame for
/// something else.
#[test]
fn a_drive_of_unknown_version_is_not_armed() {
    let mut bench = Bench::new(&Boots::new());
    bench.loses_hello = true;
    bench.settle();
    assert_eq!(bench.ask(Operation::Zero), Ok(Answer::Done));
    assert_eq!(bench.ask(Operation::Arm), Err(Refusal::Busy));
    bench.loses_hello = false;
    bench.run_leased(60);
    assert_eq!(bench.ask(Operation::Arm), Ok(Answer::Done));
}
