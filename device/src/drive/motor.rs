//! The current loop of `command_motor`, and the back-EMF speed estimate.

use crate::drive::prepare::MotorPlan;
use crepitus_model::Real;
use crepitus_model::control::current_loop::{CurrentLoop, Limit};
use crepitus_model::control::current_path::earlier_half_a;

/// Output of the bridge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bridge {
    /// All switches are open: the motor coasts.
    #[default]
    Float,
    /// This voltage, V; positive drives towards growing angle.
    Driven(f32),
}

/// Largest deviation of the current from its setpoint, A.
pub(crate) const CURRENT_SLACK_A: f32 = 0.2;

/// Filter gain per tick of the back-EMF speed estimate: 50 Hz.
const EMF_SHARE: f32 = 0.015_6;

/// Resistance of a winding that is 80 K warmer than assumed, as a share, with a
/// margin for the speed, which is estimated.
const WARM: f32 = 1.5;

/// The motor with its current loop.
#[derive(Clone, Copy, Debug)]
pub struct Motor {
    plan: MotorPlan,
    current_loop: CurrentLoop<f32>,
    /// Offset of the current sensor, A.
    offset_a: f32,
    setpoint_a: f32,
    measured_a: f32,
    bridge: Bridge,
    emf_rad_s: f32,
    /// Output of the tick before the last.
    before: Bridge,
    /// Voltage that the dead time takes of both outputs, V.
    fed_v: f32,
    fed_before_v: f32,
}

impl Motor {
    /// A motor without current.
    pub fn new(plan: &MotorPlan) -> Self {
        Self {
            plan: *plan,
            current_loop: plan.current_loop,
            offset_a: 0.0,
            setpoint_a: 0.0,
            measured_a: 0.0,
            bridge: Bridge::Float,
            emf_rad_s: 0.0,
            before: Bridge::Float,
            fed_v: 0.0,
            fed_before_v: 0.0,
        }
    }

    /// Sets the offset of the current sensor, A.
    pub fn set_offset(&mut self, offset_a: f32) {
        self.offset_a = offset_a;
    }

    /// Subtracts the sensor's offset.
    pub fn sensor_a(&self, raw_a: f32) -> f32 {
        raw_a - self.offset_a
    }

    /// The current, A, of what both sensors show without their offsets: by the amplifier of the half that switched
    /// earlier in this tick, and without lag. Where no half switches it is the sensor of the loop; so it is without
    /// the monitor, whose absence is a fault.
    #[inline]
    pub fn current_a(&self, sensor_a: f32, monitor_a: Option<f32>) -> f32 {
        match (self.bridge, monitor_a) {
            (Bridge::Float, _) => sensor_a,
            (_, None) => self.current_loop.corrected_a(sensor_a),
            (bridge, Some(monitor_a)) => {
                let shown_a = earlier_half_a(sensor_a, monitor_a, self.duty(bridge));
                self.current_loop.corrected_a(shown_a)
            }
        }
    }

    /// Lets the bridge float.
    pub fn float(&mut self) -> Bridge {
        (self.before, self.bridge) = (Bridge::Float, Bridge::Float);
        (self.fed_v, self.fed_before_v) = (0.0, 0.0);
        self.setpoint_a = 0.0;
        self.measured_a = 0.0;
        self.bridge
    }

    /// Drives with this voltage beside the back-EMF, V, through gates that must not let
    /// it pass.
    pub fn prove(&mut self, volts: f32, omega_rad_s: f32) -> Bridge {
        let volts = volts + self.plan.joint_constant * omega_rad_s;
        self.bridge =
            Bridge::Driven(volts.within(self.plan.floats_below_rad_s * self.plan.joint_constant));
        self.bridge
    }

    /// Starts the loop on a shaft that turns with `omega_rad_s`: without current,
    /// the voltage is the back-EMF.
    pub fn start(&mut self, omega_rad_s: f32) {
        self.current_loop.reset();
        self.current_loop
            .start(self.plan.joint_constant * omega_rad_s);
        self.emf_rad_s = omega_rad_s;
        self.setpoint_a = 0.0;
        self.measured_a = 0.0;
    }

    /// Runs one tick with a torque setpoint at the joint, N·m, T > 0 opposing
    /// growing angle. Without a measurement the bridge floats for this tick.
    pub fn drive(&mut self, torque_nm: f32, current_a: Option<f32>) -> Bridge {
        let setpoint_a = -torque_nm * self.plan.per_joint_constant;
        (self.before, self.fed_before_v) = (self.bridge, self.fed_v);
        self.bridge = match current_a {
            Some(measured_a) if measured_a.is_finite() && setpoint_a.is_finite() => {
                self.update_emf(measured_a);
                self.measured_a = measured_a;
                let volts = self.current_loop.tick(setpoint_a, measured_a);
                self.fed_v = self.current_loop.fed_v();
                Bridge::Driven(volts)
            }
            _ => Bridge::Float,
        };
        let limit_a = self.plan.current_limit_a;
        self.setpoint_a = setpoint_a.within(limit_a);
        self.bridge
    }

    /// Updates the speed estimate from voltage and current of the last tick.
    fn update_emf(&mut self, measured_a: f32) {
        let Bridge::Driven(volts) = self.bridge else {
            return;
        };
        let mean_a = 0.5 * (measured_a + self.measured_a);
        let emf_v = volts
            - self.fed_v
            - self.plan.resistance_ohm * mean_a
            - self.plan.inductance_per_tick_ohm * (measured_a - self.measured_a);
        let measured_rad_s = emf_v * self.plan.per_joint_constant;
        self.emf_rad_s += EMF_SHARE * (measured_rad_s - self.emf_rad_s);
    }

    /// The limit reached in the last tick.
    pub fn limited_by(&self) -> Option<Limit> {
        self.current_loop.limited_by()
    }

    /// Returns whether the limit of the voltage explains that the current is not the
    /// setpoint: on a shaft of this speed, so much voltage does not drive it. A
    /// loop whose sensor is broken ends at the limit, too, but with voltage to
    /// spare. A back-EMF beyond the limit excuses nothing: it drives a current that
    /// brakes the leg, whatever the setpoint is.
    pub fn is_out_of_voltage(&self, omega_rad_s: f32) -> bool {
        let Bridge::Driven(volts) = self.bridge else {
            return false;
        };
        if self.limited_by() != Some(Limit::Voltage) {
            return false;
        }
        let left_v =
            (volts - self.fed_v - self.plan.joint_constant * omega_rad_s) * 1.0_f32.copysign(volts);
        let needed_a = self.setpoint_a.abs() + CURRENT_SLACK_A;
        (0.0..WARM * self.plan.resistance_ohm * needed_a).contains(&left_v)
    }

    /// Current setpoint of the last tick, A.
    pub fn setpoint_a(&self) -> f32 {
        self.setpoint_a
    }

    /// Mean voltage at the motor from the middle of the last tick to that of this
    /// one, V, before [`Self::drive`]: an output acts from the beginning of the
    /// tick after its own. `None` if the bridge floated.
    pub fn mean_v(&self) -> Option<f32> {
        match (self.before, self.bridge) {
            (Bridge::Driven(before), Bridge::Driven(last)) => {
                Some(0.5 * (before + last - (self.fed_before_v + self.fed_v)))
            }
            _ => None,
        }
    }

    /// An output as a share of the supply's voltage, which the loop stays within;
    /// rounded.
    pub fn duty(&self, bridge: Bridge) -> f32 {
        match bridge {
            Bridge::Driven(volts) => volts * self.plan.duty_per_volt,
            Bridge::Float => 0.0,
        }
    }

    /// Share of the supply's voltage in this tick, before [`Self::drive`].
    pub fn duty_now(&self) -> f32 {
        self.duty(self.bridge)
    }

    /// The coefficients in force.
    pub fn plan(&self) -> &MotorPlan {
        &self.plan
    }

    /// Joint speed from back-EMF, rad/s; lags 3 ms.
    pub fn emf_rad_s(&self) -> f32 {
        self.emf_rad_s
    }

    /// Torque at the joint of one ampere, N·m/A.
    pub fn joint_constant(&self) -> f32 {
        self.plan.joint_constant
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::LARGEST_DUTY;
    use crate::drive::prepare::Preparation;

    /// A motor whose sensor shows nothing, until its voltage is at the limit.
    fn at_the_limit(torque_nm: f32) -> Motor {
        let mut motor = Motor::new(&Preparation::new().unwrap().1.motor);
        motor.start(0.0);
        for _ in 0..200 {
            motor.drive(torque_nm, Some(0.0));
        }
        assert_eq!(motor.limited_by(), Some(Limit::Voltage));
        // Torque against growing angle needs a voltage against it.
        let off = motor.duty(motor.bridge) + LARGEST_DUTY.copysign(torque_nm);
        assert!(off.abs() < 1e-6);
        motor
    }

    #[test]
    fn a_push_through_a_closed_gate_is_beside_the_back_emf() {
        let mut motor = Motor::new(&Preparation::new().unwrap().1.motor);
        for (omega_rad_s, expected_v) in [(0.0, 0.6), (1.0, 3.9454), (-1.0, -2.7454), (9.0, 16.8)] {
            let Bridge::Driven(volts) = motor.prove(0.6, omega_rad_s) else {
                panic!("it floats");
            };
            assert!((volts - expected_v).abs() < 1e-4, "{volts}");
        }
    }

    #[test]
    fn the_limit_of_the_voltage_excuses_what_it_explains() {
        for torque_nm in [-4.0_f32, 4.0] {
            let motor = at_the_limit(torque_nm);
            let fast_rad_s = -5.8_f32.copysign(torque_nm);
            assert!(motor.is_out_of_voltage(fast_rad_s));
            // With the voltage to spare of a motor at rest, or that is pulled; or with a
            // back-EMF beyond it, which brakes.
            for omega_rad_s in [0.0, 0.5 * fast_rad_s, -fast_rad_s, 1.1 * fast_rad_s] {
                assert!(!motor.is_out_of_voltage(omega_rad_s), "{omega_rad_s}");
            }
        }
        let motor = Motor::new(&Preparation::new().unwrap().1.motor);
        assert!(!motor.is_out_of_voltage(7.0), "it floats");
        assert_eq!(motor.duty(Bridge::Float), 0.0);
    }
}
