//! `reaction-mass`: the actuator that the device's `vibration-actuator` commands.
//!
//! A coil moves a mass m on a flexure, and what carries it gets the reaction. With x
//! the mass's place relative to it, at a lever r, and y its absolute way:
//!
//! ```text
//! m·ÿ = −k·x − c·ẋ − Bl·i + weight − stop        ẏ = r·Ω + ẋ
//! L·di/dt = V − R·i + Bl·ẋ
//! force on the carrier = k·x + c·ẋ + Bl·i + stop
//! ```
//!
//! so a voltage V > 0 pushes the carrier towards growing angle. In a step all of it
//! is linear: the mass and the current are eliminated, and the carrier gets one push
//! (the implicit midpoint rule, as everywhere in the chain). The damping ratio of its
//! parameters is that with the coil connected; c is what the back-EMF leaves of it.
//!
//! **The stops** are bumpers of 20 kN/m with a third of critical damping. They are met
//! at the end of the step that has passed the stroke, some 20 µm late at the speed of a full swing,
//! and left once they would have to pull; what they then still hold is lost.
//!
//! **A bridge that sleeps** leaves the coil open: its current is gone at once, and the
//! mass rings with c alone.
//!
//! The actuator sits on the [shell](super::shell) if there is one, otherwise on what the hand
//! holds; or on the brace, where it does next to nothing for the hand.
//!
//! A fit takes the coil on a carrier that stands still as an [`impedance`].
//!
//! Sources: see [`vibration_actuator`](crepitus_model::render::effects::vibration_actuator),
//! inductance of the same data sheet; bumpers are an estimate.

pub mod impedance;

use crate::chain::{Body, Chain, Push, Step, Weight};
use crate::coil::Coil;
use crate::effect::{Context, Effect, Given, Mounted, Part, numbers};
use crate::effects::limb::STANDARD_GRAVITY;
use crate::energy_balance::{Account, EnergyBalance};
use crate::load::{Load, Loaded};
use crepitus_model::SettingsError;
use crepitus_model::parameters::{Choice, ParameterSpec, Tabled};
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the reaction mass that the vibration actuator moves: flexure, stops, weight, coil and bridge",
    states: &["mass", "its velocity", "coil current"],
    parameters: &TABLE,
    choices: &[Choice {
        key: "on",
        names: &["shell", "brace"],
        default: 0,
        meaning: "what carries it: the shell, or without one what the hand holds; or the brace",
    }],
    needs: &[],
    part: Part::Mount(place, mount),
};

const NAME: &str = "reaction-mass";

/// The device's, which are true of this actuator.
const DEVICE: &[ParameterSpec; 11] = VibrationActuatorSettings::TABLE;

const TABLE: [ParameterSpec; 9] = [
    DEVICE[2],
    DEVICE[3],
    DEVICE[4],
    DEVICE[5],
    DEVICE[6],
    DEVICE[7],
    DEVICE[9],
    DEVICE[10],
    ParameterSpec {
        key: "inductance_mh",
        symbol: "L",
        unit: "mH",
        min: 0.05,
        max: 10.0,
        default: 0.2,
        meaning: "inductance of the coil",
    },
];

/// Stiffness of a bumper, N/m, and its damping ratio with the mass.
const BUMPER_N_PER_M: f64 = 2e4;
const BUMPER_DAMPING_RATIO: f64 = 0.33;

/// The device's settings for the actuator that is `given`.
pub fn as_settings(given: &Given) -> VibrationActuatorSettings {
    let [
        hz,
        zeta,
        mass_g,
        constant,
        ohm,
        stroke_mm,
        supply_v,
        lever_m,
        _,
    ] = numbers(given);
    VibrationActuatorSettings {
        resonance_hz: hz,
        damping_ratio: zeta,
        moving_mass_g: mass_g,
        force_constant_n_per_a: constant,
        resistance_ohm: ohm,
        stroke_mm,
        supply_v,
        lever_m,
        ..VibrationActuatorSettings::defaults()
    }
}

/// Refuses what no coil can be.
///
/// # Errors
/// The rule that is broken.
pub fn check(given: &Given) -> Result<(), SettingsError> {
    as_settings(given).check()
}

fn place(given: &Given) -> Mounted {
    match given.choices[0] {
        0 => Mounted::Shell,
        _ => Mounted::Brace,
    }
}

fn mount(given: &Given, context: &Context, left: Box<dyn Chain>) -> Box<dyn Chain> {
    let settings = as_settings(given);
    let [.., lever_m, inductance_mh] = numbers::<9>(given);
    let mass_kg = settings.moving_mass_g * 1e-3;
    let omega = settings.resonance_rad_s();
    let left_ratio = settings.damping_ratio - settings.electric_damping_ratio();
    let weight_n = |angle_rad: f64| {
        let turned = context.gravity_rad?;
        Some(mass_kg * STANDARD_GRAVITY * (angle_rad + turned).cos())
    };
    let sag_n = weight_n(context.start.angle_rad).unwrap_or(0.0);
    let actuator = ReactionMass {
        mass_kg,
        lever_m,
        flexure: settings.stiffness_n_per_m(),
        damping: 2.0 * left_ratio.max(0.0) * mass_kg * omega,
        stroke_m: settings.stroke_mm * 1e-3,
        bumper_damping: 2.0 * BUMPER_DAMPING_RATIO * (BUMPER_N_PER_M * mass_kg).sqrt(),
        constant: settings.force_constant_n_per_a,
        ohm: settings.resistance_ohm,
        henry: inductance_mh * 1e-3,
        supply_v: settings.supply_v,
        gravity_rad: context.gravity_rad,
        excursion_m: sag_n / settings.stiffness_n_per_m(),
        velocity_m_s: lever_m * context.start.omega_rad_s,
        current_a: 0.0,
        contact_m: None,
        volts: 0.0,
        force_n: 0.0,
        account: EnergyAccount::default(),
    };
    Loaded::on(left, actuator)
}

/// Energy that came and went, J.
#[derive(Clone, Copy, Debug, Default)]
struct EnergyAccount {
    supply: f64,
    weight: f64,
    copper: f64,
    damping: f64,
    stops: f64,
    knocks: u64,
}

#[derive(Clone)]
struct ReactionMass {
    mass_kg: f64,
    lever_m: f64,
    /// N/m, N·s/m.
    flexure: f64,
    damping: f64,
    stroke_m: f64,
    bumper_damping: f64,
    /// N/A.
    constant: f64,
    ohm: f64,
    henry: f64,
    supply_v: f64,
    gravity_rad: Option<f64>,
    excursion_m: f64,
    /// Absolute velocity of the mass along its way.
    velocity_m_s: f64,
    current_a: f64,
    /// Excursion at which it has met a stop that it touches.
    contact_m: Option<f64>,
    /// Voltage applied to the coil, and force on the carrier, in the last step.
    volts: f64,
    force_n: f64,
    account: EnergyAccount,
}

/// One step of it, for a carrier whose mean velocity is w, rad/s.
struct Solved {
    /// Force on the mass at w = 0, N, and how the relative velocity falls with it.
    pull_n: f64,
    slope: f64,
    /// Force on the carrier: at no relative velocity, N, and its slope, N·s/m.
    carried_n: f64,
    carried_slope: f64,
    /// Mean current at no relative velocity, A, and its slope, A·s/m.
    current_a: f64,
    current_slope: f64,
    volts: f64,
    weight_n: f64,
}

impl ReactionMass {
    fn solve(&self, step: &Step, angle_rad: f64) -> Solved {
        let h = step.length_s;
        let (volts, is_driven) = match step.coil {
            Coil::Driven(volts) => (volts.clamp(-self.supply_v, self.supply_v), true),
            Coil::Open => (0.0, false),
        };
        let (current_a, current_slope) = if is_driven {
            let coil = 2.0 * self.henry / h;
            let impedance = self.ohm + coil;
            (
                (volts + coil * self.current_a) / impedance,
                self.constant / impedance,
            )
        } else {
            (0.0, 0.0)
        };
        let (stop_n, stop_slope) = self.contact_m.map_or((0.0, 0.0), |met_m| {
            (
                BUMPER_N_PER_M * (self.excursion_m - met_m),
                0.5 * BUMPER_N_PER_M * h + self.bumper_damping,
            )
        });
        let weight_n = self.gravity_rad.map_or(0.0, |turned| {
            self.mass_kg * STANDARD_GRAVITY * (angle_rad + turned).cos()
        });
        let carried_n = self.flexure * self.excursion_m + self.constant * current_a + stop_n;
        let carried_slope =
            0.5 * self.flexure * h + self.damping + self.constant * current_slope + stop_slope;
        let inertial = 2.0 * self.mass_kg / h;
        Solved {
            pull_n: inertial * self.velocity_m_s - carried_n + weight_n,
            slope: inertial + carried_slope,
            carried_n,
            carried_slope,
            current_a,
            current_slope,
            volts,
            weight_n,
        }
    }

    /// Mean relative velocity, m/s.
    fn slip(&self, solved: &Solved, step: &Step, w: f64) -> f64 {
        let inertial = 2.0 * self.mass_kg / step.length_s;
        (solved.pull_n - inertial * self.lever_m * w) / solved.slope
    }

    /// Meets a stop, or leaves it.
    fn look_at_stops(&mut self, slip_m_s: f64) {
        match self.contact_m {
            None if self.excursion_m.abs() > self.stroke_m && self.excursion_m * slip_m_s > 0.0 => {
                self.contact_m = Some(self.excursion_m);
                self.account.knocks += 1;
            }
            Some(met_m) => {
                let pressed_m = self.excursion_m - met_m;
                let push_n = BUMPER_N_PER_M * pressed_m + self.bumper_damping * slip_m_s;
                if push_n * met_m <= 0.0 {
                    self.account.stops += 0.5 * BUMPER_N_PER_M * pressed_m * pressed_m;
                    self.contact_m = None;
                }
            }
            None => {}
        }
    }
}

impl Load for ReactionMass {
    const NAME: &'static str = NAME;
    const COLUMN: &'static str = "actuator_torque_nm";
    const MORE: &'static [&'static str] = &[
        "coil_voltage_v",
        "coil_current_a",
        "excursion_m",
        "stop_knocks",
    ];

    fn inertia_kg_m2(&self) -> f64 {
        0.0
    }

    fn pull(&self, step: &Step, body: &Body) -> Push {
        let solved = self.solve(step, body.angle_rad);
        let free_m_s = self.slip(&solved, step, 0.0);
        let share = 2.0 * self.mass_kg / step.length_s * self.lever_m / solved.slope;
        Push {
            torque_nm: self.lever_m * (solved.carried_n + solved.carried_slope * free_m_s),
            slope_nms: self.lever_m * solved.carried_slope * share,
            held_by_nm: None,
        }
    }

    fn moved(&mut self, step: &Step, next: &Body, mean_rad_s: f64) {
        let h = step.length_s;
        if step.coil == Coil::Open {
            // The field of the coil goes up in the diodes.
            self.account.copper += 0.5 * self.henry * self.current_a * self.current_a;
            self.current_a = 0.0;
        }
        let solved = self.solve(step, next.angle_rad - h * mean_rad_s);
        let slip = self.slip(&solved, step, mean_rad_s);
        let current_a = solved.current_a + solved.current_slope * slip;
        let mean_m_s = self.lever_m * mean_rad_s + slip;
        self.account.supply += solved.volts * current_a * h;
        self.account.copper += self.ohm * current_a * current_a * h;
        self.account.damping += self.damping * slip * slip * h;
        self.account.weight += solved.weight_n * mean_m_s * h;
        if self.contact_m.is_some() {
            self.account.stops += self.bumper_damping * slip * slip * h;
        }
        self.volts = solved.volts;
        self.force_n = solved.carried_n + solved.carried_slope * slip;
        self.excursion_m += h * slip;
        self.velocity_m_s = 2.0 * mean_m_s - self.velocity_m_s;
        if step.coil != Coil::Open {
            self.current_a = 2.0 * current_a - self.current_a;
        }
        self.look_at_stops(slip);
    }

    fn weight(&self) -> Option<Weight> {
        let (turned, nm) = (
            self.gravity_rad?,
            self.mass_kg * STANDARD_GRAVITY * self.lever_m,
        );
        Some(Box::new(move |angle| nm * (angle + turned).cos()))
    }

    fn energy(&self, _: &Body, balance: &mut EnergyBalance) {
        let v = self.velocity_m_s;
        let pressed_m = self.contact_m.map_or(0.0, |met_m| self.excursion_m - met_m);
        for (what, account, joule) in [
            ("supply", Account::Given, self.account.supply),
            ("weight", Account::Given, self.account.weight),
            ("copper", Account::Lost, self.account.copper),
            ("damping", Account::Lost, self.account.damping),
            ("stops", Account::Lost, self.account.stops),
            ("moving mass", Account::Stored, 0.5 * self.mass_kg * v * v),
            (
                "field",
                Account::Stored,
                0.5 * self.henry * self.current_a * self.current_a,
            ),
            (
                "flexure",
                Account::Stored,
                0.5 * self.flexure * self.excursion_m * self.excursion_m,
            ),
            (
                "bumper",
                Account::Stored,
                0.5 * BUMPER_N_PER_M * pressed_m * pressed_m,
            ),
        ] {
            balance.add(NAME, what, account, joule);
        }
    }

    fn write_more(&self, _: &Body, row: &mut Vec<f64>) {
        #[expect(clippy::cast_precision_loss, reason = "a count of knocks")]
        let knocks = self.account.knocks as f64;
        row.extend([self.volts, self.current_a, self.excursion_m, knocks]);
    }

    fn coil_current_a(&self) -> Option<f64> {
        Some(self.current_a)
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        if self.account.knocks > 0 {
            warnings.push(format!(
                "the reaction mass met its stops {} times: less vibration-actuator.gain, a higher resonance_hz or more \
                 stroke_mm keeps it off",
                self.account.knocks
            ));
        }
    }
}
