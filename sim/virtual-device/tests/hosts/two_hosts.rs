//! Two hosts at one port: one has the lease, the other may look, change
//! parameters, and stop.

use crate::support::{Host, set};
use crate::{connected, streaming};
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::frame::encode_bytes;
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::management::{Action, ManagementRequest, ResetCause};
use crepitus_protocol::{Lane, Session, State};
use crepitus_virtual_device::Controller;

const OTHER: Session = Session(0xbeef);

#[test]
fn what_concerns_the_torque_is_for_the_one_with_the_lease() {
    let mut host = streaming();
    let first = host.session;
    let mut number = 0;
    for operation in [
        Operation::Save,
        Operation::Zero,
        Operation::Arm,
        Operation::Disarm,
        Operation::ClearFault,
    ] {
        number += 1;
        let answer = host.ask_as(OTHER, number, operation);
        assert_eq!(
            answer,
            Some(Err(Refusal::Leased { by: first })),
            "{operation:?}"
        );
    }
    // Looking is free.
    for operation in [
        Operation::Status,
        Operation::Parameters,
        Operation::Counters,
    ] {
        number += 1;
        assert!(
            matches!(host.ask_as(OTHER, number, operation), Some(Ok(_))),
            "{operation:?}"
        );
    }
    // A renewal of the other one is none.
    let renewals = host.comms_count(CommsCounter::Renewals);
    host.renew_every = None;
    for _ in 0..40 {
        number += 1;
        let renewal = host.request_of(OTHER, number, Operation::Renew);
        host.say(&renewal);
        host.run(200);
    }
    assert_eq!(host.comms_count(CommsCounter::Renewals), renewals);
    assert_eq!(host.status().state, State::Faulted, "the lease has expired");
}

#[test]
fn another_host_changes_parameters_of_an_armed_device() {
    let mut host = streaming();
    let (base, mut values) = host.parameters();
    set(&mut values, "crepitus.static_torque_nm", 0.7);
    let answer = host.ask_as(OTHER, 1, Operation::Commit { base, values });
    assert!(
        matches!(answer, Some(Ok(Answer::Committed { .. }))),
        "{answer:?}"
    );
    assert_eq!(host.parameters().1, values);
    assert_eq!(host.status().state, State::Armed);
    // The first one knows the parameters before; its commit is refused as stale.
    let stale = host.ask(Operation::Commit { base, values });
    assert!(matches!(stale, Err(Refusal::Stale { .. })), "{stale:?}");
}

#[test]
fn telemetry_belongs_to_a_session() {
    let mut host = streaming();
    host.run(2_000);
    let accounting = |host: &Host| {
        let accounting = host.accounting.as_ref().expect("a subscription");
        (accounting.received, accounting.dropped)
    };
    let (received, _) = accounting(&host);
    let subscribed = host.ask_as(OTHER, 1, Operation::Subscribe);
    let Some(Ok(Answer::Subscribed { first_tick, .. })) = subscribed else {
        panic!("{subscribed:?}");
    };
    assert!(first_tick > received, "another one's begins where it is");
    host.run(2_000);
    assert_eq!(
        host.ask_as(OTHER, 2, Operation::Unsubscribe),
        Some(Ok(Answer::Done))
    );
    host.run(2_000);
    let (now_received, dropped) = accounting(&host);
    assert!(now_received >= received + 3_900);
    assert_eq!(dropped, 0);
    // Nothing is sent once the last one has left.
    assert_eq!(host.ask(Operation::Unsubscribe), Ok(Answer::Done));
    let sent = host.comms_count(CommsCounter::SentSamples);
    host.run(2_000);
    assert_eq!(host.comms_count(CommsCounter::SentSamples), sent);
    // What was not sent to anybody is not missed by who comes later.
    host.subscribe();
    host.run(2_000);
    let (received, dropped) = accounting(&host);
    assert!(received >= 1_900 && dropped == 0, "{received} {dropped}");
}

/// After a restart of the drive the count of what is not sent starts again.
#[test]
fn accounting_goes_on_after_a_restart_of_the_drive() {
    let mut host = connected();
    host.subscribe();
    host.run(4_000);
    host.device
        .board_mut()
        .reset(Controller::Drive, ResetCause::Power);
    host.run(1_000);
    // A host that does not read for a second.
    for _ in 0..20_000 {
        host.device.tick();
    }
    host.run(2_000);
    let accounting = host.accounting.expect("a subscription");
    assert!(accounting.dropped > 1_000, "{accounting:?}");
}

#[test]
fn stopping_is_for_everybody_and_then_the_other_one_may_arm() {
    let mut host = streaming();
    let first = host.session;
    assert!(host.manage(Action::Stop, 7).is_some());
    host.run(21);
    assert!(!host.device.board().is_driven());
    // Comms hears of it behind the blocks that were ready before.
    host.run(21);
    assert_eq!(host.status().lease, None);
    assert_eq!(
        host.ask_as(OTHER, 2, Operation::Arm),
        Some(Ok(Answer::Done))
    );
    // The first one goes on renewing, which is nothing now.
    assert_eq!(host.status().lease, Some(OTHER));
    assert_eq!(host.ask(Operation::Arm), Err(Refusal::Leased { by: OTHER }));
    for number in 3..23 {
        let renewal = host.request_of(OTHER, number, Operation::Renew);
        host.say(&renewal);
        host.run(1_000);
    }
    assert_eq!(host.status().state, State::Armed);
    assert_ne!(first, OTHER);
}

#[test]
fn stopping_works_in_the_middle_of_the_others_arming() {
    for phase in 0..40 {
        let mut host = connected();
        assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
        let first = host.session;
        let request = host.request(Operation::Arm);
        host.renew_every = Some(1_000);
        host.say(&request);
        host.run(13 * phase);
        let stop = ManagementRequest {
            action: Action::Stop,
            token: 1,
        };
        let frame = encode_bytes(Lane::Management, &stop.bytes()).expect("a frame");
        host.send(&frame);
        host.run(600);
        let replies = host.take_replies();
        let of = |session| {
            let answers: Vec<_> = replies
                .iter()
                .filter(|reply| reply.session == session)
                .map(|reply| reply.answer)
                .collect();
            assert_eq!(answers.len(), 1, "phase {phase}: {replies:?}");
            answers[0]
        };
        // The drive had been armed, or the arming was given up.
        assert!(
            [Ok(Answer::Done), Err(Refusal::Aborted)].contains(&of(first)),
            "phase {phase}: {:?}",
            of(first)
        );
        assert!(!host.device.board().is_driven());
        let status = host.status();
        assert_eq!((status.state, status.drive_fault), (State::Disarmed, 0));
        host.arm();
    }
}

#[test]
fn two_hosts_that_ask_in_turn_both_get_their_answers() {
    let mut host = streaming();
    assert!(host.ask_as(OTHER, 1, Operation::Status).is_some());
    for number in 0..200_u32 {
        let asks = [
            Operation::Status,
            Operation::Parameters,
            Operation::Counters,
        ];
        let operation = asks[number as usize % 3];
        let first = host.request(operation);
        let second = host.request_of(OTHER, 2 + number, operation);
        host.say(&first);
        host.say(&second);
        host.run(u64::from(number) % 50);
        host.run(100);
        let replies = host.take_replies();
        for request in [first, second] {
            let answered = replies
                .iter()
                .filter(|r| (r.session, r.number) == (request.session, request.number))
                .count();
            assert_eq!(answered, 1);
        }
    }
    assert_eq!(host.status().state, State::Armed);
    assert_eq!(host.accounting.expect("a subscription").dropped, 0);
}
