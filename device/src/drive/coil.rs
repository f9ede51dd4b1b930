//! The coil of the vibration actuator: what its bridge puts out, and the checks that
//! switch it off.
//!
//! A fault of the coil is latched and the motor goes on. The measured current i is
//! compared with what the voltage V drives through the resistance R, for an inductance
//! that is not known and a back-EMF of which only the largest is, e = Bl·ω₀·X:
//!
//! ```text
//! short     |i| ≤ 1.3·(V̂ + e)/R + 0.15 A, 3.1 A  V̂: the largest |V| of the last milliseconds
//! open      ⟨V·i⟩ ≥ ⅛·⟨V²⟩/(R + Rm)              ⟨ ⟩: mean over 10 ms
//! hot       ⟨i²⟩ ≤ 1.25·Ic²                       mean over the model's 10 s
//! ```
//!
//! Rm is what the moving mass adds to R at its resonance, R·ζe/(ζ − ζe). An inductance
//! only delays the current, so that it exceeds the first bound in no tick, and turns
//! the power of the second into a smaller one: an eighth is reached where ωL = 2.6·R.
//! A sensor that is stuck, or that shows the other sign, violates one of the two.
//!
//! 3.1 A is what the sensor can tell from more. No voltage is put out that, with the back-EMF,
//! drives more than 3.1/1.1 A through R: a coil of nine tenths of R is then never taken for a
//! short. Where the back-EMF alone would, voltages that are compared stay, and a mass that is
//! thrown against its voltage may be.
//!
//! Not detected: a mass that is stuck or strikes its stops, as its back-EMF is a few percent of
//! the voltage, and a fifth of it at the resonance; a coil whose two wires are swapped, as current and voltage
//! fit; anything while the command is below 0.08 A.

use crate::board::LARGEST_COIL_DUTY;
use crate::drive::prepare::CoilPlan;
use crepitus_model::Real;
use crepitus_model::render::effects::vibration_actuator::HEATING_S;
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::{CoilFault, TICK_S};

/// Output of the coil's bridge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CoilOutput {
    /// All switches are open, at once.
    #[default]
    Asleep,
    /// This share of its supply's voltage from the next PWM period on, −1 to 1; positive
    /// pushes the shell towards growing angle.
    Driven(f32),
}

/// Ticks without a measured current until the fault.
const MISSING_TICKS: u8 = 3;

/// Tolerance of the current at the largest voltage: it may be this many times that of R.
const LEAST_MARGIN: f64 = 1.1;

/// Largest voltage over the root of the mean square from which on it is compared, at least: that
/// of a sine, and some.
const PEAK_OF_COMPARED: f64 = 1.7;

/// Ticks with too much current until the fault.
const SHORT_TICKS: u8 = 5;

/// Tolerance of the resistance for a cold coil, and of the current's sensor, A.
const COLD: f32 = 1.3;
const SHORT_SLACK_A: f32 = 0.15;

/// The most that the sensor can tell from more, A: its range is 3.3 A.
const SENSOR_A: f32 = 3.1;

/// Share of the largest voltage that is left a tick later: 5 ms, more than L/R of any
/// such coil.
const PEAK_KEPT: f32 = 0.99;

/// Share of the way to the means that a tick goes: 10 ms.
const MEAN_SHARE: f32 = 1.0 / 200.0;

/// Share of the power that a whole coil takes up, below which it does not follow.
const FOLLOWS_SHARE: f32 = 1.0 / 8.0;

/// Ticks for which it does not follow until the fault.
const BESIDE_TICKS: u8 = 60;

/// Current that the voltage would drive where it is compared, A: so much that a tenth of
/// it is above the amplifier's offset.
const LEAST_A: f32 = 0.08;

/// Share of the current that the voltage would drive, squared, below which there is
/// none: what the mean still remembers of the current before.
const NO_CURRENT_SHARE: f32 = 1.0 / 8.0;

/// Mean square of the current that is too hot, as a share of that which may last: above
/// what the command allows itself, and the sensor's error.
const HOT_SHARE: f32 = 1.25;

/// Share of the way to the mean square that the heat goes in a tick.
#[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
const HEATING: f32 = (TICK_S / HEATING_S) as f32;

/// Excursion of a chirp that is played, over the stroke, by the parameters in use: those
/// of an actuator that is not identified yet may be wrong by half.
const CHIRP_STROKES: f64 = 2.0;

/// Mean square of the current that is as good as cold, A²: a coil that is not used any more
/// is watched down to here.
const COLD_A2: f32 = 1e-4;

/// Share of the largest back-EMF, squared, above which voltages are compared.
const EMF_SHARE: f32 = 0.25;

/// The sums of what is compared, and for how long a condition has held.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    /// Largest voltage of the last milliseconds, V.
    peak_v: f32,
    /// Means of V², V·i and i².
    volts_squared: f32,
    power_w: f32,
    current_squared: f32,
    /// Mean square of the measured current over the time that the coil takes to get warm,
    /// A²; kept while it sleeps.
    heat_a2: f32,
    missing: u8,
    short: u8,
    beside: u8,
}

/// The coil.
#[derive(Clone, Copy, Debug)]
pub struct Coil {
    /// `None`: there is no actuator.
    plan: Option<CoilPlan>,
    /// The pending plan, applied once the command is zero: a command that fades out needs
    /// the active one.
    next: Option<CoilPlan>,
    has_next: bool,
    fault: Option<CoilFault>,
    /// Voltages that were put out last and before, V; `None` where it was asleep.
    last_v: Option<f32>,
    before_v: f32,
    means: Means,
}

impl Coil {
    /// Asleep.
    pub fn new(plan: Option<CoilPlan>) -> Self {
        Self {
            plan,
            next: None,
            has_next: false,
            fault: None,
            last_v: None,
            before_v: 0.0,
            means: Means::default(),
        }
    }

    /// Another plan, in force as soon as the command is silent.
    pub fn change(&mut self, plan: Option<CoilPlan>) {
        (self.next, self.has_next) = (plan, plan != self.plan);
    }

    /// True if an actuator is configured, a plan is pending, or the coil is still warm.
    #[inline]
    pub fn is_in_use(&self) -> bool {
        self.plan.is_some() || self.has_next || self.means.heat_a2 > COLD_A2
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<CoilFault> {
        self.fault
    }

    /// Clears the fault; the coil stays as warm as it is.
    pub fn clear(&mut self) {
        self.fault = None;
    }

    /// Checks the amplitude of a chirp, V.
    ///
    /// # Errors
    /// [`DriveRefusal::NoActuator`] without one, and while its fault is latched;
    /// [`DriveRefusal::ChirpOutOfRange`] above the limit.
    pub fn check_chirp(&self, amplitude_v: f32) -> Result<(), DriveRefusal> {
        let plan = self.plan.filter(|_| self.fault.is_none());
        let plan = plan.ok_or(DriveRefusal::NoActuator)?;
        if amplitude_v <= plan.most_chirp_v {
            Ok(())
        } else {
            Err(DriveRefusal::ChirpOutOfRange)
        }
    }

    /// True if the bridge was driven in the last tick, so that the current is valid.
    #[inline]
    pub fn is_driven(&self) -> bool {
        self.last_v.is_some()
    }

    /// One tick: the output for the command `coil_v`, V, where the coil `may` be driven.
    /// `current_a` and `has_tripped` are those of the coil since the last output.
    // Out of line: not every device has one, and its registers are then not saved.
    #[inline(never)]
    pub fn tick(
        &mut self,
        coil_v: f32,
        may: bool,
        current_a: Option<f32>,
        has_tripped: bool,
    ) -> CoilOutput {
        if self.has_next && (coil_v == 0.0 || !may) {
            (self.plan, self.has_next) = (self.next, false);
        }
        let Some(plan) = &self.plan else {
            self.means.cool();
            return self.sleep();
        };
        if let Some(last_v) = self.last_v {
            let mean_v = 0.5 * (self.before_v + last_v);
            let found = match current_a.filter(|a| a.is_finite()) {
                Some(current_a) => self.means.check(plan, mean_v, current_a),
                None => self.means.miss(),
            };
            let tripped = has_tripped.then_some(CoilFault::Driver);
            self.fault = self.fault.or(tripped).or(found);
        } else {
            self.means.cool();
        }
        if !may || self.fault.is_some() || !coil_v.is_finite() {
            return self.sleep();
        }
        let duty = (coil_v * plan.duty_per_volt).within(plan.largest_duty);
        // Before the first output its terminals were open.
        self.before_v = self.last_v.unwrap_or(0.0);
        self.last_v = Some(duty * plan.supply_v);
        CoilOutput::Driven(duty)
    }

    fn sleep(&mut self) -> CoilOutput {
        self.last_v = None;
        self.means = Means {
            heat_a2: self.means.heat_a2,
            ..Means::default()
        };
        CoilOutput::Asleep
    }
}

impl Means {
    /// A tick that was driven without a measured current.
    #[cold]
    fn miss(&mut self) -> Option<CoilFault> {
        self.missing = self.missing.saturating_add(1);
        (self.missing >= MISSING_TICKS).then_some(CoilFault::CurrentMissing)
    }

    /// A tick that was not driven.
    fn cool(&mut self) {
        self.heat_a2 -= HEATING * self.heat_a2;
    }

    /// Checks of a tick that was driven with this voltage, the most urgent first.
    #[inline]
    fn check(&mut self, plan: &CoilPlan, volts: f32, current_a: f32) -> Option<CoilFault> {
        self.missing = 0;
        self.peak_v = volts.abs().at_least(PEAK_KEPT * self.peak_v);
        let most_a = COLD * plan.per_ohm * (self.peak_v + plan.emf_v) + SHORT_SLACK_A;
        let most_a = most_a.at_most(SENSOR_A);
        self.short = held(self.short, current_a.abs() > most_a);
        let squared = current_a * current_a;
        self.volts_squared += MEAN_SHARE * (volts * volts - self.volts_squared);
        self.power_w += MEAN_SHARE * (volts * current_a - self.power_w);
        self.current_squared += MEAN_SHARE * (squared - self.current_squared);
        self.heat_a2 += HEATING * (squared - self.heat_a2);
        let is_beside = self.volts_squared > plan.compared_v2
            && self.power_w < plan.least_power * self.volts_squared;
        self.beside = held(self.beside, is_beside);
        if self.short >= SHORT_TICKS {
            Some(CoilFault::Short)
        } else if self.beside >= BESIDE_TICKS {
            Some(self.does_not_follow(plan))
        } else {
            (self.heat_a2 > plan.most_a2).then_some(CoilFault::Hot)
        }
    }

    /// Returns whether there is no current, or another one.
    #[cold]
    fn does_not_follow(&self, plan: &CoilPlan) -> CoilFault {
        let whole_a2 = self.volts_squared * plan.per_ohm * plan.per_ohm;
        if self.current_squared < NO_CURRENT_SHARE * whole_a2 {
            CoilFault::Open
        } else {
            CoilFault::CurrentMismatch
        }
    }
}

/// Ticks for which a condition has held, with this one.
#[inline]
fn held(ticks: u8, holds: bool) -> u8 {
    if holds { ticks.saturating_add(1) } else { 0 }
}

/// Bounds of the checks, from the settings of the actuator.
impl CoilPlan {
    /// Computes the bounds for an actuator that is fitted.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
    pub fn new(
        s: &crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings,
    ) -> Self {
        let emf_v = s.force_constant_n_per_a * s.resonance_rad_s() * s.stroke_mm * 1e-3;
        let least_v = f64::from(LEAST_A) * s.resistance_ohm;
        let compared_v2 = (f64::from(EMF_SHARE) * emf_v * emf_v).max(least_v * least_v);
        // R/(R + Rm).
        let at_resonance = 1.0 - s.electric_damping_ratio() / s.damping_ratio;
        let least_power = f64::from(FOLLOWS_SHARE) * at_resonance / s.resistance_ohm;
        let ratio = s.damping_ratio;
        // A steady voltage moves the mass by Bl/(R·k), the resonance 1/(2ζ) times as far.
        let m_per_v = s.force_constant_n_per_a / (s.resistance_ohm * s.stiffness_n_per_m());
        let most_m = CHIRP_STROKES * s.stroke_mm * 1e-3;
        let chirp_v = most_m * (2.0 * ratio).min(1.0) / m_per_v;
        let measurable_v = f64::from(SENSOR_A) / LEAST_MARGIN * s.resistance_ohm - emf_v;
        let measurable_v = measurable_v.max(PEAK_OF_COMPARED * compared_v2.sqrt());
        let supplied_v = measurable_v.min(f64::from(LARGEST_COIL_DUTY) * s.supply_v);
        let continuous_a2 = s.continuous_current_a * s.continuous_current_a;
        Self {
            supply_v: s.supply_v as f32,
            duty_per_volt: (1.0 / s.supply_v) as f32,
            largest_duty: (supplied_v / s.supply_v) as f32,
            per_ohm: (1.0 / s.resistance_ohm) as f32,
            emf_v: emf_v as f32,
            compared_v2: compared_v2 as f32,
            least_power: least_power as f32,
            most_a2: HOT_SHARE * continuous_a2 as f32,
            most_chirp_v: chirp_v.min(supplied_v) as f32,
        }
    }
}

#[cfg(test)]
mod tests;
