//! # Experiments on a page
//!
//! ```text
//!  FOLDER/torque.toml, consent.txt ──> list ──────────────────────────> page
//!  FOLDER/study/ <── a line a trial ── Run <── steps of the page in control
//!                                       └──> view: what a page sees, without a level
//! ```
//!
//! The engine is that of `crepitus experiment` ([`crepitus_studies::experiment`]): it decides every trial, and has
//! an answer on the disk before the next one. [`Run`] adds what a page may do when.

mod run;

pub(crate) use run::Run;

use crate::panel_error::PanelError;
use crepitus_files::input::{self, TEXT_BYTES};
use crepitus_files::output::folder_of;
use crepitus_scene::preset::Preset;
use crepitus_studies::experiment::finding::Knee;
use crepitus_studies::experiment::findings::html;
use crepitus_studies::experiment::protocol::{Known, Protocol};
use crepitus_studies::experiment::store::{Beginning, Store};
use crepitus_studies::experiment::table::hash_of;
use crepitus_studies::experiment::{Findings, StoreError};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of the study in that of the protocols.
const STUDY: &str = "study";

/// Protocols of a list.
const MOST_LISTED: usize = 100;

/// A folder with protocols, and the study in it.
#[derive(Clone, Debug)]
pub struct Experiments {
    folder: PathBuf,
}

/// A session to begin, or to continue.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Begin<'a> {
    /// File of the protocol.
    pub(crate) file: &'a str,
    /// Pseudonym.
    pub(crate) participant: &'a str,
    /// SHA-256 of the text to which the participant has consented.
    pub(crate) consented: Option<&'a str>,
    /// Time, s since 1970.
    pub(crate) unix_s: u64,
}

/// A protocol as it is read, and its text of consent.
struct Read {
    protocol: Protocol,
    sha256: String,
    consent: Option<String>,
}

impl Experiments {
    /// Opens a folder with protocols; the folder of the study is made in it, for this user alone.
    ///
    /// # Errors
    /// [`PanelError::NoProtocols`], [`PanelError::Study`].
    pub fn open(folder: &Path) -> Result<Self, PanelError> {
        let folder = folder.to_owned();
        if !folder.is_dir() {
            return Err(PanelError::NoProtocols { folder });
        }
        let opened = Self { folder };
        Store::create(&opened.study()).map_err(PanelError::Study)?;
        Ok(opened)
    }

    fn study(&self) -> PathBuf {
        self.folder.join(STUDY)
    }

    /// Protocols, with what may be seen of them, and sessions that were interrupted; `own` are the user's own presets.
    pub(crate) fn list(&self, own: &[Preset]) -> Value {
        let files: Vec<_> = self.files().into_iter().take(MOST_LISTED).collect();
        let read: Vec<_> = files
            .iter()
            .map(|file| (file.as_str(), self.read(file, own)))
            .collect();
        let unfinished = self.unfinished(&read);
        json!({
            "folder": self.folder.display().to_string(),
            "study": self.study().display().to_string(),
            "protocols": read.iter().map(|(file, read)| described(file, read)).collect::<Vec<_>>(),
            "problem": unfinished.as_ref().err().map(ToString::to_string),
            "unfinished": unfinished.unwrap_or_default(),
        })
    }

    /// Files of protocols, by name.
    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten();
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let is_one =
            |path: &PathBuf| path.extension().is_some_and(|e| e == "toml") && path.is_file();
        let mut files: Vec<_> = paths
            .filter(is_one)
            .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
            .collect();
        files.sort();
        files
    }

    fn read(&self, file: &str, own: &[Preset]) -> Result<Read, String> {
        let path = self.folder.join(file);
        let text = |path: &Path| {
            let text = input::read_to_string(path, TEXT_BYTES);
            text.map_err(|error| format!("{}: {error}", path.display()))
        };
        let content = text(&path)?;
        let of_file = |error: &dyn std::fmt::Display| format!("{file}: {error}");
        let protocol = Protocol::from_toml(&content).map_err(|error| of_file(&error))?;
        let find = own_knee(own);
        let known = Known { own_preset: &find };
        protocol.check(known).map_err(|error| of_file(&error))?;
        let abx = protocol.abx.as_ref();
        if abx.is_some_and(|abx| abx.a.device.is_some() || abx.b.device.is_some()) {
            return Err(format!(
                "{file}: a condition names a device: two devices at once need Python, crepitus.experiments"
            ));
        }
        let consent = protocol.consent.as_ref();
        let consent = consent.map(|name| text(&folder_of(&path).join(name)));
        Ok(Read {
            sha256: hash_of(content.as_bytes()),
            consent: consent.transpose()?,
            protocol,
        })
    }

    /// Sessions that are not over, each with the file of its protocol, where that is still the same.
    fn unfinished(&self, files: &[(&str, Result<Read, String>)]) -> Result<Vec<Value>, StoreError> {
        let sessions = Store::open(&self.study())?.sessions()?;
        let unfinished = sessions.iter().filter(|held| !held.session().is_over());
        let of = |held: &crepitus_studies::experiment::Held| {
            let begun = held.begun();
            let is_it = |read: &Read| read.sha256 == begun.protocol_sha256;
            let file = files
                .iter()
                .find(|(_, read)| read.as_ref().is_ok_and(is_it));
            json!({
                "file": file.map(|(file, _)| file),
                "title": held.session().protocol().title,
                "participant": begun.participant,
                "session": begun.session,
                "answered": held.session().rows().len(),
            })
        };
        Ok(unfinished.map(of).collect())
    }

    /// Begins a session, or takes up the participant's last one with this protocol.
    ///
    /// # Errors
    /// A text for people.
    pub(crate) fn begin(&self, own: &[Preset], begin: Begin<'_>) -> Result<Run, String> {
        let Begin {
            file,
            participant,
            consented,
            unix_s,
        } = begin;
        if !self.files().iter().any(|known| known == file) {
            return Err(format!("there is no protocol {file:?}: reload the page"));
        }
        let read = self.read(file, own)?;
        let hash = read.consent.map(|text| hash_of(text.as_bytes()));
        if consented.is_some() && consented != hash.as_deref() {
            return Err(
                "the text of consent has changed since it was shown: reload the page, and read it again"
                    .to_owned(),
            );
        }
        let beginning = Beginning {
            protocol: &self.folder.join(file),
            participant,
            seed: None,
            has_consented: consented.is_some(),
            unix_s,
        };
        let find = own_knee(own);
        let store = Store::open(&self.study());
        let begun = store.and_then(|store| store.begin(beginning, Known { own_preset: &find }));
        let (held, _) = begun.map_err(|error| error.to_string())?;
        Ok(Run::new(file, held))
    }

    /// Results of all sessions, as a page.
    ///
    /// # Errors
    /// A text for people.
    pub(crate) fn results(&self, own: &[Preset]) -> Result<String, String> {
        let sessions = Store::open(&self.study()).and_then(|store| store.sessions());
        let sessions = sessions.map_err(|error| error.to_string())?;
        let find = own_knee(own);
        let known = Known { own_preset: &find };
        let all = Findings::all(&sessions, |name| known.find(name));
        let all = all.map_err(|error| error.to_string())?;
        if all.is_empty() {
            return Err("there are no results: no session has begun yet".to_owned());
        }
        Ok(html(&all))
    }
}

/// Finds a knee among the user's own presets.
fn own_knee(own: &[Preset]) -> impl Fn(&str) -> Option<Knee> + '_ {
    move |name: &str| {
        let preset = own.iter().find(|preset| preset.name == name);
        preset.map(Knee::from)
    }
}

/// A protocol for a page: neither levels nor knees.
fn described(file: &str, read: &Result<Read, String>) -> Value {
    match read {
        Err(error) => json!({ "file": file, "error": error }),
        Ok(read) => json!({
            "file": file,
            "title": read.protocol.title,
            "question": read.protocol.question,
            "kind": run::kind(&read.protocol),
            "consent": read.consent.as_ref().map(|text| json!({
                "text": text,
                "sha256": hash_of(text.as_bytes()),
            })),
        }),
    }
}

#[cfg(test)]
mod tests;
