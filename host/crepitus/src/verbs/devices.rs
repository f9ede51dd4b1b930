//! `crepitus devices`.

use crate::failure::{Failure, print, print_json};
use clap::Args;
use crepitus_client::discovery::{self, DeviceKind};
use serde_json::json;

/// List attached and simulated devices.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  crepitus devices --json")]
pub(crate) struct Arguments {}

/// Lists the devices.
pub(crate) fn run(_: &Arguments, as_json: bool) -> Result<(), Failure> {
    let devices = discovery::devices().map_err(Failure::input)?;
    if as_json {
        let list: Vec<_> = devices
            .iter()
            .map(|device| match &device.kind {
                DeviceKind::Usb { serial_number } => {
                    json!({ "port": device.port, "kind": "usb", "serial": serial_number })
                }
                DeviceKind::Simulated { name } => {
                    json!({ "port": device.port, "kind": "simulated", "name": name })
                }
                _ => json!({ "port": device.port }),
            })
            .collect();
        return print_json(&list);
    }
    if devices.is_empty() {
        return print(
            "no device is attached\n\
             `crepitus serve-sim` starts a simulated one; `--device sim` is a simulated one for one command\n",
        );
    }
    let lines = devices.iter().map(|device| {
        let what = match &device.kind {
            DeviceKind::Usb {
                serial_number: Some(number),
            } => format!("on USB, serial {number}"),
            DeviceKind::Simulated { name } => format!("simulated: --device {name}"),
            _ => "on USB".to_owned(),
        };
        format!("{}  {what}\n", device.port)
    });
    print(&lines.collect::<String>())
}
