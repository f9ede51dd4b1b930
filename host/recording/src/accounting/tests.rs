//! Every missing sample has a cause.

use super::*;
use crepitus_protocol::State;
use crepitus_protocol::telemetry::BlockFlags;

fn block(first_tick: u64, dropped: u32, start: u16) -> Block {
    Block {
        first_tick,
        dropped,
        flags: BlockFlags::new(State::Disarmed, false, start),
        ..Block::default()
    }
}

fn begin(first_tick: u64, dropped: u32, start: u8) -> Begin {
    Begin {
        first_tick,
        dropped,
        start,
    }
}

/// A device that nobody listened to for an hour has not sent 72 million samples.
#[test]
fn without_the_begin_of_the_subscription_nothing_is_missing_before_the_first_block() {
    let mut ledger = Ledger::default();
    ledger.damaged();
    assert!(ledger.block(&block(72_000_000, 72_000_000, 1)));
    assert!(ledger.block(&block(72_000_040, 72_000_020, 1)));
    let totals = ledger.accounting().totals;
    assert_eq!((totals.produced, totals.received), (60, 40));
    assert_eq!((totals.dropped, totals.by_device), (20, 20));
    // What the recorder had is known from then on.
    ledger.expect_received(100);
    let accounting = ledger.into_accounting();
    let totals = accounting.totals;
    assert_eq!((totals.produced, totals.received), (120, 40));
    assert_eq!(
        (totals.dropped, totals.by_device, totals.damaged),
        (80, 20, 60)
    );
    assert_eq!(accounting.segments[0].first_tick, 72_000_000 - 60);
    assert_eq!((accounting.gap_count, accounting.gaps[0].samples), (2, 60));
    let mut recount = Recount::new(&accounting);
    (72_000_000..72_000_020).for_each(|tick| recount.row(tick));
    (72_000_040..72_000_060).for_each(|tick| recount.row(tick));
    assert_eq!(recount.differences(), Vec::<String>::new());
}

/// Every cause once: sums, gaps, and the recount of the same rows.
#[test]
fn every_missing_sample_has_a_cause() {
    let mut ledger = Ledger::default();
    let mut ticks = Vec::new();
    let mut take = |ledger: &mut Ledger, block: &Block| {
        assert!(ledger.block(block));
        ticks.extend(block.first_tick..block.end_tick());
    };
    ledger.subscribed(begin(1_000, 60, 1));
    // 20 on the way before the first block.
    take(&mut ledger, &block(1_020, 60, 1));
    // 40 by the device.
    take(&mut ledger, &block(1_080, 100, 1));
    // 20 by the device, 20 on the way.
    take(&mut ledger, &block(1_140, 120, 1));
    assert!(!ledger.block(&block(1_140, 120, 1)), "doubled");
    ledger.damaged();
    take(&mut ledger, &block(1_200, 120, 1));
    // The connection is lost for 80 samples.
    ledger.subscribed(begin(1_300, 180, 1));
    take(&mut ledger, &block(1_300, 180, 1));
    // The drive restarts and drops its first block.
    take(&mut ledger, &block(20, 20, 2));
    take(&mut ledger, &block(40, 20, 2));
    let accounting = ledger.into_accounting();
    assert_eq!(
        accounting.totals,
        Totals {
            produced: 380,
            received: 140,
            dropped: 240,
            by_device: 80,
            not_connected: 80,
            damaged: 40,
        }
    );
    assert_eq!(accounting.totals.on_the_way(), 40);
    let causes: Vec<_> = accounting
        .gaps
        .iter()
        .map(|gap| (gap.row, gap.cause))
        .collect();
    assert_eq!(
        causes,
        [
            (0, Cause::OnTheWay),
            (20, Cause::Device),
            (40, Cause::Both),
            (60, Cause::Damaged),
            (80, Cause::NotConnected),
            (100, Cause::Device),
        ]
    );
    assert_eq!(
        (accounting.drive_restarts, accounting.segments.len()),
        (1, 3)
    );
    let recount = |ticks: &[u64]| {
        let mut recount = Recount::new(&accounting);
        for tick in ticks {
            recount.row(*tick);
        }
        recount.differences()
    };
    assert_eq!(recount(&ticks), [""; 0]);
    for wrong in [0, 50, 139] {
        let mut fewer = ticks.clone();
        fewer.remove(wrong);
        assert!(!recount(&fewer).is_empty(), "row {wrong} is missing");
        let mut more = ticks.clone();
        more.insert(wrong, ticks[wrong]);
        assert!(!recount(&more).is_empty(), "row {wrong} is there twice");
    }
    let mut swapped = ticks.clone();
    swapped.swap(30, 31);
    assert!(!recount(&swapped).is_empty());
}

/// Damage by bytes out of order: no part of the file reads as damaged, what the recorder had says so.
#[test]
fn a_gap_of_samples_that_the_recorder_had_is_damaged() {
    let causes = |received| {
        let mut ledger = Ledger::default();
        ledger.subscribed(begin(0, 0, 1));
        assert!(ledger.block(&block(20, 0, 1)));
        // 20 by the device, 20 that are not there.
        assert!(ledger.block(&block(80, 20, 1)));
        ledger.expect_received(received);
        let accounting = ledger.into_accounting();
        let gaps: Vec<_> = accounting.gaps.iter().map(|gap| gap.cause).collect();
        (accounting.totals.damaged, gaps)
    };
    let [way, both] = [Cause::OnTheWay, Cause::Both];
    assert_eq!(causes(40), (0, vec![way, both]));
    assert_eq!(causes(60), (20, vec![way, both]), "which of them");
    assert_eq!(causes(80), (40, vec![Cause::Damaged; 2]));
}

/// Their numbers have five bits.
#[test]
fn every_start_of_the_drive_is_taken_and_nothing_of_the_one_before() {
    let mut ledger = Ledger::default();
    ledger.subscribed(begin(0, 0, 0));
    assert!(ledger.block(&block(0, 0, 0)));
    for start in 1..=40 {
        assert!(ledger.block(&block(0, 0, start)), "start {start}");
        let late = block(20, 0, start - 1);
        assert!(!ledger.block(&late), "before start {start}");
    }
    let accounting = ledger.into_accounting();
    assert_eq!(
        (accounting.drive_restarts, accounting.segments.len()),
        (40, 41)
    );
    assert_eq!(
        (accounting.totals.received, accounting.totals.dropped),
        (820, 0)
    );
}

#[test]
fn a_restart_with_the_same_number_is_one() {
    let mut ledger = Ledger::default();
    ledger.subscribed(begin(1_000, 0, 1));
    assert!(ledger.block(&block(1_000, 0, 1)));
    ledger.subscribed(begin(200, 0, 1));
    assert!(ledger.block(&block(200, 0, 1)));
    let accounting = ledger.into_accounting();
    assert_eq!(
        (accounting.drive_restarts, accounting.totals.dropped),
        (1, 0)
    );
}
