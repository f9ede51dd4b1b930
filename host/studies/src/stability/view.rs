//! A device's view of a prescribed motion: its true steps, or counts of the encoder.

use crate::sampling::{Sampling, Walk};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::{Real, Sample, SettingsError, ShaftStep};
use crepitus_plant::encoder::Encoder;

/// See the module.
pub(super) struct View<'a, F> {
    walk: Walk<'a>,
    chunk: Vec<ShaftStep<F>>,
    encoder: Encoder,
    reader: EncoderReader<F>,
    counts: bool,
    /// Travel since the last sample, rad.
    unseen_rad: F,
}

impl<'a, F: Real> View<'a, F> {
    pub(super) fn new(sampling: &Sampling<'a>, counts: bool) -> Result<Self, SettingsError> {
        let settings = EncoderSettings::default();
        let encoder = Encoder::new(&settings);
        let walk = sampling.walk_from(0);
        let (angle_rad, omega_rad_s) = walk.now();
        let (first, omega) = (encoder.count(angle_rad), F::from_f64(omega_rad_s));
        Ok(Self {
            walk,
            chunk: Vec::new(),
            reader: EncoderReader::new(&settings, sampling.step_s(), first, omega)?,
            encoder,
            counts,
            unseen_rad: F::ZERO,
        })
    }

    /// The estimate of the velocity, rad/s.
    pub(super) fn omega_rad_s(&self) -> F {
        self.reader.omega_rad_s()
    }

    pub(super) fn sensing(&self) -> Sensing {
        if self.counts {
            Sensing::of_encoder(&EncoderSettings::default())
        } else {
            Sensing::IDEAL
        }
    }

    /// The joint's place, as it is seen.
    pub(super) fn place(&self) -> Position<F> {
        let angle_rad = self.walk.now().0;
        if self.counts {
            Position::at(self.encoder.count(angle_rad))
        } else {
            Sensing::IDEAL.position(angle_rad)
        }
    }

    /// The next sample, if it is not lost, and the true travel, rad.
    pub(super) fn sample(&mut self, is_lost: bool) -> (Sample<F>, f64) {
        let before_rad = self.walk.now().0;
        self.walk.fill(&mut self.chunk, 1);
        let Some(shaft) = self.chunk.first() else {
            return (Sample::Lost, 0.0);
        };
        let angle_rad = self.walk.now().0;
        self.unseen_rad += shaft.delta_phi_rad;
        let sample = if is_lost {
            self.reader.miss();
            Sample::Lost
        } else if self.counts {
            Sample::Taken(self.reader.read(self.encoder.count(angle_rad)))
        } else {
            Sample::Taken(ShaftStep {
                delta_phi_rad: std::mem::take(&mut self.unseen_rad),
                ..*shaft
            })
        };
        (sample, angle_rad - before_rad)
    }
}
