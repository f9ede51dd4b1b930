//! Errors of opening a device.

use crate::TransportError;
use crate::discovery::DiscoveryError;
use crepitus_emulator::on_target::NoTarget;
use crepitus_scene::SceneError;
use crepitus_virtual_device::VirtualError;

/// Reason why a device cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The ports of this computer cannot be listed.
    #[error(transparent)]
    Discovery(DiscoveryError),
    /// No device is attached.
    #[error("no device is attached: plug one in, or use a simulated one with `--device sim`")]
    None,
    /// Several devices are attached, and no name was given.
    #[error("several devices are attached: choose one with `--device`: {}", ports.join(", "))]
    Several {
        /// Their ports.
        ports: Vec<String>,
    },
    /// No device of this name is served.
    #[error(
        "unknown device {name:?}: expected a port, `sim`, `emulated`, or a name from `crepitus devices`; \
         `crepitus serve-sim --name NAME` starts a simulated device"
    )]
    Unknown {
        /// The name.
        name: String,
    },
    /// The program that served the simulated device has ended.
    #[error(
        "{port}: no program serves this simulated device any more; `crepitus serve-sim` starts one"
    )]
    Stale {
        /// Port of the simulated device.
        port: String,
    },
    /// The port cannot be opened.
    #[error(transparent)]
    Transport(TransportError),
    /// The scene of a simulated device is invalid.
    #[error(transparent)]
    Scene(SceneError),
    /// The simulated device cannot render the scene.
    #[error(transparent)]
    Simulated(VirtualError),
    /// No emulated device is available.
    #[error(transparent)]
    Emulated(NoTarget),
}
