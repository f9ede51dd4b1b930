//! Faults between the two images and their host: torque is off in the
//! time of the fault table, and the device recovers while the other side runs on.

use crate::host::{
    Host, MS, arm, boards, client, images, leg, run, scene, ticks_until_off, under_torque,
};
use crepitus_client::{Error, Event, Transport as _};
use crepitus_emulator::drive_board::CommsSide as _;
use crepitus_emulator::{Pair, Reset};
use crepitus_protocol::State;
use crepitus_protocol::fault::{FAULTS, Fault};
use crepitus_scene::values::values;
use std::time::Duration;

/// The table's time, ticks.
fn limit(fault: Fault) -> u64 {
    let spec = FAULTS.iter().find(|spec| spec.fault == fault);
    u64::from(spec.and_then(|spec| spec.within_ticks).expect("a time"))
}

/// The slowest watchdog: 4 × (160 + 1) clocks of 17 kHz, 37.9 ms.
const SLOWEST_WATCHDOG_MS: u64 = 38;

/// Resets of the drive and of comms.
fn resets(host: &mut Host) -> [Vec<Reset>; 2] {
    let boards = boards(host);
    [boards.resets(), boards.comms().resets()]
        .map(|resets| resets.iter().map(|(_, reset)| *reset).collect())
}

/// The faults that drive and comms report.
fn faults(host: &mut Host) -> [u8; 2] {
    let status = host.status().expect("a status");
    [status.drive_fault, status.comms_fault]
}

/// Clears the faults, and arms again.
fn recover(host: &mut Host) {
    run(host, 30);
    host.clear_fault().expect("cleared");
    arm(host);
    assert_eq!(host.status().expect("a status").state, State::Armed);
}

#[test]
fn the_link_to_the_drive_is_cut() {
    let Some(mut host) = under_torque() else {
        return;
    };
    boards(&mut host).faults.down_is_cut = true;
    let ticks = ticks_until_off(&mut host, limit(Fault::CommsSilent), true);
    println!("link to the drive cut: off after {ticks} ticks");
    boards(&mut host).faults.down_is_cut = false;
    run(&mut host, 10);
    assert_eq!(faults(&mut host)[0], Fault::CommsSilent.code());
    recover(&mut host);
    assert_eq!(resets(&mut host), [vec![], vec![]]);
}

#[test]
fn the_link_from_the_drive_is_cut() {
    let Some(mut host) = under_torque() else {
        return;
    };
    boards(&mut host).faults.up_is_cut = true;
    let ticks = ticks_until_off(&mut host, limit(Fault::DriveSilent), true);
    println!("link from the drive cut: off after {ticks} ticks");
    boards(&mut host).faults.up_is_cut = false;
    run(&mut host, 10);
    assert_eq!(faults(&mut host)[1], Fault::DriveSilent.code());
    recover(&mut host);
    assert_eq!(resets(&mut host), [vec![], vec![]]);
}

#[test]
fn the_drive_hangs() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.subscribe().expect("a subscription");
    boards(&mut host).mcu_mut().set_hung(true);
    let ticks = ticks_until_off(&mut host, limit(Fault::DriveSilent), true);
    println!("drive hung: off after {ticks} ticks");
    // The drive's watchdog restarts it, and comms has noticed nothing but that.
    let events = run(&mut host, SLOWEST_WATCHDOG_MS + 60);
    assert!(events.contains(&Event::DriveRestarted));
    assert_eq!(resets(&mut host), [vec![Reset::Watchdog], vec![]]);
    assert_eq!(faults(&mut host)[1], Fault::DriveSilent.code());
    let accounting = host.accounting().expect("a subscription");
    assert_eq!((accounting.lost_on_line(), accounting.violations()), (0, 0));
    recover(&mut host);
}

#[test]
fn comms_hangs() {
    let Some(mut host) = under_torque() else {
        return;
    };
    boards(&mut host).comms_mut().set_hung(true);
    let ticks = ticks_until_off(&mut host, limit(Fault::CommsSilent), false);
    println!("comms hung: off after {ticks} ticks");
    // The watchdog's reset takes the device off the bus.
    let cable = host.transport_mut();
    cable.wait(Duration::from_millis(SLOWEST_WATCHDOG_MS + 60));
    assert!(!cable.pair.is_plugged_in());
    let again = host
        .reconnect(Duration::from_secs(1))
        .expect("a connection");
    assert!(again.was_armed);
    assert_eq!(resets(&mut host), [vec![], vec![Reset::Watchdog]]);
    assert_eq!(faults(&mut host)[0], Fault::CommsSilent.code());
    recover(&mut host);
}

#[test]
fn the_host_is_silent() {
    let Some(mut host) = under_torque() else {
        return;
    };
    let ticks = ticks_until_off(&mut host, limit(Fault::LeaseExpired), false);
    println!("host silent: off after {ticks} ticks");
    assert!(ticks > 200 * MS, "a lease lasts 250 ms");
    run(&mut host, 10);
    assert_eq!(faults(&mut host)[0], Fault::LeaseExpired.code());
    recover(&mut host);
    assert_eq!(resets(&mut host), [vec![], vec![]]);
}

#[test]
fn the_cable_is_pulled_and_put_back_while_samples_stream() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.subscribe().expect("a subscription");
    run(&mut host, 20);
    host.transport_mut().pair.unplug();
    let ticks = ticks_until_off(&mut host, limit(Fault::LeaseExpired), true);
    println!("cable pulled: off after {ticks} ticks");
    assert!(matches!(
        host.pump(Duration::ZERO),
        Err(Error::NotConnected { .. })
    ));
    let again = host
        .reconnect(Duration::from_secs(1))
        .expect("a connection");
    assert!(again.was_armed);
    let resumed = again.resubscribed.expect("the subscription goes on");
    println!("{resumed:?}");
    assert!(resumed.unseen().expect("the same start of the drive") >= ticks);
    run(&mut host, 20);
    let accounting = host.accounting().expect("a subscription");
    assert_eq!((accounting.dropped(), accounting.violations()), (0, 0));
    assert_eq!(faults(&mut host)[0], Fault::LeaseExpired.code());
    recover(&mut host);
    assert_eq!(resets(&mut host), [vec![], vec![]]);
}

/// A host that has the port open and does not read: samples are dropped and
/// counted, and nothing else suffers.
#[test]
fn a_host_that_does_not_read() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.subscribe().expect("a subscription");
    run(&mut host, 10);
    let port = host.transport_mut().pair.host().expect("it is plugged in");
    port.set_open(false);
    for _ in 0..10 {
        host.transport_mut().wait(Duration::from_millis(10));
        // Renewals go out.
        let _ = host.pump(Duration::ZERO);
    }
    assert!(boards(&mut host).is_driven());
    let port = host.transport_mut().pair.host().expect("it is plugged in");
    port.set_open(true);
    run(&mut host, 20);
    let accounting = host.accounting().expect("a subscription");
    println!("{accounting:?}");
    assert!(accounting.dropped_by_device() > 1_000);
    assert_eq!(accounting.violations(), 0);
    assert_eq!(
        accounting.produced(),
        accounting.received() + accounting.dropped_by_device() + accounting.lost_on_line()
    );
    assert_eq!(host.status().expect("a status").state, State::Armed);
}

/// Each controller tells for itself. The internal oscillator of the emulated chip is exact; one of silicon may be too far
/// off for USB.
#[test]
fn a_wrong_crystal_is_named_by_the_controller_that_has_it() {
    let Some(images) = images() else { return };
    let values = values(&scene()).expect("a scene for the device");
    let crystal = [Fault::DriveCrystal, Fault::CommsCrystal];
    for wrong in [0, 1] {
        let mut images = images.clone();
        images[wrong].crystal_hz = 12_000_000;
        let [drive, comms] = &images;
        let mut host = client(Pair::of(drive, comms, leg(), &values));
        run(&mut host, 30);
        let mut expected = [0; 2];
        expected[wrong] = crystal[wrong].code();
        assert_eq!(faults(&mut host), expected);
        assert!(host.arm().is_err());
    }
}
