//! What the verbs that carry out a study share: the progress that they show,
//! and how they are interrupted.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use crepitus_study::{Cancelled, StudyError, Watcher};

/// Moves the progress bar, and stops at Ctrl-C.
pub(crate) struct Watch(Progress);

impl Watch {
    pub(crate) fn new() -> Self {
        interrupt::listen();
        Self(Progress::of_study())
    }
}

impl Watcher for Watch {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        self.0.reached(fraction);
        if interrupt::requested() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

/// The failure of a study.
pub(crate) fn failed(error: StudyError) -> Failure {
    match error {
        StudyError::Cancelled(_) => Failure::interrupted(),
        other => Failure::Work(format!("the study failed: {other}")),
    }
}
