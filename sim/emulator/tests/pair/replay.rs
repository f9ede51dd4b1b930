//! Replay of all that a host has sent: in order, doubled and in disorder, also
//! after restarts of either image. Nothing of it is executed.

use crate::host::{Host, arm, boards, connect_as, pair, plugged_in, run};
use crepitus_client::Transport as _;
use crepitus_emulator::Reset;
use crepitus_emulator::drive_board::CommsSide as _;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::parameters::id::STATIC_TORQUE;
use crepitus_protocol::{Fault, Revision, State};
use std::time::Duration;

/// Event between the session and its replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Between {
    Nothing,
    CommsRestarts,
    DriveRestarts,
    BothRestart,
}

/// Frames that a host has sent.
struct Sent {
    frames: Vec<Vec<u8>>,
    /// Number of the frames that open the session.
    opening: usize,
}

/// A session in which everything happens, and its bytes.
fn session() -> Option<(Host, Sent)> {
    // The handshake, and the session's nonce, belong to it.
    let mut cable = plugged_in(pair()?);
    cable.sent = Some(Vec::new());
    let mut host = connect_as(cable, 0x1234);
    let opening = host.transport_mut().sent.as_ref().map_or(0, Vec::len);
    host.subscribe().expect("a subscription");
    host.set(&[(STATIC_TORQUE, 0.5)]).expect("a commit");
    host.save().expect("saved");
    arm(&mut host);
    run(&mut host, 120);
    assert!(boards(&mut host).is_driven());
    host.disarm().expect("disarmed");
    host.unsubscribe().expect("no subscription");
    // Based on what is saved, and so on what is in force after a restart of comms: nothing but
    // its nonce is old. The last, so that no job before it makes the device busy.
    host.set(&[(STATIC_TORQUE, 0.25)]).expect("a commit");
    let frames = host.transport_mut().sent.take().expect("what was sent");
    Some((host, Sent { frames, opening }))
}

/// State that a replayed request could change.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Changes {
    /// Armings, commits, renewals.
    counts: [u32; 3],
    revision: Revision,
    value: Option<f64>,
    state: State,
}

/// Asked by another session.
fn changes(host: Host, session: u32) -> (Host, Changes) {
    let mut host = connect_as(host.into_transport(), session);
    let counters = host.counters().expect("counters");
    let counts = [
        counters.drive[DriveCounter::Armings as usize],
        counters.drive[DriveCounter::Commits as usize],
        counters.comms[CommsCounter::Renewals as usize],
    ];
    let (revision, values) = host.parameters().expect("parameters");
    let changes = Changes {
        counts,
        revision,
        value: values.get(STATIC_TORQUE),
        state: host.status().expect("a status").state,
    };
    (host, changes)
}

fn nothing_is_executed(between: Between) {
    let Some((mut host, sent)) = session() else {
        return;
    };
    assert!(sent.opening > 0 && sent.frames.len() > sent.opening + 10);
    let boards = boards(&mut host);
    if matches!(between, Between::DriveRestarts | Between::BothRestart) {
        boards.reset(Reset::Pin);
    }
    if matches!(between, Between::CommsRestarts | Between::BothRestart) {
        boards.comms_mut().reset(Reset::Pin);
    }
    let cable = host.transport_mut();
    cable.wait(Duration::from_millis(60));
    if cable.pair.host().is_none() {
        cable.reopen().expect("a device");
    }
    cable.wait(Duration::from_millis(20));
    // The first nonce that comms draws is for the replayed session.
    for frame in sent.frames.iter().take(sent.opening) {
        cable.send(frame).expect("sent");
        cable.wait(Duration::from_millis(2));
    }
    let (mut host, before) = changes(host, 1);
    let (revision, value) = match between {
        Between::Nothing | Between::DriveRestarts => (Revision(3), 0.25),
        Between::CommsRestarts | Between::BothRestart => (Revision(2), 0.5),
    };
    assert_eq!((before.revision, before.value), (revision, Some(value)));
    let mut rng = fastrand::Rng::with_seed(2);
    for round in 0..3 {
        let mut frames = sent.frames.clone();
        if round > 0 {
            frames.extend(sent.frames.clone());
            rng.shuffle(&mut frames);
        }
        for frame in &frames {
            let cable = host.transport_mut();
            cable.send(frame).expect("sent");
            for _ in 0..rng.u64(0..40) {
                cable.pair.tick();
                assert!(!cable.pair.boards().is_driven(), "{between:?} {round}");
                assert!(!cable.pair.boards().comms_line_is_on());
            }
        }
    }
    run(&mut host, 20);
    let (_, now) = changes(host, 2);
    assert_eq!(now, before, "{between:?}");
}

#[test]
fn at_once() {
    nothing_is_executed(Between::Nothing);
}

#[test]
fn after_a_restart_of_comms() {
    nothing_is_executed(Between::CommsRestarts);
}

#[test]
fn after_a_restart_of_the_drive() {
    nothing_is_executed(Between::DriveRestarts);
}

#[test]
fn after_a_restart_of_both() {
    nothing_is_executed(Between::BothRestart);
}

/// Renewals that were delayed do not keep torque on.
#[test]
fn renewals_of_before_do_not_renew() {
    let Some((host, sent)) = session() else {
        return;
    };
    let mut host = connect_as(host.into_transport(), 0x4321);
    arm(&mut host);
    // This host falls silent; somebody repeats the other's renewals, and all else.
    let mut is_driven = true;
    for frame in sent.frames.iter().cycle().take(120) {
        let cable = host.transport_mut();
        cable.send(frame).expect("sent");
        cable.wait(Duration::from_millis(3));
        is_driven = boards(&mut host).is_driven();
        if !is_driven {
            break;
        }
    }
    assert!(!is_driven, "kept on by renewals of another session");
    host.transport_mut().wait(Duration::from_millis(20));
    let fault = host.status().expect("a status").drive_fault;
    assert_eq!(fault, Fault::LeaseExpired.code());
    assert!(!boards(&mut host).comms().line_is_on());
}
