//! The messages' bytes.

use crepitus_virtual_device::usb::usbip::messages::{
    Command, Completion, DeviceRecord, Direction, HEADER_LENGTH, MAX_TRANSFER, MessageError,
    Operation, Refusal, Submit, import_reply, list_reply, unlink_reply,
};
use proptest::prelude::*;

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    let text = |pair: &[u8]| String::from_utf8(pair.to_vec()).expect("digits");
    let byte = |pair: &[u8]| u8::from_str_radix(&text(pair), 16).expect("digits");
    digits.chunks(2).map(byte).collect()
}

/// The examples of the protocol's description: a transfer each way with an interrupt endpoint of
/// device 15 on bus 1.
const DEVICE: u32 = 0x0001_000f;
const IN: &str = "
    00000001 00000d05 0001000f 00000001 00000001 00000200 00000040 ffffffff 00000000 00000004
    00000000 00000000";
const OUT: &str = "
    00000001 00000d06 0001000f 00000000 00000001 00000000 00000040 ffffffff 00000000 00000004
    00000000 00000000";
const OUT_DATA: &str = "
    ffffffff 860008a7 84ce5ae2 12376300 00000000 00000000 00000000 00000000
    00000000 00000000 00000000 00000000 00000000 00000000 00000000 00000000";

/// One byte more than is accepted.
const TOO_LONG: u32 = 256 * 1024 + 1;

fn decode(bytes: &[u8]) -> Result<Option<(Command, usize)>, MessageError> {
    Command::decode(bytes, DEVICE)
}

#[test]
fn a_transfer_from_the_device() {
    let submit = Submit {
        sequence: 0x0d05,
        direction: Direction::In,
        endpoint: 1,
        flags: 0x200,
        length: 64,
        packets: 0,
        setup: [0; 8],
        data: vec![],
    };
    let message = bytes(IN);
    assert_eq!(decode(&message), Ok(Some((Command::Submit(submit), 48))));
    for length in 0..48 {
        assert_eq!(decode(&message[..length]), Ok(None));
    }
}

#[test]
fn a_transfer_to_the_device() {
    let message = [bytes(OUT), bytes(OUT_DATA), vec![0xee; 3]].concat();
    let Ok(Some((Command::Submit(submit), 112))) = decode(&message) else {
        panic!("{:?}", decode(&message));
    };
    assert_eq!(
        (submit.sequence, submit.direction),
        (0x0d06, Direction::Out)
    );
    assert_eq!((submit.length, submit.data), (64, bytes(OUT_DATA)));
    for length in 0..112 {
        assert_eq!(decode(&message[..length]), Ok(None));
    }
}

#[test]
fn a_control_transfer_keeps_its_setup_packet_as_it_is() {
    let message = bytes(
        "00000001 00000001 0001000f 00000001 00000000 00000200 00000012 00000000 ffffffff 00000000
         80060001 00001200",
    );
    let Ok(Some((Command::Submit(submit), 48))) = decode(&message) else {
        panic!("{:?}", decode(&message));
    };
    assert_eq!(submit.setup, [0x80, 6, 0, 1, 0, 0, 18, 0]);
    assert_eq!(submit.packets, u32::MAX);
}

#[test]
fn a_withdrawal() {
    let message = bytes(
        "00000002 00000d07 0001000f 00000000 00000000 00000d05 00000000 00000000 00000000 00000000
         00000000 00000000",
    );
    let unlink = Command::Unlink {
        sequence: 0x0d07,
        victim: 0x0d05,
    };
    assert_eq!(decode(&message), Ok(Some((unlink, 48))));
}

#[test]
fn every_defect_of_a_command_has_its_name() {
    let with = |index: usize, word: u32| {
        let mut message = bytes(OUT);
        message[4 * index..4 * index + 4].copy_from_slice(&word.to_be_bytes());
        decode(&message).expect_err("it is not accepted")
    };
    let command = MessageError::UnknownCommand { command: 3 };
    assert_eq!(with(0, 3), command, "a reply is no command");
    let other = MessageError::OtherDevice {
        imported: DEVICE,
        found: 0x0001_0002,
    };
    assert_eq!(with(2, 0x0001_0002), other);
    assert_eq!(with(3, 2), MessageError::Direction { direction: 2 });
    assert_eq!(with(4, 16), MessageError::Endpoint { endpoint: 16 });
    assert_eq!(with(4, 257), MessageError::Endpoint { endpoint: 257 });
    for bytes in [TOO_LONG, 0x8000_0000, u32::MAX] {
        assert_eq!(with(6, bytes), MessageError::TooLong { bytes });
    }
    for packets in [1, 8, 0x8000_0000] {
        assert_eq!(with(8, packets), MessageError::Isochronous { packets });
    }
    // The longest that is accepted.
    let mut message = bytes(OUT);
    message[24..28].copy_from_slice(&(TOO_LONG - 1).to_be_bytes());
    assert_eq!(decode(&message), Ok(None));
    message.resize(HEADER_LENGTH + MAX_TRANSFER, 0x11);
    let length = HEADER_LENGTH + MAX_TRANSFER;
    assert!(matches!(decode(&message), Ok(Some((_, used))) if used == length));
}

#[test]
fn requests_before_an_import() {
    let list = bytes("0111 8005 00000000");
    assert_eq!(
        Operation::decode(&list),
        Ok(Some((Operation::ListDevices, 8)))
    );
    let mut import = bytes("0111 8003 00000000");
    import.extend(b"1-1");
    import.resize(40, 0);
    let mut bus_id = [0; 32];
    bus_id[..3].copy_from_slice(b"1-1");
    let expected = Operation::Import { bus_id };
    assert_eq!(Operation::decode(&import), Ok(Some((expected, 40))));
    for (message, whole) in [(list, 8), (import, 40)] {
        for length in 0..whole {
            assert_eq!(Operation::decode(&message[..length]), Ok(None));
        }
    }
    assert_eq!(
        Operation::decode(b"GET / HTTP/1.1"),
        Err(MessageError::Version { found: 0x4745 })
    );
    assert_eq!(
        Operation::decode(&bytes("0106 8005")),
        Err(MessageError::Version { found: 0x0106 })
    );
    assert_eq!(
        Operation::decode(&bytes("0111 8004")),
        Err(MessageError::UnknownOperation { code: 0x8004 })
    );
}

fn record() -> DeviceRecord {
    DeviceRecord {
        path: "/a",
        bus_id: "1-1",
        bus: 1,
        number: 5,
        vendor_id: 0x16c0,
        product_id: 0x27dd,
        release: 0x0123,
        class: [2, 3, 4],
        configuration: 0,
        configurations: 1,
        interfaces: vec![[2, 2, 1], [10, 0, 0]],
    }
}

#[test]
fn a_list_has_the_device_and_its_interfaces() {
    let mut expected = bytes("0111 0005 00000000 00000001");
    let mut device = b"/a".to_vec();
    device.resize(256, 0);
    device.extend(b"1-1");
    device.resize(288, 0);
    device.extend(bytes(
        "00000001 00000005 00000002 16c0 27dd 0123 020304 00 01 02",
    ));
    assert_eq!(device.len(), 312);
    expected.extend(&device);
    expected.extend(bytes("02020100 0a000000"));
    assert_eq!(list_reply(Some(&record())), expected);
    assert_eq!(list_reply(None), bytes("0111 0005 00000000 00000000"));
    let expected = [bytes("0111 0003 00000000"), device].concat();
    assert_eq!(import_reply(Ok(&record())), expected);
    for (refusal, status) in [
        (Refusal::Busy, "00000002"),
        (Refusal::DeviceError, "00000003"),
        (Refusal::NoDevice, "00000004"),
    ] {
        let expected = [bytes("0111 0003"), bytes(status)].concat();
        assert_eq!(import_reply(Err(refusal)), expected);
    }
    assert_eq!(record().device_id(), 0x0001_0005);
}

#[test]
fn a_device_with_too_many_interfaces_is_described_as_far_as_it_goes() {
    let mut many = record();
    many.interfaces = vec![[1, 2, 3]; 300];
    let message = list_reply(Some(&many));
    assert_eq!(message.len(), 12 + 312 + 4 * 255);
    assert_eq!(message[12 + 311], 255);
}

#[test]
fn ends_of_transfers() {
    let completion = Completion {
        sequence: 0x0d05,
        status: 0,
        moved: 3,
        packets: u32::MAX,
        data: vec![0xaa, 0xbb, 0xcc],
    };
    let expected = bytes(
        "00000003 00000d05 00000000 00000000 00000000 00000000 00000003 00000000 ffffffff 00000000
         00000000 00000000 aabbcc",
    );
    assert_eq!(completion.encode(), expected);
    let stalled = Completion {
        sequence: 0x0d06,
        status: -32,
        moved: 0x0102,
        packets: 0,
        data: vec![],
    };
    let expected = bytes(
        "00000003 00000d06 00000000 00000000 00000000 ffffffe0 00000102 00000000 00000000 00000000
         00000000 00000000",
    );
    assert_eq!(stalled.encode(), expected);
    let expected = bytes(
        "00000004 00000d07 00000000 00000000 00000000 ffffff98 00000000 00000000 00000000 00000000
         00000000 00000000",
    );
    assert_eq!(unlink_reply(0x0d07, -104), expected);
}

/// Bytes that often look like a command for the device.
fn command_like() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![0..5_u32, Just(DEVICE), 0..300_000_u32, any::<u32>()];
    let words = prop::collection::vec(word, 12);
    let header = words.prop_map(|mut words| {
        if words[1].is_multiple_of(2) {
            words[2] = DEVICE;
        }
        words.into_iter().flat_map(u32::to_be_bytes).collect()
    });
    let whole = (header, 0..200_usize).prop_map(|(mut bytes, more): (Vec<u8>, usize)| {
        bytes.resize(bytes.len() + more, 0);
        bytes
    });
    prop_oneof![whole, prop::collection::vec(any::<u8>(), 0..100)]
}

proptest! {
    #[test]
    fn any_bytes_are_a_command_or_an_error(bytes in command_like()) {
        let decoded = decode(&bytes);
        if let Ok(Some((command, used))) = &decoded {
            prop_assert!(*used >= HEADER_LENGTH && *used <= bytes.len());
            if let Command::Submit(submit) = command {
                prop_assert!(submit.length <= MAX_TRANSFER && submit.endpoint < 16);
                let carried = used - HEADER_LENGTH;
                prop_assert_eq!(submit.data.len(), carried);
                prop_assert!(carried == 0 || carried == submit.length);
            }
            // Bytes behind the command change nothing; without its last byte it is incomplete.
            let longer = [bytes.as_slice(), &[0xff; 60]].concat();
            prop_assert_eq!(&decode(&longer), &decoded);
            prop_assert_eq!(decode(&bytes[..used - 1]), Ok(None));
        }
        if decoded == Ok(None) {
            prop_assert!(bytes.len() < HEADER_LENGTH + MAX_TRANSFER);
        }
    }

    #[test]
    fn any_bytes_are_a_request_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..50)) {
        if let Ok(Some((_, used))) = Operation::decode(&bytes) {
            prop_assert!(used <= bytes.len());
        }
    }

    #[test]
    fn any_request_of_this_version(code in prop_oneof![Just(3_u8), Just(5)], rest in prop::collection::vec(any::<u8>(), 0..50)) {
        let bytes = [&[0x01, 0x11, 0x80, code], rest.as_slice()].concat();
        let whole = if code == 5 { 8 } else { 40 };
        let used = Operation::decode(&bytes).map(|decoded| decoded.map(|(_, used)| used));
        prop_assert_eq!(used, Ok((bytes.len() >= whole).then_some(whole)));
    }
}
