//! A request is carried out once, however often and in whatever order it
//! comes.

use crate::connected;
use crate::support::{Host, set};
use crepitus_protocol::Session;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Operation, Refusal, Request};

fn commit(host: &mut Host, number: u32, static_nm: f64) -> Request {
    let (base, mut values) = host.parameters();
    set(&mut values, "crepitus.static_torque_nm", static_nm);
    host.request_of(host.session, number, Operation::Commit { base, values })
}

#[test]
fn a_repeated_request_is_answered_again_and_not_carried_out_again() {
    let mut host = connected();
    let request = commit(&mut host, 500, 0.5);
    let commits = host.drive_count(DriveCounter::Commits);
    host.say(&request);
    let first = host.answer_to(&request).expect("an answer");
    assert!(first.is_ok());
    for _ in 0..5 {
        host.say(&request);
        assert_eq!(host.answer_to(&request), Some(first));
    }
    assert_eq!(host.drive_count(DriveCounter::Commits), commits + 1);
    assert_eq!(host.comms_count(CommsCounter::RepeatedRequests), 5);
}

#[test]
fn a_request_that_is_repeated_while_it_is_carried_out_has_one_answer() {
    let mut host = connected();
    let request = commit(&mut host, 500, 0.5);
    for _ in 0..5 {
        host.say(&request);
    }
    host.run(400);
    let replies = host.take_replies();
    assert!(
        replies
            .iter()
            .all(|reply| reply.answer == replies[0].answer)
    );
    assert!(replies[0].answer.is_ok());
    assert_eq!(
        host.drive_count(DriveCounter::Commits),
        2,
        "the first, and this"
    );
}

#[test]
fn what_comes_late_is_not_heard() {
    let mut host = connected();
    let session = Session(77);
    // Numbers go on beyond sixteen bits.
    for number in [65_535, 65_536, 65_537] {
        let answer = host.ask_as(session, number, Operation::Status);
        assert!(matches!(answer, Some(Ok(_))), "{number}");
    }
    let operation = commit(&mut host, 0, 0.5).operation;
    let old = host.request_of(session, 65_535, operation);
    host.say(&old);
    assert_eq!(host.answer_to(&old), None, "overtaken by three others");
    assert_eq!(host.drive_count(DriveCounter::Commits), 1);
}

#[test]
fn the_hosts_that_spoke_last_are_remembered() {
    let mut host = connected();
    for session in 1..=31 {
        let answer = host.ask_as(Session(session), 1, Operation::Status);
        assert!(matches!(answer, Some(Ok(_))), "{answer:?}");
    }
    // The first of them speaks again, and then two more.
    let operation = commit(&mut host, 0, 0.5).operation;
    let request = host.request_of(Session(1), 2, operation);
    host.say(&request);
    let answer = host.answer_to(&request);
    assert!(matches!(answer, Some(Ok(_))), "{answer:?}");
    for session in [40, 41] {
        let answer = host.ask_as(Session(session), 1, Operation::Status);
        assert!(matches!(answer, Some(Ok(_))), "{answer:?}");
    }
    host.say(&request);
    assert_eq!(
        host.answer_to(&request),
        answer,
        "answered, not carried out again"
    );
    assert_eq!(host.comms_count(CommsCounter::RepeatedRequests), 1);
    // The second one was evicted.
    let evicted = host.ask_as(Session(2), 2, Operation::Status);
    assert_eq!(evicted, Some(Err(Refusal::NotOpen)));
}
