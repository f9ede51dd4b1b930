//! A folder whose files appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Files on their way into a folder. They are written beside it and moved in
/// by [`commit`](Self::commit); dropped before that, no files remain.
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    parts: TempDir,
}

impl Folder {
    /// Prepares to fill `target`, which need not exist. Files of other names
    /// that it has are kept.
    ///
    /// # Errors
    /// If there is a file in its place, or nothing can be written there.
    pub fn create(target: &Path) -> io::Result<Self> {
        if target.exists() && !target.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::NotADirectory,
                "there is a file of this name",
            ));
        }
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        fs::create_dir_all(parent)?;
        let parts = tempfile::Builder::new()
            .prefix(".crepitus-")
            .tempdir_in(parent)?;
        Ok(Self {
            target: target.to_owned(),
            parts,
        })
    }

    /// A new file of this name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn file(&self, name: &str) -> io::Result<BufWriter<File>> {
        Ok(BufWriter::with_capacity(
            1 << 16,
            File::create(self.parts.path().join(name))?,
        ))
    }

    /// Finishes a file: everything is on the disk when this returns.
    ///
    /// # Errors
    /// If the disk does not take it all.
    pub fn finish(file: BufWriter<File>) -> io::Result<()> {
        let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()
    }

    /// Moves every file into place.
    ///
    /// # Errors
    /// If one cannot be moved.
    pub fn commit(self) -> io::Result<()> {
        fs::create_dir_all(&self.target)?;
        for entry in fs::read_dir(self.parts.path())? {
            let entry = entry?;
            fs::rename(entry.path(), self.target.join(entry.file_name()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_at_once_and_replace_their_like() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("out/run");
        for content in ["first", "second"] {
            let folder = Folder::create(&target).unwrap();
            let mut file = folder.file("a.txt").unwrap();
            file.write_all(content.as_bytes()).unwrap();
            Folder::finish(file).unwrap();
            folder.commit().unwrap();
            assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), content);
        }
        assert_eq!(names(&home.path().join("out")), ["run"]);
    }

    #[test]
    fn what_is_not_committed_leaves_nothing() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        let folder = Folder::create(&target).unwrap();
        folder.file("a.txt").unwrap().write_all(b"half").unwrap();
        drop(folder);
        assert_eq!(names(home.path()), Vec::<String>::new());
    }

    #[test]
    fn a_file_in_the_way_is_an_error() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        fs::write(&target, "mine").unwrap();
        assert!(Folder::create(&target).is_err());
        assert_eq!(fs::read_to_string(target).unwrap(), "mine");
    }
}
