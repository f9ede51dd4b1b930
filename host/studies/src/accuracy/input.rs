//! Knowledge that a rung has of the shaft: its true motion, or the device's view.
//!
//! The device has the counts of the motor's encoder and the velocity that
//! [`EncoderReader`] estimates from them, both in single precision. A count is 36 µrad
//! of the joint. The estimate begins settled, and the encoder has its defaults.

use crate::sampling::{Sampling, Walk};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::{Real, SettingsError, ShaftStep};

crepitus_model::named! {
    /// See the module.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Input {
        /// The true motion, rounded once.
        #[default]
        Exact => "exact",
        /// Counts and estimated velocity.
        Encoder => "encoder",
    }
}

/// The steps of a scene, as its input shows them.
pub struct Feed<'a, F> {
    walk: Walk<'a>,
    /// The encoder, if it is between the shaft and the rung.
    reader: Option<EncoderReader<F>>,
    rad_per_count: f64,
    placed: Vec<(f64, ShaftStep<F>)>,
}

impl<'a, F: Real> Feed<'a, F> {
    /// The steps from step `n` on.
    ///
    /// # Errors
    /// None in practice: the encoder's defaults are allowed.
    pub fn new(input: Input, sampling: &Sampling<'a>, n: u64) -> Result<Self, SettingsError> {
        let settings = EncoderSettings::default();
        let rad_per_count = settings.rad_per_count();
        let walk = sampling.walk_from(n);
        let (phi_rad, omega_rad_s) = walk.now();
        let reader = || {
            let (count, omega) = (count(phi_rad, rad_per_count), F::from_f64(omega_rad_s));
            EncoderReader::new(&settings, sampling.step_s(), count, omega)
        };
        Ok(Self {
            reader: match input {
                Input::Exact => None,
                Input::Encoder => Some(reader()?),
            },
            walk,
            rad_per_count,
            placed: Vec::new(),
        })
    }

    /// Replaces `chunk` by the next steps, at most `most`; empty at the end.
    pub fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, most: usize) {
        let Some(reader) = &mut self.reader else {
            return self.walk.fill(chunk, most);
        };
        self.walk.fill_with_angles(&mut self.placed, most);
        chunk.clear();
        let ends = self.placed.iter();
        chunk.extend(ends.map(|(phi_rad, _)| reader.read(count(*phi_rad, self.rad_per_count))));
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "counts of an encoder on a scene's angle"
)]
fn count(phi_rad: f64, rad_per_count: f64) -> i32 {
    (phi_rad / rad_per_count).floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::{StudyScene, standard};

    fn steps(input: Input, n: u64) -> Vec<ShaftStep<f32>> {
        let scene = StudyScene {
            input,
            ..standard().unwrap()[4].clone()
        };
        assert_eq!(scene.name, "constant-0.988");
        let sampling = Sampling::new(&scene.motion, 1.0, 5e-5);
        let mut chunk = Vec::new();
        let mut feed = Feed::new(scene.input, &sampling, n).unwrap();
        feed.fill(&mut chunk, 30_000);
        chunk
    }

    #[test]
    fn the_encoder_shows_whole_counts_and_loses_no_angle() {
        let rad_per_count = EncoderSettings::default().rad_per_count();
        for n in [0, 7_000] {
            let (exact, counted) = (steps(Input::Exact, n), steps(Input::Encoder, n));
            assert_eq!(exact.len(), counted.len());
            let travel = |steps: &[ShaftStep<f32>]| -> f64 {
                steps.iter().map(|s| f64::from(s.delta_phi_rad)).sum()
            };
            assert!((travel(&exact) - travel(&counted)).abs() <= rad_per_count * 1.01);
            for step in &counted {
                let counts = f64::from(step.delta_phi_rad) / rad_per_count;
                assert!((counts - counts.round()).abs() < 1e-5, "{counts}");
                // One count over 1/(2π·50 Hz).
                assert!((step.omega_end_rad_s - 0.988).abs() < 0.012, "{step:?}");
            }
            let estimates = counted.iter().map(|s| s.omega_end_rad_s);
            assert!(estimates.clone().any(|omega| omega > 0.9881));
            assert!(estimates.clone().any(|omega| omega < 0.9879));
        }
    }
}
