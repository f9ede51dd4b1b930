//! Progress and cancellation of a study.

use crepitus_model::SettingsError;
use crepitus_scene::reference::symptoms::SymptomError;

/// Receives the progress of a study, and may cancel it.
pub trait Watcher {
    /// Why it cancels.
    type Error;

    /// Called often; `fraction` of the work is done.
    ///
    /// # Errors
    /// Cancels the study.
    fn progress(&mut self, fraction: f64) -> Result<(), Self::Error>;
}

/// Why a study ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError<E> {
    /// The watcher cancelled it.
    #[error("ended early")]
    Watcher(E),
    /// Settings that do not go together.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A symptom that its reference cannot take.
    #[error(transparent)]
    Symptom(#[from] SymptomError),
}
