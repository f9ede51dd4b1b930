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
//! **As it is.** With one of the numbers of bridge and amplifiers, all zero by default, the [pulses of the
//! bridge](current_path) take the place of the ideal voltage, and the two amplifiers show the current: the loop gets
//! that of the half that switched earlier, as on the device.
//!
//! | number | default | source |
//! |---|---|---|
//! | winding | 1.23 Ω, 0.34 mH, 38.9 mN·m/A | maxon RE35, 30 V winding |
//! | supply, limits, bandwidth | 24 V, 1.37 A, 1 kHz | see `crepitus_model::control::current_loop` |
//! | gear ratio | 86 | the paper |

pub mod bridge;
pub mod current_path;
pub mod winding;

use crate::actuator::{Actuator, Commanded};
use crate::chain::Push;
use crate::effect::{Context, Effect, Given, Part, numbers, parameters};
use crate::effects::motor::current_path::{CurrentPath, CurrentPathSettings};
use crate::effects::motor::winding::{Course, Winding, WindingSettings};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::control::current_loop::{CurrentLoop, CurrentLoopSettings};
use crepitus_model::control::current_path::earlier_half_a;
use crepitus_model::control::device_limits::MotorSettings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::{Choice, ParameterSpec, Tabled};
use crepitus_model::{Real, SettingsError};

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the motor: winding, back-EMF, the supply's limit, and the sampled current loop",
    states: &["current", "loop integrator"],
    parameters: &TABLE,
    choices: &[AMPLIFIER],
    needs: &[],
    part: Part::Actuator(|given, context| {
        let settings = CurrentLoopSettings::of(split(given).0);
        let motor = MotorNumbers::of(given);
        let is_half_a = given.choices.first() == Some(&HALF_A);
        Ok(if context.single {
            Box::new(Motor::<f32>::new(&settings, &motor, is_half_a, context)?)
        } else {
            Box::new(Motor::<f64>::new(&settings, &motor, is_half_a, context)?)
        })
    }),
};

/// The amplifier whose current the loop gets. A device has no choice: it takes the earlier half's.
const AMPLIFIER: Choice = Choice {
    key: "amplifier",
    names: &["earlier-half", "half-a"],
    default: 0,
    meaning: "the amplifier whose current the loop gets: of the half that switched earlier, or always of half A",
};

/// Place of `half-a` among the names of [`AMPLIFIER`].
const HALF_A: u8 = 1;

pub(crate) const NAME: &str = "motor";

/// Trace columns of a motor.
pub(crate) const COLUMNS: [&str; 3] = ["motor_current_a", "motor_voltage_v", "motor_torque_nm"];

const LOOP: &[ParameterSpec; 7] = CurrentLoopSettings::TABLE;

/// Bridge and amplifiers as they are: see [`current_path`].
const PATH: &[ParameterSpec; 5] = parameters! {
    bridge_dead_time_us "td" "µs", 0.0..=1.0, 0.0,
        "dead time that the bridge has, of timer and driver together (0.4 on the board); 0 is an ideal bridge";
    amplifier_lag_us "λ" "µs", 0.0..=2.0, 0.0,
        "lag of the current's amplifiers and filters (0.5 on the board)";
    amplifier_excursion_a "D" "A", 0.0..=2.0, 0.0,
        "excursion of an amplifier after an edge of its half (0.3 on the board, an upper bound)";
    amplifier_settling_up_us "tu" "µs", 0.1..=20.0, 9.6,
        "time in which that after an edge upwards falls to 0.5 % of half of the range";
    amplifier_settling_down_us "tf" "µs", 0.1..=20.0, 9.8,
        "time in which that after an edge downwards does";
};

/// Settings of the current loop, which are true of this winding, what the joint
/// gets of its current: the device's own torque constant and gear ratio; bridge and amplifiers.
const TABLE: [ParameterSpec; 14] = [
    LOOP[0],
    LOOP[1],
    LOOP[2],
    LOOP[3],
    LOOP[4],
    LOOP[5],
    LOOP[6],
    MotorSettings::TABLE[0],
    EncoderSettings::TABLE[1],
    PATH[0],
    PATH[1],
    PATH[2],
    PATH[3],
    PATH[4],
];

/// The numbers of the loop, of the joint, and of bridge and amplifiers.
fn split(given: &Given) -> ([f64; 7], [f64; 2], [f64; 5]) {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = numbers(given);
    ([a, b, c, d, e, f, g], [h, i], [j, k, l, m, n])
}

/// The numbers of a motor without the device's loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorNumbers {
    /// Winding of the motor, seen from the joint.
    pub winding: WindingSettings,
    /// Supply voltage of the bridge, in either direction, V.
    pub supply_v: f64,
    /// Bridge and amplifiers.
    pub path: CurrentPathSettings,
}

impl MotorNumbers {
    /// Numbers from the effect's parameters in a scene.
    pub fn of(given: &Given) -> Self {
        let ([_, ohm, henry, supply_v, ..], [nm_per_a, gear], path) = split(given);
        let [dead_time_s, lag_s, _, up_s, down_s] = path.map(|us| 1e-6 * us);
        Self {
            winding: WindingSettings {
                resistance_ohm: ohm,
                inductance_h: henry,
                constant: nm_per_a * gear,
            },
            supply_v,
            path: CurrentPathSettings {
                dead_time_s,
                lag_s,
                excursion_a: path[2],
                settling_s: [up_s, down_s],
            },
        }
    }

    /// Bridge and amplifiers, unless they are ideal.
    fn current_path(&self) -> Option<CurrentPath> {
        CurrentPath::new(self.path, self.winding, self.supply_v)
    }
}

/// Bridge and amplifiers of a motor that is stepped by ticks.
#[derive(Clone)]
struct RealPath {
    path: CurrentPath,
    /// The loop gets the current of half A, whatever the duty.
    is_half_a: bool,
    supply_v: f64,
    /// Back-EMF in the last step, V.
    emf_v: f64,
    /// Duty of this tick.
    duty: f64,
    /// By what the two amplifiers are off in the middle of this tick, A.
    off_a: [f64; 2],
}

#[derive(Clone)]
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
    real: Option<RealPath>,
}

impl<F: Real> Motor<F> {
    fn new(
        settings: &CurrentLoopSettings,
        motor: &MotorNumbers,
        is_half_a: bool,
        context: &Context,
    ) -> Result<Self, SettingsError> {
        let winding = motor.winding;
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
            real: motor.current_path().map(|path| RealPath {
                path,
                is_half_a,
                supply_v: motor.supply_v,
                emf_v,
                duty: 0.0,
                off_a: [0.0; 2],
            }),
        })
    }

    /// A tick of the bridge as it is: sets the voltage that the winding gets of the one commanded.
    fn switch(&mut self) {
        let Some(real) = &mut self.real else {
            return;
        };
        let start_a = self.winding.current_a();
        real.duty = self.voltage_v / real.supply_v;
        let (first_v, middle_a) = real.path.half(false, real.duty, start_a, real.emf_v);
        let sampled_a = real.path.samples_a();
        // Against the current that the plant has in the middle.
        let even_a = real.path.even_a();
        let (second_v, _) = real.path.half(true, real.duty, middle_a, real.emf_v);
        self.voltage_v = f64::midpoint(first_v, second_v);
        real.off_a = sampled_a.map(|sampled_a| sampled_a - even_a);
    }

    /// Current that the loop gets, A.
    fn measured_a(&self, current_a: f64) -> F {
        let Some(real) = &self.real else {
            return F::from_f64(current_a);
        };
        let [a, b] = real.off_a.map(|off_a| F::from_f64(current_a + off_a));
        let shown_a = if real.is_half_a {
            a
        } else {
            earlier_half_a(a, b, F::from_f64(real.duty))
        };
        self.current_loop.corrected_a(shown_a)
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
        let measured_a = self.measured_a(course.current_a(left));
        self.next_voltage_v = self
            .current_loop
            .tick(F::from_f64(self.wanted_a), measured_a)
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
        if let Some(real) = &mut self.real {
            real.emf_v = self.winding.settings().constant * mean_rad_s;
        }
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
        self.switch();
    }
}
