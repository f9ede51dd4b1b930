//! A reboot that was asked for.

use crate::support::Host;
use crate::{connected, streaming};
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::management::{self, Action, ResetCause};
use crepitus_protocol::{Revision, State};
use crepitus_virtual_device::board::Controller;

#[test]
fn it_is_refused_while_there_is_torque() {
    let mut host = streaming();
    let answer = host.manage(Action::Reboot, 9);
    assert_eq!(
        answer,
        Some(management::Answer::Reboot {
            token: 9,
            done: false
        })
    );
    host.run(1_000);
    assert_eq!(host.status().state, State::Armed);
    assert!(host.device.is_plugged_in());
}

/// Reboots; returns whether the device reported to the host that it will be done.
fn reboot(host: &mut Host) -> bool {
    let answer = host.manage(Action::Reboot, 9);
    host.run(400);
    host.reconnect();
    host.run(400);
    answer
        == Some(management::Answer::Reboot {
            token: 9,
            done: true,
        })
}

#[test]
fn both_controllers_start_anew_and_the_port_comes_back() {
    for phase in 0..20 {
        let mut host = connected();
        host.run(phase);
        assert!(
            reboot(&mut host),
            "phase {phase}: the host is answered first"
        );
        let Some(management::Answer::Hello { own, drive, .. }) = host.manage(Action::Hello, 1)
        else {
            panic!("no hello");
        };
        assert_eq!(
            (own.reset, drive.reset),
            (ResetCause::Requested, ResetCause::Requested),
            "phase {phase}"
        );
        let status = host.status();
        assert_eq!(
            (status.state, status.drive_fault, status.comms_fault),
            (State::Disarmed, 0, 0)
        );
        assert_eq!(status.in_force, status.revision);
        host.subscribe();
        host.arm();
        host.run(2_000);
        assert!(host.accounting.expect("a subscription").received >= 1_900);
    }
}

#[test]
fn what_was_saved_is_there_afterwards_and_what_was_not_is_gone() {
    let mut host = connected();
    let (first, kept) = host.parameters();
    host.set("crepitus.static_torque_nm", 0.6);
    reboot(&mut host);
    assert_eq!(host.parameters(), (first, kept));
    assert_eq!(host.status().saved, Some(first));

    host.set("crepitus.static_torque_nm", 0.7);
    assert_eq!(host.ask(Operation::Save), Ok(Answer::Done));
    let (revision, values) = host.parameters();
    assert_eq!(host.status().saved, Some(revision));
    host.set("crepitus.static_torque_nm", 0.8);
    reboot(&mut host);
    assert_eq!(host.parameters(), (revision, values));
    let drive = host.device.board().drive();
    assert_eq!(
        (drive.revision(), drive.values()),
        (revision, Some(&values))
    );
}

#[test]
fn what_cannot_be_saved_is_said_and_changes_nothing() {
    let mut host = connected();
    let (first, kept) = host.parameters();
    host.device.board_mut().set_storage(false);
    host.set("crepitus.static_torque_nm", 0.6);
    let (revision, values) = host.parameters();
    assert_eq!(host.ask(Operation::Save), Err(Refusal::Storage));
    assert_eq!(host.status().saved, Some(first));
    assert_eq!(host.parameters(), (revision, values), "still in force");
    host.arm();
    assert_eq!(host.ask(Operation::Save), Err(Refusal::Armed));
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    reboot(&mut host);
    assert_eq!(host.parameters(), (first, kept));
}

/// Comms restarts by itself: the drive has parameters of the life before,
/// and is given those of this one, even where the numbers are the same.
#[test]
fn the_drive_follows_a_comms_that_has_forgotten() {
    let mut host = connected();
    host.set("crepitus.static_torque_nm", 0.6);
    host.set("crepitus.static_torque_nm", 0.7);
    for cause in [ResetCause::Watchdog, ResetCause::BrownOut] {
        host.device.board_mut().reset(Controller::Comms, cause);
        host.run(400);
        host.reconnect();
        host.run(400);
        let (revision, values) = host.parameters();
        assert_eq!(revision, Revision(1));
        let drive = host.device.board().drive();
        assert_eq!(
            (drive.revision(), drive.values()),
            (revision, Some(&values))
        );
        assert_eq!(host.ask(Operation::ClearFault), Ok(Answer::Done));
        host.set("crepitus.static_torque_nm", 0.9);
        let (revision, values) = host.parameters();
        assert_eq!(revision, Revision(2));
        let drive = host.device.board().drive();
        assert_eq!(
            (drive.revision(), drive.values()),
            (revision, Some(&values))
        );
    }
}
