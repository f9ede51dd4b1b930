//! `crepitus serve-sim`: a simulated device as a serial port, or as a USB device, in real time.

#[cfg_attr(not(unix), path = "serve_sim/no_port.rs")]
mod port;
mod usbip;

use crate::failure::Failure;
use crate::output::to_stderr;
use clap::{Args, ValueEnum};
use crepitus_client::connection::emulated;
use crepitus_scene::Overrides;
use crepitus_scene::shipped;
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::{Start, VirtualDevice};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Device at the end of the cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// The device's code, compiled for this computer.
    Sim,
    /// The firmware's own images on emulated controllers, five to six times slower than real time.
    Emulated,
}

/// Serve a simulated device as a serial port or a USB device.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus serve-sim
  crepitus serve-sim --scene everything --name bench
  crepitus info --device bench
  crepitus serve-sim --usbip
  modprobe vhci-hcd && usbip attach -r 127.0.0.1 -b 1-1
  crepitus serve-sim --usbip --device emulated

A simulated device as a serial port that any program can open, in real time, until Ctrl-C. \
`crepitus devices` lists it.

With --usbip it is a USB device instead, for the system's own drivers: once it is attached, as root, it \
is /dev/ttyACM0. USB/IP has no authentication: any program that reaches the port can use the device.")]
pub(crate) struct Arguments {
    /// The scene that sets its leg and parameters.
    #[arg(long, value_name = "SCENE", default_value = "passive-examination")]
    scene: PathBuf,

    /// Device to serve.
    #[arg(long, value_name = "KIND", default_value = "sim")]
    device: Kind,

    /// Name of the device, for --device of the other commands.
    #[arg(long, value_name = "NAME", default_value = "sim-1")]
    name: String,

    /// Offer it as a USB device over USB/IP, at this address [default: 127.0.0.1:3240].
    #[arg(
        long,
        value_name = "ADDR:PORT",
        num_args = 0..=1,
        default_missing_value = "127.0.0.1:3240",
        value_parser = usbip::address,
        conflicts_with = "name"
    )]
    usbip: Option<SocketAddr>,
}

/// Serves until Ctrl-C.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if arguments.usbip.is_none() {
        port::check(&arguments.name)?;
    }
    let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
    let mut device: Box<dyn CabledDevice> = match arguments.device {
        Kind::Sim => {
            // A device counts its starts. Without that a recording that goes on with another process
            // could begin at the very tick of the first one, and be taken for the same samples twice.
            let [starts, ..] = std::process::id().to_le_bytes();
            let start = Start {
                starts: starts.into(),
                ..Start::default()
            };
            Box::new(VirtualDevice::of(&scene, &start).map_err(Failure::input)?)
        }
        Kind::Emulated => {
            let on_build = || to_stderr("building firmware, if it is not up to date");
            emulated(&scene, on_build).map_err(Failure::input)?
        }
    };
    match arguments.usbip {
        Some(address) => usbip::serve(&scene.title, address, as_json, |server| {
            let before = device.now();
            let events = device.serve(server);
            (events, device.now() - before)
        }),
        None => port::serve(&mut *device, &scene.title, &arguments.name, as_json),
    }
}
