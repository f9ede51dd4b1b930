//! Devices that answer nonsense: the host reports it and stays whole.

use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::configuration::ConfigurationDescriptor;
use crepitus_virtual_device::usb::control::TransferError;
use crepitus_virtual_device::usb::descriptors::{
    DescriptorError, DeviceDescriptor, parse_first_language, parse_string,
};
use crepitus_virtual_device::usb::enumeration::{CdcDevice, EnumerationError, Step};
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::wire::{Handshake, MAX_PACKET, Packet, Token, UsbWire};
use proptest::prelude::*;

/// A device whose every answer comes from a list, again and again.
#[derive(Debug, Clone)]
struct Script {
    answers: Vec<Handshake>,
    at: usize,
}

impl Script {
    fn next(&mut self) -> Handshake {
        self.at += 1;
        self.answers[self.at % self.answers.len()]
    }
}

impl UsbWire for Script {
    fn bus_reset(&mut self) {}

    fn setup_transaction(&mut self, _token: Token, _request: [u8; 8]) -> Handshake {
        Handshake::Ack(Packet::EMPTY)
    }

    fn out_transaction(&mut self, _token: Token, _data: &[u8]) -> Handshake {
        Handshake::Ack(Packet::EMPTY)
    }

    fn in_transaction(&mut self, _token: Token) -> Handshake {
        self.next()
    }
}

/// A serial port that is well-behaved until it answers by a script.
#[derive(Debug)]
struct Turned {
    request: [u8; 8],
    /// Bytes of the answer to it.
    sent: usize,
    then: Option<Script>,
}

impl Turned {
    /// Bytes that the request asks for.
    fn answer(&self) -> &'static [u8] {
        let [_, request, index, kind, ..] = self.request;
        match (request, kind, index) {
            (6, 1, _) => &[18, 1, 0, 2, 2, 0, 0, 64, 1, 2, 3, 4, 5, 6, 1, 2, 3, 1],
            (6, 2, _) => &SERIAL_CONFIGURATION,
            (6, 3, 0) => &[4, 3, 9, 4],
            (6, 3, _) => &[4, 3, b'x', 0],
            _ => &[],
        }
    }
}

impl UsbWire for Turned {
    fn bus_reset(&mut self) {}

    fn setup_transaction(&mut self, _token: Token, request: [u8; 8]) -> Handshake {
        (self.request, self.sent) = (request, 0);
        Handshake::Ack(Packet::EMPTY)
    }

    fn out_transaction(&mut self, _token: Token, _data: &[u8]) -> Handshake {
        Handshake::Ack(Packet::EMPTY)
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        if let Some(script) = &mut self.then {
            return script.next();
        }
        if token.endpoint != 0 {
            return Handshake::Nak;
        }
        let asked = usize::from(u16::from_le_bytes([self.request[6], self.request[7]]));
        let answer = self.answer();
        let rest = &answer[self.sent..asked.min(answer.len())];
        let part = &rest[..rest.len().min(MAX_PACKET)];
        self.sent += part.len();
        Handshake::Ack(Packet::new(part).expect("it fits"))
    }
}

/// Bytes that often look like descriptors: a small length, a known type.
fn descriptor_like() -> impl Strategy<Value = Vec<u8>> {
    let descriptor = (0..12_u8, 0..7_u8, prop::collection::vec(any::<u8>(), 0..10))
        .prop_map(|(length, kind, rest)| [vec![length, kind], rest].concat());
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..80),
        prop::collection::vec(descriptor, 0..6).prop_map(|parts| parts.concat()),
    ]
}

fn answer() -> impl Strategy<Value = Handshake> {
    let packet = prop_oneof![
        descriptor_like(),
        Just(vec![18, 1, 0, 2, 2, 0, 0, 64, 1, 2, 3, 4, 5, 6, 1, 2, 3, 1]),
        Just(vec![18, 1, 0, 2, 2, 0, 0, 8]),
    ];
    prop_oneof![
        8 => packet.prop_map(|mut bytes| {
            bytes.truncate(MAX_PACKET);
            Handshake::Ack(Packet::new(&bytes).expect("it fits"))
        }),
        1 => Just(Handshake::Stall),
        1 => Just(Handshake::Nak),
        1 => Just(Handshake::Absent),
    ]
}

proptest! {
    #[test]
    fn any_bytes_are_a_descriptor_or_an_error(bytes in descriptor_like()) {
        let _ = DeviceDescriptor::parse(&bytes);
        let _ = DeviceDescriptor::parse_max_packet_0(&bytes);
        let _ = ConfigurationDescriptor::parse_total_length(&bytes);
        let _ = parse_first_language(&bytes);
        let _ = parse_string(&bytes);
        let _ = ConfigurationDescriptor::parse(&bytes);
    }

    #[test]
    fn any_answers_end_the_enumeration(answers in prop::collection::vec(answer(), 1..20)) {
        let mut device = Script { answers, at: 0 };
        let _ = CdcHost::enumerate(&mut device, &mut |_| ());
    }

    #[test]
    fn a_serial_port_may_turn_hostile(answers in prop::collection::vec(answer(), 1..20)) {
        let mut device = Turned { request: [0; 8], sent: 0, then: None };
        let mut host = CdcHost::enumerate(&mut device, &mut |_| ()).expect("a serial port");
        device.then = Some(Script { answers, at: 0 });
        for _ in 0..5 {
            host.queue(b"anything");
            if host.frame(&mut device, &mut |_| ()).is_err() {
                break;
            }
        }
        let traffic = host.traffic();
        prop_assert!(host.read_all().len() as u64 <= traffic.bytes_in);
        prop_assert!(traffic.bytes_in <= 64 * traffic.packets_in, "{traffic:?}");
    }

    #[test]
    fn a_good_configuration_with_one_wrong_byte(at in 0..67_usize, value: u8) {
        let mut bytes = SERIAL_CONFIGURATION;
        bytes[at] = value;
        if let Ok(configuration) = ConfigurationDescriptor::parse(&bytes)
            && let Ok(function) = configuration.serial_function()
        {
            for pipe in [function.bulk_in, function.bulk_out] {
                prop_assert!((1..=64).contains(&pipe.max_packet), "{pipe:?}");
            }
        }
    }
}

#[rustfmt::skip]
const SERIAL_CONFIGURATION: [u8; 67] = [
    9, 2, 67, 0, 2, 1, 0, 0x80, 50,
    9, 4, 0, 0, 1, 0x02, 0x02, 0, 0,
    5, 0x24, 0x00, 0x10, 0x01,
    4, 0x24, 0x02, 0x00,
    5, 0x24, 0x06, 0, 1,
    5, 0x24, 0x01, 0x00, 1,
    7, 5, 0x81, 3, 8, 0, 255,
    9, 4, 1, 0, 2, 0x0a, 0, 0, 0,
    7, 5, 0x82, 2, 64, 0, 0,
    7, 5, 0x01, 2, 64, 0, 0,
];

#[test]
fn every_defect_has_its_name() {
    let parse = ConfigurationDescriptor::parse;
    assert!(parse(&SERIAL_CONFIGURATION).is_ok());
    assert_eq!(parse(&[]), Err(DescriptorError::Truncated { at: 0 }));
    let cut = &SERIAL_CONFIGURATION[..66];
    assert_eq!(parse(cut), Err(DescriptorError::Truncated { at: 60 }));
    assert_eq!(
        parse(&SERIAL_CONFIGURATION[9..]),
        Err(DescriptorError::WrongType {
            expected: 2,
            found: 4
        })
    );
    let mut orphan = SERIAL_CONFIGURATION[..9].to_vec();
    orphan.extend([7, 5, 0x82, 2, 64, 0, 0]);
    assert_eq!(parse(&orphan), Err(DescriptorError::Orphan { at: 9 }));
    let mut short = SERIAL_CONFIGURATION[..9].to_vec();
    short.extend([5, 4, 0, 0, 1]);
    assert_eq!(
        parse(&short),
        Err(DescriptorError::TooShort {
            kind: 4,
            length: 5,
            expected: 9
        })
    );
    let no_data = parse(&SERIAL_CONFIGURATION[..44]).expect("well formed");
    assert_eq!(no_data.serial_function(), Err(DescriptorError::NotSerial));
    let packet_size = DeviceDescriptor::parse_max_packet_0(&[18, 1, 0, 2, 2, 0, 0, 7]);
    assert_eq!(
        packet_size,
        Err(DescriptorError::ControlPacketSize { size: 7 })
    );
    assert_eq!(parse_string(&[3, 3, 0]), Err(DescriptorError::NotUtf16));
    assert_eq!(
        parse_string(&[4, 3, 0, 0xd8]),
        Err(DescriptorError::NotUtf16)
    );
}

#[test]
fn a_device_that_sends_too_much_is_named() {
    let mut device = Script {
        answers: vec![Handshake::Ack(Packet::new(&[0; 20]).expect("it fits"))],
        at: 0,
    };
    let result = CdcDevice::enumerate(&mut device, &mut |_| ());
    assert_eq!(
        result,
        Err(EnumerationError::Transfer {
            step: Step::GetPacketSize,
            cause: TransferError::Overrun {
                received: 20,
                requested: 8
            },
        })
    );
}

#[test]
fn a_bus_without_a_device_stack_answers_nobody() {
    let (_bus, mut cable) = SoftBus::new();
    assert!(!cable.is_connected());
    cable.bus_reset();
    let token = Token {
        address: 0,
        endpoint: 0,
    };
    assert_eq!(cable.setup_transaction(token, [0; 8]), Handshake::Absent);
    assert_eq!(cable.out_transaction(token, &[]), Handshake::Absent);
    assert_eq!(cable.in_transaction(token), Handshake::Absent);
}
