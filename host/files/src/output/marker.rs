//! List of the files that this program wrote into a folder.
//!
//! ```text
//! # crepitus 1: files that this program wrote; others it neither replaces nor removes
//! # by run
//! 9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08  report.html
//! ```
//!
//! Apart from the comments it is what `sha256sum` writes, and `sha256sum --check` reads. A line is
//! appended before its file appears, so a file of a killed program is on the list; a line that is damaged
//! proves nothing, and its file is foreign.

use super::{Reason, temporary_in};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;

/// Name of the list.
pub const MARKER: &str = ".crepitus.sha256";

const HEADER: &str =
    "# crepitus 1: files that this program wrote; others it neither replaces nor removes";
/// Begin of the header of every version.
const ANY_HEADER: &str = "# crepitus ";
const BY: &str = "# by ";

/// Longest list that is read: a million traces take 90 MB.
const MOST_BYTES: u64 = 1 << 30;

/// File as it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Written {
    pub(super) sha256: String,
    pub(super) by: String,
}

/// Files of a folder that this program wrote. A name may have several contents while one replaces another.
#[derive(Clone, Debug, Default)]
pub(super) struct Marker {
    files: BTreeMap<String, Vec<Written>>,
}

/// List in a folder.
pub(super) enum ListState {
    None,
    Own(Marker),
    InTheWay(Reason),
}

impl Marker {
    /// Reads the list of a folder.
    pub(super) fn read(folder: &Path) -> io::Result<ListState> {
        let path = folder.join(MARKER);
        let metadata = match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(ListState::None),
            metadata => metadata?,
        };
        if let Some(reason) = kind(&metadata) {
            return Ok(ListState::InTheWay(reason));
        }
        let mut bytes = Vec::new();
        File::open(&path)?
            .take(MOST_BYTES)
            .read_to_end(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes);
        Ok(match text.split('\n').next().unwrap_or_default() {
            HEADER => ListState::Own(Self::parse(&text)),
            header if header.starts_with(ANY_HEADER) => ListState::InTheWay(Reason::OtherVersion),
            _ => ListState::InTheWay(Reason::Foreign),
        })
    }

    fn parse(text: &str) -> Self {
        let mut marker = Self::default();
        let mut by = "";
        // A last line without its end is torn.
        let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
        for line in whole.split('\n') {
            if let Some(verb) = line.strip_prefix(BY) {
                by = verb;
            } else if let Some((sha256, name)) = line.split_once("  ")
                && is_sha256(sha256)
                && is_plain(name)
            {
                marker.add(name, sha256, by);
            }
        }
        marker
    }

    /// Contents that this program has written under a name.
    pub(super) fn written(&self, name: &str) -> &[Written] {
        self.files.get(name).map_or(&[], Vec::as_slice)
    }

    /// Names on the list.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    pub(super) fn add(&mut self, name: &str, sha256: &str, by: &str) {
        let written = Written {
            sha256: sha256.to_owned(),
            by: by.to_owned(),
        };
        self.files.entry(name.to_owned()).or_default().push(written);
    }

    /// Forgets what was written under a name before the last time.
    pub(super) fn keep_last(&mut self, name: &str) {
        if let Some(written) = self.files.get_mut(name) {
            written.drain(..written.len().saturating_sub(1));
        }
    }

    pub(super) fn forget(&mut self, name: &str) {
        self.files.remove(name);
    }

    fn text(&self) -> String {
        let mut text = format!("{HEADER}\n");
        let mut by = "";
        for (name, all) in &self.files {
            for written in all {
                if written.by != by {
                    by = &written.by;
                    text.extend([BY, by, "\n"]);
                }
                text += &line(name, &written.sha256);
            }
        }
        text
    }

    /// Replaces the list of a folder.
    pub(super) fn write(&self, folder: &Path) -> io::Result<()> {
        let mut file = temporary_in(folder)?;
        file.write_all(self.text().as_bytes())?;
        file.as_file().sync_all()?;
        file.persist(folder.join(MARKER))?;
        Ok(())
    }
}

/// Appends files to the list of a folder, which has one.
pub(super) fn append(folder: &Path, by: &str, files: &[(&str, &str)]) -> io::Result<()> {
    // A line of its own before it ends one that a killed program has torn.
    let mut text = format!("\n{BY}{by}\n");
    for (name, sha256) in files {
        text += &line(name, sha256);
    }
    let path = folder.join(MARKER);
    let mut file = File::options().append(true).open(path)?;
    // Without a sync: what a power cut takes from the list is foreign, not lost.
    file.write_all(text.as_bytes())
}

fn line(name: &str, sha256: &str) -> String {
    format!("{sha256}  {name}\n")
}

/// Reason why a directory entry is no ordinary file; a read-only one is somebody's wish to keep it.
pub(super) fn kind(metadata: &fs::Metadata) -> Option<Reason> {
    let kind = metadata.file_type();
    if kind.is_symlink() {
        Some(Reason::Link)
    } else if kind.is_dir() {
        Some(Reason::Folder)
    } else if !kind.is_file() {
        Some(Reason::Special)
    } else if metadata.permissions().readonly() {
        Some(Reason::ReadOnly)
    } else {
        None
    }
}

fn is_sha256(text: &str) -> bool {
    let is_digit = |c: u8| c.is_ascii_digit() || (b'a'..=b'f').contains(&c);
    text.len() == 64 && text.bytes().all(is_digit)
}

/// Returns whether a name is that of a file in the folder itself.
pub(super) fn is_plain(name: &str) -> bool {
    !name.is_empty()
        && name != "."
        && name != ".."
        && name != MARKER
        && !name.contains(['/', '\\', '\n', '\r', '\0'])
}
