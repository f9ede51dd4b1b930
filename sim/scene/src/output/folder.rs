//! A folder whose files appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Files on their way into a folder. They are written elsewhere and moved in
/// by [`commit`](Self::commit); dropped before that, no files remain.
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    /// Temporary folder, which is only this user's, as such folders are; `files` inside is as any other.
    _parts: TempDir,
    files: PathBuf,
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
        // Of a name that is too long the system would tell only when the files are moved.
        if let Err(error) = fs::symlink_metadata(target)
            && error.kind() == io::ErrorKind::InvalidFilename
        {
            return Err(error);
        }
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        if parent.exists() && !parent.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::NotADirectory,
                "what it would be in is a file, not a folder",
            ));
        }
        fs::create_dir_all(parent)?;
        let parts = parts_of(target, parent)?;
        let files = parts.path().join("files");
        fs::create_dir(&files)?;
        Ok(Self {
            target: target.to_owned(),
            _parts: parts,
            files,
        })
    }

    /// A new file of this name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn file(&self, name: &str) -> io::Result<BufWriter<File>> {
        Ok(BufWriter::with_capacity(
            1 << 16,
            File::create(self.path_of(Path::new(name)))?,
        ))
    }

    /// Path to which a file of this name is written, for a caller that creates its files itself.
    #[must_use]
    pub fn path_of(&self, name: &Path) -> PathBuf {
        self.files.join(name)
    }

    /// Finishes a file: everything is on the disk when this returns.
    ///
    /// # Errors
    /// If the disk does not take it all.
    pub fn finish(file: BufWriter<File>) -> io::Result<()> {
        let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()
    }

    /// Moves the whole folder into place if nothing is there, in one step: of two programs only
    /// one succeeds. False if something is; it is left as it is.
    ///
    /// # Errors
    /// If it cannot be moved.
    pub fn commit_new(&self) -> io::Result<bool> {
        let Err(error) = fs::rename(&self.files, &self.target) else {
            return Ok(true);
        };
        // Systems differ in what they say of a folder that is not empty.
        if self.target.exists() {
            Ok(false)
        } else {
            Err(error)
        }
    }

    /// Another place for the files; it has to be on the same file system.
    pub fn aim_at(&mut self, target: &Path) {
        target.clone_into(&mut self.target);
    }

    /// Moves every file into place, beside those that are there.
    ///
    /// # Errors
    /// If one cannot be moved.
    pub fn commit(self) -> io::Result<()> {
        fs::create_dir_all(&self.target)?;
        for entry in fs::read_dir(&self.files)? {
            let entry = entry?;
            fs::rename(entry.path(), self.target.join(entry.file_name()))?;
        }
        Ok(())
    }
}

/// A temporary folder from which files can be moved into `target`: in its parent, from where an empty
/// target is replaced in one step, or in itself, if that is another file system or the parent
/// cannot be written.
fn parts_of(target: &Path, parent: &Path) -> io::Result<TempDir> {
    let temporary_in = |folder: &Path| {
        tempfile::Builder::new()
            .prefix(".crepitus-")
            .tempdir_in(folder)
    };
    if !target.exists() {
        return temporary_in(parent);
    }
    let inside = temporary_in(target)?;
    // Two mounts of one disk look alike: only a move tells them apart.
    if let Ok(beside) = temporary_in(parent)
        && fs::rename(inside.path(), beside.path()).is_ok()
    {
        return Ok(beside);
    }
    Ok(inside)
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
    fn of_two_new_folders_one_is_there() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        let write = |name: &str| {
            let folder = Folder::create(&target).unwrap();
            Folder::finish(folder.file(name).unwrap()).unwrap();
            folder
        };
        let (first, mut second) = (write("a.txt"), write("b.txt"));
        assert!(first.commit_new().unwrap());
        assert!(!second.commit_new().unwrap());
        second.aim_at(&home.path().join("run-2"));
        assert!(second.commit_new().unwrap());
        drop((first, second));
        assert_eq!(names(home.path()), ["run", "run-2"]);
        assert_eq!(names(&home.path().join("run-2")), ["b.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_it_as_any_folder() {
        use std::os::unix::fs::MetadataExt;
        let home = tempfile::tempdir().unwrap();
        let any = home.path().join("any");
        fs::create_dir(&any).unwrap();
        let target = home.path().join("run");
        assert!(Folder::create(&target).unwrap().commit_new().unwrap());
        let mode = |path: &Path| fs::metadata(path).unwrap().mode();
        assert_eq!(mode(&target), mode(&any));
    }

    #[cfg(unix)]
    #[test]
    fn an_empty_folder_is_replaced_in_one_step() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        fs::create_dir(&target).unwrap();
        let folder = Folder::create(&target).unwrap();
        Folder::finish(folder.file("a.txt").unwrap()).unwrap();
        assert!(folder.commit_new().unwrap());
        drop(folder);
        assert_eq!(names(home.path()), ["run"]);
        assert_eq!(names(&target), ["a.txt"]);
    }

    /// Shared memory is another file system than that of temporary files, as a rule.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_on_another_file_system_is_filled() {
        let Ok(other) = tempfile::tempdir_in("/dev/shm") else {
            eprintln!("left out: there is no /dev/shm");
            return;
        };
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        std::os::unix::fs::symlink(other.path(), &target).unwrap();
        drop(Folder::create(&target).unwrap());
        assert_eq!(names(other.path()), Vec::<String>::new());
        let folder = Folder::create(&target).unwrap();
        Folder::finish(folder.file("a.txt").unwrap()).unwrap();
        assert!(!folder.commit_new().unwrap(), "it is there already");
        folder.commit().unwrap();
        assert_eq!(names(other.path()), ["a.txt"]);
        assert_eq!(names(home.path()), ["run"]);
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
    fn a_name_that_is_too_long_is_told_at_once() {
        let home = tempfile::tempdir().unwrap();
        let error = Folder::create(&home.path().join("x".repeat(300))).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidFilename);
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
