//! Copies of a study's files: of one participant, or of all.

use super::super::table::{Held, LOCK, PROTOCOL, SESSION, TRIALS, line};
use super::super::trial::Row;
use super::{
    CONSENT, MARK, MARK_TEXT, Store, StoreError, create, entries, make, temporary_in, write,
};
use std::fs::{self, File};
use std::io;
use std::path::Path;
use tempfile::TempDir;

/// Text in place of a description that is left out of a deposit.
pub const LEFT_OUT: &str = "(left out)";

impl Store {
    /// Copies everything of a participant, with the texts of consent, into a new folder of this user alone.
    ///
    /// # Errors
    /// [`StoreError`]; what was copied of it is removed again.
    pub fn export(&self, participant: &str, to: &Path) -> Result<(), StoreError> {
        let own = self.of(participant)?;
        let sessions = self.sessions_of(participant)?;
        let new = new_beside(to)?;
        copy_all(&own, new.path())?;
        self.copy_consents(&sessions, new.path())?;
        keep_as(new, to)
    }

    /// Copies sessions of all participants into a new folder, for others to read: a study like this one, with the
    /// lines that are whole, and without what no session has written. Descriptions, in which people may be told,
    /// are [left out](LEFT_OUT) unless asked for. Returns the number of sessions.
    ///
    /// # Errors
    /// [`StoreError`]; what was copied is removed again.
    pub fn deposit(&self, to: &Path, with_descriptions: bool) -> Result<usize, StoreError> {
        let sessions = self.sessions()?;
        let new = new_beside(to)?;
        write(&new.path().join(MARK), MARK_TEXT.as_bytes())?;
        for held in &sessions {
            let own = new.path().join(&held.begun().participant);
            let own = own.join(held.folder().file_name().unwrap_or_default());
            make(&own)?;
            for name in [SESSION, PROTOCOL] {
                let path = held.folder().join(name);
                let bytes = fs::read(&path).map_err(|cause| StoreError::Write { path, cause })?;
                write(&own.join(name), &bytes)?;
            }
            let header = line(&held.session().header());
            let rows = held.session().rows().iter();
            let rows = rows.map(|row| line(&for_others(row, with_descriptions).record()));
            let table: String = std::iter::once(header).chain(rows).collect();
            write(&own.join(TRIALS), table.as_bytes())?;
            write(&own.join(LOCK), b"")?;
        }
        self.copy_consents(&sessions, new.path())?;
        keep_as(new, to)?;
        Ok(sessions.len())
    }

    /// Copies the texts of consent of sessions.
    fn copy_consents(&self, sessions: &[Held], to: &Path) -> Result<(), StoreError> {
        let hashes = sessions
            .iter()
            .filter_map(|held| held.begun().consent_sha256.as_deref());
        for hash in hashes {
            let name = format!("{hash}.txt");
            let path = self.folder.join(CONSENT).join(&name);
            let text = fs::read(&path).map_err(|cause| StoreError::Write { path, cause })?;
            let kept = to.join(CONSENT);
            make(&kept)?;
            if !kept.join(&name).exists() {
                write(&kept.join(name), &text)?;
            }
        }
        Ok(())
    }
}

/// A row without the words in which people may be told.
fn for_others(row: &Row, with_descriptions: bool) -> Row {
    let mut row = row.clone();
    if let (Row::Realism(row), false) = (&mut row, with_descriptions) {
        LEFT_OUT.clone_into(&mut row.description);
    }
    row
}

/// Makes a folder that is to become `to`, which must not exist.
fn new_beside(to: &Path) -> Result<TempDir, StoreError> {
    if to.exists() {
        return Err(StoreError::Write {
            path: to.to_owned(),
            cause: io::ErrorKind::AlreadyExists.into(),
        });
    }
    temporary_in(crepitus_files::output::folder_of(to))
}

/// Gives a folder its name.
fn keep_as(new: TempDir, to: &Path) -> Result<(), StoreError> {
    fs::rename(new.path(), to).map_err(|cause| StoreError::Write {
        path: to.to_owned(),
        cause,
    })?;
    let _ = new.keep();
    Ok(())
}

/// Copies a folder into one that exists; links and the like are left out.
fn copy_all(from: &Path, to: &Path) -> Result<(), StoreError> {
    for path in entries(from)? {
        let target = to.join(path.file_name().unwrap_or_default());
        let failed = |cause| StoreError::Write {
            path: path.clone(),
            cause,
        };
        let kind = fs::symlink_metadata(&path).map_err(failed)?;
        if kind.is_dir() {
            make(&target)?;
            copy_all(&path, &target)?;
        } else if kind.is_file() {
            let mut file = create(&target)?;
            let mut source = File::open(&path).map_err(failed)?;
            io::copy(&mut source, &mut file).map_err(failed)?;
        }
    }
    Ok(())
}
