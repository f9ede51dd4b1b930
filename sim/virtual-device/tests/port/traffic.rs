//! Bytes both ways: every length arrives without a further write, at the speed of the bus.

use crate::rig::{Echo, Source, frames, pattern_bytes, with_host};
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::wire::{Handshake, Token, UsbWire};

/// Two full packets and a bit: every kind of last packet.
const LENGTHS: std::ops::RangeInclusive<usize> = 0..=130;

#[test]
fn every_length_comes_back_without_a_further_write() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        for length in LENGTHS {
            let bytes = pattern_bytes(length);
            assert_eq!(host.queue(&bytes), length);
            frames(2, &mut host, &mut cable, &mut device);
            assert_eq!(host.read_all(), bytes, "length {length}");
        }
    });
}

#[test]
fn every_length_is_the_first_thing_a_device_may_say() {
    for length in LENGTHS.chain([512, 511, 513, 576, 640, 704, 1_024]) {
        with_host(Source::new(length), |mut device, mut cable, mut host| {
            frames(3, &mut host, &mut cable, &mut device);
            assert_eq!(host.read_all(), pattern_bytes(length), "length {length}");
        });
    }
}

#[test]
fn all_lengths_in_one_batch_come_back_in_order() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        let batch: Vec<u8> = LENGTHS.flat_map(pattern_bytes).collect();
        assert_eq!(host.queue(&batch), batch.len());
        frames(30, &mut host, &mut cable, &mut device);
        assert_eq!(host.unsent(), 0);
        assert_eq!(device.end.dropped, 0);
        assert_eq!(host.read_all(), batch);
    });
}

#[test]
fn a_megabyte_arrives_whole_at_the_speed_of_the_bus() {
    const TOTAL: usize = 1_000_000;
    with_host(Source::new(TOTAL), |mut device, mut cable, mut host| {
        let before = host.traffic();
        let mut received = Vec::new();
        while received.len() < TOTAL {
            frames(1, &mut host, &mut cable, &mut device);
            received.extend(host.read_all());
            assert!(host.traffic().frames < 2_000, "{} bytes", received.len());
        }
        assert!(received == pattern_bytes(TOTAL), "a byte is wrong");
        let traffic = host.traffic();
        assert_eq!(traffic.bytes_in, TOTAL as u64);
        let frames = traffic.frames - before.frames;
        // 19 full packets a frame at best; one in eleven carries only 63 bytes.
        assert!((823..=840).contains(&frames), "{frames} frames");
        assert!(traffic.packets_in <= 19 * frames);
    });
}

#[test]
fn both_directions_share_the_bus() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        let bytes = pattern_bytes(50_000);
        assert_eq!(host.queue(&bytes), bytes.len());
        let mut received = Vec::new();
        while received.len() < bytes.len() {
            frames(1, &mut host, &mut cable, &mut device);
            received.extend(host.read_all());
            assert!(host.traffic().frames < 200, "{} bytes", received.len());
        }
        assert!(received == bytes, "a byte is wrong");
        let traffic = host.traffic();
        let bus_bytes = traffic.bytes_in + traffic.bytes_out;
        let bus_bytes = bus_bytes + 13 * (traffic.packets_in + traffic.packets_out);
        assert!(bus_bytes <= 1_500 * traffic.frames);
    });
}

#[test]
fn a_host_that_does_not_read_stops_nobody() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        host.set_open(false);
        let bytes = pattern_bytes(20_000);
        assert_eq!(host.queue(&bytes), bytes.len());
        frames(100, &mut host, &mut cable, &mut device);
        // The device took everything, kept what fits and dropped the rest.
        assert_eq!(host.unsent(), 0);
        assert_eq!(host.traffic().bytes_in, 0);
        // In its queue, in the port's store, and one packet in the endpoint.
        let kept = 4_096 + 512 + 64;
        assert_eq!(device.end.dropped, bytes.len() - kept);
        // Opened again, what it kept comes first and nothing is lost after that.
        host.set_open(true);
        frames(10, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), bytes[..kept]);
        host.queue(b"still there?");
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), b"still there?");
    });
}

#[test]
fn a_program_that_does_not_read_fills_a_bounded_queue() {
    const TOTAL: usize = 200_000;
    with_host(Source::new(TOTAL), |mut device, mut cable, mut host| {
        frames(400, &mut host, &mut cable, &mut device);
        let waiting = host.traffic().bytes_in;
        assert!((60_000..=65_536).contains(&waiting), "{waiting} bytes");
        let mut received = Vec::new();
        for _ in 0..400 {
            received.extend(host.read_all());
            frames(1, &mut host, &mut cable, &mut device);
        }
        assert!(received == pattern_bytes(TOTAL), "a byte is wrong");
    });
}

#[test]
fn the_outgoing_queue_is_bounded() {
    with_host(Echo::default(), |_device, _cable, mut host| {
        let room = host.room();
        assert_eq!(host.queue(&vec![0; room + 1_000]), room);
        assert_eq!(host.queue(b"more"), 0);
    });
}

/// A cable that loses zero-length packets, as if the device never sent any.
struct Unterminated<'a>(&'a mut SoftCable);

impl UsbWire for Unterminated<'_> {
    fn bus_reset(&mut self) {
        self.0.bus_reset();
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        self.0.setup_transaction(token, request)
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        self.0.out_transaction(token, data)
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        match self.0.in_transaction(token) {
            Handshake::Ack(packet) if packet.is_empty() && token.endpoint != 0 => Handshake::Nak,
            answer => answer,
        }
    }
}

#[test]
fn the_host_would_notice_a_transfer_that_is_not_terminated() {
    for (length, arrives) in [(63, true), (64, false), (65, true), (128, false)] {
        with_host(Source::new(length), |mut device, mut cable, _| {
            let mut turn = device.turn();
            let mut run = |wire: &mut Unterminated| turn(wire.0);
            let mut wire = Unterminated(&mut cable);
            let mut host = CdcHost::enumerate(&mut wire, &mut run).expect("it enumerates");
            for _ in 0..5 {
                host.frame(&mut wire, &mut run).expect("the bus works");
            }
            assert_eq!(host.traffic().bytes_in, length as u64);
            let readable = if arrives { length } else { 0 };
            assert_eq!(host.read_all().len(), readable, "length {length}");
        });
    }
}

#[test]
fn the_end_of_a_frame_is_counted_in_bytes() {
    // 19 full packets leave 37 bytes of the frame: room for a packet of 24 and its overhead.
    for (last, fits) in [(24, true), (25, false)] {
        with_host(Source::new(0), |mut device, mut cable, mut host| {
            host.queue(&pattern_bytes(19 * 64 + last));
            frames(1, &mut host, &mut cable, &mut device);
            assert_eq!(host.unsent(), if fits { 0 } else { last });
            frames(1, &mut host, &mut cable, &mut device);
            assert_eq!(host.unsent(), 0);
        });
    }
}

#[test]
fn closing_the_port_forgets_a_half_fetched_transfer() {
    with_host(Source::new(65), |mut device, mut cable, mut host| {
        device.turn()(&mut cable);
        host.start_frame();
        host.poll(&mut cable).expect("the bus works");
        assert_eq!(host.traffic().bytes_in, 64);
        host.set_open(false);
        host.set_open(true);
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), pattern_bytes(65)[64..]);
    });
}
