//! Discovery, handshake and compatibility.

use crate::support::{Port, client, device, golden, ms, options};
use crepitus_client::Transport as _;
use crepitus_client::{Client, Error, Management, RequestKind};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{State, schema};

#[test]
fn a_silent_device_is_a_timeout() {
    let (shared, port) = device();
    shared.borrow_mut().to_host.swallow = usize::MAX;
    let error = Client::connect(port).unwrap_err();
    let Error::NoAnswer { request, tries, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!((*request, *tries), (RequestKind::Hello, 10));
    assert_eq!(
        error.to_string(),
        "timeout: no reply from bench to `hello` after 10 tries in 1000 ms; \
         check that it is a Crepitus device and that it has power"
    );
}

#[test]
fn a_device_whose_drive_is_silent_is_connected_all_the_same() {
    let (shared, port) = device();
    shared.borrow_mut().link_is_cut = true;
    let mut client = client(port, 1);
    assert_eq!(client.handshake().drive, None);
    assert!(!client.status().unwrap().drive_present);
}

#[test]
fn a_schema_mismatch_is_reported_with_its_remedy() {
    for (name, comms, drive) in [
        ("older-comms", ([0, 0, 9], 0x0123_4567_89ab_cdef), None),
        ("newer-comms", ([0, 2, 0], 0xfedc_ba98_7654_3210), None),
        (
            "other-sources",
            ([0, 1, 0], 0x1111_2222_3333_4444),
            Some(([0, 1, 0], 0x1111_2222_3333_4444)),
        ),
        (
            "older-both",
            ([0, 0, 9], 0x0123_4567_89ab_cdef),
            Some(([0, 0, 8], 0x5555_6666_7777_8888)),
        ),
    ] {
        let (shared, port) = device();
        {
            let mut device = shared.borrow_mut();
            (device.comms_identity.version, device.comms_identity.schema) = comms;
            if let Some(drive) = drive {
                (device.drive_identity.version, device.drive_identity.schema) = drive;
            }
            device.start_comms(ResetCause::Power);
            device.start_drive(ResetCause::Power);
        }
        let error = Client::connect(port).unwrap_err();
        assert!(matches!(error, Error::Mismatch(_)), "{error}");
        let ours = format!("{:016x}", schema::HASH);
        let text = error.to_string().replace(&ours, "(this schema)");
        golden(name, &text);
    }
}

#[test]
fn a_device_with_another_schema_can_be_stopped() {
    let (shared, port) = device();
    let mut owner = client(port, 1);
    owner.zero().unwrap();
    owner.arm().unwrap();
    assert_eq!(shared.borrow().comms.state(), State::Armed);
    // Another tool at this device finds another hash in its hello.
    let mut stranger = Management::with(Port::new(&shared), options(2));
    let mut handshake = stranger.identify().unwrap();
    handshake.comms.schema ^= 1;
    assert!(handshake.mismatch().is_some());
    let refused = stranger.reboot().unwrap_err();
    assert_eq!(
        refused,
        Error::NotDone {
            request: RequestKind::Reboot
        }
    );
    stranger.stop().unwrap();
    // Until the drive has said so.
    stranger.transport_mut().wait(ms(5));
    assert_eq!(shared.borrow().comms.state(), State::Disarmed);
    stranger.reboot().unwrap();
    assert!(matches!(
        stranger.into_client(handshake),
        Err(Error::Mismatch(_))
    ));
}

#[test]
fn a_drive_with_another_schema_is_a_fault_but_no_mismatch() {
    let (shared, port) = device();
    {
        let mut device = shared.borrow_mut();
        device.drive_identity.schema ^= 1;
        device.start_drive(ResetCause::Power);
    }
    let mut client = client(port, 1);
    let mismatch = client.handshake().mismatch().unwrap();
    assert!(mismatch.to_string().contains("flash `firmware/drive`"));
    let error = client.arm().unwrap_err().to_string();
    assert!(error.contains("version-mismatch (fault 36"), "{error}");
}
