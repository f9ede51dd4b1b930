//! What the verbs that carry out a study share: the progress that they show,
//! how they are interrupted, and the files that they leave.

use crate::failure::Failure;
use crate::interrupt;
use crate::pictures::Files;
use crate::progress::Progress;
use crepitus_scene::output::Folder;
use crepitus_study::{StudyError, Watcher};
use std::io::Write;
use std::path::Path;

/// Moves the progress bar, and stops when asked.
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
        if interrupt::asked() {
            return Err(Interrupted);
        }
        Ok(())
    }
}

/// Why a study has no result.
pub(crate) fn failed(error: StudyError<Interrupted>) -> Failure {
    match error {
        StudyError::Watcher(Interrupted) => {
            Failure::Work("interrupted: nothing was written".to_owned())
        }
        other => Failure::Work(format!("the study failed: {other}")),
    }
}

/// Writes names and contents of files, all or none.
pub(crate) fn write(folder: Folder, out: &Path, files: Files) -> Result<(), Failure> {
    for (name, content) in files {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(&content)?;
                Folder::finish(file)
            })
            .map_err(|e| Failure::at(out, "writing the results", &e))?;
    }
    folder
        .commit()
        .map_err(|e| Failure::at(out, "moving the results into place", &e))
}
