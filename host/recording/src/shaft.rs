//! Angle and speed from counts, by the drive's own estimator: the same numbers. The counts of a
//! recording are from the angle's zero; where that is set again they jump, and the shaft does not.

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::input_check::InputLimits;
use crepitus_protocol::{DeviceSettings, TICK_S, Values};

/// The shaft's estimator.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shaft {
    settings: EncoderSettings,
    reader: Option<EncoderReader<f32>>,
    next_tick: u64,
    last_count: i32,
}

impl Shaft {
    /// Applies parameters; another encoder resets the estimator.
    pub(crate) fn set(&mut self, values: &Values) {
        if let Ok(settings) = DeviceSettings::of(values)
            && settings.encoder != self.settings
        {
            self.settings = settings.encoder;
            self.reader = None;
        }
    }

    /// Angle and estimated speed in a tick. At the first one, and after a gap, the
    /// estimator restarts with the speed of the next millisecond; the difference
    /// from one that never stopped is gone within 20 ms.
    pub(crate) fn see(&mut self, tick: u64, count: i32, counts_per_s: f64) -> (f64, f32) {
        if tick != self.next_tick {
            self.reader = None;
        }
        self.next_tick = tick.wrapping_add(1);
        let rad_per_count = self.settings.rad_per_count();
        let angle_rad = f64::from(count) * rad_per_count;
        let moved = count.wrapping_sub(self.last_count);
        self.last_count = count;
        let most_rad_s = InputLimits::<f64>::device(TICK_S).speed_rad_s;
        let is_motion = |rad_s: f64| rad_s.abs() <= most_rad_s;
        let omega_rad_s = if let Some(reader) = &mut self.reader {
            if is_motion(f64::from(moved) * rad_per_count / TICK_S) {
                reader.read(count).omega_end_rad_s
            } else {
                *reader = reader.restarted(count, reader.omega_rad_s());
                reader.omega_rad_s()
            }
        } else {
            let begin = Some(counts_per_s * rad_per_count).filter(|rad_s| is_motion(*rad_s));
            #[expect(clippy::cast_possible_truncation, reason = "a speed has few digits")]
            let begin = begin.unwrap_or(0.0) as f32;
            self.reader = EncoderReader::new(&self.settings, TICK_S, count, begin).ok();
            begin
        };
        (angle_rad, omega_rad_s)
    }
}
