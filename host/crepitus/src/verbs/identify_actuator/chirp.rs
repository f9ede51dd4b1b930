//! The chirp that is played, or was.

use crate::failure::Failure;
use clap::Args;
use crepitus_identify::actuator::Band;
use crepitus_model::control::chirp::ChirpSettings;
use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::chirp::PlayedChirp;

/// Numbers of the chirp.
#[derive(Debug, Args)]
pub(super) struct ChirpArguments {
    /// Amplitude of the chirp, V: halve it if the mass hits its stops.
    #[arg(long, value_name = "V", allow_negative_numbers = true, conflicts_with = "from",
          default_value_t = ChirpSettings::default().amplitude_v)]
    amplitude_v: f32,

    /// First frequency of the chirp, Hz.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true,
          default_value_t = ChirpSettings::default().from_hz)]
    from_hz: f32,

    /// Last frequency of the chirp, Hz: lower it if the coil has eddy currents.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true,
          default_value_t = ChirpSettings::default().to_hz)]
    to_hz: f32,

    /// Duration of the chirp, s.
    #[arg(long, value_name = "S", allow_negative_numbers = true, conflicts_with = "from",
          default_value_t = ChirpSettings::default().duration_ticks as f32 / TICKS_PER_S as f32)]
    duration_s: f32,
}

impl ChirpArguments {
    /// The chirp in whole numbers, as the device takes it.
    pub(super) fn played(&self) -> Result<PlayedChirp, Failure> {
        // A cast from float saturates; the ranges are checked below.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast from float saturates"
        )]
        let whole = |value: f32, factor: f32| (value * factor).round() as u16;
        let chirp = PlayedChirp {
            amplitude_mv: whole(self.amplitude_v, 1000.0),
            from_dhz: whole(self.from_hz, 10.0),
            to_dhz: whole(self.to_hz, 10.0),
            duration_ms: whole(self.duration_s, 1000.0),
        };
        chirp.settings().check().map_err(Failure::input)?;
        Ok(chirp)
    }

    /// The band that is fitted.
    pub(super) fn band(&self) -> Band {
        Band::of_chirp(f64::from(self.from_hz), f64::from(self.to_hz))
    }
}
