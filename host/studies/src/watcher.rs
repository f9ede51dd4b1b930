//! Progress and cancellation of a study.

use crepitus_model::SettingsError;
use crepitus_scene::reference::symptoms::SymptomError;

/// Receives the progress of a study, and may cancel it.
pub trait Watcher {
    /// Called often; `fraction` of the work is done.
    ///
    /// # Errors
    /// Cancels the study.
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled>;
}

/// The watcher cancelled the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ended early")]
pub struct Cancelled;

/// Reason why a study ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The watcher cancelled it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Settings that do not go together.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A symptom that its reference cannot take.
    #[error(transparent)]
    Symptom(#[from] SymptomError),
}
