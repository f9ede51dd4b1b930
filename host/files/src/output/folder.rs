//! A folder whose files appear whole or not at all.

use super::marker::{Marker, is_plain};
use super::owned::failed;
use super::{
    Claim, Hashed, MARKER, OutputError, OwnedFolder, TEMPORARY, folder_of, hex, is_stdout,
    lock_folder, sha256,
};
use sha2::{Digest, Sha256};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{TempDir, TempPath};

/// Files on their way into a folder. They are written elsewhere and moved in
/// by [`commit`](Self::commit); dropped before that, no files remain.
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    claim: Claim,
    /// Temporary folder, which is only this user's, as such folders are; `files` inside is as any other.
    _parts: TempDir,
    files: PathBuf,
    /// SHA-256 of each file that is finished.
    finished: RefCell<BTreeMap<String, String>>,
}

/// New file of a [`Folder`], hashed while it is written: a long one is not read again.
#[derive(Debug)]
pub struct Part {
    name: String,
    file: File,
    sha: Sha256,
}

impl Write for Part {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.sha.update(bytes.get(..count).unwrap_or_default());
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Folder {
    /// Prepares to fill `target`, which need not exist, with files of which these names are known.
    ///
    /// # Errors
    /// [`OutputError`] if something is in the way, or nothing can be written there.
    pub fn create<N: AsRef<str>>(
        target: &Path,
        claim: Claim,
        names: impl IntoIterator<Item = N>,
    ) -> Result<Self, OutputError> {
        check_folder(target)?;
        if target.is_dir() {
            OwnedFolder::open(target, claim.clone())?.check(names)?;
        }
        let parent = folder_of(target);
        let prepare = || -> io::Result<(TempDir, PathBuf)> {
            fs::create_dir_all(parent)?;
            let parts = parts_of(target, parent)?;
            let files = parts.path().join("files");
            fs::create_dir(&files)?;
            Ok((parts, files))
        };
        let (parts, files) = prepare().map_err(failed(target, CREATING))?;
        Ok(Self {
            target: target.to_owned(),
            claim,
            _parts: parts,
            files,
            finished: RefCell::default(),
        })
    }

    /// A new file of this name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn file(&self, name: &str) -> io::Result<BufWriter<Part>> {
        if !is_plain(name) {
            return Err(io::ErrorKind::InvalidFilename.into());
        }
        self.finished.borrow_mut().remove(name);
        let part = Part {
            name: name.to_owned(),
            file: File::create(self.path_of(Path::new(name)))?,
            sha: Sha256::new(),
        };
        Ok(BufWriter::with_capacity(1 << 16, part))
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
    pub fn finish(&self, file: BufWriter<Part>) -> io::Result<()> {
        let part = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        part.file.sync_all()?;
        let sha256 = hex(&part.sha.finalize());
        self.finished.borrow_mut().insert(part.name, sha256);
        Ok(())
    }

    /// SHA-256 of a file, which is complete.
    fn sha256_of(&self, name: &str, path: &Path) -> io::Result<String> {
        match self.finished.borrow().get(name) {
            Some(sha256) => Ok(sha256.clone()),
            None => sha256(File::open(path)?),
        }
    }

    /// Moves the whole folder into place if nothing is there, or an empty folder, in one step: of
    /// two programs only one succeeds. False if something is; it is left as it is.
    ///
    /// # Errors
    /// If it cannot be moved.
    pub fn commit_new(&self) -> Result<bool, OutputError> {
        let failed = failed(&self.target, WRITING);
        let list = || -> io::Result<()> {
            let mut marker = Marker::default();
            for (name, path) in self.all()? {
                marker.add(&name, &self.sha256_of(&name, &path)?, &self.claim.by);
            }
            marker.write(&self.files)
        };
        list().map_err(&failed)?;
        let moved = like_target(&self.files, &self.target)
            .and_then(|()| fs::rename(&self.files, &self.target));
        let Err(error) = moved else {
            return Ok(true);
        };
        fs::remove_file(self.files.join(MARKER)).map_err(&failed)?;
        // Systems differ in what they say of a folder that is not empty.
        if self.target.exists() {
            Ok(false)
        } else {
            Err(failed(error))
        }
    }

    /// Another place for the files; it has to be on the same file system.
    pub fn aim_at(&mut self, target: &Path) {
        target.clone_into(&mut self.target);
    }

    /// Moves every file into place, beside those that are there.
    ///
    /// # Errors
    /// [`OutputError`] if something is in the way, or a file cannot be moved; of what is in the way nothing
    /// is changed.
    pub fn commit(self) -> Result<(), OutputError> {
        let failed = failed(&self.target, WRITING);
        fs::create_dir_all(&self.target).map_err(&failed)?;
        let _lock = lock_folder(&self.target);
        let mut folder = OwnedFolder::open(&self.target, self.claim.clone())?;
        let hashed = |(name, path): (String, PathBuf)| {
            let sha256 = self.sha256_of(&name, &path)?;
            let path = TempPath::try_from_path(path)?;
            Ok((name, Hashed { path, sha256 }))
        };
        let files = self.all().map_err(&failed)?.into_iter().map(hashed);
        let files: io::Result<Vec<_>> = files.collect();
        folder.put_all(files.map_err(&failed)?)?;
        folder.compact()
    }

    /// All files, in the order of their names.
    fn all(&self) -> io::Result<Vec<(String, PathBuf)>> {
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.files)? {
            let entry = entry?;
            let name = entry.file_name().into_string();
            let name = name.map_err(|_| io::Error::from(io::ErrorKind::InvalidFilename))?;
            files.push((name, std::path::absolute(entry.path())?));
        }
        files.sort();
        Ok(files)
    }
}

const CREATING: &str = "cannot be created";
const WRITING: &str = "cannot be written";

/// Checks that a path is a folder, or that one can be made there.
///
/// # Errors
/// [`OutputError`] for a file, standard output, or a link that leads nowhere.
pub fn check_folder(target: &Path) -> Result<(), OutputError> {
    let no_folder = |path: &Path, why| OutputError::NoFolder {
        path: path.to_owned(),
        why,
    };
    if is_stdout(target) {
        let why = "results are a folder of files, not standard output";
        return Err(no_folder(target, why));
    }
    match fs::symlink_metadata(target) {
        Ok(_) if target.is_dir() => return Ok(()),
        Ok(entry) if entry.is_symlink() && !target.exists() => {
            return Err(no_folder(target, "a link of this name leads nowhere"));
        }
        Ok(_) => return Err(no_folder(target, "there is a file of this name")),
        // Of a name that is too long the system would tell only when the files are moved.
        Err(error) if error.kind() == io::ErrorKind::InvalidFilename => {
            return Err(failed(target, CREATING)(error));
        }
        Err(_) => {}
    }
    let parent = folder_of(target);
    if parent.exists() && !parent.is_dir() {
        let why = "what it would be in is a file, not a folder";
        return Err(no_folder(target, why));
    }
    Ok(())
}

/// Gives a new folder the permissions of the empty one that it replaces.
fn like_target(files: &Path, target: &Path) -> io::Result<()> {
    #[cfg(unix)]
    if let (Ok(new), Ok(old)) = (fs::metadata(files), fs::symlink_metadata(target))
        && old.is_dir()
        && fs::read_dir(target)?.next().is_none()
    {
        use std::os::unix::fs::MetadataExt;
        if (new.uid(), new.gid()) != (old.uid(), old.gid()) {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        fs::set_permissions(files, old.permissions())?;
    }
    #[cfg(not(unix))]
    let _ = (files, target);
    Ok(())
}

/// A temporary folder from which files can be moved into `target`: in its parent, from where an empty
/// target is replaced in one step, or in itself, if that is another file system or the parent
/// cannot be written.
fn parts_of(target: &Path, parent: &Path) -> io::Result<TempDir> {
    let temporary_in = |folder: &Path| {
        tempfile::Builder::new()
            .prefix(TEMPORARY)
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
