//! COBS a second time, by its definition and not as a state machine: what the tests compare
//! frames with.

use std::vec::Vec;

/// Most bytes of a run without a zero.
const RUN: usize = 254;

/// Each run up to a zero, or of 254 bytes, behind its length and one.
pub(crate) fn encode(plain: &[u8]) -> Vec<u8> {
    let mut coded = Vec::new();
    let runs: Vec<&[u8]> = plain.split(|byte| *byte == 0).collect();
    let last = runs.len() - 1;
    for (number, run) in runs.into_iter().enumerate() {
        let (whole, rest) = run.as_chunks::<RUN>();
        for run in whole {
            coded.push(255);
            coded.extend(run);
        }
        // The end of the last run is that of the frame: there is no zero to stand for.
        let is_over = number == last && rest.is_empty() && !whole.is_empty();
        if !is_over {
            coded.push(u8::try_from(rest.len() + 1).unwrap());
            coded.extend(rest);
        }
    }
    coded
}

/// The bytes of a frame without its delimiter, if it is whole.
pub(crate) fn decode(coded: &[u8]) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    let mut rest = coded;
    while let [code, behind @ ..] = rest {
        let length = usize::from(*code).checked_sub(1)?;
        let run = behind.get(..length)?;
        if run.contains(&0) {
            return None;
        }
        plain.extend(run);
        rest = &behind[length..];
        if length < RUN && !rest.is_empty() {
            plain.push(0);
        }
    }
    Some(plain)
}

#[test]
fn it_is_that_of_the_paper() {
    // Cheshire and Baker, "Consistent Overhead Byte Stuffing", 1999, fig. 2.
    let plain = b"E\0\0\x2cLy\0\0@\x06O7";
    let coded = b"\x02E\x01\x04\x2cLy\x01\x05@\x06O7";
    assert_eq!(encode(plain), coded);
    assert_eq!(decode(coded).unwrap(), plain);
}
