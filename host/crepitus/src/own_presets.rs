//! The user's own presets: a folder of files in the form of those that ship.

use crate::failure::{Failure, warn};
use crepitus_files::names::is_reserved;
use crepitus_files::output::{Inputs, NewFile};
use crepitus_scene::preset::judged::{FOLDER_VARIABLE, own_folder};
use crepitus_scene::preset::{self, Disorder, Preset};
use crepitus_scene::similar::{question, similar};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The longest name.
const MOST_CHARACTERS: usize = 60;

/// The folder: `CREPITUS_PRESETS`, or `crepitus/presets` in the user's configuration.
pub(crate) fn folder() -> Result<PathBuf, Failure> {
    match own_folder() {
        Some(folder) => Ok(folder),
        None => Err(Failure::Input(format!(
            "there is no home folder to keep presets in: set {FOLDER_VARIABLE} to a folder"
        ))),
    }
}

/// Rejects what cannot be the name of an own preset.
pub(crate) fn check_name(name: &str) -> Result<(), Failure> {
    let no = |why: &str| Err(Failure::Input(format!("invalid name {name:?}: {why}")));
    let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let begins_well = name.starts_with(|c: char| c.is_ascii_lowercase() || c.is_ascii_digit());
    if !begins_well || !name.chars().all(is_word) {
        return no("expected small letters a to z, digits and hyphens, for example monday-knee");
    }
    if name.len() > MOST_CHARACTERS {
        return no(&format!("expected up to {MOST_CHARACTERS} characters"));
    }
    if is_reserved(name) {
        return no("Windows has no file of this name");
    }
    if preset::find(name).is_some() {
        return no("a preset of this name ships; choose another one");
    }
    Ok(())
}

/// The file of the own preset of this name, if there is one.
pub(crate) fn find(name: &str) -> Option<PathBuf> {
    check_name(name).ok()?;
    let file = file(&folder().ok()?, name);
    file.is_file().then_some(file)
}

/// That a name is that of a grade without its disorder, which is no preset, if it is:
/// `mas-0`, `updrs-0-cogwheel`.
pub(crate) fn grade_0(name: &str) -> Option<String> {
    let small = name.to_lowercase();
    let (grade, disorder) = Disorder::ALL.iter().find_map(|disorder| {
        let grade = disorder.grade_0()?;
        let rest = small.strip_prefix(&grade.to_lowercase().replace(' ', "-"))?;
        (rest.is_empty() || rest.starts_with('-')).then_some((grade, disorder))
    })?;
    Some(format!(
        "{name:?} is no preset: {grade} is a knee without {}; switch its effect off, for example with \
         `crepitus params set spasticity.render=off`",
        disorder.name()
    ))
}

/// Suggestions for an unknown preset, as the end of an error message: all that ship whose names
/// contain this one, regardless of case, or else the most similar name. Empty if there are none.
pub(crate) fn suggestions(name: &str) -> String {
    let files = files().unwrap_or_default();
    let own = files.iter().filter_map(|file| file.file_stem()?.to_str());
    let small = name.to_lowercase();
    let shipped = preset::shipped().iter().map(|preset| preset.name.as_str());
    let containing: Vec<&str> = shipped.clone().filter(|n| n.contains(&small)).collect();
    if small.is_empty() || containing.is_empty() {
        question(similar(shipped.chain(own), name))
    } else {
        format!("; of this kind are {}", containing.join(", "))
    }
}

/// All that can be read, with their files, in the order of their names; warns of the others. Without
/// them, those that ship are still of use.
pub(crate) fn all() -> Vec<(Preset, PathBuf)> {
    let files = files().unwrap_or_else(|failure| {
        warn(failure.into_text());
        Vec::new()
    });
    let read = files.into_iter().map(|file| (Preset::read(&file), file));
    read.filter_map(|(preset, file)| match preset {
        Ok(preset) => Some((preset, file)),
        Err(error) => {
            warn(error);
            None
        }
    })
    .collect()
}

/// The files of all, in the order of their names.
fn files() -> Result<Vec<PathBuf>, Failure> {
    // Without a home folder there are none.
    let Ok(folder) = folder() else {
        return Ok(Vec::new());
    };
    let entries = match fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(Failure::at(&folder, "cannot be read", &error)),
    };
    let mut files: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            if path.extension().is_none_or(|e| e != "toml") {
                return false;
            }
            let name = path.file_stem().and_then(|stem| stem.to_str());
            let checked = check_name(name.unwrap_or_default());
            checked
                .map_err(|error| warn(format!("{}: {}", path.display(), error.into_text())))
                .is_ok()
        })
        .collect();
    files.sort();
    Ok(files)
}

/// Writes a preset under this name, whole or not at all, and returns its file.
pub(crate) fn write(name: &str, preset: &Preset, force: bool) -> Result<PathBuf, Failure> {
    check_name(name)?;
    let folder = folder()?;
    let target = file(&folder, name);
    let text = preset.to_toml();
    // What is written can be read.
    Preset::parse(&target, &text).map_err(Failure::input)?;
    make(&folder)?;
    let file = NewFile::create(&target, force, &Inputs::default())?;
    let written = file.as_file().write_all(text.as_bytes());
    written
        .and_then(|()| file.as_file().sync_all())
        .map_err(|error| Failure::at(&target, "cannot be written", &error))?;
    file.persist()?;
    Ok(target)
}

/// Creates the folder of presets where there is none.
fn make(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| {
        // The system's words for a file in its place are "file exists".
        if folder.exists() {
            Failure::Input(format!(
                "{} is no folder to keep presets in: move it away, or set {FOLDER_VARIABLE} to a folder",
                folder.display()
            ))
        } else {
            Failure::at(folder, "cannot be created", &error)
        }
    })
}

fn file(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("toml")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_files_on_every_system() {
        for good in ["a", "monday-knee", "2nd", "com", "com10", "console"] {
            assert!(check_name(good).is_ok(), "{good}");
        }
        let long = "x".repeat(61);
        for bad in [
            "",
            "-a",
            "A",
            "a b",
            "a/b",
            "../a",
            "a.b",
            "ä",
            "a\n",
            "con",
            "nul",
            "com1",
            "lpt9",
            "coarse",
            "mas-2-catch",
            &long,
        ] {
            assert!(check_name(bad).is_err(), "{bad:?}");
        }
    }
}
