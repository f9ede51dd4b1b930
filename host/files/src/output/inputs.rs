//! Files that are read while others are written.

use std::path::Path;

/// Identity of a file, whatever its name.
#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = std::path::PathBuf;

/// Inputs of a verb, by file identity: links, hard links and other spellings of a path are the same file.
#[derive(Clone, Debug, Default)]
pub struct Inputs(Vec<Identity>);

impl Inputs {
    /// Collects the inputs that are files; names of what ships with the program are not.
    #[must_use]
    pub fn of<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Self {
        let identities = paths.into_iter();
        Self(
            identities
                .filter_map(|path| identity(path.as_ref()))
                .collect(),
        )
    }

    /// Returns whether a path leads to one of the inputs.
    #[must_use]
    pub fn contains(&self, path: &Path) -> bool {
        identity(path).is_some_and(|identity| self.0.contains(&identity))
    }
}

#[cfg(unix)]
fn identity(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<Identity> {
    std::fs::canonicalize(path).ok()
}
