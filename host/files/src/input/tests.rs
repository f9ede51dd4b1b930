use super::*;
use std::io::ErrorKind;
use tempfile::tempdir;

fn text(path: &Path) -> String {
    let error = read(path, 1_000).expect_err("not a regular file");
    let again = open(path).err().map(|error| error.to_string());
    if !matches!(error, InputError::TooLong { .. }) {
        assert_eq!(again, Some(error.to_string()), "open and read agree");
    }
    error.to_string()
}

#[test]
fn a_file_up_to_its_limit_is_read_and_none_that_is_longer() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("a");
    fs::write(&file, "abc").unwrap();
    assert_eq!(read(&file, 3).unwrap(), b"abc");
    assert_eq!(read_to_string(&file, 3).unwrap(), "abc");
    assert!(matches!(
        read(&file, 2),
        Err(InputError::TooLong { limit_bytes: 2 })
    ));
    let mut all = String::new();
    let mut opened = open_up_to(&file, 3).unwrap();
    opened.read_to_string(&mut all).unwrap();
    assert_eq!(all, "abc");
    assert!(open_up_to(&file, 2).is_err());
    fs::write(&file, b"a\xff").unwrap();
    assert!(matches!(
        read_to_string(&file, 3),
        Err(InputError::NotText(_))
    ));
}

#[test]
fn a_giant_is_refused_before_it_is_read() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("giant");
    File::create(&file).unwrap().set_len(1 << 40).unwrap();
    let error = read(&file, 16_000_000).unwrap_err();
    assert_eq!(
        error.to_string(),
        "it is longer than 16 MB, the most that is read here"
    );
    assert_eq!(io::Error::from(error).kind(), ErrorKind::FileTooLarge);
}

#[test]
fn a_folder_and_a_missing_file_are_named() {
    let folder = tempdir().unwrap();
    assert_eq!(
        text(folder.path()),
        "it is a folder, expected a regular file: name a file in it"
    );
    let none = folder.path().join("none");
    let error = io::Error::from(read(&none, 9).unwrap_err());
    assert_eq!(error.kind(), ErrorKind::NotFound);
}

#[cfg(unix)]
#[test]
fn pipes_sockets_devices_and_links_to_nothing_are_named_without_waiting() {
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    let folder = tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    mknodat(CWD, at("pipe"), FileType::Fifo, Mode::RWXU, 0).unwrap();
    std::os::unix::fs::symlink(at("pipe"), at("link")).unwrap();
    let pipe =
        "it is a pipe, expected a regular file: save what it delivers to a file, and name that";
    assert_eq!(text(&at("pipe")), pipe);
    assert_eq!(text(&at("link")), pipe);
    let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
    assert_eq!(
        text(&at("socket")),
        "it is a socket, expected a regular file"
    );
    for device in ["/dev/zero", "/dev/null"] {
        let said = text(Path::new(device));
        assert!(said.starts_with("it is a device"), "{said}");
    }
    std::os::unix::fs::symlink(at("none"), at("dangling")).unwrap();
    assert_eq!(
        text(&at("dangling")),
        "it is a link to a file that does not exist"
    );
}

/// A file whose length the system does not know is read to its end, and not past the limit.
#[cfg(target_os = "linux")]
#[test]
fn a_file_of_unknown_length_is_read_up_to_the_limit() {
    let file = Path::new("/proc/self/status");
    assert_eq!(fs::metadata(file).unwrap().len(), 0);
    assert!(read_to_string(file, 100_000).unwrap().contains("Name:"));
    assert!(matches!(read(file, 10), Err(InputError::TooLong { .. })));
}
