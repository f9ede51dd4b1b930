//! Frames whole, cut, damaged, and with bytes left over.

use super::*;
use crate::frame::{BODY_BYTES, CRC, encode_body, encode_bytes, write};
use crate::host::{Answer, Operation, Reply, Request};
use crate::link::{DriveStatus, FromDrive, Heartbeat, ToDrive};
use crate::reference;
use crate::telemetry::Block;
use crate::{Nonce, Session};
use core::fmt::Debug;
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::vec::Vec;

/// Decodes bytes; returns the bodies and the number of errors.
fn decode(decoder: &mut Decoder, bytes: &[u8]) -> (Vec<Vec<u8>>, u32) {
    let (mut bodies, mut errors) = (Vec::new(), 0);
    for byte in bytes {
        match decoder.push(*byte) {
            Some(Ok(body)) => {
                let mut all = std::vec![body.lane, body.tag];
                all.extend(body.payload);
                bodies.push(all);
            }
            Some(Err(_)) => errors += 1,
            None => {}
        }
    }
    assert_eq!(decoder.discarded().total(), errors);
    (bodies, errors)
}

fn body(length: usize) -> Vec<u8> {
    (0..length)
        .map(|i| u8::try_from(i * 7 % 256).unwrap())
        .collect()
}

#[test]
fn every_length_comes_back() {
    for length in 2..=BODY_BYTES {
        let frame = encode_body(&body(length)).unwrap();
        let mut decoder = Decoder::new();
        assert_eq!(decode(&mut decoder, &frame), (std::vec![body(length)], 0));
    }
}

/// Some end a run of 254 bytes with a code of none.
#[test]
fn frames_of_other_encoders_are_understood() {
    let longest = (BODY_BYTES + CRC_BYTES) / 254 * 254 - CRC_BYTES;
    for length in [2, 250, 251, 504, longest, BODY_BYTES - 1, BODY_BYTES] {
        let body = std::vec![7; length];
        let mut plain = body.clone();
        plain.extend(CRC.checksum(&body).to_le_bytes());
        let whole = (length + CRC_BYTES).is_multiple_of(254) && !plain.contains(&0);
        for ends in [&[0][..], &[1, 0]] {
            if ends.len() > 1 && !whole {
                continue;
            }
            let mut frame = reference::encode(&plain);
            frame.extend(ends);
            let found = decode(&mut Decoder::new(), &frame);
            assert_eq!(found, (std::vec![body.clone()], 0), "{length} {ends:?}");
        }
    }
    // One byte more than any body has.
    let mut frame = reference::encode(&[7; BODY_BYTES + CRC_BYTES + 1]);
    frame.push(0);
    let mut decoder = Decoder::new();
    assert_eq!(decode(&mut decoder, &frame), (Vec::new(), 1));
    assert_eq!(decoder.discarded().overlong, 1);
}

#[test]
fn a_body_shorter_than_lane_and_tag_is_invalid() {
    for length in 0..2 {
        let frame = encode_body(&body(length)).unwrap();
        assert_eq!(decode(&mut Decoder::new(), &frame), (Vec::new(), 1));
    }
}

/// Checks that this is a message in a frame of its lane, and none with bytes behind it.
fn check_its_end<T>(lane: Lane, message: &T)
where
    T: Copy + Debug + PartialEq + Serialize + DeserializeOwned,
{
    let mut buffer = [0; BODY_BYTES];
    let written = write(message, &mut buffer).unwrap();
    for extra in 0..3 {
        let payload = [written, &[0, 1][..extra]].concat();
        let frame = encode_bytes(lane, &payload).unwrap();
        let mut decoder = Decoder::new();
        let (_, found) = decoder.extend(&frame);
        let body = found.unwrap().unwrap();
        assert_eq!(body.lane(), Some(lane));
        let expected = (extra == 0).then_some(*message);
        assert_eq!(body.message::<T>(), expected, "{lane:?}, {extra} bytes");
    }
}

#[test]
fn a_message_with_bytes_left_over_is_none() {
    let request = Request {
        session: Session(5),
        nonce: Nonce(6),
        number: 7,
        operation: Operation::Disarm,
    };
    let reply = Reply {
        session: Session(5),
        number: 7,
        answer: Ok(Answer::Done),
    };
    check_its_end(Lane::Request, &request);
    check_its_end(Lane::Reply, &reply);
    check_its_end(Lane::Telemetry, &Block::default());
    check_its_end(Lane::ToDrive, &ToDrive::Heartbeat(Heartbeat::default()));
    check_its_end(Lane::FromDrive, &FromDrive::Status(DriveStatus::default()));
}

#[test]
fn a_frame_that_never_ends_is_overlong_and_the_next_is_received() {
    let mut bytes = std::vec![7; FRAME_BYTES + 1];
    bytes.push(0);
    let mut decoder = Decoder::new();
    assert_eq!(decode(&mut decoder, &bytes), (Vec::new(), 1));
    assert_eq!(decoder.discarded().overlong, 1);
    let good = encode_body(&body(BODY_BYTES)).unwrap();
    let mut found = 0;
    for byte in good {
        found += usize::from(matches!(decoder.push(byte), Some(Ok(_))));
    }
    assert_eq!(found, 1);
}

#[test]
fn a_decoder_recovers_from_a_disconnect() {
    let good = encode_body(&body(30)).unwrap();
    let mut decoder = Decoder::new();
    decode(&mut decoder, &good[..10]);
    decoder.reset();
    assert_eq!(decode(&mut decoder, &good), (std::vec![body(30)], 0));
}

proptest! {
    /// Checks that, whatever stands between two delimiters, a body is found where another
    /// implementation finds one, the same.
    #[test]
    fn finds_what_another_finds(mut frame: Vec<u8>, whole in any::<bool>()) {
        if whole {
            frame.truncate(BODY_BYTES);
            frame = encode_body(&frame).unwrap().to_vec();
        }
        frame.retain(|byte| *byte != 0);
        frame.truncate(FRAME_BYTES - 1);
        let plain = reference::decode(&frame);
        let expected = plain.and_then(|plain| {
            let (body, checksum) = plain.split_last_chunk::<CRC_BYTES>()?;
            let is_right = CRC.checksum(body).to_le_bytes() == *checksum;
            (body.len() >= 2 && is_right).then(|| body.to_vec())
        });
        frame.push(0);
        let (bodies, _) = decode(&mut Decoder::new(), &frame);
        prop_assert_eq!(bodies.first(), expected.as_ref());
    }

    /// Bytes in pieces of any lengths give what they give one by one.
    #[test]
    fn pieces_are_as_bytes(
        noise: Vec<u8>,
        lengths in prop::collection::vec(2_usize..=BODY_BYTES, 1..4),
        cuts in prop::collection::vec(1_usize..700, 1..8),
    ) {
        let mut bytes = noise;
        for length in lengths {
            bytes.push(0);
            bytes.extend(encode_body(&body(length)).unwrap());
        }
        let mut decoder = Decoder::new();
        let expected = decode(&mut decoder, &bytes);
        let mut others = Decoder::new();
        let (mut bodies, mut errors) = (Vec::new(), 0);
        let mut rest = &bytes[..];
        for cut in cuts.iter().cycle() {
            let (mut piece, behind) = rest.split_at((*cut).min(rest.len()));
            while !piece.is_empty() {
                let (taken, found) = others.extend(piece);
                match found {
                    Some(Ok(body)) => {
                        let mut all = std::vec![body.lane, body.tag];
                        all.extend(body.payload);
                        bodies.push(all);
                    }
                    Some(Err(_)) => errors += 1,
                    None => {}
                }
                piece = &piece[taken..];
            }
            rest = behind;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!((bodies, errors), expected);
        prop_assert_eq!(others.discarded(), decoder.discarded());
    }

    /// One flipped bit: never another message.
    #[test]
    fn a_flipped_bit_is_detected(length in 2_usize..=BODY_BYTES, at: prop::sample::Index, bit in 0..8_u32) {
        let mut frame = encode_body(&body(length)).unwrap().to_vec();
        let at = at.index(frame.len());
        frame[at] ^= 1_u8 << bit;
        frame.push(0);
        let (bodies, _) = decode(&mut Decoder::new(), &frame);
        prop_assert!(bodies.iter().all(|b| *b == body(length)), "a wrong frame was believed");
    }
}
