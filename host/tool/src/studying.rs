//! What the verbs that carry out a study share: the progress that they show,
//! and how they are interrupted.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use crepitus_study::{StudyError, Watcher};

/// Moves the progress bar, and stops at Ctrl-C.
pub(crate) struct Watch(Progress);

/// Ctrl-C.
#[derive(Debug)]
pub(crate) struct Interrupted;

impl Watch {
    pub(crate) fn new() -> Self {
        interrupt::listen();
        Self(Progress::of_study())
    }
}

impl Watcher for Watch {
    type Error = Interrupted;

    fn progress(&mut self, fraction: f64) -> Result<(), Interrupted> {
        self.0.reached(fraction);
        if interrupt::requested() {
            return Err(Interrupted);
        }
        Ok(())
    }
}

/// The failure of a study.
pub(crate) fn failed(error: StudyError<Interrupted>) -> Failure {
    match error {
        StudyError::Watcher(Interrupted) => Failure::interrupted(),
        other => Failure::Work(format!("the study failed: {other}")),
    }
}
