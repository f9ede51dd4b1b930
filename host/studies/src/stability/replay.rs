//! An input as data, to run a joint elsewhere.

use super::input::Input;
use super::observation::Hash;
use super::source::{first_omega_rad_s, motion, source};
use crate::sampling::Sampling;
use crepitus_model::{SettingsError, ShaftStep};

/// All steps of an input that does not depend on the torque.
///
/// # Errors
/// [`SettingsError`] if the input's encoder is not allowed.
pub fn steps(input: &Input) -> Result<Vec<ShaftStep<f32>>, SettingsError> {
    let (duration_s, step_s) = input.duration_and_step_s().unwrap_or((0.0, 1.0));
    let motion = motion(input);
    let sampling = Sampling::new(&motion, duration_s, step_s);
    let mut source = source(input, &sampling, &motion)?;
    let (mut all, mut chunk) = (Vec::new(), Vec::new());
    loop {
        source.fill(&mut chunk, 0.0);
        if chunk.is_empty() {
            return Ok(all);
        }
        all.append(&mut chunk);
    }
}

/// Velocity of the shaft as an input starts, rad/s.
pub fn omega_rad_s(input: &Input) -> f64 {
    first_omega_rad_s(input, &motion(input))
}

/// The hash for [`Criterion::TorqueBits`](super::Criterion::TorqueBits).
pub fn torque_hash(torques_nm: impl IntoIterator<Item = f32>) -> u64 {
    let mut hash = Hash::default();
    for torque_nm in torques_nm {
        // −0 is 0.
        hash.add(u64::from((torque_nm + 0.0).to_bits()));
    }
    hash.0
}
