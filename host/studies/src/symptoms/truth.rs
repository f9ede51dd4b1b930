//! The event-driven reference of a symptom.

use super::event::SymptomEvent;
use super::given::Given;
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::{Symptom, SymptomError};

/// All events up to `end_s`, those of the play too, in the order of time.
///
/// # Errors
/// [`SymptomError`] for settings that the law cannot take.
pub fn true_events(
    given: &Given,
    motion: &Motion,
    end_s: f64,
) -> Result<Vec<SymptomEvent>, SymptomError> {
    let mut symptom = Symptom::new(given.effect, given, motion)?;
    let events = symptom.advance(end_s).into_iter();
    Ok(events
        .map(|event| SymptomEvent {
            time_s: event.time_s,
            word: event.kind,
            omega_rad_s: event.omega_rad_s,
            before_nm: event.torque_before_nm,
            after_nm: event.torque_after_nm,
        })
        .collect())
}

/// The torque at each of these times, which ascend, N·m.
///
/// # Errors
/// As [`true_events`].
pub fn true_torques(
    given: &Given,
    motion: &Motion,
    times_s: impl Iterator<Item = f64>,
) -> Result<Vec<f64>, SymptomError> {
    let mut symptom = Symptom::new(given.effect, given, motion)?;
    Ok(times_s
        .map(|time_s| {
            symptom.advance(time_s);
            symptom.torque_nm()
        })
        .collect())
}
