//! An input as data, to run a joint elsewhere.

use super::input::Input;
use super::observation::Hash;
use super::source::source;
use crepitus_model::{SettingsError, ShaftStep};

/// All steps of an input that does not depend on the torque.
///
/// # Errors
/// [`SettingsError`] if the input's encoder is not allowed.
pub fn steps(input: &Input) -> Result<Vec<ShaftStep<f32>>, SettingsError> {
    let motion = input.motion();
    let mut source = source(input, &motion)?;
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
    input.first_omega_rad_s()
}

/// The hash of all torque bits, as a criterion has it.
pub fn torque_hash(torques_nm: impl IntoIterator<Item = f32>) -> u64 {
    let mut hash = Hash::default();
    for torque_nm in torques_nm {
        // −0 is 0.
        hash.add(u64::from((torque_nm + 0.0).to_bits()));
    }
    hash.0
}
