//! The drive's ticks against the milliseconds of comms.
//!
//! Every timeout of the drive counts its own ticks. A crystal of another
//! frequency, or a timer that is set wrong, would stretch them all, and the
//! torque's pitch, too; the drive itself cannot see that.

use crepitus_protocol::Fault;
use crepitus_protocol::link::STALE_TICKS;

/// Ticks of the drive in a millisecond.
const TICKS_PER_MS: u64 = 20;

/// Interval over which they are compared, ms: the largest deviation in it is 0.5 %.
const SPAN_MS: u64 = 4_000;

/// Compares the clocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct DriveClock {
    /// Millisecond and tick of a block.
    reference: Option<(u64, u64)>,
}

impl DriveClock {
    /// Restarts the comparison: after a restart of the drive, or when a fault is
    /// cleared.
    pub fn restart(&mut self) {
        self.reference = None;
    }

    /// Checks with the end of a block that arrives now. What is delayed for longer
    /// than a message may be is a deviation, too.
    pub fn check(&mut self, now_ms: u64, end_tick: u64) -> Option<Fault> {
        let (then_ms, then_tick) = *self.reference.get_or_insert((now_ms, end_tick));
        let passed_ms = now_ms.saturating_sub(then_ms);
        let expected = passed_ms.saturating_mul(TICKS_PER_MS);
        let ticks = end_tick.saturating_sub(then_tick);
        if passed_ms >= SPAN_MS {
            self.reference = Some((now_ms, end_tick));
        }
        (ticks.abs_diff(expected) > STALE_TICKS).then_some(Fault::DriveClock)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Milliseconds until it is noticed that the drive's clock is off by so much,
    /// in parts of a thousand.
    fn noticed_ms(per_mille: i64) -> Option<u64> {
        let mut clock = DriveClock::default();
        (0..20_000_u64).step_by(10).find(|ms| {
            // Blocks arrive up to 3 ms late.
            let ticks = (ms * TICKS_PER_MS).saturating_sub(20 * (ms * 7 % 4));
            let signed = i64::try_from(ticks).unwrap();
            let end_tick = (signed + signed * per_mille / 1_000).unsigned_abs();
            clock.check(*ms, u64::MAX / 2 + end_tick).is_some()
        })
    }

    #[test]
    fn a_clock_that_is_off_is_noticed() {
        assert_eq!(noticed_ms(0), None);
        assert_eq!(noticed_ms(1), None);
        for (per_mille, at_most_ms) in [(500, 60), (-333, 90), (20, 1_300), (-10, 4_000)] {
            let ms = noticed_ms(per_mille);
            assert!(ms.is_some_and(|ms| ms < at_most_ms), "{per_mille}: {ms:?}");
        }
    }
}
