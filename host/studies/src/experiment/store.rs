//! Participants of a study, on the disk of one person.
//!
//! ```text
//! STUDY/                          0700: this user alone
//!   crepitus-study.txt            what this folder is
//!   consent/SHA256.txt            every text to which somebody consented
//!   P01/                          a participant, by pseudonym
//!     coarse-threshold-1/         a session: see `table`
//! ```
//!
//! Files are 0600. A pseudonym has a digit: names of people rarely do. Nothing leaves the folder but by
//! [`Store::export`], of one participant, and [`Store::deposit`], of all; [`Store::delete`] removes a participant's
//! files. Their blocks on the disk are not overwritten, and copies elsewhere stay.

mod copies;

pub use copies::LEFT_OUT;

use super::protocol::{Known, Protocol, ProtocolError};
use super::table::{
    Begun, FILES, Held, LOCK, PROTOCOL, SESSION, TEMPORARY, TRIALS, TableError, hash_of, line, lock,
};
use super::{Session, order};
use crepitus_files::input::{self, InputError, TEXT_BYTES};
use crepitus_files::names::{is_reserved, plain};
use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// File that marks the folder of a study.
pub const MARK: &str = "crepitus-study.txt";
const CONSENT: &str = "consent";
const MARK_TEXT: &str = "Answers of participants in an experiment, by pseudonym. `crepitus experiment export` copies \
those of one participant, `crepitus experiment delete` removes them.\n";

/// Most characters of a pseudonym.
const MOST_PSEUDONYM: usize = 24;

/// The folder of a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
}

/// Error of a study's folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Not the folder of a study.
    #[error("{} has no {MARK}: name the folder of a study, or a new one", .0.display())]
    NoStudy(PathBuf),
    /// A file or folder cannot be written or removed.
    #[error("{}: {cause}", .path.display())]
    Write {
        /// File or folder.
        path: PathBuf,
        /// Cause.
        cause: io::Error,
    },
    /// A file cannot be read.
    #[error("{}: {cause}", .path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// Cause.
        cause: InputError,
    },
    /// The pseudonym is not allowed.
    #[error(
        "invalid pseudonym {0:?}: expected up to {MOST_PSEUDONYM} letters a to z, digits and hyphens, with a digit, \
         such as P01; never a name"
    )]
    Pseudonym(String),
    /// Another participant's, but for capital letters: on some systems they have one folder.
    #[error("{0:?} is taken: capital letters make no difference")]
    Taken(String),
    /// The study has no such participant.
    #[error("the study has no participant {0:?}")]
    NoParticipant(String),
    /// The participant has not consented.
    #[error("the protocol has a text to consent to, {}: without the participant's consent no session begins", .0.display())]
    NoConsent(PathBuf),
    /// A file that no session has written is in the way.
    #[error("{} was not written by a session: move it away, or use --force", .0.display())]
    Foreign(PathBuf),
    /// Files of a session.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The protocol is invalid.
    #[error("{}: {cause}", .path.display())]
    Protocol {
        /// File.
        path: PathBuf,
        /// Cause.
        cause: ProtocolError,
    },
}

/// Begin of a session.
#[derive(Clone, Copy, Debug)]
pub struct Beginning<'a> {
    /// File of the protocol; its consent is named relative to it.
    pub protocol: &'a Path,
    /// Pseudonym.
    pub participant: &'a str,
    /// Seed of the order; `None`: of the protocol's, the pseudonym and the number of the session.
    pub seed: Option<u64>,
    /// Whether the participant has consented to the protocol's text.
    pub has_consented: bool,
    /// Time, s since 1970.
    pub unix_s: u64,
}

impl Store {
    /// Opens the folder of a study, which is made if there is none, or if it is empty.
    ///
    /// # Errors
    /// [`StoreError::NoStudy`] of a folder with other files.
    pub fn create(folder: &Path) -> Result<Self, StoreError> {
        let mark = folder.join(MARK);
        if !mark.is_file() {
            let is_empty = |folder| fs::read_dir(folder).is_ok_and(|mut all| all.next().is_none());
            if folder.exists() && !is_empty(folder) {
                return Err(StoreError::NoStudy(folder.to_owned()));
            }
            make(folder)?;
            write(&mark, MARK_TEXT.as_bytes())?;
        }
        keep_private(folder)?;
        Self::open(folder)
    }

    /// Opens the folder of a study.
    ///
    /// # Errors
    /// [`StoreError::NoStudy`].
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        if !folder.join(MARK).is_file() {
            return Err(StoreError::NoStudy(folder.to_owned()));
        }
        let folder = folder.to_owned();
        Ok(Self { folder })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Takes up the participant's last session with this protocol if it is not over, or begins a new one;
    /// returns whether it was taken up.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn begin(
        &self,
        beginning: Beginning<'_>,
        known: Known<'_>,
    ) -> Result<(Held, bool), StoreError> {
        let Beginning {
            protocol: path,
            participant,
            unix_s,
            ..
        } = beginning;
        check_pseudonym(participant)?;
        let others = self.participants()?.into_iter();
        let is_taken =
            |other: &String| other != participant && other.eq_ignore_ascii_case(participant);
        if let Some(other) = others.into_iter().find(is_taken) {
            return Err(StoreError::Taken(other));
        }
        let text = read(path)?;
        let checked = Protocol::from_toml(&text).and_then(|protocol| {
            protocol.check(known)?;
            Ok(protocol)
        });
        let protocol = checked.map_err(|cause| StoreError::Protocol {
            path: path.to_owned(),
            cause,
        })?;
        let hash = hash_of(text.as_bytes());
        let own = self.sessions_of(participant)?.into_iter();
        let own: Vec<_> = own
            .filter(|held| held.begun().protocol_sha256 == hash)
            .collect();
        if let Some(last) = own.last()
            && !last.session().is_over()
        {
            return Ok((Held::open(last.folder())?, true));
        }
        let number = own.last().map_or(1, |held| held.begun().session + 1);
        let seed = beginning.seed.unwrap_or_else(|| {
            let text = format!("{}:{participant}:{number}", protocol.seed);
            let digits = hash_of(text.as_bytes());
            u64::from_str_radix(digits.get(..16).unwrap_or_default(), 16).unwrap_or(0)
                & order::MOST_SEED
        });
        let mut begun = Begun::new(participant, number, seed, unix_s);
        begun.protocol_sha256 = hash;
        if let Some(name) = &protocol.consent {
            let file = crepitus_files::output::folder_of(path).join(name);
            let consent = read(&file)?;
            if !beginning.has_consented {
                return Err(StoreError::NoConsent(file));
            }
            let hash = hash_of(consent.as_bytes());
            let kept = self.folder.join(CONSENT);
            make(&kept)?;
            let kept = kept.join(format!("{hash}.txt"));
            if !kept.is_file() {
                write(&kept, consent.as_bytes())?;
            }
            begun.consent_sha256 = Some(hash);
        }
        let folder = self.make_session(&begun, &protocol, &text)?;
        Ok((Held::open(&folder)?, false))
    }

    /// Makes the files of a session, all or none.
    fn make_session(
        &self,
        begun: &Begun,
        protocol: &Protocol,
        text: &str,
    ) -> Result<PathBuf, StoreError> {
        let own = self.folder.join(&begun.participant);
        make(&own)?;
        let title = match plain(&protocol.title, 40) {
            empty if empty.is_empty() => "session".to_owned(),
            title => title,
        };
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |cause| StoreError::Write { path, cause }
        };
        let new = temporary_in(&own)?;
        let json = serde_json::to_string_pretty(begun).unwrap_or_default() + "\n";
        write(&new.path().join(SESSION), json.as_bytes())?;
        write(&new.path().join(PROTOCOL), text.as_bytes())?;
        write(&new.path().join(LOCK), b"")?;
        let header = Session::new(protocol.clone(), begun.seed).header();
        write(&new.path().join(TRIALS), line(&header).as_bytes())?;
        let mut folder = own.join(format!("{title}-{}", begun.session));
        // Of another protocol with the same title.
        for number in 2.. {
            if !folder.exists() {
                break;
            }
            folder = own.join(format!("{title}-{}-{number}", begun.session));
        }
        fs::rename(new.keep(), &folder).map_err(failed(&folder))?;
        crepitus_files::output::sync_folder_of(&folder).map_err(failed(&folder))?;
        Ok(folder)
    }

    /// Pseudonyms, sorted.
    ///
    /// # Errors
    /// [`StoreError::Write`] if the folder cannot be read.
    pub fn participants(&self) -> Result<Vec<String>, StoreError> {
        let entries = entries(&self.folder)?.into_iter();
        let names = entries.filter(|path| path.is_dir()).filter_map(|path| {
            let name = path.file_name()?.to_str()?.to_owned();
            check_pseudonym(&name).is_ok().then_some(name)
        });
        Ok(names.collect())
    }

    /// Sessions of a participant, in the order of their number; none of one who has had none.
    ///
    /// # Errors
    /// [`StoreError`] of a session that was changed.
    pub fn sessions_of(&self, participant: &str) -> Result<Vec<Held>, StoreError> {
        check_pseudonym(participant)?;
        let own = self.folder.join(participant);
        if !own.exists() {
            return Ok(Vec::new());
        }
        let all = entries(&own)?.into_iter();
        let mut sessions = all
            .filter(|path| path.join(SESSION).is_file())
            .map(|path| Held::read(&path).map_err(StoreError::from))
            .collect::<Result<Vec<_>, _>>()?;
        sessions.sort_by_key(|held| held.begun().session);
        Ok(sessions)
    }

    /// Sessions of all participants.
    ///
    /// # Errors
    /// [`StoreError`] of a session that was changed.
    pub fn sessions(&self) -> Result<Vec<Held>, StoreError> {
        let mut all = Vec::new();
        for participant in self.participants()? {
            all.extend(self.sessions_of(&participant)?);
        }
        Ok(all)
    }

    /// Removes everything of a participant; returns the number of sessions. A file that no session has written is
    /// removed with `force` only.
    ///
    /// # Errors
    /// [`StoreError::Foreign`], or [`TableError::Locked`] of a session that runs, before anything is removed.
    pub fn delete(&self, participant: &str, force: bool) -> Result<usize, StoreError> {
        let own = self.of(participant)?;
        let mut locks = Vec::new();
        for session in entries(&own)? {
            let is_session = session.join(SESSION).is_file();
            if !is_session && !is_left(&session) && !force {
                return Err(StoreError::Foreign(session));
            }
            if is_session && session.join(LOCK).is_file() {
                locks.push(lock(&session)?);
            }
            let files = if session.is_dir() {
                entries(&session)?
            } else {
                Vec::new()
            };
            let is_own = |file: &PathBuf| FILES.iter().any(|name| file.ends_with(name));
            let is_foreign = |file: &&PathBuf| !is_own(file) && !is_left(file);
            if let (Some(foreign), false) = (files.iter().find(is_foreign), force) {
                return Err(StoreError::Foreign(foreign.clone()));
            }
        }
        let sessions = locks.len();
        // Where an open file cannot be removed.
        drop(locks);
        fs::remove_dir_all(&own).map_err(|cause| StoreError::Write { path: own, cause })?;
        Ok(sessions)
    }

    /// Folder of a participant.
    fn of(&self, participant: &str) -> Result<PathBuf, StoreError> {
        check_pseudonym(participant)?;
        let own = self.folder.join(participant);
        // A link leads to files of others.
        let is_own = fs::symlink_metadata(&own).is_ok_and(|entry| entry.is_dir());
        is_own
            .then_some(own)
            .ok_or_else(|| StoreError::NoParticipant(participant.to_owned()))
    }
}

/// Checks the form of a pseudonym.
///
/// # Errors
/// [`StoreError::Pseudonym`].
pub fn check_pseudonym(name: &str) -> Result<(), StoreError> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let is_one = (1..=MOST_PSEUDONYM).contains(&name.len())
        && name.chars().all(allowed)
        && name.chars().any(|c| c.is_ascii_digit())
        && name.starts_with(|c: char| c.is_ascii_alphanumeric())
        && !is_reserved(name);
    if is_one {
        return Ok(());
    }
    Err(StoreError::Pseudonym(name.to_owned()))
}

/// Returns whether a program that was killed has left it.
fn is_left(path: &Path) -> bool {
    let name = path.file_name();
    name.is_some_and(|name| name.to_string_lossy().starts_with(TEMPORARY))
}

fn read(path: &Path) -> Result<String, StoreError> {
    input::read_to_string(path, TEXT_BYTES).map_err(|cause| StoreError::Read {
        path: path.to_owned(),
        cause,
    })
}

/// Entries of a folder, sorted.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let read = || -> io::Result<Vec<PathBuf>> {
        let entries = fs::read_dir(folder)?;
        entries.map(|entry| Ok(entry?.path())).collect()
    };
    let mut all = read().map_err(|cause| StoreError::Write {
        path: folder.to_owned(),
        cause,
    })?;
    all.sort();
    Ok(all)
}

/// Makes a folder for this user alone, with those that it is in.
fn make(folder: &Path) -> Result<(), StoreError> {
    let mut builder = DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder).map_err(|cause| StoreError::Write {
        path: folder.to_owned(),
        cause,
    })
}

/// Makes a folder for this user alone, which is removed unless it is kept.
fn temporary_in(folder: &Path) -> Result<TempDir, StoreError> {
    let new = tempfile::Builder::new()
        .prefix(TEMPORARY)
        .tempdir_in(folder);
    let new = new.map_err(|cause| StoreError::Write {
        path: folder.to_owned(),
        cause,
    })?;
    keep_private(new.path())?;
    Ok(new)
}

/// Takes a folder from the others of this computer.
fn keep_private(folder: &Path) -> Result<(), StoreError> {
    #[cfg(unix)]
    fs::set_permissions(folder, std::os::unix::fs::PermissionsExt::from_mode(0o700)).map_err(
        |cause| StoreError::Write {
            path: folder.to_owned(),
            cause,
        },
    )?;
    let _ = folder;
    Ok(())
}

/// Creates a file for this user alone.
fn create(path: &Path) -> Result<File, StoreError> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path).map_err(|cause| StoreError::Write {
        path: path.to_owned(),
        cause,
    })
}

/// Writes a new file for this user alone, durably.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    let mut file = create(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    written.map_err(|cause| StoreError::Write {
        path: path.to_owned(),
        cause,
    })
}

#[cfg(test)]
mod tests;
