//! Lost messages are retried, and requests executed once.

use crate::support::{Device, Port, client, connected, device, ms, pump_for};
use crepitus_client::{Error, RequestKind, Transport};
use crepitus_protocol::counters::CommsCounter::{self, RepeatedRequests, Requests};
use crepitus_protocol::frame;
use crepitus_protocol::host::{Answer, Operation, Reply, Request};
use crepitus_protocol::parameters::id;
use crepitus_protocol::{Decoder, Lane, Nonce, Revision, Session, State};

#[test]
fn a_lost_reply_is_retried_and_nothing_is_executed_twice() {
    let (shared, mut client) = connected();
    let before = client.counters().unwrap();
    let (base, mut values) = client.parameters().unwrap();
    values.set(id::STATIC_TORQUE, 0.5);
    // The reply is somewhat longer than this.
    shared.borrow_mut().to_host.swallow = 8;
    assert_eq!(client.commit(base, &values).unwrap(), Revision(2));
    assert_eq!(client.tally().repeats, 1);
    let after = client.counters().unwrap();
    let counted =
        |counter: CommsCounter| after.comms[counter.index()] - before.comms[counter.index()];
    // Parameters, the commit, and these counters.
    assert_eq!((counted(Requests), counted(RepeatedRequests)), (3, 1));
    assert_eq!(client.status().unwrap().revision, Revision(2));
    let trip = client.round_trips().of(RequestKind::Commit).unwrap();
    assert_eq!(trip.count, 1);
    assert!(trip.worst >= ms(200) && trip.worst < ms(210), "{trip:?}");
}

#[test]
fn a_lost_request_is_retried() {
    let (shared, mut client) = connected();
    shared.borrow_mut().from_host.swallow = 5;
    client.zero().unwrap();
    shared.borrow_mut().from_host.swallow = 5;
    client.zero().unwrap();
    client.arm().unwrap();
    shared.borrow_mut().from_host.swallow = 5;
    client.stop().unwrap();
    assert_eq!(client.tally().repeats, 3);
}

/// They begin at 65,532. Beyond 2^32 the device would ignore them as old ones, which no session
/// reaches: at 1,000 requests a second it takes 50 days, and each start begins there again.
#[test]
fn sequence_numbers_pass_65_535() {
    let (_, mut client) = connected();
    for _ in 0..12 {
        client.status().unwrap();
    }
    assert_eq!(client.tally().repeats, 0);
}

#[test]
fn answers_to_others_and_old_ones_are_counted_and_ignored() {
    let (shared, mut client) = connected();
    let ours = client.session();
    for session in [ours, Session(7)] {
        let reply = Reply {
            session,
            number: 1_000,
            answer: Ok(Answer::Done),
        };
        let frame = frame::encode(Lane::Reply, &reply).unwrap();
        shared.borrow_mut().waiting(0).extend(&frame);
    }
    shared
        .borrow_mut()
        .waiting(0)
        .extend(&frame::encode_bytes(Lane::ManagementAnswer, b"S\x7f\x01").unwrap());
    shared
        .borrow_mut()
        .waiting(0)
        .extend(&frame::encode_body(b"T\xff....").unwrap());
    client.status().unwrap();
    let tally = client.tally();
    assert_eq!((tally.stray_answers, tally.foreign_frames), (3, 1));
    pump_for(&mut client, ms(5));
}

/// Opens a session without a client.
fn open(port: &mut Port, session: Session) -> Nonce {
    let request = Request {
        session,
        nonce: Nonce::NONE,
        number: 0,
        operation: Operation::Open,
    };
    port.send(&frame::encode(Lane::Request, &request).unwrap())
        .unwrap();
    let (mut decoder, mut buffer) = (Decoder::new(), [0; 256]);
    for _ in 0..20 {
        let count = port.receive(&mut buffer, ms(1)).unwrap();
        for byte in &buffer[..count] {
            let Some(Ok(body)) = decoder.push(*byte) else {
                continue;
            };
            match body.message() {
                Some(Reply {
                    answer: Ok(Answer::Opened { nonce }),
                    session: of,
                    ..
                }) if of == session => return nonce,
                _ => {}
            }
        }
    }
    panic!("not opened");
}

#[test]
fn requests_are_retried_while_the_device_is_busy() {
    let (shared, port) = device();
    let mut client = client(port, 1);
    let mut other = Port::new(&shared);
    let nonce = open(&mut other, Session(2));
    // Another host's work takes half a second: a command that the drive never
    // hears.
    shared.borrow_mut().link_is_cut = true;
    let request = Request {
        session: Session(2),
        nonce,
        number: 1,
        operation: Operation::Zero,
    };
    other
        .send(&frame::encode(Lane::Request, &request).unwrap())
        .unwrap();
    other.wait(ms(2));
    shared.borrow_mut().link_is_cut = false;
    client.save().unwrap();
    assert_eq!(client.tally().repeats, 0);
}

#[test]
fn a_line_that_spoils_a_byte_in_five_hundred_is_slow_and_right() {
    let (shared, mut client) = connected();
    spoil(&mut shared.borrow_mut(), 1_500);
    let (mut torque, mut before, mut unknown) = (0.4, 1, 0);
    for _ in 2..30 {
        torque += 0.01;
        let set = loop {
            match client.set(&[(id::STATIC_TORQUE, torque)]) {
                // The set may have been executed, which the error says.
                Err(Error::NoAnswer { .. }) => unknown += 1,
                other => break other.unwrap(),
            }
        };
        assert!(
            (before + 1..=before + 1 + unknown).contains(&set.0),
            "{set}"
        );
        (before, unknown) = (set.0, 0);
    }
    assert!(client.tally().repeats > 3, "{:?}", client.tally());
    assert!(client.tally().discarded_frames > 0);
    // The longest answer there is: a quarter of them arrives whole.
    let answers = (0..10).map(|_| client.parameters());
    let answer = answers.flatten().next();
    let (_, values) = answer.expect("in one of a hundred tries");
    assert_eq!(values.get(id::STATIC_TORQUE), Some(torque));
}

#[test]
fn a_line_that_spoils_bytes_keeps_the_lease() {
    let (shared, mut client) = connected();
    spoil(&mut shared.borrow_mut(), 600);
    client.zero().unwrap();
    client.arm().unwrap();
    pump_for(&mut client, ms(5_000));
    assert!(client.is_armed());
    assert!(client.tally().discarded_frames > 0);
    assert_eq!(shared.borrow().drive.state(), State::Armed);
}

/// Three kinds of disturbance, each at a rate per byte, in both directions.
fn spoil(device: &mut Device, once_in: u64) {
    for line in [&mut device.to_host, &mut device.from_host] {
        (line.lose, line.flip, line.double) = (once_in, once_in, once_in);
    }
}
