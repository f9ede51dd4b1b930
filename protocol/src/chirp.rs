//! A chirp for the coil of the vibration actuator, in whole numbers: what the drive
//! plays and what the host knows of it are the same bits.

use crepitus_model::control::chirp::ChirpSettings;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Ticks of a millisecond.
const TICKS_PER_MS: u32 = 20;

/// A chirp to play; the ranges are those of [`ChirpSettings`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub struct PlayedChirp {
    /// Amplitude, mV.
    pub amplitude_mv: u16,
    /// First frequency, tenths of a hertz.
    pub from_dhz: u16,
    /// Last frequency, tenths of a hertz.
    pub to_dhz: u16,
    /// Duration, ms.
    pub duration_ms: u16,
}

impl PlayedChirp {
    /// Settings for the generator.
    pub fn settings(&self) -> ChirpSettings {
        ChirpSettings {
            amplitude_v: f32::from(self.amplitude_mv) / 1000.0,
            from_hz: f32::from(self.from_dhz) / 10.0,
            to_hz: f32::from(self.to_dhz) / 10.0,
            duration_ticks: u32::from(self.duration_ms).wrapping_mul(TICKS_PER_MS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_chirp_is_one_of_whole_numbers() {
        let chirp = PlayedChirp {
            amplitude_mv: 400,
            from_dhz: 80,
            to_dhz: 5_000,
            duration_ms: 10_000,
        };
        assert_eq!(chirp.settings(), ChirpSettings::default());
        let longest = PlayedChirp {
            duration_ms: u16::MAX,
            ..chirp
        };
        assert_eq!(longest.settings().duration_ticks, 1_310_700);
        assert!(longest.settings().check().is_err());
    }
}
