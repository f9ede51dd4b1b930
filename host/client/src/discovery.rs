//! Which devices there are: on USB, and simulated ones.
//!
//! A device on USB is a serial port with the project's vendor and product id
//! *and* its name: the ids are shared with other free projects.
//!
//! A simulated device is a pty. Who offers one puts a link to it into
//! [`simulated_folder`]; the link's name is the device's. A link whose pty has
//! gone is no device.

use crepitus_protocol::usb::{PRODUCT, PRODUCT_ID, VENDOR_ID};
use serialport::{SerialPortType, UsbPortInfo};
use std::fs;
use std::path::{Path, PathBuf};

/// A device that can be opened with [`Serial::open`](crate::Serial::open).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// The port.
    pub port: String,
    /// What it is.
    pub kind: DeviceKind,
}

/// What a device is.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceKind {
    /// On USB.
    Usb {
        /// Its number, if the system says it.
        serial_number: Option<String>,
    },
    /// Simulated, by another program.
    Simulated {
        /// The name that it was given.
        name: String,
    },
}

/// The system does not say which ports it has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the system does not say which serial ports it has: {detail}")]
pub struct DiscoveryError {
    /// What it says instead.
    pub detail: String,
}

/// All devices, those on USB first, in the order of their ports.
///
/// # Errors
/// [`DiscoveryError`] if the system does not list its ports.
pub fn devices() -> Result<Vec<Device>, DiscoveryError> {
    let mut devices = usb_devices()?;
    devices.extend(simulated_devices(&simulated_folder()));
    Ok(devices)
}

/// The devices on USB.
///
/// # Errors
/// [`DiscoveryError`] if the system does not list its ports.
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
        // A port of macOS has two names; this one waits for a modem.
        .filter(|port| !port.port_name.starts_with("/dev/tty."))
        .filter_map(|port| match port.port_type {
            SerialPortType::UsbPort(usb) if is_ours(&usb) => Some(Device {
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

fn is_ours(usb: &UsbPortInfo) -> bool {
    // The system may write the name with other spaces or cases than we do.
    let is_named = |name: &str| name.to_lowercase().contains(&PRODUCT.to_lowercase());
    (usb.vid, usb.pid) == (VENDOR_ID, PRODUCT_ID) && usb.product.as_deref().is_some_and(is_named)
}

/// Where simulated devices are offered: `crepitus` in the folder of this
/// user's session, or else in the one for temporary files.
pub fn simulated_folder() -> PathBuf {
    std::env::var_os("XDG_RUNTIME_DIR")
        .filter(|folder| !folder.is_empty())
        .map_or_else(std::env::temp_dir, PathBuf::from)
        .join("crepitus")
}

/// The simulated devices that are offered in a folder, by name. A folder that
/// is not there offers none.
pub fn simulated_devices(folder: &Path) -> Vec<Device> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut devices: Vec<_> = entries
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()))
        // Follows the link: where the pty has gone, there is nothing.
        .filter(|entry| entry.path().exists())
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
        assert!(is_ours(&usb(VENDOR_ID, Some("Crepitus"))));
        assert!(is_ours(&usb(VENDOR_ID, Some("crepitus_comms"))));
        assert!(!is_ours(&usb(VENDOR_ID, Some("Blinky"))));
        assert!(!is_ours(&usb(VENDOR_ID, None)));
        assert!(!is_ours(&usb(1, Some("Crepitus"))));
    }

    #[test]
    fn the_system_is_asked_without_a_panic() {
        usb_devices().unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_whose_target_exists_are_devices() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(simulated_devices(&folder.path().join("none")), []);
        let target = folder.path().join("file");
        fs::write(&target, "").unwrap();
        symlink(&target, folder.path().join("knee")).unwrap();
        symlink(&target, folder.path().join("hip")).unwrap();
        symlink(folder.path().join("gone"), folder.path().join("stale")).unwrap();
        let names: Vec<_> = simulated_devices(folder.path())
            .into_iter()
            .map(|device| device.kind)
            .collect();
        let simulated = |name: &str| DeviceKind::Simulated { name: name.into() };
        assert_eq!(names, [simulated("hip"), simulated("knee")]);
    }
}
