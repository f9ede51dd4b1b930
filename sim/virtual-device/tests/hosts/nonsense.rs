//! Bytes that mean nothing, and those of another version.

use crate::{connected, streaming};
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::frame::{self, DELIMITER};
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::management::{Action, Answer, Role};
use crepitus_protocol::{Lane, State, schema};
use fastrand::Rng;

#[test]
fn garbage_before_the_first_frame_costs_at_most_that_frame() {
    let mut rng = Rng::with_seed(1);
    for length in [1, 63, 64, 65, 1_000, 5_000] {
        let mut host = connected();
        let garbage: Vec<u8> = (0..length).map(|_| rng.u8(..)).collect();
        host.send(&garbage);
        host.run(2_000);
        // The first one ends the garbage, if it does not end by itself.
        host.try_ask(Operation::Status, 1);
        assert!(
            host.try_ask(Operation::Status, 1).is_some(),
            "after {length} bytes"
        );
        assert!(host.comms_count(CommsCounter::FromHostDiscarded) > 0);
    }
}

/// A question that a later version has made longer, in a frame of this length.
fn question(length: usize, token: u8) -> Vec<u8> {
    let mut payload = vec![b'H', token];
    loop {
        let frame = frame::encode_bytes(Lane::Management, &payload).expect("a frame");
        if frame.len() == length {
            return frame.to_vec();
        }
        assert!(frame.len() < length);
        payload.push(1);
    }
}

#[test]
fn frames_of_every_length_are_received_or_counted() {
    const SHORTEST: u8 = 10;
    let mut host = streaming();
    for length in 0..=130_u8 {
        if length < SHORTEST {
            // Too short for any message.
            let discarded = host.comms_count(CommsCounter::FromHostDiscarded);
            let mut bytes = vec![1; usize::from(length)];
            bytes.push(DELIMITER);
            host.send(&bytes);
            host.run(100);
            let more = host.comms_count(CommsCounter::FromHostDiscarded) - discarded;
            assert_eq!(more, u32::from(length > 0), "{length}");
        } else {
            host.send(&question(usize::from(length), length));
            let answer = host.managed(length);
            assert!(matches!(answer, Some(Answer::Hello { .. })), "{length}");
        }
    }
    assert_eq!(host.status().state, State::Armed);
    assert_eq!(host.accounting.expect("a subscription").dropped, 0);
}

#[test]
fn a_host_of_another_version_can_say_hello_and_stop() {
    let mut host = streaming();
    let request = host.request_of(host.session, 5_000, Operation::Disarm);
    let mut body = vec![Lane::Request.byte(), schema::TAG ^ 0x55];
    body.extend(postcard(&request));
    let frame = frame::encode_body(&body).expect("a frame");
    let foreign = host.comms_count(CommsCounter::Foreign);
    for _ in 0..10 {
        host.send(&frame);
        host.run(50);
    }
    assert_eq!(host.comms_count(CommsCounter::Foreign), foreign + 10);
    assert!(host.take_replies().is_empty());
    assert_eq!(host.device.board().drive().state(), State::Armed);

    let Some(Answer::Hello { own, drive, .. }) = host.manage(Action::Hello, 1) else {
        panic!("no hello");
    };
    assert_eq!((own.role, drive.role), (Role::Comms, Role::Drive));
    assert_eq!((own.schema, drive.schema), (schema::HASH, schema::HASH));
    let stopped = host.manage(Action::Stop, 2);
    assert_eq!(
        stopped,
        Some(Answer::Stop {
            token: 2,
            done: true
        })
    );
    host.run(21);
    assert!(!host.device.board().is_driven());
}

/// The message of a request, without its envelope.
fn postcard(request: &Request) -> Vec<u8> {
    let framed = frame::encode(Lane::Request, request).expect("a frame");
    let mut decoder = crepitus_protocol::Decoder::new();
    let mut payload = Vec::new();
    for byte in framed {
        if let Some(Ok(body)) = decoder.push(byte) {
            payload = body.payload.to_vec();
        }
    }
    payload
}
