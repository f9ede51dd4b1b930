//! The folder of a session.
//!
//! ```text
//! FOLDER/2026-11-24-154205-six-knees-blind/
//!   session.json      all of it: plan, seed, order, truth, students, answers, notes, recordings
//!   answers.csv       one line an answer, with the truth
//!   notes.csv         one line a note; an apostrophe before what a spreadsheet would compute
//!   class.json        keys of the students' phones, until the lesson ends
//!   trial-01.parquet  recordings, named by trial: the name does not tell the knee
//!   report.html       the page to print
//! ```
//!
//! Every file is written beside its place and then renamed, so it is there whole or not at all,
//! and the one that was there stays if the disk is full. A table that somebody has edited meanwhile stays, too,
//! and the error says so. `session.json` is written first: whatever
//! happens after it, [`Session::read`] has the answers.

mod keys;

use crate::lesson::report::{Text, report};
use crate::lesson::session::{Session, SessionError};
use crepitus_files::input::{self, InputError};
use crepitus_files::names::plain;
use crepitus_files::output::{Claim, Hashed, OutputError, OwnedFolder, private_in};
use crepitus_scene::preset::Level;
use crepitus_studies::experiment::finding::Finding;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The folder of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionFolder {
    path: PathBuf,
}

/// Error of a session's folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// A file or folder cannot be written.
    #[error(
        "cannot write {}: {cause}; check that the folder exists, that it may be written, and that the disk has room",
        .path.display()
    )]
    Write {
        /// File or folder.
        path: PathBuf,
        /// Cause.
        cause: io::Error,
    },
    /// The session cannot be read.
    #[error("cannot read {}: {cause}; choose a folder with a `session.json`", .path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// Cause.
        cause: InputError,
    },
    /// The session cannot be rebuilt.
    #[error("{}: {cause}", .path.display())]
    Session {
        /// File.
        path: PathBuf,
        /// Cause.
        cause: SessionError,
    },
}

impl SessionFolder {
    /// Makes the folder of a session in another one, which is made if it does not exist, and
    /// writes the session's files into it.
    ///
    /// # Errors
    /// [`FolderError::Write`]. A folder that was made for it is removed again.
    pub fn create(parent: &Path, session: &Session) -> Result<Self, FolderError> {
        fs::create_dir_all(parent).map_err(write_error(parent))?;
        let base = format!(
            "{}-{}",
            session.started.file_name(),
            sanitised(session.lesson.name())
        );
        let mut path = parent.join(&base);
        for number in 2.. {
            match fs::create_dir(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    path = parent.join(format!("{base}-{number}"));
                }
                made => {
                    made.map_err(write_error(&path))?;
                    break;
                }
            }
        }
        let folder = Self { path };
        if let Err(error) = folder.save(session) {
            // The error to report is that of the files.
            let own = OwnedFolder::open(&folder.path, Claim::by("lesson"));
            let _ = own.and_then(OwnedFolder::remove_own);
            return Err(error);
        }
        Ok(folder)
    }

    /// The folder of a session that was begun before.
    ///
    /// # Errors
    /// [`FolderError::Read`], [`FolderError::Session`].
    pub fn open(path: &Path) -> Result<(Self, Session), FolderError> {
        let session = Session::read(path)?;
        let path = path.to_owned();
        Ok((Self { path }, session))
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// File of a trial's recording, from 1; the caller writes it.
    pub fn recording(&self, trial: usize) -> PathBuf {
        self.path.join(recording_name(trial))
    }

    /// File of a trial's next recording, from 1, with this extension. One that an interrupted program has left
    /// stays beside it.
    pub fn next_recording(&self, session: &Session, trial: usize, extension: &str) -> PathBuf {
        let mut path = self.recording(trial).with_extension(extension);
        if session.recording_of(trial).is_none() {
            return path;
        }
        for number in 2.. {
            if !path.exists() {
                break;
            }
            path.set_file_name(format!("trial-{trial:02}-{number}.{extension}"));
        }
        path
    }

    /// Writes session, answers and notes. To be called after every change.
    ///
    /// # Errors
    /// [`FolderError::Write`]; the files that were there stay.
    pub fn save(&self, session: &Session) -> Result<(), FolderError> {
        let path = self.path.join(SESSION);
        let json = session.to_json();
        let json = json.map_err(|cause| FolderError::Session { path, cause })?;
        self.write(SESSION, json.as_bytes())?;
        self.write_table(ANSWERS, &answers(session))?;
        self.write_table(NOTES, &notes(session))
    }

    /// Writes the page to print, its texts by key.
    ///
    /// # Errors
    /// [`FolderError::Write`].
    pub fn save_report(&self, session: &Session, text: Text<'_>) -> Result<PathBuf, FolderError> {
        self.write(REPORT, report(session, text).as_bytes())?;
        Ok(self.path.join(REPORT))
    }

    fn write_table(&self, name: &str, rows: &[Vec<String>]) -> Result<(), FolderError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let written = rows.iter().try_for_each(|row| writer.write_record(row));
        let bytes = written
            .map_err(io::Error::from)
            .and_then(|()| writer.into_inner().map_err(csv::IntoInnerError::into_error));
        let bytes = bytes.map_err(write_error(&self.path.join(name)))?;
        self.write(name, &bytes)
    }

    /// Puts a file in its place, whole.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), FolderError> {
        let path = self.path.join(name);
        let put = || -> io::Result<()> {
            // Of students.
            let mut file = private_in(&self.path)?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            let file = Hashed::of(file.into_temp_path())?;
            // A table that somebody has edited stays; answers must not be lost, and are in the session.
            let claim = Claim::by("lesson").force(name == SESSION);
            let mut folder = OwnedFolder::open(&self.path, claim).map_err(io_error)?;
            folder.put(file, name).map_err(io_error)?;
            folder.compact().map_err(io_error)
        };
        put().map_err(write_error(&path))
    }
}

impl Session {
    /// Reads the session of a folder, whether it has ended or not.
    ///
    /// # Errors
    /// [`FolderError::Read`], [`FolderError::Session`].
    pub fn read(folder: &Path) -> Result<Self, FolderError> {
        let path = folder.join(SESSION);
        let text = match input::read_to_string(&path, SESSION_BYTES) {
            Ok(text) => text,
            Err(cause) => return Err(FolderError::Read { path, cause }),
        };
        Self::from_json(&text).map_err(|cause| FolderError::Session { path, cause })
    }
}

/// Longest session that is read, bytes: a lesson of a day with a thousand answers is a tenth of it.
const SESSION_BYTES: u64 = 16_000_000;

const SESSION: &str = "session.json";
const ANSWERS: &str = "answers.csv";
const NOTES: &str = "notes.csv";
const REPORT: &str = "report.html";

/// Name of a trial's recording, from 1.
pub(crate) fn recording_name(trial: usize) -> String {
    format!("trial-{trial:02}.parquet")
}

/// The trial, from 1, of a recording's file name.
pub(crate) fn trial_of(file: &str) -> Option<usize> {
    let digits = file.strip_prefix("trial-")?.split(['-', '.']).next()?;
    digits.parse().ok()
}

fn io_error(error: OutputError) -> io::Error {
    match error {
        OutputError::Io { source, .. } => source,
        error => io::Error::other(error),
    }
}

fn write_error(path: &Path) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_owned();
    |cause| FolderError::Write { path, cause }
}

/// A name for a folder, of the name of a lesson.
fn sanitised(name: &str) -> String {
    let name = plain(name, 40);
    if name.is_empty() {
        return "lesson".to_owned();
    }
    name
}

/// Table of answers, by trial and student.
fn answers(session: &Session) -> Vec<Vec<String>> {
    let lesson = &session.lesson;
    let head = [
        "trial",
        "preset",
        "true_disorder",
        "true_level",
        "student",
        "disorder",
        "level",
        "confidence",
        "right",
        "level_right",
        "time_s",
        "recording",
        "torque_share",
        "counts",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let mut answers: Vec<_> = lesson.answers().iter().collect();
    let place = |student: &str| lesson.students().iter().position(|other| other == student);
    answers.sort_by_key(|answer| (answer.trial, place(&answer.student)));
    for answer in answers {
        let knee = lesson.knee_of(answer.trial);
        let level_right = answer.is_level_right(knee).map(|right| right.to_string());
        let recording = session.recording_of(answer.trial).unwrap_or_default();
        rows.push(vec![
            answer.trial.to_string(),
            knee.preset.clone(),
            knee.disorder.map_or("", Finding::name).to_owned(),
            knee.level.map_or("", Level::name).to_owned(),
            answer.student.clone(),
            answer.disorder.name().to_owned(),
            answer.level.map_or("", Level::name).to_owned(),
            answer.confidence.to_string(),
            answer.is_right(knee).to_string(),
            level_right.unwrap_or_default(),
            answer.time_s.to_string(),
            recording.to_owned(),
            answer
                .torque_share
                .map(|share| share.to_string())
                .unwrap_or_default(),
            answer.counts().to_string(),
        ]);
    }
    rows
}

/// Table of notes, in the order in which they were made.
fn notes(session: &Session) -> Vec<Vec<String>> {
    let head = ["time_s", "trial", "by", "text"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for note in session.lesson.notes() {
        rows.push(vec![
            note.time_s.to_string(),
            note.trial.to_string(),
            note.by.name().to_owned(),
            as_text(&note.text),
        ]);
    }
    rows
}

/// A text that a spreadsheet does not take for a formula: an apostrophe comes before it.
fn as_text(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@']) {
        return format!("'{text}");
    }
    text.to_owned()
}

#[cfg(test)]
mod tests;
