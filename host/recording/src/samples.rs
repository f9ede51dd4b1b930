//! Conversion of telemetry blocks to rows.

use crate::row::Row;
use crate::shaft::Shaft;
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block, COIL_TICKS, NO_CURRENT};
use crepitus_protocol::{TICKS_PER_S, Values};

/// Converts samples to rows, with angle and speed from the drive's own
/// estimator.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    shaft: Shaft,
    /// Start of the count, at the first block since the drive has started.
    begin: Begin,
    next_tick: u64,
    has_begun: bool,
}

/// Start of a count of ticks.
#[derive(Clone, Copy, Debug, Default)]
struct Begin {
    start: u8,
    tick: u64,
    /// Ticks of time that have passed before it.
    passed: u64,
}

impl Samples {
    /// Sets the parameters from the next block on.
    pub fn set(&mut self, values: &Values) {
        self.shaft.set(values);
    }

    /// The rows of a block. Time starts at the first block, and goes on at once
    /// where the drive has restarted: how long that took is not known.
    pub fn rows<'a>(&'a mut self, block: &'a Block) -> impl Iterator<Item = Row> + 'a {
        let (start, tick) = (block.flags.start(), block.first_tick);
        if !self.has_begun || start != self.begin.start || tick < self.next_tick {
            let passed = self.begin.passed + self.next_tick.saturating_sub(self.begin.tick);
            self.begin = Begin {
                start,
                tick,
                passed,
            };
            self.has_begun = true;
        }
        self.next_tick = block.end_tick();
        let begin = self.begin;
        let counts_per_s = counts_per_s(block);
        let coil = block.coil_currents.iter();
        let coil = coil.flat_map(|mean| std::iter::repeat_n(mean.amperes(), COIL_TICKS));
        block
            .ticks()
            .zip(coil)
            .map(move |((tick, sample, phases), coil_a)| {
                let (angle_rad, omega_rad_s) = self.shaft.see(tick, sample.count, counts_per_s);
                let since = tick.saturating_sub(begin.tick) + begin.passed;
                Row {
                    tick,
                    #[expect(clippy::cast_precision_loss, reason = "centuries of ticks")]
                    time_s: since as f64 / f64::from(TICKS_PER_S),
                    count: sample.count,
                    angle_rad,
                    omega_rad_s,
                    model_torque_nm: sample.model_torque_nm,
                    torque_nm: sample.torque_nm,
                    current_a: (sample.current_ma != NO_CURRENT)
                        .then(|| f32::from(sample.current_ma) * 1e-3),
                    coil_a,
                    revision: block.revision.0,
                    flags: sample.flags,
                    phases,
                }
            })
    }
}

/// Mean speed over a block.
fn counts_per_s(block: &Block) -> f64 {
    let [first, .., last] = &block.samples;
    let moved = last.count.wrapping_sub(first.count);
    f64::from(moved) * f64::from(TICKS_PER_S) / f64::from(BLOCK_TICKS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::Phases;
    use crepitus_protocol::State;
    use crepitus_protocol::telemetry::{BlockFlags, CoilCurrent, EffectPhases, Sample};

    #[test]
    fn time_goes_on_where_the_drive_has_restarted() {
        let block = |first_tick, start| Block {
            first_tick,
            flags: BlockFlags::new(State::Disarmed, false, start),
            ..Block::default()
        };
        let mut samples = Samples::default();
        let mut first_s = |block: Block| samples.rows(&block).next().expect("a row").time_s;
        assert_eq!(first_s(block(5_000, 1)), 0.0);
        assert_eq!(first_s(block(5_040, 1)), 0.002);
        assert_eq!(first_s(block(0, 2)), 0.003);
        assert_eq!(first_s(block(20, 2)), 0.004);
        // With the same number.
        assert_eq!(first_s(block(20, 2)), 0.005);
    }

    /// Counts are from the zero: another one is no motion.
    #[test]
    fn another_zero_is_no_speed() {
        // One count a tick, and the zero is set in the middle.
        let block = |first_tick: u64| Block {
            first_tick,
            samples: core::array::from_fn(|n| Sample {
                count: i32::try_from(first_tick).unwrap() + i32::try_from(n).unwrap()
                    - if first_tick + n as u64 >= 2_010 {
                        8_000
                    } else {
                        0
                    },
                ..Sample::default()
            }),
            ..Block::default()
        };
        let mut samples = Samples::default();
        let begin = (0..200).map(|n| block(20 * n));
        let speeds: Vec<f32> = begin
            .flat_map(|block| {
                samples
                    .rows(&block)
                    .map(|row| row.omega_rad_s)
                    .collect::<Vec<_>>()
            })
            .collect();
        let usual = speeds[1_900];
        assert!(usual > 0.5, "{usual}");
        for speed in &speeds[1_900..] {
            assert!((speed - usual).abs() < 0.01 * usual, "{speed} for {usual}");
        }
        // Also where a block with the jump is the first.
        let first = Samples::default()
            .rows(&block(2_000))
            .next()
            .expect("a row");
        assert_eq!(first.omega_rad_s, 0.0);
    }

    #[test]
    fn a_row_has_the_phases_of_its_tick() {
        let block = Block {
            first_tick: 40,
            phases: core::array::from_fn(|n| EffectPhases(1 << (n % 16))),
            ..Block::default()
        };
        let mut samples = Samples::default();
        for (row, n) in samples.rows(&block).zip(0..) {
            assert_eq!((row.tick, row.phases), (40 + n, Phases(1 << (n % 16))));
        }
    }

    #[test]
    fn a_row_has_the_mean_current_of_the_coil_in_its_five_ticks() {
        let block = Block {
            coil_currents: [-1_250, 0, i16::MIN, 500].map(CoilCurrent),
            ..Block::default()
        };
        let mut samples = Samples::default();
        let rows: Vec<_> = samples.rows(&block).map(|row| row.coil_a).collect();
        let means = [Some(-1.25), Some(0.0), None, Some(0.5)];
        for (row, n) in rows.iter().zip(0..) {
            assert_eq!(*row, means[n / 5], "{n}");
        }
        assert_eq!(rows.len(), 20);
    }

    /// No jump from rest that there was not.
    #[test]
    fn speed_is_right_from_the_first_sample_and_after_a_gap() {
        let block = |first_tick: u64| {
            let mut block = Block {
                first_tick,
                ..Block::default()
            };
            // Ten counts a tick.
            for (sample, tick) in block.samples.iter_mut().zip(first_tick..) {
                sample.count = i32::try_from(10 * tick).expect("early");
            }
            block
        };
        let mut samples = Samples::default();
        let per_count = crepitus_model::control::encoder::EncoderSettings::default();
        let expected = 10.0 * f64::from(TICKS_PER_S) * per_count.rad_per_count();
        for first_tick in [100, 120, 5_000] {
            for row in samples.rows(&block(first_tick)) {
                let error = f64::from(row.omega_rad_s) / expected - 1.0;
                assert!(error.abs() < 1e-4, "tick {}: {error}", row.tick);
            }
        }
    }
}
