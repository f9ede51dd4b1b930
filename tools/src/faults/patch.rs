//! Faults as they are listed: a patch file each, `tools/faults/<area>/<name>.patch`.
//!
//! ```text
//! What: a slip pushes the leg instead of opposing it
//! Noticed-by: -p crepitus-model --test energy -- nor_does_any_other_hand
//!
//! --- a/model/src/solver/frozen.rs
//! +++ b/model/src/solver/frozen.rs
//! @@ -400,7 +400,7 @@
//! ```
//!
//! | line of the header | what it holds |
//! |---|---|
//! | `What` | what is wrong |
//! | `Noticed-by` | arguments of `cargo test` for the test that must fail |
//! | `Unseen` | the reason why no test can notice it |
//! | `Program` | `drive` or `comms`, whose image is built with the fault for the test to run |
//! | `Image` | bytes of that image, and what replaces them: `8? f3 12 88 -> af f3 00 80` |
//! | `Result` | written by a trial: hash of what was tried, and the test that failed or `nothing` |
//! | `# …` | a comment |
//!
//! An empty line ends the header. A unified diff follows, as `git diff` writes it. Numbers of
//! lines may be old, the lines themselves may not: those of each hunk stand in the file once.

use crate::faults::image_edit::ImageEdit;
use crate::faults::outcome::Outcome;
use crate::faults::tree;
use diffy::patch_set::{FileOperation, ParseOptions, PatchSet};
use diffy::{Hunk, Line};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folder of the patches, from the root of the repository.
pub const FOLDER: &str = "tools/faults";

/// Lines of a header.
const KEYS: [&str; 6] = ["What", "Noticed-by", "Unseen", "Program", "Image", "Result"];

/// Value of a `Result` if no test failed.
const NOTHING: &str = "nothing";

/// A program of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Program {
    /// Program of the drive.
    Drive,
    /// Program of comms.
    Comms,
}

impl Program {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Drive, Self::Comms];

    /// Name of its image.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Comms => "comms",
        }
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|program| program.name() == name)
    }
}

/// A fault.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Patch file, from the root of the repository.
    pub file: PathBuf,
    /// Name of the folder that the patch is in.
    pub area: String,
    /// Name on the command line.
    pub name: String,
    /// Description of the fault, in one line.
    pub what: String,
    /// Arguments of `cargo test` for the test that must fail.
    pub noticed_by: Option<String>,
    /// Reason why no test can notice it, if none can.
    pub unseen: Option<String>,
    /// Program whose image is built with the fault, if the test runs images.
    pub program: Option<Program>,
    /// Edit of that image.
    pub image: Option<ImageEdit>,
    /// Outcome on record, unless the patch has changed since.
    pub result: Option<Outcome>,
    /// Hash of what the outcome depends on.
    hash: u64,
    /// Changes of the sources; may be empty.
    diff: String,
}

/// Text of a file before and after a fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Text as it is.
    pub was: String,
    /// Text with the fault.
    pub now: String,
}

/// Reason why a patch cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PatchError {
    /// A patch cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The file is no patch, or not one of these sources.
    #[error("{}: {what}", path.display())]
    Form {
        /// The patch.
        path: PathBuf,
        /// Description of the error.
        what: String,
    },
    /// The lines of a hunk do not stand in the file exactly once.
    #[error(
        "{}: the lines of hunk {hunk} stand {found} times in {file}, expected once; the source has changed, so make the \
         diff again: plant the fault in {file}, replace the diff by that of `git diff`, and restore the file",
        path.display()
    )]
    Place {
        /// The patch.
        path: PathBuf,
        /// The file that it changes.
        file: String,
        /// Number of the hunk in that file, from 1.
        hunk: usize,
        /// Number of places.
        found: usize,
    },
}

/// All faults, by area and name.
///
/// # Errors
/// [`PatchError`] if one cannot be read.
pub fn all(root: &Path) -> Result<Vec<Fault>, PatchError> {
    let folder = root.join(FOLDER);
    let files = tree::files(&folder).map_err(file_error(&folder))?;
    files
        .iter()
        .filter(|file| file.extension().is_some_and(|e| e == "patch"))
        .map(|file| {
            let file = Path::new(FOLDER).join(file);
            let path = root.join(&file);
            let text = fs::read_to_string(&path).map_err(file_error(&path))?;
            Fault::parse(&file, &text)
        })
        .collect()
}

impl Fault {
    /// Fault of a patch file, whose path is from the root of the repository.
    ///
    /// # Errors
    /// [`PatchError::Form`] if it is none.
    pub fn parse(file: &Path, text: &str) -> Result<Self, PatchError> {
        let (head, diff) = text.split_once("\n\n").unwrap_or((text, ""));
        let mut header = BTreeMap::new();
        for line in head.lines().filter(|line| !line.starts_with('#')) {
            let (key, value) = line.split_once(": ").unwrap_or((line, ""));
            let is_known = KEYS.contains(&key) && !value.trim().is_empty();
            if !is_known || header.insert(key, value.trim().to_owned()).is_some() {
                let keys = KEYS.join(", ");
                let what = format!("`{line}` is no line of a header, or the second one: {keys}");
                return Err(form(file, what));
            }
        }
        // Other words do not change the outcome.
        let [what, unseen, result] = ["What", "Unseen", "Result"].map(|key| header.remove(key));
        let hash = hash(&header, diff);
        let result = result.and_then(|result| {
            let by = result.strip_prefix(&format!("{hash:016x} "))?;
            Some(match by {
                NOTHING => Outcome::NotNoticed,
                _ => Outcome::Noticed(by.to_owned()),
            })
        });
        let program = (header.remove("Program"))
            .map(|name| Program::named(&name).ok_or(name))
            .transpose()
            .map_err(|name| form(file, format!("`{name}` is no program: drive or comms")))?;
        let image = (header.remove("Image"))
            .map(|edit| ImageEdit::parse(&edit).ok_or(edit))
            .transpose()
            .map_err(|edit| form(file, format!("`{edit}` is not like `8? f3 -> af f3`")))?;
        let fault = Self {
            file: file.to_owned(),
            area: text_of(file.parent().and_then(Path::file_name)),
            name: text_of(file.file_stem()),
            what: what.unwrap_or_default(),
            noticed_by: header.remove("Noticed-by"),
            unseen,
            program,
            image,
            result,
            hash,
            diff: diff.to_owned(),
        };
        for (is_wrong, what) in [
            (fault.what.is_empty(), "it has no `What`"),
            (
                fault.noticed_by.is_none() && fault.unseen.is_none(),
                "it has neither `Noticed-by` nor `Unseen`",
            ),
            (
                fault.image.is_some() && fault.program.is_none(),
                "it has `Image`, and no `Program`",
            ),
            (
                fault.image.is_none() && diff.is_empty(),
                "it changes nothing: an empty line and a diff follow the header",
            ),
        ] {
            if is_wrong {
                return Err(form(file, what));
            }
        }
        Ok(fault)
    }

    /// Files that it changes, from the root of the repository.
    pub fn changed_files(&self) -> impl Iterator<Item = &str> {
        let lines = self.diff.lines();
        lines.filter_map(|line| line.strip_prefix("--- a/"))
    }

    /// Files that it changes in `root`, with their texts.
    ///
    /// # Errors
    /// [`PatchError`] if it does not apply.
    pub fn apply(&self, root: &Path) -> Result<BTreeMap<PathBuf, Change>, PatchError> {
        let mut changes = BTreeMap::new();
        if self.diff.is_empty() {
            return Ok(changes);
        }
        let mut hunks = 0;
        for part in PatchSet::parse(&self.diff, ParseOptions::unidiff()) {
            let part = part.map_err(|error| form(&self.file, error.to_string()))?;
            let (FileOperation::Modify { original, modified }, Some(patch)) =
                (part.operation().strip_prefix(1), part.patch().as_text())
            else {
                return Err(form(&self.file, "it adds, deletes or renames a file"));
            };
            let file = original.into_owned();
            if file != modified {
                return Err(form(&self.file, format!("it renames {file}")));
            }
            if changes.contains_key(Path::new(&file)) {
                return Err(form(&self.file, format!("{file} is in its diff twice")));
            }
            let was = fs::read_to_string(root.join(&file)).map_err(|error| {
                let what = format!("{file}: {error}; name the file as it is called now");
                form(&self.file, what)
            })?;
            for (hunk, lines) in (1..).zip(patch.hunks()) {
                let found = places(&was, lines);
                if found != 1 {
                    return Err(PatchError::Place {
                        path: self.file.clone(),
                        file,
                        hunk,
                        found,
                    });
                }
                hunks += 1;
            }
            let now = diffy::apply(&was, patch)
                .map_err(|error| form(&self.file, format!("{file}: {error}")))?;
            if now == was {
                return Err(form(&self.file, format!("it changes nothing in {file}")));
            }
            changes.insert(PathBuf::from(file), Change { was, now });
        }
        // Lines behind a hunk that are not in it are passed over.
        let begun = self.diff.lines().filter(|line| line.starts_with("@@ "));
        if begun.count() != hunks {
            let what = "a hunk has another number of lines than its `@@` says";
            return Err(form(&self.file, what));
        }
        Ok(changes)
    }

    /// Edits an image, if the fault does that.
    ///
    /// # Errors
    /// [`PatchError::Form`] if its bytes are not there.
    pub fn edit_image(&self, image: &mut [u8]) -> Result<(), PatchError> {
        match &self.image {
            Some(edit) if edit.apply(image) == 0 => Err(form(
                &self.file,
                "the bytes of `Image` are not in the image",
            )),
            _ => Ok(()),
        }
    }

    /// Writes the result, if there is one, into the patch in `root`, whole or not at all. A patch
    /// that has been edited since it was read stays as it is.
    ///
    /// # Errors
    /// [`PatchError::File`] if it cannot be written.
    pub fn record(&self, root: &Path) -> Result<(), PatchError> {
        let by = match &self.result {
            Some(Outcome::Noticed(by)) => by.as_str(),
            Some(Outcome::NotNoticed) => NOTHING,
            None => return Ok(()),
        };
        let path = root.join(&self.file);
        let text = fs::read_to_string(&path).map_err(file_error(&path))?;
        if !Self::parse(&self.file, &text).is_ok_and(|fault| fault.hash == self.hash) {
            return Ok(());
        }
        let result = format!("Result: {:016x} {by}", self.hash);
        let end = text.find("\n\n").unwrap_or(text.trim_end().len());
        let (head, diff) = text.split_at(end);
        let head = head.lines().filter(|line| !line.starts_with("Result: "));
        let lines: Vec<&str> = head.chain([result.as_str()]).collect();
        let new = path.with_extension("new");
        fs::write(&new, lines.join("\n") + diff)
            .and_then(|()| fs::rename(&new, &path))
            .map_err(file_error(&path))
    }
}

/// FNV-1a hash, 64 bits: it is the same with every compiler.
fn hash(header: &BTreeMap<&str, String>, diff: &str) -> u64 {
    let lines = (header.iter()).flat_map(|(key, value)| [*key, ": ", value.as_str(), "\n"]);
    let bytes = lines.chain([diff]).flat_map(str::bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Adds the path to an error of the file system.
fn file_error(path: &Path) -> impl FnOnce(io::Error) -> PatchError + '_ {
    move |source| PatchError::File {
        path: path.to_owned(),
        source,
    }
}

fn form(path: &Path, what: impl Into<String>) -> PatchError {
    PatchError::Form {
        path: path.to_owned(),
        what: what.into(),
    }
}

fn text_of(part: Option<&OsStr>) -> String {
    part.unwrap_or_default().to_string_lossy().into_owned()
}

/// Number of places in a source where the lines stand that a hunk keeps or deletes.
fn places(source: &str, hunk: &Hunk<'_, str>) -> usize {
    let expected: Vec<&str> = (hunk.lines().iter())
        .filter_map(|line| match line {
            Line::Context(text) | Line::Delete(text) => Some(*text),
            Line::Insert(_) => None,
        })
        .collect();
    let lines: Vec<&str> = source.split_inclusive('\n').collect();
    // A window of no lines is an error.
    let windows = lines.windows(expected.len().max(1));
    windows.filter(|window| *window == expected).count()
}

#[cfg(test)]
mod tests;
