//! Transfers of every kind, as transactions on the bus.

use crate::bench::{BULK_IN, BULK_OUT, Transaction, with_bench};
use crate::client::setup;
use crate::rig::{Echo, pattern_bytes};
use crepitus_virtual_device::usb::wire::{Handshake, Packet};

const SHORT_NOT_OK: u32 = 1;
const ZERO_PACKET: u32 = 0x40;
/// 9,600 baud, two stop bits, even parity, seven bits.
const LINE_CODING: [u8; 7] = [0x80, 0x25, 0, 0, 2, 2, 7];

/// Halt of the bulk IN endpoint, set (3) or cleared (1).
fn halt(request: u8) -> [u8; 8] {
    setup(0x02, request, 0, 0x82, 0)
}

/// Returns the lengths of the packets to the device.
fn lengths_out(seen: &[Transaction]) -> Vec<usize> {
    let length = |seen: &Transaction| match seen {
        Transaction::Out(1, data) => Some(data.len()),
        _ => None,
    };
    seen.iter().filter_map(length).collect()
}

#[test]
fn line_coding_is_what_was_set() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let reply = bench.control(&mut client, setup(0x21, 0x20, 0, 0, 7), &LINE_CODING);
        assert_eq!((reply.status, reply.actual), (0, 7));
        assert!(reply.data.is_empty(), "data went the other way");
        let reply = bench.control(&mut client, setup(0xa1, 0x21, 0, 0, 7), &[]);
        assert_eq!((reply.status, reply.actual), (0, 7));
        assert_eq!(reply.data, LINE_CODING);
        // DTR and RTS: a transfer without data.
        let reply = bench.control(&mut client, setup(0x21, 0x22, 3, 0, 0), &[]);
        assert_eq!((reply.status, reply.actual), (0, 0));
        let expected = [
            Transaction::Setup(setup(0x21, 0x20, 0, 0, 7)),
            Transaction::Out(0, LINE_CODING.to_vec()),
            Transaction::In(0, vec![]),
            Transaction::Setup(setup(0xa1, 0x21, 0, 0, 7)),
            Transaction::In(0, LINE_CODING.to_vec()),
            Transaction::Out(0, vec![]),
            Transaction::Setup(setup(0x21, 0x22, 3, 0, 0)),
            Transaction::In(0, vec![]),
        ];
        assert_eq!(bench.tap.seen, expected);
    });
}

#[test]
fn an_address_is_the_servers_own() {
    with_bench(Echo::default(), |bench| {
        let (mut client, _) = bench.import();
        bench.tap.seen.clear();
        let reply = bench.control(&mut client, setup(0x00, 5, 99, 0, 0), &[]);
        assert_eq!((reply.status, reply.actual), (0, 0));
        assert_eq!(bench.tap.seen, [], "it does not reach the device");
        let reply = bench.control(&mut client, setup(0x80, 8, 0, 0, 1), &[]);
        assert_eq!(reply.data, [0], "it still answers: not configured");
    });
}

#[test]
fn an_unknown_request_is_a_stall_and_the_next_one_works() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        for request in [
            setup(0x80, 6, 0x0600, 0, 10),
            setup(0xc0, 0x77, 0, 0, 64),
            setup(0x40, 0x77, 0, 0, 0),
        ] {
            let reply = bench.control(&mut client, request, &[]);
            assert_eq!((reply.status, reply.actual), (-32, 0), "-EPIPE");
            let reply = bench.control(&mut client, setup(0x80, 8, 0, 0, 1), &[]);
            assert_eq!((reply.status, reply.data), (0, vec![1]));
        }
    });
}

#[test]
fn a_control_request_that_contradicts_its_buffer_is_refused() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        // The SETUP packet asks for 18 bytes, the buffer holds 64; then the other direction.
        for (direction, length) in [(1_u32, 64_u32), (0, 18)] {
            let mut header = Vec::new();
            for word in [1, 777, client.device, direction, 0, 0, length, 0, 0, 0] {
                header.extend(word.to_be_bytes());
            }
            header.extend(setup(0x80, 6, 0x0100, 0, 18));
            if direction == 0 {
                header.extend(vec![0; length as usize]);
            }
            client.send(&header);
            let reply = bench.reply(&mut client);
            assert_eq!((reply.sequence, reply.status, reply.actual), (777, -22, 0));
        }
        assert_eq!(bench.tap.seen, []);
    });
}

#[test]
fn a_halted_endpoint_stalls_until_the_halt_is_cleared() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        assert_eq!(bench.control(&mut client, halt(3), &[]).status, 0);
        client.submit_out(BULK_OUT, b"held", 0);
        assert_eq!(bench.reply(&mut client).status, 0, "the other pipe works");
        for _ in 0..2 {
            let sequence = client.submit_in(BULK_IN, 64, 0);
            let reply = bench.reply(&mut client);
            assert_eq!(
                (reply.sequence, reply.status, reply.actual),
                (sequence, -32, 0)
            );
        }
        assert_eq!(bench.control(&mut client, halt(1), &[]).status, 0);
        client.submit_in(BULK_IN, 64, 0);
        assert_eq!(bench.reply(&mut client).data, b"held");
    });
}

#[test]
fn every_length_comes_back() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        client.packets_out = u32::MAX;
        let mut reading = client.submit_in(BULK_IN, 256, 0);
        for length in 1..=200 {
            let bytes = pattern_bytes(length);
            let sending = client.submit_out(BULK_OUT, &bytes, 0);
            let mut is_sent = false;
            let mut received = Vec::new();
            while !is_sent || received.len() < length {
                let reply = bench.reply(&mut client);
                assert_eq!((reply.command, reply.status), (3, 0));
                if reply.sequence == sending {
                    assert!(!is_sent, "answered twice");
                    assert_eq!(reply.actual as usize, length);
                    assert_eq!(reply.packets, u32::MAX, "as the client gave it");
                    is_sent = true;
                } else {
                    assert_eq!((reply.sequence, reply.packets), (reading, 0));
                    assert_eq!(reply.actual as usize, reply.data.len());
                    received.extend(reply.data);
                    reading = client.submit_in(BULK_IN, 256, 0);
                }
            }
            assert_eq!(received, bytes, "length {length}");
        }
    });
}

#[test]
fn packets_are_full_but_the_last_and_a_zero_packet_is_sent_when_asked_for() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        for (length, flags, expected) in [
            (0, 0, vec![0]),
            (0, ZERO_PACKET, vec![0]),
            (1, ZERO_PACKET, vec![1]),
            (64, 0, vec![64]),
            (64, ZERO_PACKET, vec![64, 0]),
            (65, ZERO_PACKET, vec![64, 1]),
            (128, 0, vec![64, 64]),
            (128, ZERO_PACKET, vec![64, 64, 0]),
            (130, 0, vec![64, 64, 2]),
        ] {
            bench.tap.seen.clear();
            client.submit_out(BULK_OUT, &pattern_bytes(length), flags);
            let reply = bench.reply(&mut client);
            assert_eq!((reply.status, reply.actual as usize), (0, length));
            assert_eq!(lengths_out(&bench.tap.seen), expected, "{length} bytes");
        }
    });
}

#[test]
fn a_transfer_ends_with_a_full_buffer_or_a_short_packet() {
    let full = || Handshake::Ack(Packet::new(&[7; 64]).expect("it fits"));
    let short = |length| Handshake::Ack(Packet::new(&vec![8; length]).expect("it fits"));
    let cases: [(u32, u32, Vec<Handshake>, i32, usize); 9] = [
        (128, 0, vec![full(), full()], 0, 128),
        (128, 0, vec![full(), short(3)], 0, 67),
        (128, 0, vec![full(), short(0)], 0, 64),
        (128, SHORT_NOT_OK, vec![full(), full()], 0, 128),
        (128, SHORT_NOT_OK, vec![full(), short(63)], -121, 127),
        (100, 0, vec![full(), full()], -75, 100),
        (10, 0, vec![short(11)], -75, 10),
        (128, 0, vec![full(), Handshake::Stall], -32, 64),
        (
            128,
            0,
            vec![full(), Handshake::Nak, Handshake::Nak, Handshake::Absent],
            -71,
            64,
        ),
    ];
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        for (length, flags, answers, status, actual) in cases {
            bench.tap.forged.extend(&answers);
            let sequence = client.submit_in(BULK_IN, length, flags);
            let reply = bench.reply(&mut client);
            assert_eq!(
                (reply.sequence, reply.status),
                (sequence, status),
                "{answers:?}"
            );
            assert_eq!(reply.data.len(), actual, "{answers:?}");
            assert!(bench.tap.forged.is_empty());
        }
    });
}

#[test]
fn an_endpoint_that_is_not_there_is_an_error() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        for endpoint in [3, 15] {
            client.submit_in(endpoint, 64, 0);
            assert_eq!(bench.reply(&mut client).status, -2, "-ENOENT");
        }
        client.submit_out(2, b"the other direction", 0);
        let reply = bench.reply(&mut client);
        assert_eq!((reply.status, reply.actual), (-2, 0));
        assert_eq!(bench.tap.seen, []);
    });
}
