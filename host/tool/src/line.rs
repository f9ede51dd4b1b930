//! The device that a person means, and the line to it.

use crate::cli::DeviceArguments;
use crate::failure::Failure;
use crate::shipped;
use crate::simulated::Simulated;
use crepitus_client::discovery::{self, Device, DeviceKind};
use crepitus_client::{Client, Error, Management, Serial, Transport, TransportError};
use crepitus_protocol::ValueError;
use crepitus_protocol::host::Refusal;
use crepitus_scene::Overrides;
use std::time::Duration;

/// The name of the device that lives for one command.
const SIMULATED: &str = "sim";

/// A serial port, or a simulated device in this process.
pub(crate) enum Line {
    Serial(Serial),
    Simulated(Box<Simulated>),
}

/// Opens the line to the device that the arguments name.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Line, Failure> {
    match arguments.device.as_deref() {
        Some(SIMULATED) => {
            let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
            let device = Simulated::of(&scene).map_err(Failure::input)?;
            Ok(Line::Simulated(Box::new(device)))
        }
        Some(name) => Ok(Line::Serial(serial(&port(name)?)?)),
        None => Ok(Line::Serial(serial(&the_only_one()?)?)),
    }
}

/// Opens the line and finds out who is there.
pub(crate) fn connect(arguments: &DeviceArguments) -> Result<Client<Line>, Failure> {
    Client::connect(open(arguments)?).map_err(failure)
}

/// Opens the line to a device of any version.
pub(crate) fn manage(arguments: &DeviceArguments) -> Result<Management<Line>, Failure> {
    Ok(Management::new(open(arguments)?))
}

/// A refusal by the device is failed work (exit code 1); values outside its
/// rules and unknown parameters are bad input (2).
pub(crate) fn failure(error: Error) -> Failure {
    let told = error.to_string();
    let is_input = match error {
        Error::UnknownParameter { .. } => true,
        Error::Refused(refused) => match refused.refusal {
            Refusal::Values(ValueError::NeedsDisarmed { .. }) => false,
            Refusal::Values(_) => true,
            _ => false,
        },
        _ => false,
    };
    if is_input {
        Failure::Input(told)
    } else {
        Failure::Work(told)
    }
}

fn serial(port: &str) -> Result<Serial, Failure> {
    Serial::open(port).map_err(|error| Failure::Input(error.to_string()))
}

/// The port of a name: itself, or that of a simulated device.
fn port(name: &str) -> Result<String, Failure> {
    if name.contains(['/', '\\']) || name.to_ascii_uppercase().starts_with("COM") {
        return Ok(name.to_owned());
    }
    let offered = discovery::simulated_devices(&discovery::simulated_folder());
    let found = offered
        .into_iter()
        .find(|device| matches!(&device.kind, DeviceKind::Simulated { name: its } if its == name));
    found.map(|device| device.port).ok_or_else(|| {
        Failure::Input(format!(
            "there is no simulated device {name:?}: `crepitus serve-sim --name {name}` offers one, \
             `crepitus devices` lists what there is, and `--device sim` is one that lives for this \
             command"
        ))
    })
}

fn the_only_one() -> Result<String, Failure> {
    let devices = discovery::devices().map_err(Failure::input)?;
    match devices.as_slice() {
        [Device { port, .. }] => Ok(port.clone()),
        [] => Err(Failure::Input(
            "no device is attached: plug one in, or try a simulated one with `--device sim`"
                .to_owned(),
        )),
        several => {
            let ports: Vec<_> = several.iter().map(|device| device.port.as_str()).collect();
            Err(Failure::Input(format!(
                "there are several devices: choose one with `--device`: {}",
                ports.join(", ")
            )))
        }
    }
}

impl Transport for Line {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        match self {
            Self::Serial(serial) => serial.send(bytes),
            Self::Simulated(device) => device.send(bytes),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        match self {
            Self::Serial(serial) => serial.receive(buffer, patience),
            Self::Simulated(device) => device.receive(buffer, patience),
        }
    }

    fn now(&self) -> Duration {
        match self {
            Self::Serial(serial) => serial.now(),
            Self::Simulated(device) => device.now(),
        }
    }

    fn wait(&mut self, time: Duration) {
        match self {
            Self::Serial(serial) => serial.wait(time),
            Self::Simulated(device) => device.wait(time),
        }
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        match self {
            Self::Serial(serial) => serial.reopen(),
            Self::Simulated(device) => device.reopen(),
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Serial(serial) => serial.name(),
            Self::Simulated(device) => device.name(),
        }
    }
}
