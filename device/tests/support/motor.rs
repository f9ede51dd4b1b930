//! A free shaft on a motor: enough of a plant for a drive to be armed.

use crepitus_device::drive::motor::Bridge;

/// Winding and gear of the default parameters; inertia of the drivetrain.
const RESISTANCE_OHM: f64 = 1.23;
const INDUCTANCE_H: f64 = 0.34e-3;
const NM_PER_A: f64 = 0.0389 * 86.0;
const INERTIA_KG_M2: f64 = 0.051;
const COUNTS_PER_RAD: f64 = 4.0 * 512.0 * 86.0 / std::f64::consts::TAU;
const FRICTION_NMS: f64 = 0.5;
const TICK_S: f64 = 5e-5;

/// The motor, the shaft and its encoder.
#[derive(Clone, Copy, Default)]
pub(crate) struct Motor {
    start: u32,
    angle_rad: f64,
    omega_rad_s: f64,
    current_a: f64,
    /// Torque of a hand, N·m.
    pub(crate) hand_nm: f64,
    /// Prescribed motion of the shaft: counter and speed.
    pub(crate) turned: Option<(i32, f64)>,
}

impl Motor {
    /// Returns a motor at rest, with the counter of the encoder at `start`.
    pub(crate) fn at(start: u32) -> Self {
        Self {
            start,
            ..Self::default()
        }
    }

    pub(crate) fn current_a(&self) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a converter rounds more")]
        let current_a = self.current_a as f32;
        current_a
    }

    /// The 32-bit counter of the quadrature timer.
    pub(crate) fn counter(&self) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        let counts = match self.turned {
            Some((counts, _)) => counts,
            None => (self.angle_rad * COUNTS_PER_RAD).floor() as i32,
        };
        self.start.wrapping_add_signed(counts)
    }

    /// One tick.
    pub(crate) fn tick(&mut self, bridge: Bridge) {
        let substeps = 10;
        let step_s = TICK_S / f64::from(substeps);
        for _ in 0..substeps {
            match bridge {
                Bridge::Float => self.current_a = 0.0,
                Bridge::Driven(volts) => {
                    let over = f64::from(volts)
                        - RESISTANCE_OHM * self.current_a
                        - NM_PER_A * self.omega_rad_s;
                    self.current_a += step_s * over / INDUCTANCE_H;
                }
            }
            if let Some((_, omega_rad_s)) = self.turned {
                self.omega_rad_s = omega_rad_s;
                continue;
            }
            let torque_nm =
                NM_PER_A * self.current_a + self.hand_nm - FRICTION_NMS * self.omega_rad_s;
            self.omega_rad_s += step_s * torque_nm / INERTIA_KG_M2;
            self.angle_rad += step_s * self.omega_rad_s;
        }
    }
}
