//! Arming and the lease.

use crate::support::{connected, ms, pump_for, refusal, turning};
use crepitus_client::{Error, Event, Transport};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::Refusal;
use crepitus_protocol::{Fault, State};

#[test]
fn arm_is_armed_and_stays_so_while_it_is_pumped() {
    let (shared, mut client) = turning(|t| 0.5 * t);
    assert_eq!(client.status().unwrap().state, State::Disarmed);
    client.zero().unwrap();
    client.arm().unwrap();
    let status = client.status().unwrap();
    assert_eq!(status.state, State::Armed);
    assert_eq!(status.lease, Some(client.session()));
    assert!(client.is_armed() && status.zeroed);

    let events = pump_for(&mut client, ms(2_000));
    let changes: Vec<_> = events
        .iter()
        .map(|event| match event {
            Event::State(change) => change.now.state,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(
        changes,
        [State::Armed],
        "and nothing else while it is armed"
    );
    assert!(client.is_armed());
    assert_eq!(shared.borrow().drive.state(), State::Armed);
    assert!(shared.borrow().torque_nm().abs() > 0.05, "it grates");
    // Every 50 ms, and one more or less at the ends.
    let renewals = client.counters().unwrap().comms[CommsCounter::Renewals.index()];
    assert!((39..=42).contains(&renewals), "{renewals}");

    client.disarm().unwrap();
    assert!(!client.is_armed());
    // The answer is that of comms; the drive's next block reports its state.
    pump_for(&mut client, ms(2));
    let status = client.status().unwrap();
    assert_eq!((status.state, status.lease), (State::Disarmed, None));
    assert_eq!((status.drive_fault, status.comms_fault), (0, 0));
    pump_for(&mut client, ms(300));
    let counters = client.counters().unwrap();
    assert_eq!(counters.comms[CommsCounter::LeasesExpired.index()], 0);
    assert_eq!(counters.drive[DriveCounter::Faults.index()], 0);
    assert_eq!(shared.borrow().torque_nm(), 0.0);
}

#[test]
fn without_pump_the_lease_expires() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    client.transport_mut().wait(ms(300));
    assert_eq!(shared.borrow().drive.state(), State::Faulted);
    assert!(client.is_armed(), "it has not looked yet");
    let events = pump_for(&mut client, ms(50));
    let [Event::State(change)] = &events[..] else {
        panic!("{events:?}");
    };
    assert_eq!(change.now.state, State::Faulted);
    assert_eq!(change.now.drive_fault, Fault::LeaseExpired.code());
    assert!(!client.is_armed());

    let error = client.arm().unwrap_err();
    let fault = Fault::LeaseExpired.code();
    assert!(error.to_string().contains("lease-expired"), "{error}");
    assert_eq!(refusal::<()>(Err(error)), Refusal::Faulted { code: fault });
    client.clear_fault().unwrap();
    assert_eq!(client.status().unwrap().state, State::Disarmed);
    client.zero().unwrap();
    client.arm().unwrap();
    assert_eq!(client.status().unwrap().state, State::Armed);
}

#[test]
fn arming_twice_keeps_the_device_armed() {
    let (_, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    assert_eq!(refusal(client.arm()), Refusal::Armed);
    pump_for(&mut client, ms(600));
    assert!(client.is_armed());
    assert_eq!(
        refusal(client.zero()),
        Refusal::Drive(crepitus_protocol::link::DriveRefusal::Armed)
    );
    assert_eq!(refusal(client.save()), Refusal::Armed);
    client.close().unwrap();
}

#[test]
fn a_silent_drive_ends_torque_with_a_fault() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    pump_for(&mut client, ms(100));
    shared.borrow_mut().link_is_cut = true;
    let events = pump_for(&mut client, ms(150));
    let faulted = events.iter().any(|event| {
        matches!(event, Event::State(change)
            if change.now.comms_fault == Fault::DriveSilent.code() && !change.now.drive_present)
    });
    assert!(faulted, "{events:?}");
    assert!(!client.is_armed());
    assert_eq!(shared.borrow().drive.state(), State::Faulted);
    assert_eq!(refusal(client.zero()), Refusal::DriveSilent);
    shared.borrow_mut().link_is_cut = false;
    pump_for(&mut client, ms(20));
    client.clear_fault().unwrap();
    let status = client.status().unwrap();
    assert_eq!((status.drive_fault, status.comms_fault), (0, 0));
    client.zero().unwrap();
    client.arm().unwrap();
}

/// A program that stops waiting for arming disarms the device.
#[test]
fn arming_that_is_not_answered_is_withdrawn() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    shared.borrow_mut().to_host.swallow = usize::MAX;
    let error = client.arm().unwrap_err();
    assert!(matches!(error, Error::NoAnswer { .. }), "{error}");
    client.transport_mut().wait(ms(20));
    assert_eq!(shared.borrow().drive.state(), State::Disarmed);
    assert_eq!(shared.borrow().drive.fault(), None);
}

#[test]
fn the_holder_of_the_lease_is_told_when_nothing_answers() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    pump_for(&mut client, ms(200));
    shared.borrow_mut().to_host.swallow = usize::MAX;
    let since = client.now();
    let lost = loop {
        if let Some(Event::Lost(loss)) = client.pump(ms(20)).unwrap() {
            break loss;
        }
        assert!(client.now() < since + ms(2_000), "nothing is said");
    };
    assert!(
        client.now() >= since + ms(900),
        "a few lost replies are no loss"
    );
    assert!(format!("{lost:?}").contains("nothing answers"), "{lost:?}");
    assert!(!client.is_armed());
}
