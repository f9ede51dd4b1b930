//! The coil of the vibration actuator with its driver, its sensor and its supply, and
//! their faults.

use super::sensors::CurrentSensor;
use crepitus_plant::effects::reaction_mass;
use crepitus_plant::plant::Coil;
use crepitus_scene::Scene;

/// Range of the sensor, A: its amplifier's output ends at ground and at 3.3 V.
pub const COIL_RANGE_A: f64 = 3.3;

/// Possible faults of the coil.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoilFaults {
    /// Reading of shunt and amplifier.
    pub sensor: CurrentSensor,
    /// The driver pulls its nFAULT low, or its wire is broken.
    pub driver_fails: bool,
    /// A wire is interrupted.
    pub is_open: bool,
    /// This resistance lies across the driver's outputs, Ω.
    pub short_ohm: Option<f64>,
}

/// Driver and supply.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoilDriver {
    pub(super) faults: CoilFaults,
    supply_v: f64,
    /// Commanded; `None`: asleep.
    duty: Option<f64>,
}

impl CoilDriver {
    pub(super) fn new(scene: &Scene) -> Self {
        let actuator = reaction_mass::as_settings(&scene.given(&reaction_mass::EFFECT));
        Self {
            faults: CoilFaults::default(),
            supply_v: actuator.supply_v,
            duty: None,
        }
    }

    pub(super) fn set(&mut self, duty: Option<f64>) {
        self.duty = duty;
    }

    /// Voltage at its outputs; `None` where they are open.
    pub(super) fn volts(&self, is_supplied: bool) -> Option<f64> {
        let duty = self.duty.filter(|_| is_supplied)?;
        Some(duty.clamp(-1.0, 1.0) * self.supply_v)
    }

    /// Effect of the driver on the coil.
    pub(super) fn terminals(&self, is_supplied: bool) -> Coil {
        match self.volts(is_supplied) {
            Some(volts) if !self.faults.is_open => Coil::Driven(volts),
            _ => Coil::Open,
        }
    }

    /// Reading of the sensor, A, for the coil's current.
    pub(super) fn shows_a(&self, coil_a: f64, is_supplied: bool) -> f64 {
        let beside_a = (self.faults.short_ohm.zip(self.volts(is_supplied)))
            .map_or(0.0, |(ohm, volts)| volts / ohm);
        let shown_a = self.faults.sensor.shows(coil_a + beside_a);
        shown_a.clamp(-COIL_RANGE_A, COIL_RANGE_A)
    }
}
