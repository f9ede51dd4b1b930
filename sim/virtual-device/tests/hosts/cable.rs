//! The plug, and hosts that are killed or do not read.

use crate::support::Host;
use crate::{connected, streaming};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::{Fault, LEASE_TICKS, Session, State};
use crepitus_virtual_device::usb::host::Traffic;

/// Everything arrives, and the device does as it is asked.
fn all_is_well(host: &mut Host) {
    host.subscribe();
    let status = host.status();
    if status.state == State::Faulted {
        assert_eq!(host.ask(Operation::ClearFault), Ok(Answer::Done));
    }
    host.arm();
    let before = host.accounting.expect("a subscription").received;
    host.run(4_000);
    let accounting = host.accounting.expect("a subscription");
    assert!(accounting.received - before >= 3_800, "telemetry flows");
    assert_eq!(accounting.dropped, 0);
    assert_eq!(host.status().state, State::Armed);
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
}

/// Ticks until the bridge floats; the device goes on meanwhile.
fn ticks_until_it_floats(host: &mut Host) -> u64 {
    let produced = host.drive_count(DriveCounter::Produced);
    let mut ticks = 0;
    for tick in 1..=2 * LEASE_TICKS {
        host.tick();
        if host.device.board().is_driven() {
            ticks = tick + 1;
        }
    }
    let more = u64::from(host.drive_count(DriveCounter::Produced) - produced);
    assert!(more + 20 >= 2 * LEASE_TICKS, "the device goes on");
    ticks
}

#[test]
fn the_plug_is_pulled_and_pushed_in_again_while_it_streams() {
    let mut host = connected();
    for round in 0..20 {
        host.subscribe();
        host.run(500 + 7 * round);
        assert_eq!(host.accounting.expect("a subscription").dropped, 0);
        host.device.unplug();
        host.run(37 * round);
        host.reconnect();
        assert_eq!(host.status().state, State::Disarmed);
        assert_eq!(host.discarded, 0, "the wire begins with whole frames");
    }
    all_is_well(&mut host);
}

#[test]
fn traffic_is_that_of_all_connections() {
    let mut host = connected();
    let mut sum = Traffic::default();
    for _ in 0..3 {
        host.subscribe();
        host.run(500);
        let own = host.device.host().expect("a port").traffic();
        assert!(
            own.frames >= 25 && own.bytes_out > 0 && own.bytes_in > 0,
            "{own:?}"
        );
        sum.add(own);
        assert_eq!(host.device.traffic(), sum);
        host.device.unplug();
        host.run(100);
        assert_eq!(host.device.traffic(), sum, "without a plug");
        host.reconnect();
    }
}

#[test]
fn torque_ends_when_the_plug_is_pulled() {
    let mut host = streaming();
    host.device.unplug();
    let ticks = ticks_until_it_floats(&mut host);
    assert!((1..=LEASE_TICKS).contains(&ticks), "{ticks}");
    host.reconnect();
    assert_eq!(host.status().drive_fault, Fault::LeaseExpired.code());
    all_is_well(&mut host);
}

#[test]
fn a_host_that_is_back_before_its_lease_ends_keeps_it() {
    let mut host = streaming();
    let session = host.session;
    let number = host.number;
    host.device.unplug();
    host.run(2_000);
    host.reconnect();
    (host.session, host.number) = (session, number);
    host.run(10_000);
    let status = host.status();
    assert_eq!((status.state, status.lease), (State::Armed, Some(session)));
    assert!(
        host.accounting.is_none(),
        "a subscription ends with its host"
    );
    host.subscribe();
    host.run(2_000);
    assert!(host.accounting.expect("a subscription").received >= 1_900);
}

#[test]
fn a_host_that_is_killed_loses_its_torque_and_another_gets_everything() {
    let mut host = streaming();
    host.device.host().expect("a port").set_open(false);
    host.renew_every = None;
    let ticks = ticks_until_it_floats(&mut host);
    assert!((1..=LEASE_TICKS).contains(&ticks), "{ticks}");
    assert!(host.comms_count(CommsCounter::DroppedSamples) > 5_000);
    // Another program opens the port. What waited for the first one comes
    // first.
    host.device.host().expect("a port").set_open(true);
    host.accounting = None;
    host.session = Session(99);
    host.number = 500;
    host.run(2_000);
    assert_eq!(host.status().drive_fault, Fault::LeaseExpired.code());
    all_is_well(&mut host);
}

#[test]
fn a_port_that_is_never_read_stops_nothing() {
    const SECONDS: u64 = 10;
    let mut host = streaming();
    // The host renews its lease, and reads nothing.
    host.device.host().expect("a port").set_open(false);
    let produced = host.drive_count(DriveCounter::Produced);
    host.run(SECONDS * 20_000);
    let more = u64::from(host.drive_count(DriveCounter::Produced) - produced);
    assert!(more + 20 >= SECONDS * 20_000);
    assert_eq!(
        host.drive_count(DriveCounter::Dropped),
        0,
        "the link goes on"
    );
    assert_eq!(host.comms_count(CommsCounter::LostSamples), 0);
    assert_eq!(host.device.board().drive().state(), State::Armed);
    // The host reads again: the accounting says to the sample what it has missed.
    host.device.host().expect("a port").set_open(true);
    host.run(4_000);
    let accounting = host.accounting.expect("a subscription");
    assert!(
        u64::from(accounting.dropped) > (SECONDS - 1) * 20_000,
        "{accounting:?}"
    );
    assert_eq!(host.status().state, State::Armed);
    let (sent, dropped, received) = (
        host.comms_count(CommsCounter::SentSamples),
        host.comms_count(CommsCounter::DroppedSamples),
        host.comms_count(CommsCounter::ReceivedSamples),
    );
    assert_eq!(
        u64::from(sent + dropped),
        u64::from(received) - accounting.first_tick
    );
}
