//! Common parts of the verbs that carry out a study: the progress that they show,
//! how they are interrupted, and where their times were measured.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_studies::{Cancelled, StudyError, Watcher};

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

/// The computer that a study runs on, as its `summary.json` names it.
pub(crate) fn host() -> String {
    format!("{} {}", std::env::consts::ARCH, std::env::consts::OS)
}

/// Computer, clock and build of the times of a study, for its page.
pub(crate) fn measured_on(host: &str) -> String {
    let build = if cfg!(debug_assertions) {
        "a debug build: times mean little"
    } else {
        "a release build"
    };
    format!("{host}, {CLOCK}, {build}")
}
