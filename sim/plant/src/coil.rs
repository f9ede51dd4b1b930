//! Bridge of the coil of the actuator on the shell.

/// Bridge of the coil of the actuator on the shell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coil {
    /// The bridge holds this voltage, V.
    Driven(f64),
    /// The bridge sleeps.
    #[default]
    Open,
}
