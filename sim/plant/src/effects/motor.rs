//! `motor`: winding, back-EMF, supply, and the device's current loop.
//!
//! ```text
//! L·di/dt = v − R·i − Kt·N·Ω,   torque on the joint = Kt·N·i,   |v| ≤ supply
//! ```
//!
//! The voltage is held between two PWM periods. In the middle of a tick the
//! device samples the current and computes the next voltage from this tick's
//! torque (`crepitus_model::current_loop`, the code of the firmware, in the
//! scene's precision); the PWM loads it with the next period, half a tick
//! later.
//!
//! The voltage is constant over a tick, so the plant steps as long; the current
//! in the tick's middle comes from the same closed form.
//!
//! The winding's 0.28 ms are short against a tick, so its equation is solved
//! exactly for a constant voltage and the shaft's mean velocity w: current and
//! mean torque come out affine in w, so the coupling with the mechanics is
//! implicit and what the voltage supplies is exactly what the copper, the field
//! and the shaft take.
//!
//! | number | default | source |
//! |---|---|---|
//! | winding | 1.23 Ω, 0.34 mH, 38.9 mN·m/A | maxon RE35, 30 V winding |
//! | supply, limits, bandwidth | 24 V, 1.37 A, 1 kHz | see `crepitus_model::current_loop` |
//! | gear ratio | 86 | the paper |

use crate::actuator::Actuator;
use crate::chain::Push;
use crate::effect::{Context, Effect, Part, numbers};
use crate::ledger::{Account, Ledger};
use crepitus_model::current_loop::{CurrentLoop, CurrentLoopSettings};
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
        let [bandwidth, ohm, henry, supply, limit, nm_per_a, gear] = numbers(given);
        let settings = CurrentLoopSettings::of([bandwidth, ohm, henry, supply, limit]);
        Ok(if context.single {
            Box::new(Motor::<f32>::new(&settings, nm_per_a * gear, context)?)
        } else {
            Box::new(Motor::<f64>::new(&settings, nm_per_a * gear, context)?)
        })
    }),
};

const NAME: &str = "motor";

const LOOP: &[ParameterSpec; 5] = CurrentLoopSettings::TABLE;

/// What the loop is told, which is true of this winding, and what the joint
/// gets of its current.
const TABLE: [ParameterSpec; 7] = [
    LOOP[0],
    LOOP[1],
    LOOP[2],
    LOOP[3],
    LOOP[4],
    ParameterSpec {
        key: "torque_constant_nm_per_a",
        symbol: "Kt",
        unit: "N·m/A",
        min: 1e-4,
        max: 10.0,
        default: 0.0389,
        meaning: "torque of the motor for one ampere, and its back-EMF for one rad/s",
    },
    ParameterSpec {
        key: "gear_ratio",
        symbol: "N",
        unit: "motor turns per joint turn",
        min: 1.0,
        max: 1e4,
        default: 86.0,
        meaning: "reduction between the motor and the joint",
    },
];

/// The winding under a held voltage over one length of time.
#[derive(Clone, Copy, Debug)]
struct Transient {
    length_s: f64,
    /// Share of a difference from the final current that is left at the end.
    left: f64,
    /// Mean of that share over the time.
    mean: f64,
}

struct Motor<F> {
    current_loop: CurrentLoop<F>,
    ohm: f64,
    henry: f64,
    /// Kt·N, N·m/A and V·s/rad.
    constant: f64,
    transient: Transient,
    half_tick_s: f64,
    /// What half a tick leaves of a difference from the final current.
    half_left: f64,
    /// Time until the current is sampled, s; zero once it was.
    until_sample_s: f64,
    wanted_a: f64,
    current_a: f64,
    voltage_v: f64,
    next_voltage_v: f64,
    /// Mean torque over the last step; positive opposes growing angle.
    torque_nm: f64,
    absorbed_j: f64,
    supplied_j: f64,
    copper_j: f64,
}

impl<F: Real> Motor<F> {
    fn new(
        settings: &CurrentLoopSettings,
        constant: f64,
        context: &Context,
    ) -> Result<Self, SettingsError> {
        // The shaft turns as the scene begins: without current, the voltage is
        // the back-EMF.
        let emf_v = constant * context.start.omega_rad_s;
        let voltage_v = emf_v.clamp(-settings.supply_v, settings.supply_v);
        let mut current_loop = CurrentLoop::new(settings, context.tick_s)?;
        current_loop.start(F::from_f64(voltage_v));
        let mut motor = Self {
            current_loop,
            ohm: settings.resistance_ohm,
            henry: settings.inductance_h,
            constant,
            transient: Transient {
                length_s: 0.0,
                left: 1.0,
                mean: 1.0,
            },
            half_tick_s: context.tick_s / 2.0,
            half_left: (-settings.resistance_ohm * context.tick_s / 2.0 / settings.inductance_h)
                .exp(),
            until_sample_s: 0.0,
            wanted_a: 0.0,
            current_a: (voltage_v - emf_v) / settings.resistance_ohm,
            voltage_v,
            next_voltage_v: voltage_v,
            torque_nm: 0.0,
            absorbed_j: 0.0,
            supplied_j: 0.0,
            copper_j: 0.0,
        };
        motor.transient = motor.transient(context.tick_s);
        Ok(motor)
    }

    fn transient(&self, length_s: f64) -> Transient {
        if length_s == self.transient.length_s {
            return self.transient;
        }
        let x = self.ohm * length_s / self.henry;
        Transient {
            length_s,
            left: (-x).exp(),
            mean: -(-x).exp_m1() / x,
        }
    }

    /// Measures the current in the middle of the tick, if it is in this step,
    /// and computes the next voltage.
    fn sample(&mut self, step: &Transient, final_a: f64, from_a: f64) {
        let until_s = self.until_sample_s;
        self.until_sample_s -= step.length_s;
        // Many short steps reach the middle but for rounding.
        if self.until_sample_s > 1e-6 * self.half_tick_s {
            return;
        }
        self.until_sample_s = 0.0;
        let left = if until_s == self.half_tick_s {
            self.half_left
        } else {
            (-self.ohm * until_s / self.henry).exp()
        };
        let measured_a = final_a + left * from_a;
        self.next_voltage_v = self
            .current_loop
            .tick(F::from_f64(self.wanted_a), F::from_f64(measured_a))
            .to_f64();
    }

    /// The current that the winding tends to, A.
    fn final_a(&self, mean_rad_s: f64) -> f64 {
        (self.voltage_v - self.constant * mean_rad_s) / self.ohm
    }
}

impl<F: Real> Actuator for Motor<F> {
    fn command(&mut self, torque_nm: f64) {
        self.wanted_a = -torque_nm / self.constant;
        self.voltage_v = self.next_voltage_v;
        self.until_sample_s = self.half_tick_s;
    }

    fn fold(&mut self, length_s: f64) -> Push {
        self.transient = self.transient(length_s);
        let forced = 1.0 - self.transient.mean;
        let amperes = self.transient.mean * self.current_a + forced * self.voltage_v / self.ohm;
        Push {
            torque_nm: self.constant * amperes,
            slope_nms: self.constant * self.constant * forced / self.ohm,
            held_by_nm: None,
        }
    }

    fn load_nm(&self) -> f64 {
        self.constant * self.current_a
    }

    fn settle(&mut self, length_s: f64, mean_rad_s: f64) {
        let t = self.transient(length_s);
        let final_a = self.final_a(mean_rad_s);
        let from_a = self.current_a - final_a;
        let mean_a = final_a + t.mean * from_a;
        // ∫i² dt of an exponential.
        if self.until_sample_s > 0.0 {
            self.sample(&t, final_a, from_a);
        }
        let tau_s = self.henry / self.ohm;
        let square = length_s * final_a * (final_a + 2.0 * t.mean * from_a)
            + 0.5 * tau_s * from_a * from_a * (1.0 - t.left * t.left);
        self.copper_j += self.ohm * square;
        self.supplied_j += self.voltage_v * mean_a * length_s;
        self.torque_nm = -self.constant * mean_a;
        self.absorbed_j += self.torque_nm * mean_rad_s * length_s;
        self.current_a = final_a + t.left * from_a;
    }

    fn absorbed_j(&self) -> f64 {
        self.absorbed_j
    }

    fn book(&self, ledger: &mut Ledger) {
        ledger.book(NAME, "supply", Account::Given, self.supplied_j);
        ledger.book(NAME, "copper", Account::Lost, self.copper_j);
        ledger.book(
            NAME,
            "field",
            Account::Stored,
            0.5 * self.henry * self.current_a * self.current_a,
        );
    }

    fn columns(&self) -> &'static [&'static str] {
        &["motor_current_a", "motor_voltage_v", "motor_torque_nm"]
    }

    fn write(&self, row: &mut Vec<f64>) {
        row.extend([self.current_a, self.voltage_v, self.torque_nm]);
    }
}
