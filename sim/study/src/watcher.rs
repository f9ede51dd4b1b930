//! Who watches a study: progress, and the way to end it early.

use crepitus_model::SettingsError;

/// Sees a study go by, and may end it.
pub trait Watcher {
    /// Why it ends early.
    type Error;

    /// Called often; `fraction` of the work is done.
    ///
    /// # Errors
    /// Ends the study.
    fn progress(&mut self, fraction: f64) -> Result<(), Self::Error>;
}

/// Why a study ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError<E> {
    /// The watcher ended it.
    #[error("ended early")]
    Watcher(E),
    /// Settings that do not go together.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}
