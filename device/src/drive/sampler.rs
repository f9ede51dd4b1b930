//! `sample_encoder`: the counter to what the model needs of the shaft.

use crate::drive::prepare::Reader;
use crepitus_model::Sample;
use crepitus_model::control::encoder::EncoderReader;
use crepitus_protocol::telemetry::BLOCK_TICKS;

/// After so many ticks without a count that a shaft can make, the shaft is
/// taken to be where the counter says: the counter itself was disturbed.
pub const LOST_TICKS: u32 = 20;

/// What is known of the shaft in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// Ticks since the start.
    pub tick: u64,
    /// Counts from where the angle is zero; wraps.
    pub count: i32,
    /// The shaft's motion since the last tick.
    pub shaft: Sample<f32>,
    /// Estimated velocity, rad/s.
    pub omega_rad_s: f32,
    /// Ticks in a row without a count to believe, this one included.
    pub lost_ticks: u32,
}

/// Reads the encoder, once a tick.
#[derive(Clone, Debug)]
pub struct Sampler {
    reader: EncoderReader<f32>,
    /// The most counts that a shaft makes in a tick.
    most_counts: u32,
    tick: u64,
    /// Ticks of the block that have begun.
    in_block: u32,
    last: i32,
    zero: i32,
    lost_ticks: u32,
}

impl Sampler {
    /// On a shaft at rest at this count; the next tick is `tick`.
    pub fn new(reader: &Reader, counter: u32, tick: u64) -> Self {
        let last = counter.cast_signed();
        Self {
            reader: reader.at_zero.restarted(last, 0.0),
            most_counts: reader.most_counts,
            tick,
            in_block: 0,
            last,
            zero: last,
            lost_ticks: 0,
        }
    }

    /// Whether the next tick begins a block of telemetry: the moment to take
    /// parameters over.
    pub fn begins_block(&self) -> bool {
        self.in_block == 0
    }

    /// Another encoder: the estimate begins anew.
    pub fn replace(&mut self, reader: &Reader) {
        self.reader = reader
            .at_zero
            .restarted(self.last, self.reader.omega_rad_s());
        self.most_counts = reader.most_counts;
    }

    /// The angle is zero here.
    pub fn zero(&mut self) {
        self.zero = self.last;
    }

    /// Ticks in a row without a count to believe.
    pub fn lost_ticks(&self) -> u32 {
        self.lost_ticks
    }

    /// The next tick.
    pub fn next_tick(&self) -> u64 {
        self.tick
    }

    /// One tick: what the 32-bit counter of the quadrature timer says.
    pub fn sample(&mut self, counter: u32) -> Sampled {
        let count = counter.cast_signed();
        let moved = count.wrapping_sub(self.last).unsigned_abs();
        let ticks = self.lost_ticks.saturating_add(1);
        let shaft = if moved <= self.most_counts.saturating_mul(ticks) {
            self.last = count;
            self.lost_ticks = 0;
            Sample::Taken(self.reader.read(count))
        } else {
            self.lost_ticks = ticks;
            if ticks > LOST_TICKS {
                self.reader = self.reader.restarted(count, 0.0);
                self.last = count;
            } else {
                self.reader.miss();
            }
            Sample::Lost
        };
        let tick = self.tick;
        self.tick = tick.wrapping_add(1);
        self.in_block = self.in_block.wrapping_add(1) % BLOCK_TICKS;
        Sampled {
            tick,
            count: self.last.wrapping_sub(self.zero),
            shaft,
            omega_rad_s: self.reader.omega_rad_s(),
            lost_ticks: self.lost_ticks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::control::encoder::EncoderSettings;

    fn sampler(start: u32) -> Sampler {
        Sampler::new(&Reader::of(&EncoderSettings::default()).unwrap(), start, 0)
    }

    #[test]
    fn counts_are_counted_from_zero_across_the_wrap() {
        for start in [0, 7, u32::MAX - 10, 0x7fff_fffa] {
            let mut sampler = sampler(start);
            for i in 1..=30_i32 {
                let sampled = sampler.sample(start.wrapping_add(i.cast_unsigned()));
                assert_eq!((sampled.count, sampled.lost_ticks), (i, 0));
                assert!(matches!(sampled.shaft, Sample::Taken(_)));
            }
            sampler.zero();
            assert_eq!(sampler.sample(start.wrapping_add(29)).count, -1);
        }
    }

    #[test]
    fn a_jump_that_no_shaft_makes_is_no_motion() {
        let mut sampler = sampler(100);
        sampler.sample(101);
        // A disturbance of one tick: what follows is as if it had not been.
        let lost = sampler.sample(90_000);
        assert_eq!((lost.shaft, lost.count), (Sample::Lost, 1));
        assert!(matches!(
            sampler.sample(103).shaft,
            Sample::Taken(step) if step.delta_phi_rad > 0.0
        ));
        // A counter that stays elsewhere is believed in the end, at rest.
        for n in 1..=LOST_TICKS + 1 {
            assert_eq!(sampler.sample(900_000).lost_ticks, n);
        }
        let found = sampler.sample(900_000);
        assert_eq!((found.lost_ticks, found.omega_rad_s), (0, 0.0));
    }
}
