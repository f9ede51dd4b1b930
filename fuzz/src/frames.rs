//! Any bytes to the decoder of frames, and any body in a frame:
//!
//! - each run of bytes between two delimiters is a frame or is counted as
//!   none, and no frame is given whose checksum is another;
//! - a body that is found comes back from a frame of its own;
//! - a decoded message, encoded again, is the same message;
//! - after a delimiter, whatever came before, a valid frame is received. The
//!   good ones are the golden ones.

use crate::bytes::Bytes;
use crepitus_protocol::decoder::Body;
use crepitus_protocol::frame::{self, BODY_BYTES, CRC, Frame};
use crepitus_protocol::host::{Reply, Request};
use crepitus_protocol::link::{FromDrive, ToDrive};
use crepitus_protocol::management::{Answer, ManagementRequest};
use crepitus_protocol::task_times::DeviceTimes;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::LazyLock;

const VECTORS: &str = include_str!("../../protocol/golden/vectors.txt");

/// The frames of the file of golden bytes.
static GOLDEN: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let (mut frames, mut is_frame) = (Vec::new(), false);
    for line in VECTORS.lines() {
        let (key, rest) = line.split_at_checked(8).unwrap_or((line, ""));
        match key.trim() {
            "frame" => {
                frames.push(Vec::new());
                is_frame = true;
            }
            "" => is_frame &= !rest.is_empty(),
            _ => is_frame = false,
        }
        if is_frame && let Some(frame) = frames.last_mut() {
            let bytes = rest.split_whitespace();
            frame.extend(bytes.filter_map(|byte| u8::from_str_radix(byte, 16).ok()));
        }
    }
    frames
});

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let golden = &GOLDEN[usize::from(bytes.byte()) % GOLDEN.len()];
    if bytes.byte().is_multiple_of(2) {
        stream(bytes.rest(), golden);
    } else {
        let body = bytes.rest();
        let frame = frame::encode_body(&body[..body.len().min(BODY_BYTES)]);
        stream(&frame.expect("a body that fits"), golden);
    }
}

/// Bytes as they come, then a good frame.
fn stream(noise: &[u8], golden: &[u8]) {
    let mut decoder = Decoder::new();
    let (mut runs, mut found, mut run) = (0, 0, Vec::new());
    for byte in noise {
        if let Some(Ok(body)) = decoder.push(*byte) {
            found += 1;
            assert!(has_valid_crc(&run, &body), "{run:02x?} is no frame");
            understood(&body);
        }
        if *byte != 0 {
            run.push(*byte);
        } else {
            runs += u32::from(!run.is_empty());
            run.clear();
        }
    }
    assert_eq!(runs, found + decoder.discarded().total());
    decoder.push(0);
    let discarded = decoder.discarded();
    let last = golden.iter().filter_map(|byte| match decoder.push(*byte)? {
        Ok(body) => Some([&[body.lane, body.tag][..], body.payload].concat()),
        Err(error) => panic!("a good frame is none: {error:?}"),
    });
    let bodies: Vec<_> = last.collect();
    assert_eq!(bodies.len(), 1, "a good frame is not received");
    let again = frame::encode_body(&bodies[0]).expect("it was a frame");
    assert_eq!(again, golden);
    assert_eq!(decoder.discarded(), discarded);
}

/// Returns whether the frame holds that body and a valid CRC, by an independent decoder.
fn has_valid_crc(run: &[u8], body: &Body<'_>) -> bool {
    let mut plain = Vec::new();
    let mut rest = run;
    while let Some((code, next)) = rest.split_first() {
        let count = usize::from(*code) - 1;
        if next.len() < count {
            return false;
        }
        let (bytes, after) = next.split_at(count);
        plain.extend(bytes);
        if *code < u8::MAX && !after.is_empty() {
            plain.push(0);
        }
        rest = after;
    }
    let Some((bytes, checksum)) = plain.split_last_chunk() else {
        return false;
    };
    CRC.checksum(bytes) == u32::from_le_bytes(*checksum)
        && bytes == [&[body.lane, body.tag][..], body.payload].concat()
}

/// A body that was found.
fn understood(body: &Body<'_>) {
    let bytes = [&[body.lane, body.tag][..], body.payload].concat();
    let frame = frame::encode_body(&bytes).expect("it was in a frame");
    assert!(
        frame
            .split_last()
            .is_some_and(|(_, rest)| !rest.contains(&0))
    );
    let mut decoder = Decoder::new();
    let last = frame.iter().filter_map(|byte| {
        let body = decoder.push(*byte)?.expect("a frame of our own");
        assert_eq!((body.lane, body.tag), (bytes[0], bytes[1]));
        Some(CRC.checksum(body.payload))
    });
    assert!(last.eq([CRC.checksum(body.payload)]));
    match body.lane() {
        None => {}
        Some(Lane::Management) => {
            if let Some(question) = ManagementRequest::of(body.payload) {
                assert_eq!(question.bytes(), body.payload[..2]);
            }
        }
        Some(Lane::ManagementAnswer) => {
            if let Some(answer) = Answer::of(body.payload) {
                assert_eq!(Answer::of(&answer.bytes()), Some(answer));
            }
        }
        Some(lane @ Lane::Request) => rewritten::<Request>(lane, body),
        Some(lane @ Lane::Reply) => rewritten::<Reply>(lane, body),
        Some(lane @ Lane::Telemetry) => rewritten::<Block>(lane, body),
        Some(lane @ Lane::ToDrive) => rewritten::<ToDrive>(lane, body),
        Some(lane @ Lane::FromDrive) => rewritten::<FromDrive>(lane, body),
        Some(lane @ Lane::Times) => rewritten::<DeviceTimes>(lane, body),
    }
}

/// A message, encoded again, is the same; compared as bytes, since it may hold
/// NaN.
fn rewritten<T: DeserializeOwned + Serialize>(lane: Lane, body: &Body<'_>) {
    let Some(message) = body.message::<T>() else {
        return;
    };
    let first: Frame = frame::encode(lane, &message).expect("it was in a frame");
    let mut decoder = Decoder::new();
    let again = first.iter().find_map(|byte| {
        let body = decoder.push(*byte)?.expect("a frame of our own");
        let message: T = body.message().expect("a message of our own");
        Some(frame::encode(lane, &message).expect("it fits"))
    });
    assert_eq!(again, Some(first));
}
