//! Errors of starting the panel.

use crepitus_studies::experiment::StoreError;
use std::net::IpAddr;
use std::path::PathBuf;

/// Command that lists the addresses of this computer.
const LIST_ADDRESSES: &str = if cfg!(windows) {
    "ipconfig"
} else {
    "ip address"
};

/// Errors of starting.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PanelError {
    /// This computer does not have the address.
    #[error(
        "--lan {address}: this computer has no such address: `{}` lists those that it has",
        LIST_ADDRESSES
    )]
    Address {
        /// Address.
        address: IpAddr,
    },
    /// The port cannot be used.
    #[error(
        "port {port} of {address} cannot be used: {source}; choose another one with --port (0 is any free one)"
    )]
    Port {
        /// Address.
        address: IpAddr,
        /// Port.
        port: u16,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The folder with protocols is missing.
    #[error(
        "--experiments {}: expected a folder with protocols: make it, then write one with \
        `crepitus experiment new threshold {}`",
        .folder.display(), .folder.join("torque.toml").display()
    )]
    NoProtocols {
        /// Folder.
        folder: PathBuf,
    },
    /// The study in that folder cannot be opened or written.
    #[error("--experiments: {0}")]
    Study(StoreError),
    /// The system has no random numbers, or no threads.
    #[error("the panel cannot start: {0}")]
    System(String),
    /// Built without TLS.
    #[error(
        "--lan needs TLS, and this crepitus was built without it: build it with `--features lan`"
    )]
    NoTls,
}
