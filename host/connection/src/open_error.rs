//! Why a device cannot be opened.

use crepitus_board::VirtualError;
use crepitus_client::TransportError;
use crepitus_client::discovery::DiscoveryError;
use crepitus_emulator::on_target::NoTarget;
use crepitus_scene::SceneError;

/// Why a device cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The ports of this computer cannot be listed.
    #[error(transparent)]
    Discovery(DiscoveryError),
    /// There is none.
    #[error("no device is attached: plug one in, or use a simulated one with `--device sim`")]
    None,
    /// There are several.
    #[error("several devices are attached: choose one with `--device`: {}", ports.join(", "))]
    Several {
        /// Their ports.
        ports: Vec<String>,
    },
    /// No device of this name is served.
    #[error(
        "unknown device {name:?}: expected a port, `sim`, `emulated`, or a name from `crepitus devices`; \
         `crepitus serve-sim --name {name}` starts a simulated device of this name"
    )]
    Unknown {
        /// The name.
        name: String,
    },
    /// The program that served it has ended.
    #[error(
        "{port}: no program serves this simulated device any more; `crepitus serve-sim` starts one"
    )]
    Stale {
        /// The port.
        port: String,
    },
    /// The port.
    #[error(transparent)]
    Transport(TransportError),
    /// The scene of a simulated device.
    #[error(transparent)]
    Scene(SceneError),
    /// The simulated device.
    #[error(transparent)]
    Simulated(VirtualError),
    /// The emulated device.
    #[error(transparent)]
    Emulated(NoTarget),
}
