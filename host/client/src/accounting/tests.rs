//! Accounting with deliberate losses.

use super::*;
use crepitus_protocol::State;
use crepitus_protocol::accounting::Missing;
use crepitus_protocol::telemetry::BlockFlags;
use proptest::prelude::*;

fn block(first_tick: u64, dropped: u32, start: u16) -> Block {
    Block {
        first_tick,
        dropped,
        flags: BlockFlags::new(State::Armed, false, start),
        ..Block::default()
    }
}

fn from(first_tick: u64) -> Begin {
    Begin {
        first_tick,
        dropped: 0,
        start: 1,
    }
}

/// A block before which samples are missing, of which the device has reported some.
fn next(first_tick: u64, samples: u64, reported: u64) -> Taken {
    Taken::Next(Missing {
        first_tick,
        samples,
        reported,
    })
}

fn sums(accounting: &Accounting) -> [u64; 4] {
    assert_eq!(accounting.violations(), 0);
    assert_eq!(
        accounting.produced(),
        accounting.received() + accounting.dropped()
    );
    assert_eq!(
        accounting.dropped(),
        accounting.dropped_by_device() + accounting.lost_on_line()
    );
    [
        accounting.produced(),
        accounting.received(),
        accounting.dropped_by_device(),
        accounting.lost_on_line(),
    ]
}

#[test]
fn what_is_missing_was_dropped_or_lost() {
    let mut accounting = Accounting::new(from(1_000));
    assert_eq!(accounting.take(&block(1_000, 0, 1)), next(1_000, 0, 0));
    // Three blocks missing; the device has dropped one of them.
    assert_eq!(accounting.take(&block(1_080, 20, 1)), next(1_020, 60, 20));
    assert_eq!(accounting.take(&block(1_080, 20, 1)), Taken::Old);
    assert_eq!(accounting.take(&block(1_020, 0, 1)), Taken::Old);
    assert_eq!(sums(&accounting), [100, 40, 20, 40]);
    let gap = Gap {
        first_tick: 1_020,
        samples: 60,
    };
    assert!(accounting.gaps().eq([&gap]));
    assert_eq!(
        (accounting.old_blocks(), accounting.next_tick()),
        (2, 1_100)
    );
}

#[test]
fn a_restart_of_the_drive_begins_a_segment() {
    let mut accounting = Accounting::new(from(1_000));
    accounting.take(&block(1_000, 0, 1));
    // The device has dropped the first two blocks after the restart.
    let taken = accounting.take(&block(60, 40, 2));
    let missing = Missing {
        first_tick: 20,
        samples: 40,
        reported: 40,
    };
    assert_eq!(taken, Taken::Restarted(missing));
    assert_eq!(accounting.take(&block(80, 40, 2)), next(80, 0, 0));
    assert_eq!(sums(&accounting), [20 + 80, 20 + 40, 40, 0]);
    assert_eq!((accounting.restarts(), accounting.first_tick()), (1, 20));
}

/// The drive restarts between the subscription and its first block.
#[test]
fn a_restart_before_the_first_block_is_one() {
    let mut accounting = Accounting::new(from(1_000));
    let taken = accounting.take(&block(20, 0, 2));
    assert!(matches!(taken, Taken::Restarted(missing) if missing.samples == 0));
    assert_eq!(sums(&accounting), [20, 20, 0, 0]);
}

#[test]
fn the_dropped_counter_may_wrap() {
    let mut accounting = Accounting::new(from(0));
    accounting.take(&block(0xffff_fff0, 0xffff_fff0, 1));
    accounting.take(&block(0x1_0000_0018, 4, 1));
    assert_eq!(sums(&accounting), [0x1_0000_002c, 40, 0x1_0000_0004, 0]);
}

#[test]
fn an_inconsistent_count_is_detected() {
    let mut accounting = Accounting::new(from(0));
    accounting.take(&block(0, 0, 1));
    accounting.take(&block(20, 20, 1));
    assert_eq!(accounting.violations(), 1);
}

proptest! {
    /// With random drops, losses and repeats the sums balance and show where
    /// samples were lost.
    #[test]
    fn the_law_holds(fates in prop::collection::vec(0..4_u8, 1..200), start_tick in 0..u64::MAX / 2, before: u32) {
        let mut accounting = Accounting::new(Begin { dropped: before, ..from(start_tick) });
        let (mut dropped, mut lost, mut received, mut tick) = (0_u32, 0, 0, start_tick);
        let (mut dropped_seen, mut lost_seen) = (0, 0);
        for fate in fates {
            match fate {
                0 => dropped += 20,
                1 => lost += 20,
                _ => {
                    received += 20;
                    (dropped_seen, lost_seen) = (dropped, lost);
                    for _ in 2..=fate {
                        accounting.take(&block(tick, before.wrapping_add(dropped), 1));
                    }
                }
            }
            tick += 20;
        }
        let [_, here, by_device, on_line] = sums(&accounting);
        prop_assert_eq!([here, by_device, on_line], [received, u64::from(dropped_seen), lost_seen]);
        prop_assert_eq!(accounting.gaps().map(|gap| gap.samples).sum::<u64>(), accounting.dropped());
    }
}
