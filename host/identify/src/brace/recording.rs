//! Input of the identification: samples of a device, and the weight.

use crepitus_plant::effects::limb::STANDARD_GRAVITY;

/// A sample of a recorded device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Tick of the drive.
    pub tick: u64,
    /// Count of the encoder.
    pub count: i32,
    /// Measured current of the motor, A; positive drives towards growing angle. `None` where
    /// it was not measured: the bridge was open.
    pub current_a: Option<f32>,
    /// Whether the drive has rejected the encoder's count.
    pub is_lost: bool,
}

/// Samples of one recording, with the constants of the device.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Samples in the order of their ticks; ticks may be missing.
    pub samples: Vec<Sample>,
    /// Length of a tick, s.
    pub tick_s: f64,
    /// Joint angle per encoder count, rad.
    pub rad_per_count: f64,
    /// Torque constant of the motor in the device's settings, N·m/A.
    pub torque_constant_nm_per_a: f64,
    /// Turns of the motor for one of the joint.
    pub gear_ratio: f64,
}

impl Recording {
    /// Returns the torque at the joint per ampere without losses, N·m/A.
    pub(crate) fn nm_per_a(&self) -> f64 {
        self.torque_constant_nm_per_a * self.gear_ratio
    }
}

/// An independently measured value with its relative standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value, in the unit of its field.
    pub value: f64,
    /// Standard deviation over the value.
    pub deviation: f64,
}

/// The weight in the cuffs: a bar, a dummy leg, a sandbag on a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Moment about the axis when it is horizontal, N·m: mass times g times lever.
    pub moment_nm: Measured,
    /// Inertia about the axis, kg·m².
    pub inertia_kg_m2: Measured,
}

impl Weight {
    /// Returns a weight of `mass_kg` with its centre `lever_m` from the axis. Without
    /// `inertia_kg_m2` the mass is a point, with m·l². `deviation` is the relative standard
    /// deviation of the moment; that of the inertia is twice as large, since the lever counts
    /// twice.
    pub fn new(mass_kg: f64, lever_m: f64, inertia_kg_m2: Option<f64>, deviation: f64) -> Self {
        let inertia = inertia_kg_m2.unwrap_or(mass_kg * lever_m * lever_m);
        Self {
            moment_nm: Measured {
                value: mass_kg * STANDARD_GRAVITY * lever_m,
                deviation,
            },
            inertia_kg_m2: Measured {
                value: inertia,
                deviation: 2.0 * deviation,
            },
        }
    }
}
