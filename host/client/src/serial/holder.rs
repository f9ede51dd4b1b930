//! Process that holds a port, and its group, from Linux's /proc and /etc.

use crate::transport::Holder;
use std::fs;
use std::path::Path;

/// The process that has this port open, if visible: those of other users are
/// not.
pub fn holder_of(port: &str) -> Option<Holder> {
    let port = fs::canonicalize(port).ok()?;
    fs::read_dir("/proc").ok()?.flatten().find_map(|entry| {
        let pid = entry.file_name().to_str()?.parse().ok()?;
        let files = fs::read_dir(entry.path().join("fd")).ok()?;
        files
            .flatten()
            .any(|file| fs::read_link(file.path()).is_ok_and(|target| target == port))
            .then(|| Holder {
                pid,
                program: program(&entry.path()),
            })
    })
}

fn program(process: &Path) -> String {
    fs::read_to_string(process.join("comm"))
        .map_or_else(|_| "?".to_owned(), |name| name.trim_end().to_owned())
}

/// Returns whether this is a character device.
pub(super) fn is_terminal(port: &str) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        fs::metadata(port).is_ok_and(|data| data.file_type().is_char_device())
    }
    #[cfg(not(unix))]
    {
        let _ = port;
        true
    }
}

/// Returns whether a port is a pseudo-terminal, which belongs to the user of the program that made it.
pub(super) fn is_pseudo_terminal(port: &str) -> bool {
    fs::canonicalize(port).is_ok_and(|port| port.starts_with("/dev/pts"))
}

/// The group with permission for this port.
#[cfg(unix)]
pub(super) fn group_of(port: &str) -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    let id = fs::metadata(port).ok()?.gid().to_string();
    group_in(&fs::read_to_string("/etc/group").ok()?, &id)
}

/// The name of a group in the text of /etc/group; none of root's, which nobody is to join.
#[cfg(unix)]
fn group_in(groups: &str, id: &str) -> Option<String> {
    // name:password:id:members
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)? == id && id != "0").then(|| name.to_owned())
    })
}

/// The group with permission for this port.
#[cfg(not(unix))]
pub(super) fn group_of(_port: &str) -> Option<String> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn this_program_is_seen_to_hold_its_file() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let holder = holder_of(file.path().to_str().unwrap()).unwrap();
        assert_eq!(holder.pid, std::process::id());
        assert!(!holder.program.is_empty());
        let other = tempfile::tempdir().unwrap();
        assert_eq!(holder_of(other.path().to_str().unwrap()), None);
    }

    #[test]
    fn the_group_of_a_port_is_found_by_its_number() {
        // Passwords are no numbers of groups, even if they look like some.
        let groups = "root:x:0:\ndialout:14:20:ada\n\nuucp:x:14:ada,bob\nplugdev::46:\n";
        for (id, name) in [("20", "dialout"), ("14", "uucp"), ("46", "plugdev")] {
            assert_eq!(group_in(groups, id).as_deref(), Some(name));
        }
        for id in ["0", "4", "x", ""] {
            assert_eq!(group_in(groups, id), None, "{id}");
        }
    }
}
