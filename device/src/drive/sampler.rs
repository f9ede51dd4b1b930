//! Shaft motion from the encoder's counter: the first part of `render_torque`.

use crate::drive::prepare::Reader;
use crepitus_model::Sample;
use crepitus_model::control::encoder::EncoderReader;

/// Number of consecutive implausible counts after which the reader restarts at the
/// counter's value: the counter itself was disturbed.
pub const LOST_TICKS: u32 = 20;

/// Motion of the shaft in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// The last plausible count; wraps.
    pub count: i32,
    /// The shaft's motion since the last tick.
    pub shaft: Sample<f32>,
    /// Estimated velocity, rad/s.
    pub omega_rad_s: f32,
    /// Consecutive ticks without a plausible count, this one included.
    pub lost_ticks: u32,
}

/// Reads the encoder, once a tick.
#[derive(Clone, Debug)]
pub struct Sampler {
    reader: EncoderReader<f32>,
    /// Most plausible counts in a tick.
    most_counts: u32,
    last: i32,
    lost_ticks: u32,
}

impl Sampler {
    /// Starts on a shaft at rest at this count.
    pub fn new(reader: &Reader, counter: u32) -> Self {
        let last = counter.cast_signed();
        Self {
            reader: reader.at_zero.restarted(last, 0.0),
            most_counts: reader.most_counts,
            last,
            lost_ticks: 0,
        }
    }

    /// Replaces the encoder: the estimator restarts.
    pub fn replace(&mut self, reader: &Reader) {
        self.reader = reader
            .at_zero
            .restarted(self.last, self.reader.omega_rad_s());
        self.most_counts = reader.most_counts;
    }

    /// Runs one tick with the 32-bit counter of the quadrature timer.
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
        Sampled {
            count: self.last,
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
        Sampler::new(&Reader::of(&EncoderSettings::default()).unwrap(), start)
    }

    #[test]
    fn counts_are_counted_across_the_wrap() {
        for start in [0, 7, u32::MAX - 10, 0x7fff_fffa] {
            let mut sampler = sampler(start);
            for i in 1..=30_i32 {
                let sampled = sampler.sample(start.wrapping_add(i.cast_unsigned()));
                let count = start.cast_signed().wrapping_add(i);
                assert_eq!((sampled.count, sampled.lost_ticks), (count, 0));
                assert!(matches!(sampled.shaft, Sample::Taken(_)));
            }
        }
    }

    #[test]
    fn an_implausible_jump_is_rejected() {
        let mut sampler = sampler(100);
        sampler.sample(101);
        // A disturbance of one tick does not affect those after it.
        let lost = sampler.sample(90_000);
        assert_eq!((lost.shaft, lost.count), (Sample::Lost, 101));
        assert!(matches!(
            sampler.sample(103).shaft,
            Sample::Taken(step) if step.delta_phi_rad > 0.0
        ));
        // A persistent jump is accepted in the end, at rest.
        for n in 1..=LOST_TICKS + 1 {
            assert_eq!(sampler.sample(900_000).lost_ticks, n);
        }
        let found = sampler.sample(900_000);
        assert_eq!((found.lost_ticks, found.omega_rad_s), (0, 0.0));
    }
}
