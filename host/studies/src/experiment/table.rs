//! Files of a session, on which a killed one goes on.
//!
//! ```text
//! SESSION/
//!   session.json    participant, seed, begin, version, hashes of protocol and consent
//!   protocol.toml   as it was when the session began
//!   trials.csv      a line a trial, on the disk before the next trial is shown
//!   described.txt   of realism: number of the trial, and the last description, which may have no rating yet
//!   session.lock    empty; locked by the program that runs the session
//! ```
//!
//! A line without its end, of a program killed while writing, is cut off: its trial comes again. Every other
//! line is answered again by [`Session`]; a line that does not come out the same was edited, and is an error.

use super::finding::Finding;
use super::protocol::{Protocol, ProtocolError};
use super::session::{Session, SessionError};
use super::trial::{Rating, Response, Row, Trial};
use crepitus_files::input::{self, InputError, TEXT_BYTES};
use crepitus_files::output::sha256;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

/// Version of `session.json`.
const FORMAT: u32 = 1;

/// Longest table that is read, bytes: of 2,000 trials, each with the longest description, it is half.
const TABLE_BYTES: u64 = 16_000_000;

pub(super) const SESSION: &str = "session.json";
pub(super) const PROTOCOL: &str = "protocol.toml";
pub(super) const TRIALS: &str = "trials.csv";
pub(super) const LOCK: &str = "session.lock";

pub(super) const DESCRIBED: &str = "described.txt";

/// Begin of the names of what a program that was killed may leave.
pub(super) const TEMPORARY: &str = ".crepitus-";

/// Every file of a session.
pub(super) const FILES: [&str; 5] = [SESSION, PROTOCOL, TRIALS, LOCK, DESCRIBED];

/// Begin of a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Begun {
    /// Version of the file.
    pub format: u32,
    /// Version of the program.
    pub tool: String,
    /// Pseudonym.
    pub participant: String,
    /// Number of this participant's session with this protocol, from 1.
    pub session: usize,
    /// Seed of the order.
    pub seed: u64,
    /// Begin, s since 1970.
    pub unix_s: u64,
    /// SHA-256 of the protocol.
    pub protocol_sha256: String,
    /// SHA-256 of the text to which the participant consented; none if the protocol names none.
    pub consent_sha256: Option<String>,
}

impl Begun {
    /// A session that begins at a time, s since 1970.
    pub(super) fn new(participant: &str, session: usize, seed: u64, unix_s: u64) -> Self {
        Self {
            format: FORMAT,
            tool: env!("CARGO_PKG_VERSION").to_owned(),
            participant: participant.to_owned(),
            session,
            seed,
            unix_s,
            protocol_sha256: String::new(),
            consent_sha256: None,
        }
    }
}

/// Error of a session's files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A file cannot be read.
    #[error("{}: {cause}", .file.display())]
    Read {
        /// File.
        file: PathBuf,
        /// Cause.
        cause: InputError,
    },
    /// A file cannot be opened, locked or written.
    #[error("{}: {cause}; no trial is answered until it can be written", .file.display())]
    Write {
        /// File.
        file: PathBuf,
        /// Cause.
        cause: io::Error,
    },
    /// Another program has the session.
    #[error("{}: another program runs this session; end that one first", .0.display())]
    Locked(PathBuf),
    /// Not the file that was written.
    #[error("{}: {why}; the file was changed after it was written", .file.display())]
    Changed {
        /// File.
        file: PathBuf,
        /// Difference.
        why: String,
    },
    /// The protocol is invalid.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// The answer is invalid.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// A session with its files. One that is not [open](Self::open) for answers does not hold the lock.
#[derive(Debug)]
pub struct Held {
    folder: PathBuf,
    begun: Begun,
    session: Session,
    /// The table, and the lock.
    open: Option<(File, File)>,
}

impl Held {
    /// Reads a session, to look at: whether it is over or not.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read(folder: &Path) -> Result<Self, TableError> {
        let text = |name: &str, most| {
            let file = folder.join(name);
            input::read_to_string(&file, most).map_err(|cause| TableError::Read { file, cause })
        };
        let changed = |name: &str, why: String| TableError::Changed {
            file: folder.join(name),
            why,
        };
        let begun: Begun = serde_json::from_str(&text(SESSION, TEXT_BYTES)?)
            .map_err(|error| changed(SESSION, error.to_string()))?;
        if begun.format != FORMAT {
            let why = format!("it has format {}, expected {FORMAT}", begun.format);
            return Err(changed(SESSION, why));
        }
        let protocol = text(PROTOCOL, TEXT_BYTES)?;
        if hash_of(protocol.as_bytes()) != begun.protocol_sha256 {
            let why = "its SHA-256 is not the one in session.json";
            return Err(changed(PROTOCOL, why.to_owned()));
        }
        let mut session = Session::new(Protocol::from_toml(&protocol)?, begun.seed);
        let file = folder.join(TRIALS);
        let table = input::read_to_string(&file, TABLE_BYTES);
        let table = table.map_err(|cause| TableError::Read { file, cause })?;
        replay(&mut session, whole_lines(&table)).map_err(|why| changed(TRIALS, why))?;
        let file = folder.join(DESCRIBED);
        if file.exists() {
            let text = input::read_to_string(&file, TEXT_BYTES);
            let text = text.map_err(|cause| TableError::Read { file, cause })?;
            describe_again(&mut session, &text);
        }
        Ok(Self {
            folder: folder.to_owned(),
            begun,
            session,
            open: None,
        })
    }

    /// Opens a session for answers: locks its table, and cuts off a line without its end.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn open(folder: &Path) -> Result<Self, TableError> {
        let lock = lock(folder)?;
        let file = folder.join(TRIALS);
        let failed = |cause| TableError::Write {
            file: file.clone(),
            cause,
        };
        let mut held = Self::read(folder)?;
        let text = input::read_to_string(&file, TABLE_BYTES);
        let text = text.map_err(|cause| TableError::Read {
            file: file.clone(),
            cause,
        })?;
        let options = OpenOptions::new().write(true).open(&file);
        let mut table = options.map_err(failed)?;
        let whole = whole_lines(&text).len() as u64;
        table.set_len(whole).map_err(failed)?;
        table.seek(io::SeekFrom::End(0)).map_err(failed)?;
        held.open = Some((table, lock));
        Ok(held)
    }

    /// Its begin.
    pub const fn begun(&self) -> &Begun {
        &self.begun
    }

    /// Folder of its files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The session itself.
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// The current trial; `None` if the session is over.
    pub fn trial(&self) -> Option<Trial> {
        self.session.trial()
    }

    /// Takes an answer, and writes its row, or the description, to the disk.
    ///
    /// # Errors
    /// [`TableError`]; the trial stays the current one.
    pub fn answer(&mut self, response: Response, unix_s: f64) -> Result<Option<Row>, TableError> {
        let mut next = self.session.clone();
        // As the table has it: it is answered again with the same.
        let unix_s = (unix_s * 1e3).round() / 1e3;
        let row = next.answer(response, unix_s)?.cloned();
        let (name, written) = match &row {
            Some(row) => (TRIALS, self.write(&line(&row.record()))),
            None => (DESCRIBED, self.keep_description(&next)),
        };
        written.map_err(|cause| TableError::Write {
            file: self.folder.join(name),
            cause,
        })?;
        self.session = next;
        Ok(row)
    }

    /// Writes the description that waits for its rating.
    fn keep_description(&self, next: &Session) -> io::Result<()> {
        let number = next.rows().len() + 1;
        let text = next.described().unwrap_or_default();
        let mut file = tempfile::Builder::new()
            .prefix(TEMPORARY)
            .tempfile_in(&self.folder)?;
        file.write_all(format!("{number}\n{text}\n").as_bytes())?;
        file.as_file().sync_all()?;
        file.persist(self.folder.join(DESCRIBED))?;
        Ok(())
    }

    /// Appends a line; if that fails, what there is of it is cut off again.
    fn write(&mut self, line: &str) -> io::Result<()> {
        let looked_at = || io::Error::other("the session was opened to look at");
        let (table, _) = self.open.as_mut().ok_or_else(looked_at)?;
        let end = table.stream_position()?;
        let written = table
            .write_all(line.as_bytes())
            .and_then(|()| table.sync_data());
        if written.is_err() {
            table.set_len(end)?;
            table.seek(io::SeekFrom::Start(end))?;
        }
        written
    }
}

/// Locks a session, until the file is dropped. Of its own, as on some systems nobody can read a locked file.
pub(super) fn lock(folder: &Path) -> Result<File, TableError> {
    let file = folder.join(LOCK);
    let failed = |cause| TableError::Write {
        file: file.clone(),
        cause,
    };
    let lock = OpenOptions::new().write(true).open(&file).map_err(failed)?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => Err(TableError::Locked(folder.to_owned())),
        Err(TryLockError::Error(cause)) => Err(failed(cause)),
    }
}

/// SHA-256 in hex digits.
pub fn hash_of(bytes: &[u8]) -> String {
    // Reading from memory cannot fail.
    sha256(bytes).unwrap_or_default()
}

/// The lines of a text that have their end.
fn whole_lines(text: &str) -> &str {
    let end = text.rfind('\n').map_or(0, |last| last + 1);
    text.get(..end).unwrap_or_default()
}

/// A record as a line of CSV.
pub(super) fn line(record: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(record);
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

/// Describes the current knee again, if the text is of its trial.
fn describe_again(session: &mut Session, text: &str) {
    let of = session.rows().len() + 1;
    if let Some((number, description)) = text.split_once('\n')
        && number == of.to_string()
    {
        // One that is no description is asked for again.
        let _ = session.answer(Response::Description(description.trim().to_owned()), 0.0);
    }
}

/// Answers every record of a table again.
fn replay(session: &mut Session, table: &str) -> Result<(), String> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = reader.headers().map_err(|error| error.to_string())?;
    if !header
        .iter()
        .eq(session.header().iter().map(String::as_str))
    {
        return Err("its first line is not that of this protocol".to_owned());
    }
    for (number, record) in (2..).zip(reader.records()) {
        let record: Vec<String> = match record {
            Ok(record) => record.iter().map(str::to_owned).collect(),
            Err(error) => return Err(error.to_string()),
        };
        let again = session.again(&record);
        if again.as_ref() != Some(&record) {
            return Err(format!("line {number} is no answer to its trial"));
        }
    }
    Ok(())
}

impl Session {
    /// Names of the columns of the table.
    pub fn header(&self) -> Vec<String> {
        let names: &[&str] = if self.protocol().threshold.is_some() {
            &[
                "trial",
                "staircase",
                "difference",
                "comparison_in",
                "answer",
                "is_right",
                "has_turned",
                "unix_s",
            ]
        } else if self.protocol().abx.is_some() {
            &["trial", "x", "answer", "is_right", "unix_s"]
        } else {
            &[
                "trial",
                "knee",
                "presentation",
                "description",
                "severity",
                "type",
                "unix_s",
                "realism",
            ]
        };
        let features = self.protocol().realism.iter().flat_map(|r| &r.features);
        let features = features.map(|feature| format!("realism: {feature}"));
        let names = names.iter().map(|name| (*name).to_owned());
        names.chain(features).collect()
    }

    /// Answers a record again, and returns its row's; `None` if it is no answer.
    fn again(&mut self, record: &[String]) -> Option<Vec<String>> {
        let header = self.header();
        let cell = |name: &str| {
            let place = header.iter().position(|column| column == name)?;
            record.get(place).map(String::as_str)
        };
        let unix_s = cell("unix_s")?.parse().ok()?;
        let response = if self.protocol().realism.is_some() {
            let description = Response::Description(cell("description")?.to_owned());
            self.answer(description, unix_s).ok()?;
            let realism = record.get(7..)?.iter().map(|cell| cell.parse().ok());
            Response::Rating(Rating {
                realism: realism.collect::<Option<_>>()?,
                severity: severity(cell("severity")?)?,
                finding: Finding::find(cell("type")?)?,
            })
        } else {
            Response::Choice(cell("answer")?.parse().ok()?)
        };
        let row = self.answer(response, unix_s).ok()??;
        Some(row.record())
    }
}

/// Names of the grades of severity.
pub const SEVERITIES: [&str; 4] = ["none", "mild", "moderate", "severe"];

/// The grade of this name.
pub fn severity(name: &str) -> Option<u8> {
    let place = SEVERITIES.iter().position(|grade| *grade == name)?;
    u8::try_from(place).ok()
}

impl Row {
    /// The cells of its line.
    pub fn record(&self) -> Vec<String> {
        match self {
            Self::Threshold(row) => vec![
                row.trial.to_string(),
                row.staircase.to_string(),
                row.difference.to_string(),
                row.comparison_in.to_string(),
                row.answer.to_string(),
                row.is_right.to_string(),
                row.has_turned.to_string(),
                row.unix_s.to_string(),
            ],
            Self::Abx(row) => vec![
                row.trial.to_string(),
                row.x.to_string(),
                row.answer.to_string(),
                (row.answer == row.x).to_string(),
                row.unix_s.to_string(),
            ],
            Self::Realism(row) => {
                let rating = &row.rating;
                let grade = SEVERITIES.get(usize::from(rating.severity));
                let mut cells = vec![
                    row.trial.to_string(),
                    row.knee.clone(),
                    row.presentation.to_string(),
                    row.description.clone(),
                    grade.copied().unwrap_or_default().to_owned(),
                    rating.finding.name().to_owned(),
                    row.unix_s.to_string(),
                ];
                cells.extend(rating.realism.iter().map(ToString::to_string));
                cells
            }
        }
    }
}

#[cfg(test)]
mod tests;
