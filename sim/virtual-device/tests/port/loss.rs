//! Hosts come and go: pulled cables, bus resets, sleep, unconfiguration.

use crate::rig::{Device, Echo, Source, frames, pattern_bytes, with_device, with_host};
use crepitus_device::usb_port::HostBytes;
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::control::{ControlRequest, TransferError};
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::wire::{Handshake, Packet, Token, UsbWire};

fn replug<E: HostBytes>(cable: &mut SoftCable, device: &mut Device<'_, E>) -> CdcHost {
    cable.plug_in();
    CdcHost::enumerate(cable, &mut device.turn()).expect("it enumerates")
}

#[test]
fn before_a_host_configures_it_the_end_keeps_its_bytes() {
    with_device(Source::new(100), |mut device, mut cable| {
        for _ in 0..100 {
            device.turn()(&mut cable);
        }
        assert_eq!((device.end.at, device.end.hosts_lost), (0, 0));
        let mut host = replug(&mut cable, &mut device);
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), pattern_bytes(100));
    });
}

#[test]
fn unplugged_in_mid_transfer_and_plugged_in_again() {
    // At every phase of a stream of packets, including just after a full one.
    for turns in 0..60 {
        with_host(Source::new(5_000), |mut device, mut cable, mut host| {
            for turn in 0..turns {
                if turn % 20 == 0 {
                    host.start_frame();
                }
                host.poll(&mut cable).expect("the bus works");
                device.turn()(&mut cable);
            }
            cable.unplug();
            host.start_frame();
            assert_eq!(host.poll(&mut cable), Err(TransferError::Detached));
            for _ in 0..10 {
                device.turn()(&mut cable);
            }
            assert_eq!(device.end.hosts_lost, 1, "told once");
            assert!(!device.port.is_configured());
            // The source starts again from its first byte: so must what the new host reads.
            let mut host = replug(&mut cable, &mut device);
            frames(10, &mut host, &mut cable, &mut device);
            assert!(host.read_all() == pattern_bytes(5_000), "turn {turns}");
            assert_eq!(device.end.hosts_lost, 1);
        });
    }
}

#[test]
fn a_host_that_sends_when_the_plug_is_pulled_leaves_nothing_behind() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        host.queue(&pattern_bytes(1_000));
        frames(1, &mut host, &mut cable, &mut device);
        host.start_frame();
        host.poll(&mut cable).expect("the bus works"); // a packet the device has not seen
        cable.unplug();
        let mut host = replug(&mut cable, &mut device);
        frames(2, &mut host, &mut cable, &mut device);
        assert!(host.read_all().is_empty());
        assert_eq!(device.end.hosts_lost, 1);
        host.queue(b"fresh");
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), b"fresh");
    });
}

#[test]
fn a_bus_reset_during_transfers_is_a_fresh_start() {
    with_host(Source::new(3_000), |mut device, mut cable, mut host| {
        for resets in 1..=5 {
            frames(1, &mut host, &mut cable, &mut device);
            cable.bus_reset();
            let frame = host.frame(&mut cable, &mut device.turn());
            assert_eq!(frame, Err(TransferError::Detached));
            device.turn()(&mut cable);
            assert_eq!(device.end.hosts_lost, resets);
            host = CdcHost::enumerate(&mut cable, &mut device.turn()).expect("it enumerates");
        }
        frames(5, &mut host, &mut cable, &mut device);
        assert!(host.read_all() == pattern_bytes(3_000), "a byte is wrong");
    });
}

#[test]
fn a_host_that_sleeps_and_wakes_finds_a_fresh_start() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        host.set_open(false);
        host.queue(&[0xaa; 1_000]);
        frames(4, &mut host, &mut cable, &mut device);
        cable.suspend();
        for _ in 0..10 {
            device.turn()(&mut cable);
        }
        assert_eq!(device.end.hosts_lost, 1);
        cable.resume();
        device.turn()(&mut cable);
        assert!(device.port.is_configured(), "no new enumeration needed");
        host.set_open(true);
        host.queue(b"good morning");
        frames(2, &mut host, &mut cable, &mut device);
        // One packet of before was in the endpoint: documented, and all there is.
        let mut expected = vec![0xaa; 64];
        expected.extend(b"good morning");
        assert_eq!(host.read_all(), expected);
        assert_eq!(device.end.hosts_lost, 1);
    });
}

fn set_configuration(value: u16) -> ControlRequest {
    ControlRequest {
        request_type: 0,
        request: 9,
        value,
        index: 0,
    }
}

#[test]
fn what_an_unconfigured_device_receives_is_not_for_the_end() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        let control = host.device().control;
        let configure = |value, cable: &mut SoftCable, device: &mut Device<'_, Echo>| {
            let request = set_configuration(value);
            let answer = control.write(cable, &mut device.turn(), request, &[]);
            assert_eq!(answer, Ok(()));
        };
        configure(0, &mut cable, &mut device);
        for _ in 0..3 {
            let token = Token {
                address: control.address,
                endpoint: 1,
            };
            let answer = cable.out_transaction(token, b"nobody home");
            assert_eq!(
                answer,
                Handshake::Ack(Packet::EMPTY),
                "the endpoint stays free"
            );
            device.turn()(&mut cable);
        }
        configure(1, &mut cable, &mut device);
        host.queue(b"home");
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), b"home");
    });
}

#[test]
fn an_unconfigured_device_keeps_at_most_one_packet() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        let control = host.device().control;
        host.set_open(false);
        host.queue(&[0xaa; 1_000]);
        frames(4, &mut host, &mut cable, &mut device);
        for (value, lost) in [(0, 1), (0, 1), (1, 1), (0, 2), (1, 2)] {
            let request = set_configuration(value);
            let answer = control.write(&mut cable, &mut device.turn(), request, &[]);
            assert_eq!(answer, Ok(()));
            assert_eq!(device.end.hosts_lost, lost);
            assert_eq!(device.port.is_configured(), value == 1);
        }
        host.set_open(true);
        host.queue(b"again");
        frames(2, &mut host, &mut cable, &mut device);
        let mut expected = vec![0xaa; 64];
        expected.extend(b"again");
        assert_eq!(host.read_all(), expected);
    });
}

#[test]
fn a_halted_pipe_is_an_error_until_it_is_cleared() {
    let halt = |request| ControlRequest {
        request_type: 2,
        request,
        value: 0,
        index: 0x82,
    };
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        let control = host.device().control;
        let set = control.write(&mut cable, &mut device.turn(), halt(3), &[]);
        assert_eq!(set, Ok(()));
        host.queue(b"held");
        let frame = host.frame(&mut cable, &mut device.turn());
        assert_eq!(frame, Err(TransferError::Stalled { endpoint: 2 }));
        let clear = control.write(&mut cable, &mut device.turn(), halt(1), &[]);
        assert_eq!(clear, Ok(()));
        frames(2, &mut host, &mut cable, &mut device);
        assert_eq!(host.read_all(), b"held");
    });
}

#[test]
fn the_interrupt_line_is_active_while_there_is_something_to_poll_for() {
    with_host(Echo::default(), |mut device, mut cable, mut host| {
        device.turn()(&mut cable);
        assert!(!cable.interrupt_pending());
        host.queue(b"x");
        host.start_frame();
        host.poll(&mut cable).expect("the bus works");
        assert!(cable.interrupt_pending(), "a packet has come");
        device.turn()(&mut cable);
        assert!(!cable.interrupt_pending());
        host.poll(&mut cable).expect("the bus works");
        assert!(cable.interrupt_pending(), "a packet has gone");
        device.turn()(&mut cable);
        assert!(!cable.interrupt_pending());
        cable.bus_reset();
        assert!(cable.interrupt_pending());
    });
}
