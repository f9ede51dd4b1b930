//! Information that a host obtains about the device, and requests that it may not make.

use crate::rig::{Device, Echo, IDENTITY, with_device, with_host};
use crepitus_device::usb_port::{PRODUCT_ID, UsbIdentity, UsbPort, UsbPortError, VENDOR_ID};
use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::control::{ControlRequest, TransferError};
use crepitus_virtual_device::usb::enumeration::{CdcDevice, EnumerationError, Step};
use usb_device::bus::UsbBusAllocator;

#[rustfmt::skip]
const DEVICE_DESCRIPTOR: [u8; 18] = [
    18, 1, 0x00, 0x02,       // USB 2.0
    0x02, 0, 0,              // CDC
    64,
    0xc0, 0x16, 0xdd, 0x27,  // vendor, product
    0x10, 0x00,              // release
    1, 2, 3,                 // strings
    1,
];

#[rustfmt::skip]
const CONFIGURATION_DESCRIPTOR: [u8; 67] = [
    9, 2, 67, 0, 2, 1, 0, 0xc0, 10,       // two interfaces, self-powered, 20 mA
    9, 4, 0, 0, 1, 0x02, 0x02, 0, 0,      // interface 0: CDC-ACM
    5, 0x24, 0x00, 0x10, 0x01,            // header, CDC 1.10
    4, 0x24, 0x02, 0x00,                  // ACM
    5, 0x24, 0x06, 0, 1,                  // union
    5, 0x24, 0x01, 0x00, 1,               // call management
    7, 5, 0x81, 3, 8, 0, 255,             // notifications
    9, 4, 1, 0, 2, 0x0a, 0, 0, 0,         // interface 1: CDC data
    7, 5, 0x82, 2, 64, 0, 0,              // bulk IN
    7, 5, 0x01, 2, 64, 0, 0,              // bulk OUT
];

const GET_DESCRIPTOR: ControlRequest = ControlRequest {
    request_type: 0x80,
    request: 6,
    value: 0,
    index: 0,
};

#[test]
fn descriptors_are_the_expected_bytes() {
    with_host(Echo::default(), |mut device, mut cable, host| {
        let control = host.device().control;
        let mut get = |value| {
            let request = ControlRequest {
                value,
                ..GET_DESCRIPTOR
            };
            control.read(&mut cable, &mut device.turn(), request, 255)
        };
        assert_eq!(get(0x0100), Ok(DEVICE_DESCRIPTOR.to_vec()));
        assert_eq!(get(0x0200), Ok(CONFIGURATION_DESCRIPTOR.to_vec()));
    });
}

#[test]
fn the_host_understands_them() {
    with_host(Echo::default(), |device, _cable, host| {
        assert!(device.port.is_configured());
        let found = host.device();
        assert_eq!(found.device.vendor_id, VENDOR_ID);
        assert_eq!(found.device.product_id, PRODUCT_ID);
        assert_eq!(found.device.usb_release, 0x0200);
        assert_eq!(found.configuration.interfaces.len(), 2);
        assert_eq!(found.configuration.max_power_ma, 20);
        assert!(found.configuration.is_self_powered);
        assert_eq!(found.function.control_interface, 0);
        assert_eq!(found.function.bulk_in.address, 0x82);
        assert_eq!(found.function.bulk_out.address, 0x01);
        assert_eq!(found.manufacturer.as_deref(), Some(IDENTITY.manufacturer));
        assert_eq!(found.product.as_deref(), Some(IDENTITY.product));
        assert_eq!(found.serial_number.as_deref(), Some(IDENTITY.serial_number));
    });
}

#[test]
fn no_device_is_an_error_at_the_first_request() {
    let absent = EnumerationError::Transfer {
        step: Step::GetPacketSize,
        cause: TransferError::Detached,
    };
    with_device(Echo::default(), |mut device, mut cable| {
        // Pulled out, and there but never running.
        let silent = CdcDevice::enumerate(&mut cable, &mut |_| ());
        assert_eq!(silent, Err(absent));
        cable.unplug();
        let unplugged = CdcDevice::enumerate(&mut cable, &mut device.turn());
        assert_eq!(unplugged, Err(absent));
        assert_eq!(
            absent.to_string(),
            "GET_DESCRIPTOR (device, 8 bytes): the device does not answer"
        );
    });
}

#[test]
fn a_device_that_hangs_is_a_time_out_at_the_request_it_hangs_in() {
    with_device(Echo::default(), |mut device, mut cable| {
        let mut turns = 0;
        // The device handles the bus reset and then no more.
        let result = CdcDevice::enumerate(&mut cable, &mut |cable| {
            turns += 1;
            if turns <= 200 {
                device.turn()(cable);
            }
        });
        assert_eq!(
            result,
            Err(EnumerationError::Transfer {
                step: Step::GetPacketSize,
                cause: TransferError::TimedOut { turns: 10_000 },
            })
        );
    });
}

#[test]
fn the_cable_can_be_pulled_at_any_turn_of_the_enumeration() {
    let mut turns_needed = 0;
    with_device(Echo::default(), |mut device, mut cable| {
        CdcDevice::enumerate(&mut cable, &mut |cable| {
            turns_needed += 1;
            device.turn()(cable);
        })
        .expect("it enumerates");
    });
    for last in 0..turns_needed {
        with_device(Echo::default(), |mut device, mut cable| {
            let mut turn = 0;
            let result = CdcDevice::enumerate(&mut cable, &mut |cable| {
                if turn == last {
                    cable.unplug();
                }
                turn += 1;
                device.turn()(cable);
            });
            assert!(
                matches!(
                    result,
                    Err(EnumerationError::Transfer {
                        cause: TransferError::Detached,
                        ..
                    })
                ),
                "turn {last}: {result:?}"
            );
            cable.plug_in();
            CdcDevice::enumerate(&mut cable, &mut device.turn()).expect("it enumerates");
        });
    }
}

#[test]
fn strings_up_to_the_longest_descriptor_arrive_whole() {
    for units in [0, 1, 31, 63, 125, 126] {
        let text = "x".repeat(units);
        let (bus, mut cable) = SoftBus::new();
        let allocator = UsbBusAllocator::new(bus);
        let identity = UsbIdentity {
            serial_number: &text,
            ..IDENTITY
        };
        let port = UsbPort::new(&allocator, &identity).expect("it fits");
        let mut device = Device {
            port,
            end: Echo::default(),
        };
        let found = CdcDevice::enumerate(&mut cable, &mut device.turn()).expect("it enumerates");
        assert_eq!(found.serial_number, Some(text.clone()));
    }
}

#[test]
fn a_longer_string_is_refused() {
    let text = "\u{10348}".repeat(63) + "x";
    let (bus, _cable) = SoftBus::new();
    let allocator = UsbBusAllocator::new(bus);
    let identity = UsbIdentity {
        product: &text,
        ..IDENTITY
    };
    let refused = UsbPort::new(&allocator, &identity).err();
    assert_eq!(refused, Some(UsbPortError::StringTooLong { units: 127 }));
}
