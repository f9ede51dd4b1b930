//! Invalid frames of any length change nothing but counters.

mod support;

use crepitus_device::comms::Inputs;
use crepitus_device::counters::Counters;
use crepitus_device::usb_port::HostBytes;
use crepitus_device::{Comms, Drive};
use crepitus_protocol::counters::DRIVE_COUNT;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::frame::{encode_body, encode_bytes};
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply};
use crepitus_protocol::management::{self, Action, ManagementRequest};
use crepitus_protocol::{Decoder, Lane, State};
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

/// A device works normally after noise, half a frame, delimiters, and a frame
/// that never ends.
#[test]
fn garbage_before_the_first_frame_is_discarded() {
    let half = encode_bytes(Lane::Management, b"H\x07").unwrap();
    for garbage in [
        &b"AT+CGMM\r\n"[..],
        &half[..4],
        &[0; 70],
        &[0xff; 700],
        &[2, 2, 0, 1, 1, 0, 5],
    ] {
        let mut bench = Bench::new(&Boots::new());
        for byte in garbage {
            bench.comms.received(&[*byte]);
            bench.comms.link_received(*byte);
            bench.drive.link_received(*byte);
        }
        // The delimiter that a host sends first; the link has none, and loses
        // a frame.
        bench.comms.received(&[0]);
        assert!(matches!(
            bench.ask(Operation::Status),
            Ok(Answer::Status(_))
        ));
        bench.settle();
        assert_eq!(bench.ask(Operation::Zero), Ok(Answer::Done));
        assert_eq!(bench.ask(Operation::Arm), Ok(Answer::Done));
        assert_eq!(bench.ask(Operation::Disarm), Ok(Answer::Done));
    }
}

/// A request lost to garbage before it is retried with its sequence number and
/// carried out once.
#[test]
fn a_request_that_was_lost_is_repeated() {
    let mut bench = Bench::new(&Boots::new());
    bench.open();
    bench.comms.received(b"no delimiter follows");
    bench.number = 7;
    bench.tell(Operation::Parameters);
    bench.millisecond();
    let requests = |bench: &Bench| bench.comms.counters().get(CommsCounter::Requests);
    assert_eq!(requests(&bench), 1, "the opening");
    sent(&mut bench.comms);
    for _ in 0..3 {
        bench.tell(Operation::Parameters);
    }
    let (mut decoder, mut replies) = (Decoder::new(), 0);
    for byte in sent(&mut bench.comms) {
        if let Some(Ok(body)) = decoder.push(byte) {
            let reply: Reply = body.message().unwrap();
            assert!(matches!(reply.answer, Ok(Answer::Parameters { .. })));
            replies += 1;
        }
    }
    assert_eq!((requests(&bench), replies), (2, 3));
}

/// Extra bytes of a management request, from a later version, are ignored.
#[test]
fn a_longer_management_request_is_answered() {
    let mut comms = Comms::new(&Boots::new().comms);
    sent(&mut comms);
    let question = ManagementRequest {
        action: Action::Hello,
        token: 200,
    };
    for extra in 0..=LONGEST {
        let bytes = [&question.bytes()[..], &vec![1; extra]].concat();
        comms.received(&encode_bytes(Lane::Management, &bytes).unwrap());
        let answer = sent(&mut comms);
        let mut decoder = Decoder::new();
        let mut tokens = Vec::new();
        for byte in answer {
            if let Some(Ok(body)) = decoder.push(byte) {
                tokens.push(management::Answer::of(body.payload).unwrap().token());
            }
        }
        assert_eq!(tokens, [200]);
    }
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
