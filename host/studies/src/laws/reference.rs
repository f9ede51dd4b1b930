//! The torque of our joint by the event-driven reference, as the study demands it.

use crepitus_model::{Convention, Parameters, Real, Restart, Settings, SettingsError, Validated};
use crepitus_plant::Motion;
use crepitus_scene::reference::Reference;

/// The joint as the device renders it, in the convention `frozen`.
pub(super) fn demanded(joint: &Parameters) -> Result<Validated<Settings>, SettingsError> {
    Settings {
        parameters: *joint,
        convention: Convention::Frozen,
        restart: Restart::default(),
    }
    .validate()
}

/// Calls `each` with time and torque of the joint, so often in a second.
pub(super) fn torques(
    settings: &Validated<Settings>,
    motion: &Motion,
    duration_s: f64,
    rate_hz: f64,
    mut each: impl FnMut(f64, f64),
) {
    let mut reference = Reference::new(settings, motion);
    for n in 1..=(duration_s * rate_hz).round().whole() {
        let time_s = f64::from_whole(n) / rate_hz;
        reference.advance(time_s, |_| {});
        each(time_s, reference.torque_nm());
    }
}
