//! Counts to angle and speed, as the drive does it: the same estimator, the
//! same numbers.

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_protocol::{DeviceSettings, TICK_S, Values};

/// Follows the shaft.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    settings: EncoderSettings,
    reader: Option<EncoderReader<f32>>,
    next_tick: u64,
}

impl Shaft {
    pub(crate) fn new() -> Self {
        Self {
            settings: EncoderSettings::default(),
            reader: None,
            next_tick: 0,
        }
    }

    /// Another encoder, perhaps.
    pub(crate) fn set(&mut self, values: &Values) {
        if let Ok(settings) = DeviceSettings::of(values)
            && settings.encoder != self.settings
        {
            self.settings = settings.encoder;
            self.reader = None;
        }
    }

    /// Angle and estimated speed in a tick. After a gap the estimate begins
    /// anew, and settles within 20 ms.
    pub(crate) fn see(&mut self, tick: u64, count: i32) -> (f64, f32) {
        if tick != self.next_tick {
            self.reader = None;
        }
        self.next_tick = tick.wrapping_add(1);
        let angle_rad = f64::from(count) * self.settings.rad_per_count();
        let omega_rad_s = if let Some(reader) = &mut self.reader {
            reader.read(count).omega_end_rad_s
        } else {
            self.reader = EncoderReader::new(&self.settings, TICK_S, count, 0.0).ok();
            0.0
        };
        (angle_rad, omega_rad_s)
    }
}
