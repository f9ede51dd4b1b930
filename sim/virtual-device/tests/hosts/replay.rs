//! Replay of all that a host has sent, by somebody else: in order, in
//! disorder, doubled, late, after restarts of either controller. Nothing of it is
//! executed.

use crate::connected;
use crate::support::{Host, set};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::{Revision, Session, State, Values};
use crepitus_virtual_device::Controller;
use fastrand::Rng;

/// Events between the session and its replay.
#[derive(Clone, Copy, Debug)]
enum Between {
    Nothing,
    CommsRestarts,
    DriveRestarts,
    BothRestart,
    /// Enough other sessions for the device to forget the first.
    Others,
}

/// A session in which everything happens, and its bytes. What it has committed is of before, for
/// a device that starts with what was saved; without that it would be new.
fn session(saves: bool) -> (Host, Vec<Vec<u8>>) {
    let mut host = connected();
    host.sent = Some(Vec::new());
    host.open();
    host.subscribe();
    host.commit(|values| set(values, "crepitus.static_torque_nm", 0.5))
        .expect("a commit");
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    if saves {
        assert_eq!(host.ask(Operation::Save), Ok(Answer::Done));
    }
    host.renew_every = Some(1_000);
    assert_eq!(host.ask(Operation::Arm), Ok(Answer::Done));
    host.run(4_000);
    assert!(host.device.board().is_driven());
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.renew_every = None;
    let sent = host.sent.take().expect("what was sent");
    (host, sent)
}

fn happen(host: &mut Host, between: Between) {
    let restarted: &[Controller] = match between {
        Between::Nothing => &[],
        Between::CommsRestarts => &[Controller::Comms],
        Between::DriveRestarts => &[Controller::Drive],
        Between::BothRestart => &[Controller::Comms, Controller::Drive],
        Between::Others => {
            for session in 1..=40 {
                let answer = host.ask_as(Session(session), 1, Operation::Status);
                assert!(matches!(answer, Some(Ok(_))), "{answer:?}");
            }
            &[]
        }
    };
    for controller in restarted {
        host.device
            .board_mut()
            .reset(*controller, ResetCause::Power);
    }
    // Nobody opens a session: the first nonce that comms draws is for a replay.
    host.run(1_000);
    if host.device.host().is_none() {
        assert!(host.device.plug_in().is_ok());
    }
    host.run(1_000);
}

/// State that a request could change, looked up without one.
fn changes(host: &Host) -> (u32, u32, u32, Revision, Values) {
    let board = host.device.board();
    let (comms, drive) = (board.comms(), board.drive());
    (
        drive.counters().get(DriveCounter::Armings),
        drive.counters().get(DriveCounter::Commits),
        comms.counters().get(CommsCounter::Renewals),
        comms.revision(),
        *comms.values(),
    )
}

#[test]
fn nothing_that_is_replayed_is_executed() {
    for between in [
        Between::Nothing,
        Between::CommsRestarts,
        Between::DriveRestarts,
        Between::BothRestart,
        Between::Others,
    ] {
        let mut rng = Rng::with_seed(2);
        for round in 0..6 {
            let (mut host, sent) = session(round % 2 == 0);
            happen(&mut host, between);
            let before = changes(&host);
            for _ in 0..3 {
                let mut frames = sent.clone();
                if round > 0 {
                    frames.extend(sent.clone());
                    rng.shuffle(&mut frames);
                }
                for frame in &frames {
                    host.send(frame);
                    for _ in 0..rng.u64(0..200) {
                        host.tick();
                        assert!(!host.device.board().is_driven(), "{between:?} {round}");
                        assert_ne!(host.device.board().drive().state(), State::Arming);
                    }
                }
            }
            assert_eq!(changes(&host), before, "{between:?} {round}");
        }
    }
}

/// The holder of a lease opens its session again, as after a lost connection: its
/// renewals of before do not keep torque on.
#[test]
fn renewals_of_before_the_session_was_opened_again_are_none() {
    let mut host = connected();
    host.arm();
    // The number of this renewal is newer than all that follow.
    let old = host.request_of(host.session, u32::MAX, Operation::Renew);
    host.open();
    host.run(2_000);
    assert!(host.device.board().is_driven(), "the new nonce renews");
    host.renew_every = None;
    for _ in 0..12 {
        host.say(&old);
        host.run(500);
    }
    assert!(!host.device.board().is_driven());
    assert_eq!(host.status().state, State::Faulted);
}

/// The holder of a lease falls silent, and somebody sends what it sent last, in its own
/// session, again and again.
#[test]
fn a_renewal_that_is_repeated_keeps_no_torque_on() {
    let mut host = connected();
    host.sent = Some(Vec::new());
    host.arm();
    host.run(4_000);
    host.renew_every = None;
    let sent = host.sent.take().expect("what was sent");
    let last = sent.last().expect("a renewal").clone();
    let renewals = host.comms_count(CommsCounter::Renewals);
    assert!(renewals > 1);
    for tick in 0..5_001 {
        if tick % 500 == 0 {
            host.send(&last);
        }
        host.tick();
    }
    assert!(!host.device.board().is_driven());
    assert_eq!(host.comms_count(CommsCounter::Renewals), renewals);
    assert_eq!(host.status().state, State::Faulted, "the lease has expired");
}

/// A request to arm stays an old one, even as many requests later as half of the numbers
/// that sixteen bits have.
#[test]
fn a_request_to_arm_does_not_become_new_with_time() {
    let mut host = connected();
    host.sent = Some(Vec::new());
    host.arm();
    let sent = host.sent.take().expect("what was sent");
    host.renew_every = None;
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    let before = changes(&host);
    for later in [1, 1 << 15, 1 << 16, 3 << 15, 1 << 31] {
        host.number += later;
        host.status();
        for frame in &sent {
            host.send(frame);
            host.run(200);
            assert!(!host.device.board().is_driven());
        }
    }
    assert_eq!(changes(&host), before);
}

/// A request to arm arrives after the host has given up and disarmed.
#[test]
fn a_late_request_to_arm_is_not_heard() {
    let mut host = connected();
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    let arm = host.request(Operation::Arm);
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.say(&arm);
    for _ in 0..2_000 {
        host.tick();
        let board = host.device.board();
        assert_ne!(board.drive().state(), State::Arming);
        assert_ne!(board.comms().state(), State::Arming);
    }
    assert_eq!(host.drive_count(DriveCounter::Armings), 0);
}

/// After a restart of comms not even what the host sends without having noticed
/// is executed.
#[test]
fn a_host_that_has_not_noticed_a_restart_is_told() {
    let mut host = connected();
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    let arm = host.request(Operation::Arm);
    host.device
        .board_mut()
        .reset(Controller::Comms, ResetCause::Power);
    host.run(2_000);
    if host.device.host().is_none() {
        assert!(host.device.plug_in().is_ok());
    }
    host.say(&arm);
    assert_eq!(host.answer_to(&arm), Some(Err(Refusal::NotOpen)));
    assert_eq!(host.drive_count(DriveCounter::Armings), 0);
    assert!(host.comms_count(CommsCounter::NotOpen) > 0);
}
