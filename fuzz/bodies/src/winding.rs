//! A motor's winding: enough of a motor for a current loop to be content.

use crepitus_device::drive::motor::Bridge;

/// Resistance, Ω; V·s/rad at the joint; a tick over the inductance, 1/Ω; angle
/// of a count in a tick, rad/s. Those of the default parameters.
const RESISTANCE_OHM: f32 = 1.23;
const JOINT_CONSTANT: f32 = 3.3454;
const TICK_PER_INDUCTANCE: f32 = 0.147;
const COUNT_RAD_PER_S: f32 = 0.7135;

/// The winding.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Winding {
    current_a: f32,
}

impl Winding {
    pub(crate) fn current_a(self) -> f32 {
        self.current_a
    }

    /// Runs one tick, with a shaft that turns by this many counts.
    pub(crate) fn tick(&mut self, bridge: Bridge, turn: i8) {
        match bridge {
            Bridge::Float => self.current_a = 0.0,
            Bridge::Driven(volts) => {
                let emf_v = JOINT_CONSTANT * COUNT_RAD_PER_S * f32::from(turn);
                let over_v = volts - emf_v - RESISTANCE_OHM * self.current_a;
                self.current_a += TICK_PER_INDUCTANCE * over_v;
            }
        }
    }
}
