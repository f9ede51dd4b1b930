//! A connection that is lost and reopened.

use crate::support::{check_accounting, connected, ms, pump_for};
use crepitus_client::{Error, Event, RequestKind, Transport, TransportError};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Fault, Revision, State};

#[test]
fn a_lost_connection_is_reported_once_and_resumes_its_subscription() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    client.subscribe().unwrap();
    pump_for(&mut client, ms(200));
    shared.borrow_mut().unplug();
    let event = client.pump(ms(20)).unwrap();
    assert!(
        matches!(&event, Some(Event::Lost(TransportError::Lost { port, .. })) if port == "bench"),
        "{event:?}"
    );
    assert!(!client.is_connected() && !client.is_armed());
    let not_connected = Error::NotConnected {
        port: "bench".into(),
    };
    assert_eq!(client.pump(ms(20)).unwrap_err(), not_connected);
    assert_eq!(client.status().unwrap_err(), not_connected);
    let until = client.accounting().unwrap().next_tick();
    let before = check_accounting(&client);

    // The device is not back yet.
    let error = client.reconnect(ms(300)).unwrap_err();
    assert!(matches!(
        error,
        Error::Transport(TransportError::NotFound { .. })
    ));
    shared.borrow_mut().is_plugged = true;
    let back = client.reconnect(ms(300)).unwrap();
    assert!(back.was_armed && client.is_connected() && !client.is_armed());
    assert_eq!(back.unanswered, None);
    // Without its host it has disarmed with a fault.
    assert_eq!(back.status.state, State::Faulted);
    assert_eq!(back.status.drive_fault, Fault::LeaseExpired.code());
    let again = back.resubscribed.unwrap();
    assert_eq!(again.until_tick, until);
    assert!(again.unseen().unwrap() >= 300 * 20, "{again:?}");

    pump_for(&mut client, ms(100));
    let after = check_accounting(&client);
    assert_eq!(after[0], after[1], "what was not seen is in no accounting");
    assert!(after[1] >= before[1] + 1_900);
    assert_eq!(shared.borrow().drive.state(), State::Faulted);
}

#[test]
fn arming_does_not_come_back_even_if_the_lease_is_alive() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    pump_for(&mut client, ms(100));
    shared.borrow_mut().unplug();
    assert!(matches!(
        client.pump(ms(1)).unwrap(),
        Some(Event::State(_) | Event::Lost(_))
    ));
    shared.borrow_mut().is_plugged = true;
    let back = client.reconnect(ms(100)).unwrap();
    assert!(back.was_armed);
    assert_eq!(back.status.state, State::Armed, "the lease is still alive");
    pump_for(&mut client, ms(400));
    assert_eq!(shared.borrow().drive.state(), State::Faulted);
}

#[test]
fn a_pending_request_is_reported_after_a_loss() {
    let (shared, mut client) = connected();
    shared.borrow_mut().unplug();
    let error = client.zero().unwrap_err();
    assert_eq!(
        error.to_string(),
        "connection to bench lost (no such device): the device was unplugged, switched off or rebooted"
    );
    shared.borrow_mut().is_plugged = true;
    let back = client.reconnect(ms(100)).unwrap();
    assert_eq!(back.unanswered, Some(RequestKind::Zero));
    assert!(!back.was_armed && back.resubscribed.is_none());
    client.zero().unwrap();
}

#[test]
fn a_power_cycle_restarts_the_device() {
    let (shared, mut client) = connected();
    client.set(&[(4, 0.5)]).unwrap();
    client.subscribe().unwrap();
    pump_for(&mut client, ms(500));
    {
        let mut device = shared.borrow_mut();
        device.unplug();
        device.start_comms(ResetCause::Power);
        device.start_drive(ResetCause::Power);
        device.is_plugged = true;
    }
    client.transport_mut().wait(ms(50));
    // Not detected without a call.
    let back = client.reconnect(ms(300)).unwrap();
    assert_eq!(back.handshake.drive.unwrap().reset, ResetCause::Power);
    assert_eq!(back.status.revision, Revision(1));
    assert_eq!(
        back.resubscribed.unwrap().unseen(),
        None,
        "ticks begin anew"
    );
    pump_for(&mut client, ms(100));
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
    assert!(produced > 11_000);
}

#[test]
fn another_schema_is_detected_at_once() {
    let (shared, mut client) = connected();
    {
        let mut device = shared.borrow_mut();
        device.unplug();
        device.comms_identity.schema ^= 1;
        device.start_comms(ResetCause::Requested);
        device.is_plugged = true;
    }
    let error = client.reconnect(ms(10_000)).unwrap_err();
    assert!(matches!(error, Error::Mismatch(_)), "{error}");
    assert!(client.now() < ms(1_000));
    assert!(!client.is_connected());
}
