//! Every sample, or the number of those that are missing.

use crate::support::{Port, check_accounting, client, connected, device, ms, pump_for, turning};
use crepitus_client::{Client, Event, Transport, TransportError};
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::management::ResetCause;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Fault, State};

fn blocks_for(client: &mut Client<Port>, time: std::time::Duration) -> Vec<Block> {
    let end = client.now() + time;
    let mut blocks = Vec::new();
    while client.now() < end {
        if let Some(Event::Block(arrival)) = client.pump(ms(20)).unwrap() {
            blocks.push(*arrival.block);
        }
    }
    blocks
}

#[test]
fn nothing_is_streamed_to_a_client_that_has_ended_its_telemetry() {
    let (_shared, mut client) = turning(|t| 0.3 * t);
    client.end_telemetry();
    client.subscribe().unwrap();
    assert!(!blocks_for(&mut client, ms(20)).is_empty());
    client.end_telemetry();
    // What was under way.
    blocks_for(&mut client, ms(20));
    let unasked = client.tally().unasked_blocks;
    assert!(blocks_for(&mut client, ms(50)).is_empty());
    // The device sends none: it is not the client that drops them.
    assert_eq!(client.tally().unasked_blocks, unasked);
}

#[test]
fn on_a_lossy_line_the_sum_still_holds() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    {
        let line = &mut shared.borrow_mut().to_host;
        (line.lose, line.flip, line.double) = (2_000, 2_000, 2_000);
    }
    let blocks = blocks_for(&mut client, ms(3_000));
    let [produced, received, dropped, lost] = check_accounting(&client);
    assert_eq!(received, 20 * blocks.len() as u64);
    assert_eq!(
        produced,
        blocks.last().unwrap().end_tick() - client.accounting().unwrap().first_tick()
    );
    assert_eq!(dropped, 0, "the device has dropped nothing");
    // A frame of 345 bytes is spoiled with a chance of 40 %.
    assert!(lost > produced / 5 && lost < produced * 3 / 5, "{lost}");
    assert!(client.tally().discarded_frames > 100);
}

#[test]
fn frames_that_come_twice_are_taken_once() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    for _ in 0..5 {
        shared.borrow_mut().millisecond();
    }
    let waiting: Vec<u8> = shared.borrow_mut().waiting(0).iter().copied().collect();
    shared.borrow_mut().waiting(0).extend(waiting);
    pump_for(&mut client, ms(5));
    let accounting = client.accounting().unwrap();
    assert!(accounting.old_blocks() >= 4);
    assert_eq!(accounting.dropped(), 0);
    check_accounting(&client);
}

#[test]
fn a_slow_host_gets_the_count_of_lost_samples() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    shared.borrow_mut().room = 4_096;
    pump_for(&mut client, ms(100));
    client.transport_mut().wait(ms(500));
    pump_for(&mut client, ms(200));
    let [_, _, dropped, lost] = check_accounting(&client);
    // The host was away for 500 ms, of which about 60 found room on the way.
    assert!((8_000..10_000).contains(&dropped), "{dropped}");
    assert_eq!(lost, 0);
    let accounting = client.accounting().unwrap();
    assert_eq!(accounting.gap_count(), 1);
}

/// A computer that receives half of what the device sends: the system's buffer is always full.
#[test]
fn a_computer_that_is_slow_at_receiving_hands_out_all_that_it_receives() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    shared.borrow_mut().room = 65_536;
    client.transport_mut().bytes_per_ms = Some(172);
    let blocks = blocks_for(&mut client, ms(2_000)).len();
    assert!((850..1_050).contains(&blocks), "{blocks}");
    assert_eq!(client.unheard(), None);
    check_accounting(&client);
}

/// The request at the end is answered more than a second later, behind all the blocks.
#[test]
fn a_link_that_lags_by_more_than_a_second_is_not_one_that_has_stopped() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    shared.borrow_mut().room = 65_536;
    client.transport_mut().bytes_per_ms = Some(50);
    pump_for(&mut client, ms(2_000));
    assert_eq!(client.unheard(), None);
    client.transport_mut().wait(ms(200));
    shared.borrow_mut().link_is_cut = true;
    client.transport_mut().bytes_per_ms = None;
    pump_for(&mut client, ms(500));
    assert!(client.unheard().is_some(), "nothing is heard any more");
}

/// The blocks received are old, and what the device dropped since then is in no block yet.
#[test]
fn a_link_that_lags_is_not_one_that_has_stopped() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    shared.borrow_mut().room = 4_096;
    pump_for(&mut client, ms(100));
    client.transport_mut().wait(ms(500));
    assert_eq!(client.unheard(), None);
    client.transport_mut().wait(ms(200));
    shared.borrow_mut().link_is_cut = true;
    pump_for(&mut client, ms(200));
    assert!(client.unheard().is_some(), "nothing is heard any more");
}

#[test]
fn the_link_between_the_controllers_may_lose_some_too() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    for _ in 0..20 {
        pump_for(&mut client, ms(20));
        shared.borrow_mut().link_is_cut = true;
        pump_for(&mut client, ms(3));
        shared.borrow_mut().link_is_cut = false;
    }
    pump_for(&mut client, ms(20));
    let [_, _, dropped, lost] = check_accounting(&client);
    assert_eq!((dropped, lost), (20 * 3 * 20, 0));
    let counters = client.counters().unwrap();
    assert_eq!(counters.comms[CommsCounter::LostSamples.index()], 1_200);
}

#[test]
fn a_restart_of_the_drive_is_reported_and_the_sums_continue() {
    let (shared, mut client) = connected();
    client.zero().unwrap();
    client.arm().unwrap();
    client.subscribe().unwrap();
    pump_for(&mut client, ms(100));
    shared.borrow_mut().start_drive(ResetCause::Watchdog);
    let events = pump_for(&mut client, ms(100));
    assert!(events.contains(&Event::DriveRestarted));
    let now = events.iter().rev().find_map(|event| match event {
        Event::State(change) => Some(change.now),
        _ => None,
    });
    let now = now.unwrap();
    assert_eq!(now.state, State::Faulted);
    assert_eq!(now.drive_fault, Fault::DriveWatchdog.code());
    assert_eq!(now.comms_fault, Fault::DriveRestarted.code());
    assert!(!client.is_armed());
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
    assert!(produced > 3_900, "{produced}");
    assert_eq!(client.accounting().unwrap().restarts(), 1);
    client.clear_fault().unwrap();
    client.zero().unwrap();
    client.arm().unwrap();
}

#[test]
fn silence_is_reported_once() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    pump_for(&mut client, ms(50));
    shared.borrow_mut().link_is_cut = true;
    let events = pump_for(&mut client, ms(2_000));
    let silences = events
        .iter()
        .filter(|event| matches!(event, Event::Silent(time) if *time >= ms(500)))
        .count();
    assert_eq!(silences, 1, "{events:?}");
    shared.borrow_mut().link_is_cut = false;
    pump_for(&mut client, ms(50));
    let [produced, received, by_device, _] = check_accounting(&client);
    assert_eq!(produced, received + by_device);
    assert!(by_device >= 39_000, "{by_device}");
}

#[test]
fn a_restart_of_comms_is_noticed_and_the_subscription_resumed() {
    let (shared, mut client) = connected();
    client.subscribe().unwrap();
    pump_for(&mut client, ms(50));
    shared.borrow_mut().start_comms(ResetCause::Power);
    let mut lost = None;
    while lost.is_none() {
        match client.pump(ms(200)).unwrap() {
            Some(Event::Lost(error)) => lost = Some(error),
            Some(_) => {}
            None => panic!("not noticed"),
        }
    }
    let port = client.port();
    assert_eq!(lost, Some(TransportError::Forgotten { port }));
    let back = client.reconnect(ms(500)).unwrap();
    assert!(back.resubscribed.unwrap().unseen().unwrap() < 4_000);
    pump_for(&mut client, ms(50));
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
    assert!(received >= 1_900, "{received}");
}

#[test]
fn a_new_subscription_restarts_the_accounting() {
    let (_, mut client) = connected();
    let first = client.subscribe().unwrap().first_tick;
    pump_for(&mut client, ms(50));
    client.transport_mut().wait(ms(20));
    let second = client.subscribe().unwrap().first_tick;
    assert!(second >= first + 1_400);
    pump_for(&mut client, ms(50));
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
    assert!(produced <= 1_040, "{produced}");
    client.unsubscribe().unwrap();
    let after = check_accounting(&client);
    assert!(pump_for(&mut client, ms(50)).is_empty());
    assert_eq!(check_accounting(&client), after);
}

#[test]
fn a_subscription_whose_reply_is_lost_misses_nothing() {
    let (shared, mut client) = connected();
    shared.borrow_mut().to_host.swallow = 8;
    client.subscribe().unwrap();
    assert_eq!(client.tally().repeats, 1);
    pump_for(&mut client, ms(100));
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
    assert!(produced >= 3_800, "{produced}");
}

#[test]
fn blocks_are_dropped_when_the_event_queue_is_full() {
    let (_, mut client) = connected();
    client.subscribe().unwrap();
    for _ in 0..110 {
        client.transport_mut().wait(ms(100));
        client.status().unwrap();
    }
    assert!((1_000..1_200).contains(&client.tally().unread_blocks));
    pump_for(&mut client, ms(1_000));
    let [_, _, dropped, lost] = check_accounting(&client);
    assert_eq!((dropped, lost), (0, 20 * client.tally().unread_blocks));
}

#[test]
fn blocks_of_an_earlier_program_do_no_harm() {
    let (shared, port) = device();
    let mut earlier = client(port, 1);
    earlier.subscribe().unwrap();
    drop(earlier);
    let mut client = client(Port::new(&shared), 2);
    pump_for(&mut client, ms(50));
    assert!(client.tally().unasked_blocks > 40);
    assert!(client.accounting().is_none());
    client.subscribe().unwrap();
    pump_for(&mut client, ms(50));
    let [produced, received, _, _] = check_accounting(&client);
    assert_eq!(produced, received);
}
