//! Description of a fault: the columns of the table.

use super::Fault;

crepitus_model::named! {
    /// Controller that detects a fault.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Detector {
        /// The drive controller.
        Drive => "drive",
        /// The comms controller.
        Comms => "comms",
    }
}

/// Description of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultSpec {
    /// The fault.
    pub fault: Fault,
    /// Name.
    pub name: &'static str,
    /// Cause.
    pub cause: &'static str,
    /// Controller that detects it.
    pub detector: Detector,
    /// Detection criterion.
    pub detection: &'static str,
    /// Reaction.
    pub reaction: &'static str,
    /// Ticks of the drive (50 µs) from the cause until the bridge floats; `None`
    /// if it floats already.
    pub within_ticks: Option<u32>,
    /// Remedy.
    pub clear: &'static str,
}
