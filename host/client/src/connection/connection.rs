//! Transport to a device by its name.

use crate::connection::open_error::OpenError;
use crate::connection::simulated::Simulated;
use crate::discovery::{self, Device, DeviceKind};
use crate::sharing::{Program, Shared};
use crate::{Serial, Transport, TransportError};
use crepitus_scene::{Scene, SceneError};
use crepitus_virtual_device::HandInput;
use std::path::Path;
use std::time::Duration;

/// Names of a simulated, and of an emulated device in this process.
const SIMULATED: &str = "sim";
const EMULATED: &str = "emulated";

/// A device at a serial port, shared with other programs, or a simulated one in
/// this process.
pub enum Connection {
    /// Device at a port.
    Shared(Box<Shared>),
    /// Device at a port that cannot be shared, for a stop.
    Alone(Box<Serial>),
    /// Device in this process.
    Simulated(Box<Simulated>),
}

impl Connection {
    /// Opens the connection to the device of this name; without one, to the only
    /// device that is attached. `program` is how other programs at the same device
    /// name this one; `scene` is called for a device in this process.
    ///
    /// # Errors
    /// [`OpenError`].
    pub fn open(
        name: Option<&str>,
        program: &str,
        scene: impl FnOnce() -> Result<Scene, SceneError>,
    ) -> Result<Self, OpenError> {
        let simulated = match name {
            Some(SIMULATED) => {
                let scene = scene().map_err(OpenError::Scene)?;
                Simulated::of(&scene).map_err(OpenError::Simulated)?
            }
            Some(EMULATED) => {
                let scene = scene().map_err(OpenError::Scene)?;
                Simulated::emulated(&scene).map_err(OpenError::Emulated)?
            }
            name => return serial(&port_of(name)?, program),
        };
        Ok(Self::Simulated(Box::new(simulated)))
    }

    /// Opens a port for what has to work even where programs cannot meet, as with a full disk: a stop. Then
    /// it is opened without serving it, which fails if another program has it.
    ///
    /// # Errors
    /// As of [`Self::open`].
    pub fn open_to_stop(name: Option<&str>, program: &str) -> Result<Self, OpenError> {
        let port = port_of(name)?;
        serial(&port, program).or_else(|error| match error {
            OpenError::Transport(TransportError::Unshared { .. }) => Serial::open(&port)
                .map(|serial| Self::Alone(Box::new(serial)))
                .map_err(OpenError::Transport),
            error => Err(error),
        })
    }

    /// The ports of all devices that are attached.
    ///
    /// # Errors
    /// [`OpenError::Discovery`].
    pub fn attached() -> Result<Vec<String>, OpenError> {
        let devices = discovery::devices().map_err(OpenError::Discovery)?;
        Ok(devices.into_iter().map(|device| device.port).collect())
    }

    /// Limits a device in this process to real time; a device at a port is unchanged.
    pub fn in_real_time(self) -> Self {
        match self {
            Self::Simulated(simulated) => Self::Simulated(Box::new(simulated.in_real_time())),
            at_a_port => at_a_port,
        }
    }

    /// Lets a device in this process and in real time make up for the time since the last call; others run on by themselves.
    pub fn run_on(&mut self) {
        if let Self::Simulated(simulated) = self {
            simulated.run_on();
        }
    }

    /// Input of a hand that moves the leg of a device in this process.
    pub fn hand(&self) -> Option<HandInput> {
        match self {
            Self::Simulated(simulated) => simulated.hand(),
            Self::Shared(_) | Self::Alone(_) => None,
        }
    }

    /// Returns the programs that are connected to the device. Empty for a device in this process,
    /// and if the list cannot be read.
    pub fn programs(&mut self) -> Vec<Program> {
        match self {
            Self::Shared(shared) => shared.programs().unwrap_or_default(),
            Self::Alone(_) | Self::Simulated(_) => Vec::new(),
        }
    }

    /// The program through which this one is connected to a port, if it does not respond. Asks it.
    pub fn hanging(&mut self) -> Option<TransportError> {
        match self {
            Self::Shared(shared) => shared.hanging(),
            Self::Alone(_) | Self::Simulated(_) => None,
        }
    }

    fn transport(&self) -> &dyn Transport {
        match self {
            Self::Shared(shared) => &**shared,
            Self::Alone(serial) => &**serial,
            Self::Simulated(simulated) => &**simulated,
        }
    }

    fn transport_mut(&mut self) -> &mut dyn Transport {
        match self {
            Self::Shared(shared) => &mut **shared,
            Self::Alone(serial) => &mut **serial,
            Self::Simulated(simulated) => &mut **simulated,
        }
    }
}

fn serial(port: &str, program: &str) -> Result<Connection, OpenError> {
    if discovery::is_stale(Path::new(port)) {
        return Err(OpenError::Stale {
            port: port.to_owned(),
        });
    }
    Shared::open(port, program)
        .map(|shared| Connection::Shared(Box::new(shared)))
        .map_err(OpenError::Transport)
}

/// Returns whether a name is that of a device in this process.
pub fn is_in_this_process(name: &str) -> bool {
    [SIMULATED, EMULATED].contains(&name)
}

/// Returns whether a name is a port, and not the name of a simulated device: a path, or `COM` with a
/// number.
pub fn is_port(name: &str) -> bool {
    let of_windows = name
        .get(..3)
        .filter(|start| start.eq_ignore_ascii_case("COM"))
        .and_then(|_| name.get(3..));
    name.contains(['/', '\\']) || of_windows.is_some_and(|number| number.parse::<u32>().is_ok())
}

/// Resolves a name to a port: a port stands for itself, another name for the simulated device of
/// `offered` that is served under it.
fn port(name: &str, offered: impl FnOnce() -> Vec<Device>) -> Result<String, OpenError> {
    if is_port(name) {
        return Ok(name.to_owned());
    }
    let found = offered()
        .into_iter()
        .find(|device| matches!(&device.kind, DeviceKind::Simulated { name: its } if its == name));
    found
        .map(|device| device.port)
        .ok_or_else(|| OpenError::Unknown {
            name: name.to_owned(),
        })
}

/// The port of this name, or of the only device.
fn port_of(name: Option<&str>) -> Result<String, OpenError> {
    match name {
        Some(name) => port(name, simulated_devices),
        None => only_port(&discovery::devices().map_err(OpenError::Discovery)?),
    }
}

fn simulated_devices() -> Vec<Device> {
    discovery::simulated_devices(&discovery::simulated_folder())
}

/// Returns the port of the only device.
fn only_port(devices: &[Device]) -> Result<String, OpenError> {
    match devices {
        [Device { port, .. }] => Ok(port.clone()),
        [] => Err(OpenError::None),
        several => Err(OpenError::Several {
            ports: several.iter().map(|device| device.port.clone()).collect(),
        }),
    }
}

impl Transport for Connection {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Client, Error, Event};
    use crepitus_scene::{Overrides, shipped};

    fn scene() -> Result<Scene, SceneError> {
        shipped::scene(Path::new("passive-examination"), &Overrides::default())
    }

    fn served(names: &[&str]) -> Vec<Device> {
        let device = |name: &&str| Device {
            port: format!("/run/crepitus/{name}"),
            kind: DeviceKind::Simulated {
                name: (*name).to_owned(),
            },
        };
        names.iter().map(device).collect()
    }

    #[test]
    fn a_name_is_that_of_one_device() {
        let offered = || served(&["knee", "knee-2", "left"]);
        for name in ["knee", "knee-2", "left"] {
            let port = port(name, offered).unwrap();
            assert_eq!(port, format!("/run/crepitus/{name}"));
        }
        for name in ["kne", "Knee", ""] {
            let error = port(name, offered).unwrap_err();
            assert!(matches!(error, OpenError::Unknown { .. }), "{error}");
        }
    }

    #[test]
    fn a_port_stands_for_itself() {
        let none = || -> Vec<Device> { panic!("for a port") };
        for name in ["/dev/ttyACM0", "COM3", "com12", r"\\.\COM10"] {
            assert_eq!(port(name, none).unwrap(), name);
        }
        // Names of simulated devices.
        let names = ["comms", "COM", "compass", "com3x"];
        for name in names {
            let port = port(name, || served(&names)).unwrap();
            assert_eq!(port, format!("/run/crepitus/{name}"));
        }
    }

    #[test]
    fn without_a_name_there_has_to_be_one_device() {
        assert_eq!(only_port(&served(&["knee"])).unwrap(), "/run/crepitus/knee");
        assert!(matches!(only_port(&[]), Err(OpenError::None)));
        let several = only_port(&served(&["left", "right"]))
            .unwrap_err()
            .to_string();
        assert!(
            several.contains("/run/crepitus/left, /run/crepitus/right"),
            "{several}"
        );
    }

    #[test]
    fn a_simulated_device_answers() {
        let connection = Connection::open(Some("sim"), "a test", scene).unwrap();
        let client = Client::connect(connection).unwrap();
        assert_eq!(client.port(), "a simulated device");
    }

    #[test]
    fn crepitus_stays_within_its_static_torque() -> Result<(), Error> {
        let mut client = Client::connect(Connection::open(Some("sim"), "a test", scene).unwrap())?;
        client.zero()?;
        client.arm()?;
        client.subscribe()?;
        while client.now() < Duration::from_secs(2) {
            if let Some(Event::Block(samples)) = client.pump(Duration::from_millis(20))? {
                let mut torques = samples.block.samples.iter().map(|s| s.model_torque_nm);
                assert!(torques.all(|nm| nm.abs() < 0.401));
            }
        }
        client.disarm()
    }

    #[test]
    fn the_readme_shows_that_test() {
        let (readme, here) = (
            include_str!("../../../../README.md"),
            include_str!("connection.rs"),
        );
        let shown: Vec<&str> = readme
            .split("```rust\n")
            .skip(1)
            .filter_map(|part| part.split("```").next())
            .collect();
        assert_eq!(shown.len(), 1);
        for line in shown[0].lines().map(str::trim) {
            assert!(here.lines().any(|own| own.trim() == line), "{line}");
        }
    }

    #[test]
    fn the_scene_of_a_port_is_not_read() {
        let no_scene = || -> Result<Scene, SceneError> { panic!("for a port") };
        let error = Connection::open(Some("/no/such/port"), "a test", no_scene).err();
        assert!(matches!(error, Some(OpenError::Transport(_))), "{error:?}");
        let error = Connection::open(Some("nobody-serves-this"), "a test", no_scene).err();
        assert!(
            matches!(error, Some(OpenError::Unknown { .. })),
            "{error:?}"
        );
    }

    #[test]
    fn a_scene_that_no_device_has_is_refused() {
        let physical = || shipped::scene(Path::new("knee-pass-physical"), &Overrides::default());
        let error = Connection::open(Some("sim"), "a test", physical).err();
        assert!(matches!(error, Some(OpenError::Simulated(_))), "{error:?}");
        let none = || shipped::scene(Path::new("no-such-scene"), &Overrides::default());
        let error = Connection::open(Some("sim"), "a test", none).err();
        assert!(matches!(error, Some(OpenError::Scene(_))), "{error:?}");
    }
}
