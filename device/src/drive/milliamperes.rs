//! Currents of the motor and of the coil as telemetry has them: whole milliamperes.

use crepitus_model::Real;

/// Rounds and clamps to the range of i16, never
/// [`NO_CURRENT`](crepitus_protocol::telemetry::NO_CURRENT).
pub(crate) fn milliamperes(current_a: f32) -> i16 {
    let most = f32::from(i16::MAX);
    let scaled = current_a * 1e3;
    let rounded = (scaled + 0.5_f32.copysign(scaled)).within(most);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast from float saturates"
    )]
    // To 32 bits it is one instruction.
    let milliamperes = rounded as i32;
    i16::try_from(milliamperes).unwrap_or(0)
}
