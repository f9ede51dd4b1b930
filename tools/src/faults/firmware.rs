//! Faults of the firmware: `firmware.toml`, and how they are planted.
//!
//! Each is built into an image of its own: what it changes are registers,
//! locks and the linker script, which no switch can choose at run time.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The list that is in the repository.
const LIST: &str = include_str!("../../faults/firmware.toml");

/// Marks of the text that an edit replaces.
const MARKS: [char; 2] = ['«', '»'];

/// A program of the firmware.
#[derive(Clone, Copy, Debug, Default, Deserialize, Hash, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "lowercase")]
pub enum Program {
    /// Program of the drive.
    #[default]
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
}

/// A fault of the firmware.
#[derive(Clone, Debug, Deserialize, Hash)]
#[serde(deny_unknown_fields)]
pub struct FirmwareFault {
    /// Name on the command line.
    pub name: String,
    /// Description of the fault, in one line.
    pub what: String,
    /// Program whose image the fault is built into.
    #[serde(default)]
    pub program: Program,
    /// Edits of the sources.
    #[serde(default)]
    pub edit: Vec<Edit>,
    /// An edit of the built image.
    pub image: Option<ImageEdit>,
    /// Reason why no test can notice it, if none can.
    pub unseen: Option<String>,
}

/// An edit of a source.
#[derive(Clone, Debug, Deserialize, Hash)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// The file, from the root of the repository.
    pub file: String,
    /// A text that occurs once in the file; what is between its marks « » is
    /// replaced.
    pub text: String,
    /// The replacement.
    pub with: String,
}

/// An edit of an image: every occurrence of some bytes is replaced.
#[derive(Clone, Debug, Deserialize, Hash)]
#[serde(deny_unknown_fields)]
pub struct ImageEdit {
    /// Digits of the bytes; `?` is any digit.
    pub bytes: String,
    /// Digits of as many bytes.
    pub with: String,
}

/// Reason why a fault cannot be planted.
#[derive(Debug, thiserror::Error)]
pub enum FirmwareError {
    /// The list is invalid.
    #[error("firmware.toml: {0}")]
    List(#[from] toml::de::Error),
    /// A file of an edit cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A text does not occur in its file exactly once.
    #[error(
        "fault `{name}`: its text stands {found} times in {file}, expected once, with one expression between « and »; \
         the source has changed, so change the fault in tools/faults/firmware.toml"
    )]
    Text {
        /// The fault.
        name: String,
        /// The file.
        file: String,
        /// Number of occurrences.
        found: usize,
    },
    /// The bytes do not occur in the image, or are no bytes.
    #[error("fault `{0}`: its bytes are not in the image, or are no pairs of hexadecimal digits")]
    Bytes(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    fault: Vec<FirmwareFault>,
}

/// All faults, in the order of the list.
///
/// # Errors
/// [`FirmwareError::List`] if the list cannot be read.
pub fn all() -> Result<Vec<FirmwareFault>, FirmwareError> {
    Ok(toml::from_str::<List>(LIST)?.fault)
}

impl FirmwareFault {
    /// The files that it changes, with their new texts.
    ///
    /// # Errors
    /// [`FirmwareError`] if a file cannot be read, or an edit does not apply.
    pub fn sources(&self, root: &Path) -> Result<BTreeMap<PathBuf, String>, FirmwareError> {
        let mut changed: BTreeMap<PathBuf, String> = BTreeMap::new();
        for edit in &self.edit {
            let path = PathBuf::from(&edit.file);
            let source = if let Some(source) = changed.get(&path) {
                source.clone()
            } else {
                let path = root.join(&path);
                let read = std::fs::read_to_string(&path);
                read.map_err(|source| FirmwareError::Read { path, source })?
            };
            changed.insert(path, self.apply(edit, &source)?);
        }
        Ok(changed)
    }

    fn apply(&self, edit: &Edit, source: &str) -> Result<String, FirmwareError> {
        let parts: Vec<&str> = edit.text.split(MARKS).collect();
        let text = parts.concat();
        let found = source.matches(&text).count();
        match (&parts[..], source.split_once(&text)) {
            ([before, _, after], Some((head, tail))) if found == 1 => {
                Ok([head, before, &edit.with, after, tail].concat())
            }
            _ => Err(FirmwareError::Text {
                name: self.name.clone(),
                file: edit.file.clone(),
                found,
            }),
        }
    }

    /// Edits an image, if the fault does that.
    ///
    /// # Errors
    /// [`FirmwareError::Bytes`] if its bytes are not there.
    pub fn edit_image(&self, image: &mut [u8]) -> Result<(), FirmwareError> {
        let Some(edit) = &self.image else {
            return Ok(());
        };
        let bad = || FirmwareError::Bytes(self.name.clone());
        let pattern = digits(&edit.bytes).ok_or_else(bad)?;
        let with = digits(&edit.with).ok_or_else(bad)?;
        let with: Vec<u8> = with.iter().map(|byte| byte.value).collect();
        if pattern.is_empty() || pattern.len() != with.len() {
            return Err(bad());
        }
        let (mut at, mut found) = (0, 0);
        while let Some(window) = image.get_mut(at..at + pattern.len()) {
            let is_it = pattern
                .iter()
                .zip(&*window)
                .all(|(byte, is)| is & byte.mask == byte.value);
            if is_it {
                window.copy_from_slice(&with);
                found += 1;
            }
            // Instructions are halves of words.
            at += 2;
        }
        if found == 0 { Err(bad()) } else { Ok(()) }
    }
}

/// A byte, of which digits may be free.
struct Masked {
    value: u8,
    mask: u8,
}

fn digits(text: &str) -> Option<Vec<Masked>> {
    let pairs: Vec<char> = text
        .chars()
        .filter(|digit| !digit.is_whitespace())
        .collect();
    let digit = |digit: char| match digit {
        '?' => Some((0, 0)),
        _ => Some((u8::try_from(digit.to_digit(16)?).ok()?, 15)),
    };
    let bytes = pairs.chunks(2).map(|pair| {
        let [high, low] = pair else { return None };
        let ((high, high_mask), (low, low_mask)) = (digit(*high)?, digit(*low)?);
        Some(Masked {
            value: high << 4 | low,
            mask: high_mask << 4 | low_mask,
        })
    });
    bytes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(edit: Vec<Edit>, image: Option<ImageEdit>) -> FirmwareFault {
        FirmwareFault {
            program: Program::Drive,
            name: "priority".to_owned(),
            what: "a priority".to_owned(),
            edit,
            image,
            unseen: None,
        }
    }

    #[test]
    fn a_text_is_replaced_where_it_stands_once() {
        let edit = |text: &str| Edit {
            file: "main.rs".to_owned(),
            text: text.to_owned(),
            with: "1".to_owned(),
        };
        let it = fault(vec![], None);
        let applied = it.apply(&edit("a = «4»,"), "x; a = 4, b = 4,").unwrap();
        assert_eq!(applied, "x; a = 1, b = 4,");
        for source in ["b = 4,", "a = 4, a = 4,"] {
            assert!(it.apply(&edit("a = «4»,"), source).is_err());
        }
        assert!(it.apply(&edit("a = 4,"), "a = 4,").is_err(), "no marks");
    }

    #[test]
    fn bytes_are_replaced_wherever_they_are() {
        let edit = |bytes: &str| ImageEdit {
            bytes: bytes.to_owned(),
            with: "af f3 00 80".to_owned(),
        };
        let mut image = [0, 0, 0x81, 0xf3, 0x12, 0x88, 0x82, 0xf3, 0x12, 0x88];
        fault(vec![], Some(edit("8? f3 12 88")))
            .edit_image(&mut image)
            .unwrap();
        assert_eq!(image, [0, 0, 0xaf, 0xf3, 0, 0x80, 0xaf, 0xf3, 0, 0x80]);
        for bytes in ["8? f3 12 88", "8", "zz", ""] {
            assert!(
                fault(vec![], Some(edit(bytes)))
                    .edit_image(&mut image)
                    .is_err()
            );
        }
    }
}
