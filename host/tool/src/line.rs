//! Connections: which device the arguments name, and its transport.

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

/// The name of the simulated device for one command.
const SIMULATED: &str = "sim";

/// A serial port, or a simulated device in this process.
pub(crate) struct Line(Box<dyn Transport>);

impl Line {
    pub(crate) fn new(transport: impl Transport + 'static) -> Self {
        Self(Box::new(transport))
    }
}

/// Opens the connection to the device that the arguments name.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Line, Failure> {
    match arguments.device.as_deref() {
        Some(SIMULATED) => {
            let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
            let device = Simulated::of(&scene).map_err(Failure::input)?;
            Ok(Line::new(device))
        }
        Some(name) => serial(&port(name)?),
        None => serial(&only_port()?),
    }
}

/// Opens the connection and performs the handshake.
pub(crate) fn connect(arguments: &DeviceArguments) -> Result<Client<Line>, Failure> {
    Client::connect(open(arguments)?).map_err(failure)
}

/// Opens the connection to a device of any version.
pub(crate) fn manage(arguments: &DeviceArguments) -> Result<Management<Line>, Failure> {
    Ok(Management::new(open(arguments)?))
}

/// A rejected request is failed work (exit code 1); invalid values and unknown
/// parameters are bad input (2).
pub(crate) fn failure(error: Error) -> Failure {
    let text = error.to_string();
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
        Failure::Input(text)
    } else {
        Failure::Work(text)
    }
}

fn serial(port: &str) -> Result<Line, Failure> {
    Serial::open(port).map(Line::new).map_err(Failure::input)
}

/// The port of a name: the name itself, or the port of a simulated device.
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
            "unknown device {name:?}: expected a port, `sim`, or a name from `crepitus devices`; \
             `crepitus serve-sim --name {name}` starts a simulated device of this name"
        ))
    })
}

fn only_port() -> Result<String, Failure> {
    let devices = discovery::devices().map_err(Failure::input)?;
    match devices.as_slice() {
        [Device { port, .. }] => Ok(port.clone()),
        [] => Err(Failure::Input(
            "no device is attached: plug one in, or use a simulated one with `--device sim`"
                .to_owned(),
        )),
        several => {
            let ports: Vec<_> = several.iter().map(|device| device.port.as_str()).collect();
            Err(Failure::Input(format!(
                "several devices are attached: choose one with `--device`: {}",
                ports.join(", ")
            )))
        }
    }
}

impl Transport for Line {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        self.0.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> Result<usize, TransportError> {
        self.0.receive(buffer, timeout)
    }

    fn now(&self) -> Duration {
        self.0.now()
    }

    fn wait(&mut self, time: Duration) {
        self.0.wait(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.0.reopen()
    }

    fn name(&self) -> String {
        self.0.name()
    }
}
