//! `motor`: winding, back-EMF, supply, and the device's current loop.
//!
//! The [winding] gets a voltage of up to the supply's, held
//! between two PWM periods. In the middle of a tick the device samples the
//! current and computes the next voltage from this tick's torque
//! (`crepitus_model::control::current_loop`, the code of the firmware, in the scene's
//! precision); the PWM loads it with the next period, half a tick later.
//!
//! The voltage is constant over a tick, so the plant steps as long; the current
//! in the tick's middle comes from the same closed form.
//!
//! | number | default | source |
//! |---|---|---|
//! | winding | 1.23 Ω, 0.34 mH, 38.9 mN·m/A | maxon RE35, 30 V winding |
//! | supply, limits, bandwidth | 24 V, 1.37 A, 1 kHz | see `crepitus_model::control::current_loop` |
//! | gear ratio | 86 | the paper |

pub mod bridge;
pub mod winding;

use crate::actuator::{Actuator, Commanded};
use crate::chain::Push;
use crate::effect::{Context, Effect, Given, Part, numbers};
use crate::effects::motor::winding::{Course, Winding, WindingSettings};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::control::current_loop::{CurrentLoop, CurrentLoopSettings};
use crepitus_model::control::device_limits::MotorSettings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::{ParameterSpec, Tabled};
use crepitus_model::{Real, SettingsError};

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the motor: winding, back-EMF, the supply's limit, and the sampled current loop",
    states: &["current", "loop integrator"],
    parameters: &TABLE,
    choices: &[],
    needs: &[],
    part: Part::Actuator(|given, context| {
        let [bandwidth, ohm, henry, supply, limit, _, _] = numbers(given);
        let settings = CurrentLoopSettings::of([bandwidth, ohm, henry, supply, limit]);
        let winding = MotorNumbers::of(given).winding;
        Ok(if context.single {
            Box::new(Motor::<f32>::new(&settings, winding, context)?)
        } else {
            Box::new(Motor::<f64>::new(&settings, winding, context)?)
        })
    }),
};

pub(crate) const NAME: &str = "motor";

/// Trace columns of a motor.
pub(crate) const COLUMNS: [&str; 3] = ["motor_current_a", "motor_voltage_v", "motor_torque_nm"];

const LOOP: &[ParameterSpec; 5] = CurrentLoopSettings::TABLE;

/// Settings of the current loop, which are true of this winding, and what the joint
/// gets of its current: the device's own torque constant and gear ratio.
const TABLE: [ParameterSpec; 7] = [
    LOOP[0],
    LOOP[1],
    LOOP[2],
    LOOP[3],
    LOOP[4],
    MotorSettings::TABLE[0],
    EncoderSettings::TABLE[1],
];

/// The numbers of a motor without the device's loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorNumbers {
    /// Winding of the motor, seen from the joint.
    pub winding: WindingSettings,
    /// Supply voltage of the bridge, in either direction, V.
    pub supply_v: f64,
}

impl MotorNumbers {
    /// Numbers from the effect's parameters in a scene.
    pub fn of(given: &Given) -> Self {
        let [_, ohm, henry, supply_v, _, nm_per_a, gear] = numbers(given);
        Self {
            winding: WindingSettings {
                resistance_ohm: ohm,
                inductance_h: henry,
                constant: nm_per_a * gear,
            },
            supply_v,
        }
    }
}

struct Motor<F> {
    current_loop: CurrentLoop<F>,
    winding: Winding,
    half_tick_s: f64,
    /// Share of a difference from the final current that is left after half a tick.
    half_left: f64,
    /// Time until the current is sampled, s; zero once it was.
    until_sample_s: f64,
    wanted_a: f64,
    voltage_v: f64,
    next_voltage_v: f64,
}

impl<F: Real> Motor<F> {
    fn new(
        settings: &CurrentLoopSettings,
        winding: WindingSettings,
        context: &Context,
    ) -> Result<Self, SettingsError> {
        // The shaft turns as the scene begins: without current, the voltage is
        // the back-EMF.
        let emf_v = winding.constant * context.start.omega_rad_s;
        let voltage_v = emf_v.clamp(-settings.supply_v, settings.supply_v);
        let mut current_loop = CurrentLoop::new(settings, context.tick_s)?;
        current_loop.start(F::from_f64(voltage_v));
        let current_a = (voltage_v - emf_v) / winding.resistance_ohm;
        let winding = Winding::new(winding, current_a, context.tick_s);
        let half_tick_s = context.tick_s / 2.0;
        Ok(Self {
            current_loop,
            half_left: winding.left_after(half_tick_s),
            winding,
            half_tick_s,
            until_sample_s: 0.0,
            wanted_a: 0.0,
            voltage_v,
            next_voltage_v: voltage_v,
        })
    }

    /// Measures the current in the middle of the tick, if it is in this step,
    /// and computes the next voltage.
    fn sample(&mut self, length_s: f64, course: &Course) {
        let until_s = self.until_sample_s;
        self.until_sample_s -= length_s;
        // Many short steps reach the middle but for rounding.
        if self.until_sample_s > 1e-6 * self.half_tick_s {
            return;
        }
        self.until_sample_s = 0.0;
        let left = if until_s == self.half_tick_s {
            self.half_left
        } else {
            self.winding.left_after(until_s)
        };
        let measured_a = course.current_a(left);
        self.next_voltage_v = self
            .current_loop
            .tick(F::from_f64(self.wanted_a), F::from_f64(measured_a))
            .to_f64();
    }
}

impl<F: Real> Actuator for Motor<F> {
    fn fold(&mut self, length_s: f64) -> Push {
        self.winding.fold(self.voltage_v, length_s)
    }

    fn load_nm(&self) -> f64 {
        self.winding.load_nm()
    }

    fn settle(&mut self, length_s: f64, mean_rad_s: f64) {
        let course = self.winding.course(self.voltage_v, mean_rad_s);
        if self.until_sample_s > 0.0 {
            self.sample(length_s, &course);
        }
        self.winding
            .settle(self.voltage_v, length_s, mean_rad_s, &course);
    }

    fn absorbed_j(&self) -> f64 {
        self.winding.absorbed_j()
    }

    fn energy(&self, balance: &mut EnergyBalance) {
        balance.add(NAME, "supply", Account::Given, self.winding.supplied_j());
        self.winding.energy(NAME, balance);
    }

    fn columns(&self) -> &'static [&'static str] {
        &COLUMNS
    }

    fn write(&self, row: &mut Vec<f64>) {
        row.extend([
            self.winding.current_a(),
            self.voltage_v,
            self.winding.torque_nm(),
        ]);
    }
}

impl<F: Real> Commanded for Motor<F> {
    fn command(&mut self, torque_nm: f64) {
        self.wanted_a = -torque_nm / self.winding.settings().constant;
        self.voltage_v = self.next_voltage_v;
        self.until_sample_s = self.half_tick_s;
    }
}
