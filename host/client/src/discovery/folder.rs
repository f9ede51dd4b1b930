//! The folder of this user: simulated devices, and what programs that share a
//! device meet by.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// `crepitus` in the user's runtime folder (`XDG_RUNTIME_DIR`) if it is there and this user's,
/// or else `crepitus-` and the user's number in the temporary folder.
pub fn user_folder() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(folder) if is_own(Path::new(&folder)) => PathBuf::from(folder).join("crepitus"),
        _ => temporary(),
    }
}

fn temporary() -> PathBuf {
    std::env::temp_dir().join(own_name())
}

/// Every folder that may be this user's with some environment, as far as it is there and
/// nobody else's.
pub fn user_folders() -> Vec<PathBuf> {
    let mut folders = vec![user_folder()];
    folders.push(runtime().join("crepitus"));
    folders.push(temporary());
    folders.dedup();
    folders.retain(|folder| is_own(folder));
    folders
}

/// The one in the temporary folder, made if it is not there: its path is short.
///
/// # Errors
/// As [`make_user_folder`].
pub fn make_temporary_user_folder() -> io::Result<PathBuf> {
    let folder = temporary();
    make_private(&folder)?;
    Ok(folder)
}

/// The runtime folder of a login, whatever the environment says; where there is none, one that
/// does not exist.
#[cfg(unix)]
fn runtime() -> PathBuf {
    let number = rustix::process::geteuid().as_raw();
    PathBuf::from(format!("/run/user/{number}"))
}

#[cfg(not(unix))]
fn runtime() -> PathBuf {
    temporary()
}

#[cfg(unix)]
fn is_own(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let own = rustix::process::geteuid().as_raw();
    fs::symlink_metadata(folder).is_ok_and(|found| found.is_dir() && found.uid() == own)
}

#[cfg(not(unix))]
fn is_own(folder: &Path) -> bool {
    folder.is_dir()
}

/// [`user_folder`], made if it is not there.
///
/// # Errors
/// Of the system; [`io::ErrorKind::PermissionDenied`] if something of that name belongs to
/// another user; [`io::ErrorKind::NotADirectory`] if it is no folder.
pub fn make_user_folder() -> io::Result<PathBuf> {
    let folder = user_folder();
    make_private(&folder)?;
    Ok(folder)
}

#[cfg(unix)]
fn own_name() -> String {
    format!("crepitus-{}", rustix::process::geteuid().as_raw())
}

/// The temporary folder is the user's own.
#[cfg(not(unix))]
fn own_name() -> String {
    "crepitus".to_owned()
}

#[cfg(unix)]
fn make_private(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
    let made = fs::DirBuilder::new().mode(0o700).create(folder);
    match made {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    // Not what a link leads to: others can make links in the temporary folder.
    let found = fs::symlink_metadata(folder)?;
    if found.uid() != rustix::process::geteuid().as_raw() {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "it belongs to another user; remove it, or set XDG_RUNTIME_DIR to a folder of your own",
        ));
    }
    if !found.is_dir() {
        return Err(io::Error::new(
            io::ErrorKind::NotADirectory,
            "it is no folder; remove it, or set XDG_RUNTIME_DIR to another folder of your own",
        ));
    }
    if found.mode() & 0o077 != 0 {
        fs::set_permissions(folder, fs::Permissions::from_mode(0o700))?;
    }
    Ok(())
}

#[cfg(not(unix))]
fn make_private(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn the_folder_is_for_nobody_else() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("crepitus");
        make_private(&folder).unwrap();
        let mode = || fs::metadata(&folder).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(), 0o700);
        for open in [0o777, 0o770, 0o750, 0o705] {
            fs::set_permissions(&folder, fs::Permissions::from_mode(open)).unwrap();
            make_private(&folder).unwrap();
            assert_eq!(mode(), 0o700, "{open:o}");
        }
        let link = home.path().join("link");
        symlink(&folder, &link).unwrap();
        let file = home.path().join("file");
        fs::write(&file, "").unwrap();
        for other in [link, file] {
            let error = make_private(&other).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::NotADirectory);
            assert!(error.to_string().contains("no folder"), "{error}");
        }
        let nowhere = home.path().join("no/such/folder");
        assert!(make_private(&nowhere).is_err());
    }
}
