//! The USB controller, register by register (RM0090 34.16, 34.17).

use crate::bench::Bench;
use crepitus_virtual_device::usb::wire::{Handshake, Packet, Token, UsbWire};

const OTG: u32 = 0x5000_0000;
const GUSBCFG: u32 = OTG + 0x00c;
const GRSTCTL: u32 = OTG + 0x010;
const GINTSTS: u32 = OTG + 0x014;
const GINTMSK: u32 = OTG + 0x018;
const GRXSTSR: u32 = OTG + 0x01c;
const GRXSTSP: u32 = OTG + 0x020;
const GRXFSIZ: u32 = OTG + 0x024;
const DIEPTXF0: u32 = OTG + 0x028;
const DIEPTXF1: u32 = OTG + 0x104;
const GCCFG: u32 = OTG + 0x038;
const DCFG: u32 = OTG + 0x800;
const DCTL: u32 = OTG + 0x804;
const DSTS: u32 = OTG + 0x808;
const DIEPMSK: u32 = OTG + 0x810;
const DAINT: u32 = OTG + 0x818;
const DAINTMSK: u32 = OTG + 0x81c;
const DIEPCTL: u32 = OTG + 0x900;
const DIEPINT: u32 = OTG + 0x908;
const DIEPTSIZ: u32 = OTG + 0x910;
const DTXFSTS: u32 = OTG + 0x918;
const DOEPCTL: u32 = OTG + 0xb00;
const DOEPINT: u32 = OTG + 0xb08;
const FIFO: u32 = OTG + 0x1000;
const ENDPOINT: u32 = 0x20;

const USBSUSP: u32 = 1 << 11;
const USBRST: u32 = 1 << 12;
const ENUMDNE: u32 = 1 << 13;
const RXFLVL: u32 = 1 << 4;
const IEPINT: u32 = 1 << 18;
const WKUPINT: u32 = 1 << 31;

const EPENA: u32 = 1 << 31;
const CNAK: u32 = 1 << 26;
const STALL: u32 = 1 << 21;
const BULK: u32 = 2 << 18;
const USBAEP: u32 = 1 << 15;

const CONTROL: Token = Token {
    address: 0,
    endpoint: 0,
};
const PIPE: Token = Token {
    address: 0,
    endpoint: 1,
};
const ACK: Handshake = Handshake::Ack(Packet::EMPTY);

fn ack(data: &[u8]) -> Handshake {
    Handshake::Ack(Packet::new(data).expect("it fits"))
}

const RCC: u32 = 0x4002_3800;

/// Clocks and pins of the controller.
fn clocked() -> Bench {
    let mut bench = Bench::new();
    bench.set(RCC, 1 << 16);
    bench.run_us(200);
    // 8 MHz / 4 * 168 / 7 = 48 MHz.
    bench.write(RCC + 4, 4 | 168 << 6 | 1 << 22 | 7 << 24);
    bench.set(RCC, 1 << 24);
    bench.run_us(200);
    bench.write(RCC + 8, 2);
    bench.set(RCC + 0x30, 1);
    bench.set(RCC + 0x34, 1 << 7);
    bench.set(0x4002_0000, 2 << 22 | 2 << 24);
    bench.set(0x4002_0024, 10 << 12 | 10 << 16);
    bench
}

/// A device on a bus that has been reset, with a bulk endpoint each way.
fn ready() -> Bench {
    let mut bench = clocked();
    bench.set(GUSBCFG, 1 << 30);
    bench.write(GCCFG, 1 << 16 | 1 << 21);
    bench.write(DCTL, 0);
    bench.0.plug_in();
    assert!(bench.0.is_connected());
    bench.0.bus_reset();
    bench.run_us(6_000);
    bench.write(GINTSTS, u32::MAX);
    bench.write(GRXFSIZ, 64);
    bench.write(DIEPTXF0, 16 << 16 | 64);
    bench.write(DIEPTXF1, 32 << 16 | 0x50);
    bench.write(DOEPCTL, EPENA | CNAK);
    bench.write(DIEPCTL + ENDPOINT, USBAEP | BULK | 1 << 22 | 64);
    bench.write(DOEPCTL + ENDPOINT, EPENA | CNAK | USBAEP | BULK | 64);
    bench
}

/// Puts bytes into the FIFO of endpoint `n`, to go as so many packets.
fn send(bench: &mut Bench, n: u32, bytes: &[u8], packets: u32) {
    let size = packets << 19 | u32::try_from(bytes.len()).expect("short");
    bench.write(DIEPTSIZ + n * ENDPOINT, size);
    bench.set(DIEPCTL + n * ENDPOINT, EPENA | CNAK);
    for chunk in bytes.chunks(4) {
        let mut word = [0; 4];
        word[..chunk.len()].copy_from_slice(chunk);
        bench.write(FIFO + n * 0x1000, u32::from_le_bytes(word));
    }
}

/// Takes an entry of the receive FIFO: endpoint, kind, data.
fn receive(bench: &mut Bench) -> (u32, u32, Vec<u8>) {
    let status = bench.read(GRXSTSP);
    let length = (status >> 4 & 0x7ff) as usize;
    let words = (0..length.div_ceil(4)).map(|_| bench.read(FIFO));
    let mut data: Vec<u8> = words.flat_map(u32::to_le_bytes).collect();
    data.truncate(length);
    (status & 15, status >> 17 & 15, data)
}

const OUT: u32 = 2;
const OUT_DONE: u32 = 3;
const SETUP_DONE: u32 = 4;
const SETUP: u32 = 6;

#[test]
fn a_device_shows_only_with_all_that_it_needs() {
    let mut bench = clocked();
    bench.0.plug_in();
    assert!(!bench.0.is_connected(), "host, or nothing, after a reset");
    bench.set(GUSBCFG, 1 << 30);
    assert!(!bench.0.is_connected(), "its transceiver is off");
    bench.write(GCCFG, 1 << 16);
    assert!(bench.0.is_connected());
    bench.write(DCTL, 2);
    assert!(!bench.0.is_connected(), "soft disconnect");
    bench.write(DCTL, 0);
    // 8 MHz / 4 * 168 / 8 = 42 MHz.
    bench.write(0x4002_3800, 1 << 16 | 1);
    bench.write(0x4002_3804, 4 | 168 << 6 | 1 << 22 | 8 << 24);
    bench.write(0x4002_3800, 1 << 24 | 1 << 16 | 1);
    bench.run_us(200);
    assert!(!bench.0.is_connected(), "not 48 MHz");
    assert_eq!(
        bench.0.setup_transaction(CONTROL, [0; 8]),
        Handshake::Absent
    );
}

#[test]
fn a_bus_reset_is_two_events_and_it_answers_at_address_0() {
    let mut bench = clocked();
    bench.set(GUSBCFG, 1 << 30);
    bench.write(GCCFG, 1 << 16);
    bench.0.plug_in();
    bench.0.bus_reset();
    assert_eq!(bench.read(GINTSTS) & (USBRST | ENUMDNE), USBRST);
    assert_eq!(
        bench.0.setup_transaction(CONTROL, [0; 8]),
        Handshake::Absent
    );
    bench.run_us(4_900);
    assert_eq!(bench.read(GINTSTS) & (USBRST | ENUMDNE), USBRST);
    bench.run_us(200);
    assert_eq!(bench.read(GINTSTS) & (USBRST | ENUMDNE), USBRST | ENUMDNE);
    assert_eq!(bench.read(DSTS) & 6, 6, "full speed");
    bench.write(GINTSTS, USBRST);
    assert_eq!(bench.read(GINTSTS) & (USBRST | ENUMDNE), ENUMDNE);
    bench.write(GRXFSIZ, 64);
    assert_eq!(bench.0.setup_transaction(CONTROL, [0; 8]), ACK);
    let elsewhere = Token {
        address: 3,
        endpoint: 0,
    };
    assert_eq!(
        bench.0.setup_transaction(elsewhere, [0; 8]),
        Handshake::Absent
    );
}

#[test]
fn what_is_received_is_in_order_with_its_kind_and_length() {
    let mut bench = ready();
    let request = [1, 2, 3, 4, 5, 6, 7, 8];
    assert_eq!(bench.0.setup_transaction(CONTROL, request), ACK);
    assert_eq!(bench.0.out_transaction(PIPE, b"seven b"), ACK);
    assert_ne!(bench.read(GINTSTS) & RXFLVL, 0);
    assert_eq!(
        bench.read(GRXSTSR) >> 17 & 15,
        SETUP,
        "a look takes nothing"
    );
    assert_eq!(receive(&mut bench), (0, SETUP, request.to_vec()));
    assert_eq!(receive(&mut bench), (0, SETUP_DONE, vec![]));
    assert_eq!(receive(&mut bench), (1, OUT, b"seven b".to_vec()));
    assert_eq!(receive(&mut bench), (1, OUT_DONE, vec![]));
    assert_eq!(bench.read(GINTSTS) & RXFLVL, 0);
    assert_ne!(bench.read(DOEPINT) & 1 << 3, 0, "STUP");
    assert_ne!(bench.read(DOEPINT + ENDPOINT) & 1, 0, "XFRC");
}

#[test]
fn an_endpoint_takes_a_packet_and_no_more_until_it_is_enabled_again() {
    let mut bench = ready();
    assert_eq!(bench.0.out_transaction(PIPE, &[7; 64]), ACK);
    assert_eq!(bench.0.out_transaction(PIPE, &[8; 64]), Handshake::Nak);
    let control = bench.read(DOEPCTL + ENDPOINT);
    assert_eq!(control & (EPENA | 1 << 17), 1 << 17, "NAKSTS");
    bench.set(DOEPCTL + ENDPOINT, EPENA | CNAK);
    assert_eq!(bench.0.out_transaction(PIPE, &[8; 64]), ACK);
    // The FIFO has 64 words: two packets with their statuses are 36.
    bench.set(DOEPCTL + ENDPOINT, EPENA | CNAK);
    assert_eq!(bench.0.out_transaction(PIPE, &[9; 64]), ACK);
    bench.set(DOEPCTL + ENDPOINT, EPENA | CNAK);
    assert_eq!(bench.0.out_transaction(PIPE, &[10; 64]), Handshake::Nak);
    for byte in 7..10 {
        assert_eq!(receive(&mut bench), (1, OUT, vec![byte; 64]));
        assert_eq!(receive(&mut bench), (1, OUT_DONE, vec![]));
    }
    assert_eq!(bench.0.out_transaction(PIPE, &[10; 64]), ACK);
}

#[test]
fn a_packet_goes_when_it_is_there_whole() {
    let mut bench = ready();
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Nak);
    assert_eq!(bench.read(DTXFSTS + ENDPOINT), 32);
    bench.write(DIEPTSIZ + ENDPOINT, 1 << 19 | 6);
    bench.set(DIEPCTL + ENDPOINT, EPENA | CNAK);
    bench.write(FIFO + 0x1000, u32::from_le_bytes(*b"whol"));
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Nak, "half of it");
    assert_eq!(bench.read(DTXFSTS + ENDPOINT), 31);
    bench.write(FIFO + 0x1000, u32::from_le_bytes(*b"e!xx"));
    bench.write(DIEPMSK, 1);
    bench.write(DAINTMSK, 1 << 1);
    assert_eq!(bench.0.in_transaction(PIPE), ack(b"whole!"));
    assert_eq!(bench.read(DAINT), 1 << 1);
    assert_ne!(bench.read(GINTSTS) & IEPINT, 0);
    bench.write(DIEPINT + ENDPOINT, 1);
    assert_eq!(bench.read(GINTSTS) & IEPINT, 0);
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Nak);
}

#[test]
fn a_transfer_of_several_packets_ends_with_the_last() {
    let mut bench = ready();
    let bytes: Vec<u8> = (0..100).collect();
    send(&mut bench, 1, &bytes, 2);
    assert_eq!(bench.0.in_transaction(PIPE), ack(&bytes[..64]));
    assert_eq!(bench.read(DIEPINT + ENDPOINT) & 1, 0);
    assert_eq!(bench.read(DIEPTSIZ + ENDPOINT), 1 << 19 | 0x24);
    assert_eq!(bench.0.in_transaction(PIPE), ack(&bytes[64..]));
    assert_eq!(bench.read(DIEPINT + ENDPOINT) & 1, 1);
    send(&mut bench, 1, &[], 1);
    assert_eq!(bench.0.in_transaction(PIPE), ACK);
}

#[test]
fn a_fifo_that_is_written_over_its_depth_is_reported() {
    let mut bench = ready();
    send(&mut bench, 1, &[0; 128], 2);
    assert_eq!(bench.0.in_transaction(PIPE), ack(&[0; 64]));
    for _ in 0..17 {
        bench.write(FIFO + 0x1000, 0);
    }
    bench.write(GINTMSK, 0);
    assert_eq!(bench.0.not_modelled(), ["OTG_FS"]);
}

#[test]
fn a_stall_ends_with_the_next_setup_but_only_at_the_control_endpoint() {
    let mut bench = ready();
    for place in [DIEPCTL, DOEPCTL, DIEPCTL + ENDPOINT, DOEPCTL + ENDPOINT] {
        bench.set(place, STALL);
    }
    for token in [CONTROL, PIPE] {
        assert_eq!(bench.0.in_transaction(token), Handshake::Stall);
        assert_eq!(bench.0.out_transaction(token, &[1]), Handshake::Stall);
    }
    assert_eq!(bench.0.setup_transaction(CONTROL, [0; 8]), ACK);
    assert_eq!(bench.0.in_transaction(CONTROL), Handshake::Nak);
    assert_eq!(bench.0.out_transaction(CONTROL, &[]), Handshake::Nak);
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Stall);
    assert_eq!(bench.0.out_transaction(PIPE, &[1]), Handshake::Stall);
}

#[test]
fn an_address_is_its_own_after_the_status_stage() {
    let mut bench = ready();
    let request = [0, 5, 9, 0, 0, 0, 0, 0];
    assert_eq!(bench.0.setup_transaction(CONTROL, request), ACK);
    bench.set(DCFG, 9 << 4);
    send(&mut bench, 0, &[], 1);
    let there = Token {
        address: 9,
        endpoint: 0,
    };
    assert_eq!(bench.0.in_transaction(there), Handshake::Absent);
    assert_eq!(bench.0.in_transaction(CONTROL), ACK, "at the old one");
    assert_eq!(
        bench.0.setup_transaction(CONTROL, [0; 8]),
        Handshake::Absent
    );
    assert_eq!(bench.0.setup_transaction(there, [0; 8]), ACK);
}

#[test]
fn an_idle_bus_is_a_suspend_after_three_milliseconds() {
    let mut bench = ready();
    bench.0.suspend_bus();
    bench.run_us(2_900);
    assert_eq!(bench.read(GINTSTS) & USBSUSP, 0);
    bench.run_us(200);
    assert_ne!(bench.read(GINTSTS) & USBSUSP, 0);
    assert_eq!(bench.read(DSTS) & 1, 1);
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Absent);
    bench.0.resume_bus();
    assert_ne!(bench.read(GINTSTS) & WKUPINT, 0);
    assert_eq!(bench.read(DSTS) & 1, 0);
    assert_eq!(bench.0.in_transaction(PIPE), Handshake::Nak);
    // Two milliseconds are none.
    bench.write(GINTSTS, u32::MAX);
    bench.0.suspend_bus();
    bench.run_us(2_000);
    bench.0.resume_bus();
    bench.run_us(2_000);
    assert_eq!(bench.read(GINTSTS) & (USBSUSP | WKUPINT), 0);
}

#[test]
fn flushes_and_resets_leave_nothing() {
    let mut bench = ready();
    assert_eq!(bench.0.out_transaction(PIPE, &[1; 9]), ACK);
    send(&mut bench, 1, &[2; 9], 1);
    bench.write(GRSTCTL, 1 << 4 | 1 << 5 | 1 << 6);
    assert_eq!(bench.read(GRXSTSP), 0);
    assert_eq!(bench.read(DTXFSTS + ENDPOINT), 32);
    bench.write(GRSTCTL, 1);
    assert_eq!(bench.read(GRSTCTL) >> 31, 1, "AHBIDL");
    assert_eq!(bench.read(GINTMSK), 0);
    assert!(!bench.0.is_connected());
}
