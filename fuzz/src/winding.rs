//! A motor's winding: enough of a motor for a current loop to be content.

use crepitus_device::drive::coil::CoilOutput;
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

/// Current of the coil at all of its supply, A, by the default parameters: 5 V over 1.8 Ω.
const COIL_A: f32 = 5.0 / 1.8;

/// The coil of the vibration actuator: what its duty drives through its resistance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CoilWinding {
    current_a: f32,
}

impl CoilWinding {
    pub(crate) fn current_a(self) -> f32 {
        self.current_a
    }

    /// Runs one tick.
    pub(crate) fn tick(&mut self, output: CoilOutput) {
        self.current_a = match output {
            CoilOutput::Asleep => 0.0,
            CoilOutput::Driven(duty) => duty * COIL_A,
        };
    }
}
