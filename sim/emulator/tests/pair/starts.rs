//! Starts of comms differ: the nonce of a session of before is never that of a session of now.

use crate::host::{Cable, connect_as, pair, plugged_in};
use crepitus_emulator::Reset;
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::{Decoder, Lane, Nonce};

/// Starts that are compared, of each kind.
const STARTS: u32 = 3;

/// The nonce of a session that is opened first after a start: as it is repeated in a request.
fn first_nonce(mut cable: Cable, session: u32) -> (Cable, Nonce) {
    cable.sent = Some(Vec::new());
    let mut host = connect_as(cable, session);
    host.counters().expect("counters");
    let mut cable = host.into_transport();
    let mut decoder = Decoder::new();
    let bytes = cable.sent.take().expect("what was sent").concat();
    let requests = bytes.into_iter().filter_map(|byte| {
        let body = decoder.push(byte)?.ok()?;
        let is_request = body.lane() == Some(Lane::Request);
        body.message::<Request>().filter(|_| is_request)
    });
    let counters = requests
        .filter(|request| request.operation == Operation::Counters)
        .last();
    let nonce = counters.expect("a request").nonce;
    assert_ne!(nonce, Nonce::NONE);
    (cable, nonce)
}

/// The first nonces of some starts, each after `restart`.
fn nonces(restart: impl Fn(&mut Cable)) -> Option<Vec<Nonce>> {
    let mut cable = plugged_in(pair()?);
    // The drive need not run.
    cable.pair.boards_mut().mcu_mut().set_hung(true);
    let mut nonces = Vec::new();
    for _ in 0..STARTS {
        let nonce;
        (cable, nonce) = first_nonce(cable, 0x1234);
        nonces.push(nonce);
        restart(&mut cable);
        cable.pair.plug_in().expect("a device");
    }
    Some(nonces)
}

fn all_differ(mut nonces: Vec<Nonce>) {
    println!("{nonces:x?}");
    nonces.sort_unstable_by_key(|nonce| nonce.0);
    nonces.dedup();
    assert_eq!(nonces.len(), STARTS as usize);
}

#[test]
fn starts_after_power_was_off_differ() {
    let Some(nonces) = nonces(|cable| {
        cable.pair.power_cycle();
        cable.pair.boards_mut().mcu_mut().set_hung(true);
    }) else {
        return;
    };
    all_differ(nonces);
}

#[test]
fn starts_after_a_reset_differ() {
    let Some(nonces) = nonces(|cable| cable.pair.boards_mut().comms_mut().reset(Reset::Pin)) else {
        return;
    };
    all_differ(nonces);
}
