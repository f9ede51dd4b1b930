//! Discovery of devices, on USB and simulated.
//!
//! A device on USB is a serial port with the project's vendor and product id
//! *and* its name: the ids are shared with other free projects. Windows does not
//! tell the name; there the handshake rejects what is none of ours.
//!
//! A simulated device is a pty with a symbolic link in [`simulated_folder`]; the
//! link's name is the device's. A link that no program serves is ignored, and
//! never opened, as is one that does not lead to that program's pty: see [`ServedName`].

mod folder;
mod name;

use crepitus_protocol::usb::{PRODUCT, PRODUCT_ID, VENDOR_ID};
pub use folder::{make_temporary_user_folder, make_user_folder, user_folder, user_folders};
use name::Standing;
pub use name::{Elsewhere, ServedName};
use serialport::{SerialPortType, UsbPortInfo};
use std::fs;
use std::path::{Path, PathBuf};

/// A device that can be opened with [`Serial::open`](crate::Serial::open).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// The port.
    pub port: String,
    /// Kind of device.
    pub kind: DeviceKind,
}

/// Kind of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceKind {
    /// Device on USB.
    Usb {
        /// Serial number, if the system reports it.
        serial_number: Option<String>,
    },
    /// Simulated, by another program.
    Simulated {
        /// Name.
        name: String,
    },
}

/// The system cannot list its serial ports.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot list the serial ports of this system: {detail}")]
pub struct DiscoveryError {
    /// Error of the system.
    pub detail: String,
}

/// All devices, those on USB first, in the order of their ports.
///
/// # Errors
/// [`DiscoveryError`] if the system cannot list its ports.
pub fn devices() -> Result<Vec<Device>, DiscoveryError> {
    let mut devices = usb_devices()?;
    let is_served = |standing: &Standing| *standing == Standing::Served;
    devices.extend(links_in(&simulated_folder(), is_served));
    Ok(devices)
}

/// The devices on USB.
///
/// # Errors
/// [`DiscoveryError`] if the system cannot list its ports.
pub fn usb_devices() -> Result<Vec<Device>, DiscoveryError> {
    // The library panics on a Linux without this folder: a container.
    if cfg!(target_os = "linux") && !Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let ports = serialport::available_ports().map_err(|error| DiscoveryError {
        detail: error.to_string(),
    })?;
    let mut devices: Vec<_> = ports
        .into_iter()
        // A port of macOS has two names; opening this one waits for a modem.
        .filter(|port| !port.port_name.starts_with("/dev/tty."))
        .filter_map(|port| match port.port_type {
            SerialPortType::UsbPort(usb) if is_ours(&usb, TELLS_PRODUCT) => Some(Device {
                port: port.port_name,
                kind: DeviceKind::Usb {
                    serial_number: usb.serial_number,
                },
            }),
            _ => None,
        })
        .collect();
    devices.sort_by(|a, b| a.port.cmp(&b.port));
    Ok(devices)
}

/// Whether the system tells the name of a product. Windows has that of its driver in its place: "USB Serial Device
/// (COM3)", in the user's language.
const TELLS_PRODUCT: bool = !cfg!(windows);

fn is_ours(usb: &UsbPortInfo, tells_product: bool) -> bool {
    // Systems differ in spaces and case of the name.
    let is_named = |name: &str| name.to_lowercase().contains(&PRODUCT.to_lowercase());
    (usb.vid, usb.pid) == (VENDOR_ID, PRODUCT_ID)
        && (!tells_product || usb.product.as_deref().is_some_and(is_named))
}

/// Folder of simulated devices, of this user alone: see [`user_folder`].
pub fn simulated_folder() -> PathBuf {
    user_folder()
}

/// The simulated devices of a folder, by name; none if it does not exist. Unlike [`devices`], also
/// those whose link [`leads_elsewhere`]: opening one of these by name is an error that says where it leads.
pub fn simulated_devices(folder: &Path) -> Vec<Device> {
    links_in(folder, |standing| *standing != Standing::Ended)
}

/// The links of a folder behind which there is what is wanted, in the order of their names.
fn links_in(folder: &Path, is_wanted: impl Fn(&Standing) -> bool) -> Vec<Device> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut devices: Vec<_> = entries
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()))
        .filter(|entry| is_wanted(&name::standing(&entry.path())))
        .filter_map(|entry| {
            Some(Device {
                port: entry.path().to_str()?.to_owned(),
                kind: DeviceKind::Simulated {
                    name: entry.file_name().to_str()?.to_owned(),
                },
            })
        })
        .collect();
    devices.sort_by(|a, b| a.port.cmp(&b.port));
    devices
}

/// True if this port is, or links to, the link of a simulated device that no program serves
/// any more. What is behind it may be anybody's terminal.
///
/// A link is one of a simulated device if it is in [`simulated_folder`], however the path is
/// written, or has a lock file beside it: `XDG_RUNTIME_DIR` may have been another when it was made.
pub fn is_stale(port: &Path) -> bool {
    is_stale_in(&simulated_folder(), port)
}

/// Target of this port, if it is, or links to, the link of a simulated device that is served, and
/// that link does not lead to it. What is behind it may be anybody's terminal.
pub fn leads_elsewhere(port: &Path) -> Option<Elsewhere> {
    match unserved_in(&simulated_folder(), port) {
        Some(Standing::Elsewhere(elsewhere)) => Some(elsewhere),
        _ => None,
    }
}

fn is_stale_in(folder: &Path, port: &Path) -> bool {
    unserved_in(folder, port) == Some(Standing::Ended)
}

/// Pseudo-terminal that this port is, if it is one and does not lead there by the link of a simulated device.
/// When its program has ended, its name may be given to anybody's terminal: that is another one.
#[cfg(unix)]
pub fn pseudo_terminal(port: &Path) -> Option<PseudoTerminal> {
    use std::os::unix::fs::MetadataExt;
    let path = fs::canonicalize(port).ok()?;
    if !path.starts_with("/dev/pts") || !simulated_links(&simulated_folder(), port).is_empty() {
        return None;
    }
    let node = fs::metadata(&path).ok()?;
    Some(PseudoTerminal(node.rdev(), node.ctime(), node.ctime_nsec()))
}

/// The same: other systems have none that we serve.
#[cfg(not(unix))]
pub fn pseudo_terminal(_: &Path) -> Option<PseudoTerminal> {
    None
}

/// A pseudo-terminal: its number, and when its node was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PseudoTerminal(u64, i64, i64);

/// Target of the first link on the way from this port that is one of a simulated device, and
/// not served.
fn unserved_in(folder: &Path, port: &Path) -> Option<Standing> {
    let links = simulated_links(folder, port);
    let mut standings = links.iter().map(|link| name::standing(link));
    standings.find(|standing| *standing != Standing::Served)
}

/// The links on the way from this port that are of simulated devices.
fn simulated_links(folder: &Path, port: &Path) -> Vec<PathBuf> {
    /// Links that lead to links; the system follows 40.
    const MOST_LINKS: usize = 40;
    let folder = fs::canonicalize(folder).ok();
    let mut path = port.to_path_buf();
    let mut found = Vec::new();
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&path) else {
            break;
        };
        let parent = match path.parent() {
            Some(parent) if parent != Path::new("") => parent.to_path_buf(),
            _ => PathBuf::from("."),
        };
        let is_there = folder.is_some() && fs::canonicalize(&parent).ok() == folder;
        if is_there || name::has_lock(&path) {
            found.push(path);
        }
        path = parent.join(target);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_alone_are_not_enough() {
        let usb = |vid, product: Option<&str>| UsbPortInfo {
            vid,
            pid: PRODUCT_ID,
            serial_number: None,
            manufacturer: None,
            product: product.map(str::to_owned),
        };
        assert!(is_ours(&usb(VENDOR_ID, Some("Crepitus")), true));
        assert!(is_ours(&usb(VENDOR_ID, Some("crepitus_comms")), true));
        assert!(!is_ours(&usb(VENDOR_ID, Some("Blinky")), true));
        assert!(!is_ours(&usb(VENDOR_ID, None), true));
        assert!(!is_ours(&usb(1, Some("Crepitus")), true));
        // As Windows lists it.
        let of_driver = Some("Serielles USB-Gerät (COM3)");
        assert!(is_ours(&usb(VENDOR_ID, of_driver), false));
        assert!(!is_ours(&usb(1, of_driver), false));
    }

    #[test]
    fn listing_ports_does_not_panic() {
        usb_devices().unwrap();
    }

    /// Text in the lock of the program that serves a device at this pty.
    #[cfg(unix)]
    fn lock_text(pty: &Path) -> String {
        format!("{}\n", pty.display())
    }

    #[cfg(unix)]
    #[test]
    fn a_stale_link_is_told_by_its_lock_wherever_it_is_and_however_it_is_written() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("terminal"), "").unwrap();
        fs::create_dir(path("inside")).unwrap();
        symlink(path("terminal"), path("inside/knee")).unwrap();
        symlink("inside/knee", path("shortcut")).unwrap();
        let names = [
            "inside/knee",
            "inside/../inside/knee",
            "./inside/knee",
            "shortcut",
        ];
        // Anybody's link.
        assert!(names.iter().all(|name| !is_stale(&path(name))));
        // In the folder of simulated devices each link is one of theirs.
        for name in names {
            assert!(is_stale_in(&path("inside"), &path(name)), "{name}");
        }
        let lock = fs::File::create(path("inside/knee.lock")).unwrap();
        for name in names {
            assert!(is_stale(&path(name)), "{name}");
        }
        lock.lock().unwrap();
        fs::write(path("inside/knee.lock"), lock_text(&path("terminal"))).unwrap();
        assert!(names.iter().all(|name| !is_stale(&path(name))));
        assert!(!is_stale(&path("terminal")));
        let elsewhere = |name: &str| leads_elsewhere(&path(name));
        assert!(names.iter().all(|name| elsewhere(name).is_none()));
        // Replaced while it is served.
        fs::write(path("inside/knee.lock"), lock_text(&path("pty"))).unwrap();
        assert!(names.iter().all(|name| !is_stale(&path(name))));
        assert!(names.iter().all(|name| elsewhere(name).is_some()));
        // A link to itself leads nowhere.
        symlink(path("round"), path("round")).unwrap();
        assert!(!is_stale(&path("round")));
    }

    #[cfg(unix)]
    #[test]
    fn links_that_are_served_are_devices() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(simulated_devices(&folder.path().join("none")), []);
        let [target, gone, other] = ["file", "gone", "other"].map(|name| folder.path().join(name));
        for file in [&target, &other] {
            fs::write(file, "").unwrap();
        }
        let mut locks = Vec::new();
        for (name, target, said, is_locked) in [
            ("knee", &target, lock_text(&target), true),
            ("hip", &target, lock_text(&target), true),
            ("killed", &target, lock_text(&target), false),
            ("no-pty", &gone, lock_text(&gone), true),
            ("replaced", &other, lock_text(&target), true),
            ("silent", &target, String::new(), true),
        ] {
            let link = folder.path().join(name);
            symlink(target, &link).unwrap();
            let lock = folder.path().join(format!("{name}.lock"));
            fs::write(&lock, said).unwrap();
            let lock = fs::File::open(lock).unwrap();
            if is_locked {
                lock.lock().unwrap();
                locks.push(lock);
            }
        }
        symlink(&target, folder.path().join("never-served")).unwrap();
        let names = |devices: Vec<Device>| -> Vec<_> {
            devices.into_iter().map(|device| device.kind).collect()
        };
        let simulated = |name: &str| DeviceKind::Simulated { name: name.into() };
        let served = links_in(folder.path(), |standing| *standing == Standing::Served);
        assert_eq!(names(served), [simulated("hip"), simulated("knee")]);
        let named = simulated_devices(folder.path());
        assert_eq!(names(named), ["hip", "knee", "replaced"].map(simulated));
    }
}
