//! Connections: which device the arguments name, and its transport.

use crate::cli::DeviceArguments;
use crate::failure::Failure;
use crate::simulated::Simulated;
use crepitus_client::discovery::{self, Device, DeviceKind};
use crepitus_client::{Client, Error, Management, RequestKind, Transport, TransportError};
use crepitus_protocol::host::Refusal;
use crepitus_protocol::{Session, ValueError};
use crepitus_scene::Overrides;
use crepitus_scene::shipped;
use crepitus_sharing::{Program, Shared};
use std::path::Path;
use std::time::Duration;

/// The names of a simulated, and of an emulated device for one command.
const SIMULATED: &str = "sim";
const EMULATED: &str = "emulated";

/// A device at a serial port, shared with other programs, or a simulated one in
/// this process.
pub(crate) enum Line {
    Shared(Box<Shared>),
    Simulated(Box<Simulated>),
}

impl Line {
    /// The programs that are connected to the device; none to one in this
    /// process. If they cannot be told, there are none to name.
    pub(crate) fn programs(&mut self) -> Vec<Program> {
        match self {
            Self::Shared(shared) => shared.programs().unwrap_or_default(),
            Self::Simulated(_) => Vec::new(),
        }
    }

    fn transport(&self) -> &dyn Transport {
        match self {
            Self::Shared(shared) => &**shared,
            Self::Simulated(simulated) => &**simulated,
        }
    }

    fn transport_mut(&mut self) -> &mut dyn Transport {
        match self {
            Self::Shared(shared) => &mut **shared,
            Self::Simulated(simulated) => &mut **simulated,
        }
    }
}

/// Opens the connection to the device that the arguments name.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Line, Failure> {
    match arguments.device.as_deref() {
        Some(SIMULATED) => {
            let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
            let device = Simulated::of(&scene).map_err(Failure::input)?;
            Ok(Line::Simulated(Box::new(device)))
        }
        Some(EMULATED) => {
            let scene = shipped::scene(&arguments.scene, &Overrides::default())?;
            let device = Simulated::emulated(&scene).map_err(Failure::input)?;
            Ok(Line::Simulated(Box::new(device)))
        }
        Some(name) => serial(&port(name)?),
        None => serial(&only_port()?),
    }
}

/// The same; a device in this process is not faster than real time.
pub(crate) fn open_in_real_time(arguments: &DeviceArguments) -> Result<Line, Failure> {
    Ok(match open(arguments)? {
        Line::Simulated(simulated) => Line::Simulated(Box::new(simulated.in_real_time())),
        shared @ Line::Shared(_) => shared,
    })
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

/// [`failure`]; a device that another program has armed is told with that
/// program's name.
pub(crate) fn failure_with(client: &mut Client<Line>, error: Error) -> Failure {
    let Error::Refused(refused) = &error else {
        return failure(error);
    };
    let Refusal::Leased { by } = refused.refusal else {
        return failure(error);
    };
    let request = refused.request;
    let Some(other) = holder(client, by) else {
        return failure(error);
    };
    let way_out = if request == RequestKind::Disarm {
        "`crepitus disarm --force` or `crepitus stop` turns its torque off"
    } else {
        "end that program, or run `crepitus stop`"
    };
    Failure::Work(format!(
        "`{request}` is rejected: {} has armed the device; {way_out}",
        named(&other)
    ))
}

/// The program of a session, if it is connected to the same device.
pub(crate) fn holder(client: &mut Client<Line>, session: Session) -> Option<Program> {
    let programs = client.transport_mut().programs();
    programs.into_iter().find(|p| p.session == Some(session))
}

/// A program for people.
pub(crate) fn named(program: &Program) -> String {
    format!("`{}`, process {},", program.name, program.pid)
}

fn serial(port: &str) -> Result<Line, Failure> {
    if discovery::is_stale(Path::new(port)) {
        return Err(Failure::Input(format!(
            "{port}: no program serves this simulated device any more; \
             `crepitus serve-sim` starts one"
        )));
    }
    Shared::open(port, &command_line())
        .map(|shared| Line::Shared(Box::new(shared)))
        .map_err(Failure::input)
}

/// What the user typed, by which other programs name this one.
fn command_line() -> String {
    let arguments = std::env::args_os().skip(1);
    let words = arguments.map(|argument| argument.to_string_lossy().into_owned());
    ["crepitus".to_owned()]
        .into_iter()
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
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
            "unknown device {name:?}: expected a port, `sim`, `emulated`, or a name from `crepitus devices`; \
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
        self.transport_mut().send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> Result<usize, TransportError> {
        self.transport_mut().receive(buffer, timeout)
    }

    fn now(&self) -> Duration {
        self.transport().now()
    }

    fn wait(&mut self, time: Duration) {
        self.transport_mut().wait(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.transport_mut().reopen()
    }

    fn name(&self) -> String {
        self.transport().name()
    }
}
