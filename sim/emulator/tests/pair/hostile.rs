//! A host that breaks the rules of control transfers: no packet of its may stop the
//! device, and the next request that keeps them works.

use crate::host::MS;
use crate::usb::{GET_LINE_CODING, PIPE, SET_LINE_CODING, descriptor, plugged_in, read, write};
use crepitus_emulator::Pair;
use crepitus_virtual_device::usb::wire::{Handshake, Token, UsbWire};

const TOKEN: Token = Token {
    address: PIPE.address,
    endpoint: 0,
};

/// A request of the vendor's with data to the device; `usb-device` keeps 256 bytes.
fn vendor(length: u16) -> [u8; 8] {
    let [low, high] = length.to_le_bytes();
    [0x40, 99, 0, 0, 0, 0, low, high]
}

/// The first 64 bytes of the configuration: a second packet would follow.
const GET_CONFIGURATION: [u8; 8] = [0x80, 6, 0, 2, 0, 0, 255, 0];

#[derive(Clone, Copy)]
enum Step {
    Setup([u8; 8]),
    Out(usize),
    In,
}
use Step::{In, Out, Setup};

/// Steps of the host, a millisecond apart, whatever the answers are.
fn play(pair: &mut Pair, steps: &[Step]) {
    for step in steps {
        let boards = pair.boards_mut();
        let answer = match step {
            Setup(bytes) => boards.setup_transaction(TOKEN, *bytes),
            Out(bytes) => boards.out_transaction(TOKEN, &vec![0xa5; *bytes]),
            In => boards.in_transaction(TOKEN),
        };
        assert_ne!(answer, Handshake::Absent, "the device is gone");
        boards.run(MS);
    }
}

/// Checks that after these steps the device is still the same, and answers.
fn survives(steps: &[Step]) {
    let Some(mut pair) = plugged_in() else { return };
    play(&mut pair, steps);
    // Longer than the watchdog waits.
    pair.boards_mut().run(60 * MS);
    assert_eq!(pair.boards().comms().resets(), []);
    let device = read(&mut pair, descriptor(1, 0), 18).expect("a descriptor");
    assert_eq!(device.len(), 18);
    let coding = [0x80, 0x25, 0, 0, 0, 2, 7];
    write(&mut pair, SET_LINE_CODING, &coding).expect("taken");
    let read_back = read(&mut pair, GET_LINE_CODING, 7);
    assert_eq!(read_back.as_deref(), Ok(&coding[..]));
    pair.boards_mut().run(60 * MS);
    assert_eq!(pair.boards().comms().resets(), []);
}

#[test]
fn more_data_than_the_control_buffer_has_room_for() {
    survives(&[
        Setup(vendor(300)),
        Out(64),
        Out(64),
        Out(64),
        Out(64),
        Out(44),
    ]);
}

#[test]
fn more_data_than_the_request_announced() {
    let before_the_end = [Setup(vendor(250)), Out(64), Out(64), Out(32), Out(64)];
    survives(&before_the_end);
    survives(&[&before_the_end[..], &[Out(64)]].concat());
    survives(&[Setup(vendor(1)), Out(64), Out(64)]);
}

#[test]
fn data_without_a_request() {
    survives(&[Out(8), Out(64)]);
}

#[test]
fn data_to_the_device_while_it_sends_its_own() {
    survives(&[Setup(GET_CONFIGURATION), In, Out(8), In]);
    survives(&[Setup(GET_CONFIGURATION), Out(64), In, In]);
}

#[test]
fn a_request_in_the_middle_of_another() {
    survives(&[
        Setup(vendor(100)),
        Out(64),
        Setup(GET_CONFIGURATION),
        In,
        Setup(vendor(3)),
        Setup(vendor(300)),
        In,
        In,
    ]);
    survives(&[Setup(GET_CONFIGURATION), In, Setup(vendor(0)), In, In]);
}

#[test]
fn requests_without_sense() {
    let Some(mut pair) = plugged_in() else { return };
    let recipients = 0..=4;
    let kinds = (0..8).flat_map(|kind| recipients.clone().map(move |to| kind << 5 | to));
    for request_type in kinds {
        for number in (0..16).chain([0x20, 0x21, 0x22, 0xff]) {
            // An address of its own would end the conversation.
            if (request_type, number) == (0, 5) {
                continue;
            }
            for (value, index) in [(0, 0), (0x0100, 0x8f), (0x02ff, 0x00ff), (0xffff, 0xffff)] {
                let [v, i] = [value, index].map(u16::to_le_bytes);
                let bytes = [request_type, number, v[0], v[1], i[0], i[1], 64, 0];
                let boards = pair.boards_mut();
                let _ = boards.setup_transaction(TOKEN, bytes);
                boards.run(2);
                let _ = match request_type & 0x80 {
                    0 => boards.out_transaction(TOKEN, &[0x5a; 64]),
                    _ => boards.in_transaction(TOKEN),
                };
                boards.run(2);
            }
        }
    }
    assert_eq!(pair.boards().comms().resets(), []);
    let device = read(&mut pair, descriptor(1, 0), 18).expect("a descriptor");
    assert_eq!(device.len(), 18);
}
