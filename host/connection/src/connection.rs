//! The transport of the device that a name means.

use crate::open_error::OpenError;
use crate::simulated::Simulated;
use crepitus_client::discovery::{self, Device, DeviceKind};
use crepitus_client::{Transport, TransportError};
use crepitus_scene::{Scene, SceneError};
use crepitus_sharing::{Program, Shared};
use std::path::Path;
use std::time::Duration;

/// The names of a simulated, and of an emulated device in this process.
const SIMULATED: &str = "sim";
const EMULATED: &str = "emulated";

/// A device at a serial port, shared with other programs, or a simulated one in
/// this process.
pub enum Connection {
    /// At a port.
    Shared(Box<Shared>),
    /// In this process.
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
            Some(name) => return serial(&port(name)?, program),
            None => return serial(&only_port()?, program),
        };
        Ok(Self::Simulated(Box::new(simulated)))
    }

    /// The same; a device in this process is not faster than real time.
    pub fn in_real_time(self) -> Self {
        match self {
            Self::Simulated(simulated) => Self::Simulated(Box::new(simulated.in_real_time())),
            shared @ Self::Shared(_) => shared,
        }
    }

    /// The programs that are connected to the device; none to one in this
    /// process. If they cannot be told, there are none to name.
    pub fn programs(&mut self) -> Vec<Program> {
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

/// The port of a name: the name itself, or the port of a simulated device.
fn port(name: &str) -> Result<String, OpenError> {
    if name.contains(['/', '\\']) || name.to_ascii_uppercase().starts_with("COM") {
        return Ok(name.to_owned());
    }
    let offered = discovery::simulated_devices(&discovery::simulated_folder());
    let found = offered
        .into_iter()
        .find(|device| matches!(&device.kind, DeviceKind::Simulated { name: its } if its == name));
    found
        .map(|device| device.port)
        .ok_or_else(|| OpenError::Unknown {
            name: name.to_owned(),
        })
}

fn only_port() -> Result<String, OpenError> {
    let devices = discovery::devices().map_err(OpenError::Discovery)?;
    match devices.as_slice() {
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
    use crepitus_client::Client;
    use crepitus_scene::{Overrides, shipped};

    fn scene() -> Result<Scene, SceneError> {
        shipped::scene(Path::new("passive-examination"), &Overrides::default())
    }

    #[test]
    fn a_simulated_device_answers() {
        let connection = Connection::open(Some("sim"), "a test", scene).unwrap();
        let client = Client::connect(connection).unwrap();
        assert_eq!(client.port(), "a simulated device");
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
