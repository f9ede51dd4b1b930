//! The software bus by itself: each rule of the peripheral, driven by hand from both ends.

use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::wire::{Handshake, Packet, Token, UsbWire};
use usb_device::bus::{PollResult, UsbBus};
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{UsbDirection, UsbError};

const CONTROL: Token = Token {
    address: 0,
    endpoint: 0,
};
const PIPE: Token = Token {
    address: 0,
    endpoint: 1,
};
const ACK: Handshake = Handshake::Ack(Packet::EMPTY);

fn endpoint_in(index: usize) -> EndpointAddress {
    EndpointAddress::from_parts(index, UsbDirection::In)
}

fn endpoint_out(index: usize) -> EndpointAddress {
    EndpointAddress::from_parts(index, UsbDirection::Out)
}

/// Control endpoint and one bulk pipe each way, enabled, after a bus reset.
fn ready() -> (SoftBus, SoftCable) {
    let (mut bus, mut cable) = SoftBus::new();
    for direction in [UsbDirection::In, UsbDirection::Out] {
        let zero = EndpointAddress::from_parts(0, direction);
        bus.alloc_ep(direction, Some(zero), EndpointType::Control, 8, 0)
            .expect("free");
        bus.alloc_ep(direction, None, EndpointType::Bulk, 64, 0)
            .expect("free");
    }
    bus.enable();
    cable.bus_reset();
    assert!(matches!(bus.poll(), PollResult::Reset));
    bus.reset();
    (bus, cable)
}

/// `ep_out`, `ep_in_complete` and `ep_setup` of a poll.
fn events(bus: &SoftBus) -> (u16, u16, u16) {
    match bus.poll() {
        PollResult::Data {
            ep_out,
            ep_in_complete,
            ep_setup,
        } => (ep_out, ep_in_complete, ep_setup),
        PollResult::None => (0, 0, 0),
        _ => panic!("an event of the line"),
    }
}

#[test]
fn endpoints_are_given_once() {
    let (mut bus, _cable) = ready();
    let mut allocate = |address| bus.alloc_ep(UsbDirection::In, address, EndpointType::Bulk, 64, 0);
    let taken = allocate(Some(endpoint_in(1)));
    assert_eq!(taken, Err(UsbError::InvalidEndpoint));
    let beyond = allocate(Some(endpoint_in(16)));
    assert_eq!(beyond, Err(UsbError::InvalidEndpoint));
    for index in 2..16 {
        assert_eq!(allocate(None), Ok(endpoint_in(index)));
    }
    assert_eq!(allocate(None), Err(UsbError::EndpointOverflow));
}

#[test]
fn sizes_are_checked_at_both_ends() {
    let (bus, mut cable) = ready();
    let long = [0; 65];
    assert_eq!(
        bus.write(endpoint_in(1), &long),
        Err(UsbError::BufferOverflow)
    );
    assert_eq!(
        bus.write(endpoint_in(0), &long[..9]),
        Err(UsbError::BufferOverflow)
    );
    assert_eq!(cable.out_transaction(PIPE, &long), Handshake::Absent);
    assert_eq!(
        cable.out_transaction(CONTROL, &long[..9]),
        Handshake::Absent
    );
    assert_eq!(cable.out_transaction(PIPE, &long[..10]), ACK);
    let mut small = [0; 9];
    let lost = bus.read(endpoint_out(1), &mut small);
    assert_eq!(lost, Err(UsbError::BufferOverflow));
    assert_eq!(cable.out_transaction(PIPE, b"next"), ACK);
}

#[test]
fn what_does_not_exist_does_not_answer() {
    let (bus, mut cable) = ready();
    for token in [
        Token {
            endpoint: 2,
            ..PIPE
        },
        Token {
            endpoint: 16,
            ..PIPE
        },
        Token { address: 9, ..PIPE },
    ] {
        assert_eq!(cable.in_transaction(token), Handshake::Absent);
        assert_eq!(cable.out_transaction(token, &[]), Handshake::Absent);
        assert_eq!(cable.setup_transaction(token, [0; 8]), Handshake::Absent);
    }
    let invalid = Err(UsbError::InvalidEndpoint);
    assert_eq!(bus.write(endpoint_in(2), &[]), invalid);
    assert_eq!(bus.write(endpoint_out(1), &[]), invalid);
    assert_eq!(bus.read(endpoint_out(2), &mut []), invalid);
    assert_eq!(bus.read(endpoint_in(1), &mut []), invalid);
    bus.set_device_address(9);
    assert_eq!(cable.in_transaction(PIPE), Handshake::Absent);
    let addressed = Token { address: 9, ..PIPE };
    assert_eq!(cable.in_transaction(addressed), Handshake::Nak);
}

#[test]
fn a_setup_ends_what_the_control_endpoint_was_doing() {
    let (bus, mut cable) = ready();
    assert_eq!(bus.write(endpoint_in(0), b"old"), Ok(3));
    assert_eq!(cable.out_transaction(CONTROL, b"old"), ACK);
    bus.set_stalled(endpoint_in(0), true);
    bus.set_stalled(endpoint_out(0), true);
    assert_eq!(cable.in_transaction(CONTROL), Handshake::Stall);
    assert_eq!(cable.out_transaction(CONTROL, &[]), Handshake::Stall);

    assert_eq!(cable.setup_transaction(CONTROL, [1; 8]), ACK);
    assert_eq!(cable.setup_transaction(CONTROL, [2; 8]), ACK, "repeated");
    assert!(!bus.is_stalled(endpoint_in(0)) && !bus.is_stalled(endpoint_out(0)));
    assert_eq!(events(&bus), (0, 0, 1));
    assert_eq!(cable.in_transaction(CONTROL), Handshake::Nak);
    // The data stage waits until the request has been read.
    assert_eq!(cable.out_transaction(CONTROL, b"data"), Handshake::Nak);
    let mut buffer = [0; 8];
    assert_eq!(bus.read(endpoint_out(0), &mut buffer), Ok(8));
    assert_eq!(buffer, [2; 8]);
    assert_eq!(cable.out_transaction(CONTROL, b"data"), ACK);
    assert_eq!(events(&bus), (1, 0, 0));
}
