//! Widths and order on the wire, and flags.

use super::*;
use crate::frame::encode;
use crate::lane::Lane;

#[test]
fn a_tick_has_its_sample_and_its_phases() {
    let block = Block {
        first_tick: 1 << 40,
        samples: core::array::from_fn(|n| Sample {
            count: i32::try_from(n).unwrap(),
            ..Sample::default()
        }),
        phases: core::array::from_fn(|n| EffectPhases(0xf000 | u16::try_from(n).unwrap())),
        ..Block::default()
    };
    assert_eq!(block.ticks().count(), BLOCK_SAMPLES);
    for ((tick, sample, phases), n) in block.ticks().zip(0_u16..) {
        assert_eq!(tick, block.first_tick + u64::from(n));
        assert_eq!((sample.count, phases), (n.into(), Phases(0xf000 | n)));
    }
}

#[test]
fn a_block_costs_at_most_seven_percent_more_than_its_ticks() {
    // After twenty days, with a busy afternoon of commits and losses.
    let block = Block {
        sequence: u16::MAX,
        first_tick: 20 * 86_400 * u64::from(crate::TICKS_PER_S),
        revision: Revision(1000),
        dropped: 1000,
        flags: BlockFlags(7),
        ..Block::default()
    };
    let payload = TICKS_BYTES;
    let frame = encode(Lane::Telemetry, &block).unwrap();
    assert!(
        (frame.len() - payload) * 100 <= payload * 7,
        "{}",
        frame.len()
    );
}

#[test]
fn flags_are_what_was_put_in() {
    for sign in [0, 1, -1] {
        for reason in LimitReason::ALL {
            let flags = SampleFlags::default()
                .with_limit(LimitReason::NotArmed)
                .with(SampleFlags::LATE, true)
                .with_phase(-1)
                .with_limit(reason)
                .with_phase(sign);
            assert_eq!((flags.phase_sign(), flags.limit()), (sign, reason));
            assert!(flags.has(SampleFlags::LATE));
            assert!(!flags.has(SampleFlags::BREAK | SampleFlags::SETTLING));
        }
    }
    for (share, eighths) in [
        (0.0, 0),
        (1e-30, 1),
        (0.125, 1),
        (0.126, 2),
        (0.5, 4),
        (0.500_001, 5),
        (0.875, 7),
        (1.0, 7),
        (f32::INFINITY, 7),
        (-0.1, 0),
        (f32::NAN, 0),
    ] {
        let before = SampleFlags(SampleFlags::CHIRP | SampleFlags::HELD_BACK);
        let flags = before.with_held_back(share);
        assert_eq!(flags.held_back(), eighths, "{share}");
        assert!(flags.has(SampleFlags::CHIRP));
    }
    for state in State::ALL {
        for (zeroed, start) in [(false, 0), (true, 31), (true, 0xff03)] {
            let flags = BlockFlags::new(state, zeroed, start);
            assert_eq!((flags.state(), flags.is_zeroed()), (state, zeroed));
            assert_eq!(u16::from(flags.start()), start & 31);
        }
    }
}
