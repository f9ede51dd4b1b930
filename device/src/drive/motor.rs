//! The current loop of `command_motor`, and what current and voltage say about
//! the shaft.

use crate::drive::prepare::MotorPlan;
use crepitus_model::Real;
use crepitus_model::control::current_loop::{CurrentLoop, Limit};

/// What the bridge does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bridge {
    /// All switches are open: the motor coasts.
    #[default]
    Float,
    /// This voltage, V; positive drives towards growing angle.
    Driven(f32),
}

/// Bandwidth of the speed from back-EMF, as share of a tick: 50 Hz.
const EMF_SHARE: f32 = 0.015_6;

/// The motor of a drive.
#[derive(Clone, Copy, Debug)]
pub struct Motor {
    plan: MotorPlan,
    current_loop: CurrentLoop<f32>,
    /// What the sensor shows without current, A.
    offset_a: f32,
    wanted_a: f32,
    measured_a: f32,
    bridge: Bridge,
    emf_rad_s: f32,
}

impl Motor {
    /// A motor without current.
    pub fn new(plan: &MotorPlan) -> Self {
        Self {
            plan: *plan,
            current_loop: plan.current_loop,
            offset_a: 0.0,
            wanted_a: 0.0,
            measured_a: 0.0,
            bridge: Bridge::Float,
            emf_rad_s: 0.0,
        }
    }

    /// What the sensor shows without current, A.
    pub fn set_offset(&mut self, offset_a: f32) {
        self.offset_a = offset_a;
    }

    /// Takes the sensor's offset off.
    pub fn current_a(&self, raw_a: f32) -> f32 {
        raw_a - self.offset_a
    }

    /// The bridge floats.
    pub fn float(&mut self) -> Bridge {
        self.bridge = Bridge::Float;
        self.wanted_a = 0.0;
        self.measured_a = 0.0;
        self.bridge
    }

    /// Takes over a shaft that turns with `omega_rad_s`: without current, the
    /// voltage is the back-EMF.
    pub fn start(&mut self, omega_rad_s: f32) {
        self.current_loop.reset();
        self.current_loop
            .start(self.plan.joint_constant * omega_rad_s);
        self.emf_rad_s = omega_rad_s;
        self.wanted_a = 0.0;
        self.measured_a = 0.0;
    }

    /// One tick towards a torque at the joint, N·m, T > 0 opposing growing
    /// angle. Without a measurement the bridge floats for this tick.
    pub fn drive(&mut self, torque_nm: f32, current_a: Option<f32>) -> Bridge {
        let wanted_a = -torque_nm * self.plan.amperes_per_nm;
        self.bridge = match current_a {
            Some(measured_a) if measured_a.is_finite() && wanted_a.is_finite() => {
                self.look_at_emf(measured_a);
                self.measured_a = measured_a;
                Bridge::Driven(self.current_loop.tick(wanted_a, measured_a))
            }
            _ => Bridge::Float,
        };
        let most_a = self.plan.current_limit_a;
        self.wanted_a = wanted_a.within(most_a);
        self.bridge
    }

    /// The speed that voltage and current of the last tick explain.
    fn look_at_emf(&mut self, measured_a: f32) {
        let Bridge::Driven(volts) = self.bridge else {
            return;
        };
        let mean_a = 0.5 * (measured_a + self.measured_a);
        let emf_v = volts
            - self.plan.resistance_ohm * mean_a
            - self.plan.inductance_per_tick_ohm * (measured_a - self.measured_a);
        let seen_rad_s = emf_v / self.plan.joint_constant;
        self.emf_rad_s += EMF_SHARE * (seen_rad_s - self.emf_rad_s);
    }

    /// What limited the last tick.
    pub fn limited_by(&self) -> Option<Limit> {
        self.current_loop.limited_by()
    }

    /// What was asked of the current in the last tick, A.
    pub fn wanted_a(&self) -> f32 {
        self.wanted_a
    }

    /// Speed of the joint that voltage and current explain, rad/s; lags 3 ms.
    pub fn emf_rad_s(&self) -> f32 {
        self.emf_rad_s
    }

    /// Torque at the joint of one ampere, N·m/A.
    pub fn joint_constant(&self) -> f32 {
        self.plan.joint_constant
    }
}
