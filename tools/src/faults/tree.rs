//! The scratch copy of the sources that faults and mutants are planted in.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Entries of the root that no test needs.
const LEFT_OUT: [&str; 4] = [".git", "target", "out", "bench"];

/// Makes `to` a copy of the sources in `from`, with other texts for some files.
/// A file that is already the same is not written, so that it is not rebuilt.
///
/// # Errors
/// The file system's error.
pub fn copy(from: &Path, to: &Path, others: &BTreeMap<PathBuf, String>) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for file in files(from)? {
        let bytes = match others.get(&file) {
            Some(text) => text.clone().into_bytes(),
            None => fs::read(from.join(&file))?,
        };
        write_if_changed(&to.join(&file), &bytes)?;
    }
    // Files removed from the sources must not be built.
    for file in files(to)? {
        if !from.join(&file).exists() {
            fs::remove_file(to.join(&file))?;
        }
    }
    Ok(())
}

/// Writes a file unless it holds these bytes already.
fn write_if_changed(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, bytes)
}

/// All files below a folder, relative to it, in order.
pub(crate) fn files(root: &Path) -> io::Result<Vec<PathBuf>> {
    let (mut found, mut folders) = (Vec::new(), vec![PathBuf::new()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let path = folder.join(entry.file_name());
            if LEFT_OUT.iter().any(|left_out| path == Path::new(left_out)) {
                continue;
            }
            if entry.file_type()?.is_dir() {
                // Build output is marked like this.
                if !entry.path().join("CACHEDIR.TAG").exists() {
                    folders.push(path);
                }
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}
