//! The device as a serial port: a pty with a name.

use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crepitus_client::connection::{Clock, is_port};
use crepitus_client::discovery::{ServedName, user_folder};
use crepitus_files::json_path;
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::usb::pty::Pty;
use serde_json::json;
use std::fs;
use std::io::ErrorKind;
use std::thread::sleep;
use std::time::Duration;

/// Ticks between two exchanges with the port.
const EXCHANGE_TICKS: u64 = 20;

/// The longest name; that of the file of its lock is longer.
const MOST_NAME_BYTES: usize = 200;

/// Rejects a name that cannot be one of a device.
pub(super) fn check(name: &str) -> Result<(), Failure> {
    let is_plain = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    if name.len() > MOST_NAME_BYTES {
        return Err(Failure::Input(format!(
            "--name {name:?}: expected at most {MOST_NAME_BYTES} bytes, got {}",
            name.len()
        )));
    }
    let is_reserved = ["", "sim", "emulated", "shared"].contains(&name) || is_port(name);
    // `--device` would take a hyphen at the beginning for an option's.
    if is_reserved || name.starts_with('-') || !name.chars().all(is_plain) {
        return Err(Failure::Input(format!(
            "--name {name:?}: expected letters, digits, `_` and, not at the beginning, `-`; and not `sim`, `emulated`, \
             `shared` or a port of Windows such as `COM3`, which `--device` takes for something else"
        )));
    }
    Ok(())
}

/// Serves the device under this name until Ctrl-C.
pub(super) fn serve(
    device: &mut dyn CabledDevice,
    title: &str,
    name: &str,
    as_json: bool,
) -> Result<(), Failure> {
    let served = ServedName::take(name).map_err(|e| match e.kind() {
        ErrorKind::AddrInUse => Failure::Input(format!(
            "--name {name:?}: another program serves a device of this name; choose another one"
        )),
        _ => Failure::at(&user_folder(), "the folder of simulated devices", &e),
    })?;
    let link = served.link();
    let made = Pty::new(Some(link)).and_then(|pty| {
        served.publish(&fs::read_link(link)?)?;
        Ok(pty)
    });
    let mut pty = made.map_err(|e| Failure::at(link, "cannot be created", &e))?;
    interrupt::listen();
    if as_json {
        print_json(&json!({ "port": json_path(link), "name": name, "scene": title }))?;
    } else {
        print(&format!(
            "{title} is served as {}\ntry `crepitus info --device {name}`; Ctrl-C stops it\n",
            link.display(),
        ))?;
    }
    let mut clock = Clock::new();
    while !interrupt::requested() {
        let end = device.now() + clock.due_ticks();
        while device.now() < end && !interrupt::requested() {
            device.tick();
            if device.now().is_multiple_of(EXCHANGE_TICKS) {
                // After a restart of comms the cable is still connected. Until it answers, each try takes
                // some 10 ms of device time.
                if device.host().is_none() {
                    let _ = device.plug_in();
                }
                if let Some(host) = device.host() {
                    pty.exchange(host)
                        .map_err(|e| Failure::at(link, "the port failed", &e))?;
                }
            }
        }
        sleep(Duration::from_millis(1));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_that_device_takes() {
        for name in ["knee", "left-2", "_", "a-", "\u{e9}"] {
            assert!(check(name).is_ok(), "{name}");
        }
        assert!(check(&"\u{e9}".repeat(100)).is_ok());
        let long = "\u{e9}".repeat(101);
        for (name, part) in [
            (long.as_str(), "at most 200 bytes, got 202"),
            ("-x", "not at the beginning"),
            ("-", "not at the beginning"),
            ("", "expected letters"),
            ("a/b", "expected letters"),
            ("sim", "not `sim`"),
            ("com3", "`COM3`"),
        ] {
            let text = check(name).unwrap_err().into_text();
            assert!(text.contains(part), "{name}: {text}");
        }
    }
}
