//! A cable that is lent to a host outside, as over USB/IP.

use crate::{connected, streaming};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, LEASE_TICKS};
use crepitus_virtual_device::VirtualDevice;
use crepitus_virtual_device::board::Controller;
use crepitus_virtual_device::usb::control::TransferError;
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::wire::UsbWire;

fn enumerate(device: &mut VirtualDevice) -> Option<CdcHost> {
    device.lend_cable(|cable, mut run| CdcHost::enumerate(cable, &mut run).ok())
}

fn frame(device: &mut VirtualDevice, host: &mut CdcHost) -> Result<(), TransferError> {
    device.lend_cable(|cable, mut run| host.frame(cable, &mut run))
}

fn is_connected(device: &mut VirtualDevice) -> bool {
    device.lend_cable(|cable, _| cable.is_connected())
}

#[test]
fn the_other_host_has_the_device_alone() {
    let mut device = connected().device;
    assert!(device.is_plugged_in());
    let before = device.board().now();
    let mut host = enumerate(&mut device).expect("it enumerates");
    assert!(
        device.board().now() - before > 12 * 20,
        "a reset takes its time"
    );
    assert!(!device.is_plugged_in(), "not for the host in this process");
    let before = device.board().now();
    assert_eq!(frame(&mut device, &mut host), Ok(()));
    assert_eq!(
        device.board().now() - before,
        20,
        "a frame is a millisecond"
    );
    assert_eq!(host.device().serial_number.as_deref(), Some("SIM-COMMS-01"));
}

#[test]
fn a_pulled_cable_is_pulled_for_the_other_host_too() {
    let mut device = connected().device;
    let mut host = enumerate(&mut device).expect("it enumerates");
    device.unplug();
    assert!(!is_connected(&mut device));
    assert_eq!(frame(&mut device, &mut host), Err(TransferError::Detached));
    assert!(enumerate(&mut device).is_none());
    device.plug_in().expect("it enumerates");
    assert!(enumerate(&mut device).is_some());
}

#[test]
fn torque_ends_when_the_cable_changes_hands() {
    let mut device = streaming().device;
    assert!(device.board().is_driven());
    let mut host = enumerate(&mut device).expect("it enumerates");
    for _ in 0..=LEASE_TICKS / 20 {
        assert_eq!(frame(&mut device, &mut host), Ok(()));
    }
    assert!(!device.board().is_driven());
    assert_eq!(device.board().drive().fault(), Some(Fault::LeaseExpired));
}

#[test]
fn a_restart_of_comms_disconnects_the_device_until_the_next_call() {
    let mut device = connected().device;
    let mut host = enumerate(&mut device).expect("it enumerates");
    device
        .board_mut()
        .reset(Controller::Comms, ResetCause::Watchdog);
    let mut frames = 0;
    while frame(&mut device, &mut host).is_ok() {
        frames += 1;
        assert!(frames < 1_000, "it has not restarted");
    }
    assert!(is_connected(&mut device));
    assert!(enumerate(&mut device).is_some());
}
