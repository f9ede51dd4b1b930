//! The observer of a run, of no particular type: so the loops of this crate are
//! compiled here, once, and not again for everybody who observes.

use super::{Observer, RunError};
use crate::trace::{EventRecord, SymptomEvent};

/// The observer has had enough; it knows why.
pub(super) struct Stopped;

/// An [`Observer`] whose reasons stay with it.
pub(super) trait Watch {
    /// Returns whether rows of the trace are needed.
    fn wants_rows(&self) -> bool;
    /// Returns whether the run is to make every step.
    fn needs_steps(&self) -> bool;
    fn row(&mut self, values: &[f64]) -> Result<(), Stopped>;
    fn event(&mut self, event: &EventRecord) -> Result<(), Stopped>;
    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Stopped>;
    fn progress(&mut self, time_s: f64) -> Result<(), Stopped>;
}

/// A run that ended early, as the loops know it.
pub(super) type Ended = RunError<Stopped>;

impl From<Stopped> for Ended {
    fn from(stopped: Stopped) -> Self {
        Self::Observer(stopped)
    }
}

/// Watches for an observer.
struct Watching<'a, O: Observer> {
    observer: &'a mut O,
    reason: Option<O::Error>,
}

impl<O: Observer> Watching<'_, O> {
    fn noted(&mut self, result: Result<(), O::Error>) -> Result<(), Stopped> {
        result.map_err(|reason| {
            self.reason = Some(reason);
            Stopped
        })
    }
}

impl<O: Observer> Watch for Watching<'_, O> {
    fn wants_rows(&self) -> bool {
        O::WANTS_ROWS
    }

    fn needs_steps(&self) -> bool {
        O::WANTS_ROWS || O::NEEDS_STEPS
    }

    fn row(&mut self, values: &[f64]) -> Result<(), Stopped> {
        let result = self.observer.row(values);
        self.noted(result)
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Stopped> {
        let result = self.observer.event(event);
        self.noted(result)
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Stopped> {
        let result = self.observer.symptom(event);
        self.noted(result)
    }

    fn progress(&mut self, time_s: f64) -> Result<(), Stopped> {
        let result = self.observer.progress(time_s);
        self.noted(result)
    }
}

/// Runs `work` under the eyes of an observer.
///
/// # Panics
/// If `work` ends as stopped without the observer's word: a mistake of ours.
pub(super) fn watched<T, O: Observer>(
    observer: &mut O,
    work: impl FnOnce(&mut dyn Watch) -> Result<T, Ended>,
) -> Result<T, RunError<O::Error>> {
    let mut watching = Watching {
        observer,
        reason: None,
    };
    work(&mut watching).map_err(|ended| match ended {
        RunError::Settings(error) => RunError::Settings(error),
        RunError::Diverged(error) => RunError::Diverged(error),
        RunError::Observer(Stopped) => {
            RunError::Observer(watching.reason.take().expect("a reason to stop"))
        }
    })
}
