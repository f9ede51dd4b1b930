//! Conversion of telemetry blocks to rows.

use crate::row::Row;
use crate::shaft::Shaft;
use crepitus_protocol::telemetry::{Block, NO_CURRENT};
use crepitus_protocol::{TICKS_PER_S, Values};

/// Converts samples to rows, with angle and speed from the drive's own
/// estimator.
#[derive(Clone, Debug)]
pub struct Samples {
    shaft: Shaft,
    first_tick: Option<u64>,
}

impl Default for Samples {
    fn default() -> Self {
        Self {
            shaft: Shaft::new(),
            first_tick: None,
        }
    }
}

impl Samples {
    /// Sets the parameters from the next block on.
    pub fn set(&mut self, values: &Values) {
        self.shaft.set(values);
    }

    /// The rows of a block. Time starts at the first block.
    pub fn rows<'a>(&'a mut self, block: &'a Block) -> impl Iterator<Item = Row> + 'a {
        let first_tick = *self.first_tick.get_or_insert(block.first_tick);
        (block.first_tick..)
            .zip(&block.samples)
            .map(move |(tick, sample)| {
                let (angle_rad, omega_rad_s) = self.shaft.see(tick, sample.count);
                let since = tick.saturating_sub(first_tick);
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
                    revision: block.revision.0,
                    flags: sample.flags,
                }
            })
    }
}
