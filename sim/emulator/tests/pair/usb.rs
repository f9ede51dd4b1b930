//! The bus itself: requests, stalls, suspend, the plug.

use crate::host::{MS, boards, client, connected, pair, run};
use crepitus_emulator::pair::Boards;
use crepitus_emulator::{Pair, Pin};
use crepitus_protocol::usb::{PRODUCT_ID, VENDOR_ID};
use crepitus_virtual_device::usb::control::{ControlPipe, ControlRequest, TransferError};
use std::time::Duration;

const STALLED: TransferError = TransferError::Stalled { endpoint: 0 };

/// The control pipe of a device that is enumerated.
pub(crate) const PIPE: ControlPipe = ControlPipe {
    address: 5,
    max_packet: 64,
};

pub(crate) const fn request(request_type: u8, request: u8, value: u16) -> ControlRequest {
    ControlRequest {
        request_type,
        request,
        value,
        index: 0,
    }
}

pub(crate) const GET_LINE_CODING: ControlRequest = request(0xa1, 0x21, 0);
pub(crate) const SET_LINE_CODING: ControlRequest = request(0x21, 0x20, 0);
const GET_STATUS: ControlRequest = request(0x80, 0, 0);

/// A descriptor of this kind and number.
pub(crate) const fn descriptor(kind: u8, number: u8) -> ControlRequest {
    request(0x80, 6, u16::from_be_bytes([kind, number]))
}

pub(crate) fn plugged_in() -> Option<Pair> {
    let mut pair = pair()?;
    pair.plug_in().expect("a device");
    Some(pair)
}

pub(crate) fn read(
    pair: &mut Pair,
    asked: ControlRequest,
    most: u16,
) -> Result<Vec<u8>, TransferError> {
    PIPE.read(pair.boards_mut(), &mut turn, asked, most)
}

pub(crate) fn write(
    pair: &mut Pair,
    asked: ControlRequest,
    data: &[u8],
) -> Result<(), TransferError> {
    PIPE.write(pair.boards_mut(), &mut turn, asked, data)
}

pub(crate) fn turn(boards: &mut Boards) {
    boards.run(1);
}

#[test]
fn it_says_what_it_is() {
    let Some(mut pair) = plugged_in() else { return };
    let device = pair.host().expect("a host").device().clone();
    assert_eq!(device.device.vendor_id, VENDOR_ID);
    assert_eq!(device.device.product_id, PRODUCT_ID);
    assert_eq!(device.device.usb_release, 0x200);
    assert!(device.configuration.is_self_powered);
    assert_eq!(device.manufacturer.as_deref(), Some("Crepitus"));
    // The chip's own number.
    let serial = device.serial_number.expect("a serial number");
    assert_eq!(serial, "0100020003454d554c343035");
    assert_eq!(read(&mut pair, GET_STATUS, 2), Ok(vec![1, 0]));
}

#[test]
fn what_it_does_not_know_it_stalls_and_the_next_request_works() {
    let Some(mut pair) = plugged_in() else { return };
    for unknown in [
        descriptor(3, 200),
        // DEVICE_QUALIFIER: a full-speed device has none.
        descriptor(6, 0),
        request(0xc0, 99, 0),
    ] {
        assert_eq!(read(&mut pair, unknown, 64), Err(STALLED), "{unknown:?}");
        let device = read(&mut pair, descriptor(1, 0), 18).expect("a descriptor");
        assert_eq!(device.len(), 18);
    }
    assert_eq!(
        write(&mut pair, request(0x40, 99, 0), &[1, 2]),
        Err(STALLED)
    );
    // More than there is: what there is. Less: so much.
    for (most, length) in [(255, 18), (18, 18), (7, 7)] {
        let device = read(&mut pair, descriptor(1, 0), most).expect("a descriptor");
        assert_eq!(device.len(), length);
    }
}

#[test]
fn line_coding_is_kept_and_means_nothing() {
    let Some(mut pair) = plugged_in() else { return };
    let coding = [0x80, 0x25, 0, 0, 0, 2, 7];
    write(&mut pair, SET_LINE_CODING, &coding).expect("taken");
    assert_eq!(
        read(&mut pair, GET_LINE_CODING, 7).as_deref(),
        Ok(&coding[..])
    );
}

#[test]
fn a_halted_pipe_is_cleared() {
    let Some(mut host) = connected() else { return };
    let bulk_in = {
        let port = host.transport_mut().pair.host().expect("a host");
        u16::from(port.device().function.bulk_in.address)
    };
    let halt = |request| ControlRequest {
        request_type: 0x02,
        request,
        value: 0,
        index: bulk_in,
    };
    let pair = &mut host.transport_mut().pair;
    write(pair, halt(3), &[]).expect("halted");
    let port = pair.host().expect("a host").clone().poll(pair.boards_mut());
    assert!(matches!(port, Err(TransferError::Stalled { endpoint: 2 })));
    write(pair, halt(1), &[]).expect("cleared");
    assert!(host.status().is_ok(), "it goes on");
}

#[test]
fn a_suspend_loses_the_host_and_a_resume_finds_it_again() {
    let Some(mut host) = connected() else { return };
    boards(&mut host).comms_mut().mcu_mut().suspend_bus();
    // While frames are missing nobody asks.
    boards(&mut host).run(10 * MS);
    boards(&mut host).comms_mut().mcu_mut().resume_bus();
    boards(&mut host).run(2 * MS);
    assert!(host.transport_mut().pair.is_plugged_in());
    let status = host.status().expect("the same session goes on");
    assert!(status.drive_present);
}

/// Both flags stand when the driver looks: it reports the resume, then the suspend
/// that was before it. The next packet wakes the device all the same.
#[test]
fn a_suspend_and_a_resume_at_once_end_awake() {
    let Some(mut host) = connected() else { return };
    boards(&mut host).comms_mut().mcu_mut().set_hung(true);
    boards(&mut host).comms_mut().mcu_mut().suspend_bus();
    boards(&mut host).run(4 * MS);
    boards(&mut host).comms_mut().mcu_mut().resume_bus();
    boards(&mut host).comms_mut().mcu_mut().set_hung(false);
    boards(&mut host).run(2 * MS);
    assert!(
        host.status().is_ok(),
        "the device sleeps on a bus that is awake"
    );
}

#[test]
fn the_plug_can_be_pulled_twenty_times() {
    let Some(mut pair) = pair() else { return };
    // The drive need not run.
    pair.boards_mut().mcu_mut().set_hung(true);
    for n in 0..20 {
        assert!(pair.plug_in().is_ok(), "{n}");
        for _ in 0..n {
            pair.tick();
        }
        pair.unplug();
        for _ in 0..(n % 5) * MS {
            pair.tick();
        }
    }
    let mut host = client(pair);
    assert!(host.status().is_ok());
    assert_eq!(boards(&mut host).comms().resets(), []);
}

#[test]
fn pins_that_are_not_its_own_are_no_device() {
    let Some(mut pair) = plugged_in() else { return };
    let mcu = pair.boards_mut().comms_mut().mcu_mut();
    assert!(mcu.is_connected());
    // PA12 is an input.
    let moder = mcu.peek(0x4002_0000).expect("a port");
    mcu.poke(0x4002_0000, moder & !(3 << 24));
    assert!(!mcu.is_connected());
    mcu.poke(0x4002_0000, moder);
    assert!(mcu.is_connected());
    assert_eq!(mcu.pin_setup(Pin::new('A', 12)).mode.to_string(), "AF10");
    // Soft disconnect.
    mcu.poke(0x5000_0804, 2);
    assert!(!mcu.is_connected());
}

/// Blocks arrive each millisecond, and a reply of several packets beside them at once.
#[test]
fn blocks_and_replies_arrive_at_once() {
    let Some(mut host) = connected() else { return };
    let before = host.transport_mut().pair.traffic();
    host.subscribe().expect("a subscription");
    let events = run(&mut host, 60);
    assert!(events.len() >= 58, "{}", events.len());
    let after = host.transport_mut().pair.traffic();
    let packets = after.packets_in - before.packets_in;
    let bytes = after.bytes_in - before.bytes_in;
    println!("{packets} packets, {bytes} bytes in 60 ms");
    let mut worst = Duration::ZERO;
    for _ in 0..20 {
        let begin = host.now();
        host.parameters().expect("parameters");
        let took = host.now().saturating_sub(begin);
        // Sent as it is made, not with the next tick of comms.
        assert!(took < Duration::from_micros(2_500), "{took:?}");
        worst = worst.max(took);
    }
    println!("parameters: at worst after {worst:?}");
}
