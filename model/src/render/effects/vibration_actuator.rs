//! A reaction-mass actuator on the shell that the trainee's hand holds.
//!
//! Rotor, brace and cuff swallow what is fast in the rendered torque: of a ripple
//! of 0.4 N·m the hand gets 5 mN·m. A small moving mass near the ankle pushes the
//! shell with the missing force itself. Above the corner fc it is
//!
//! ```text
//! force on the shell = −g·T/r          T = torque of all symptoms, with a bone's ringing
//! ```
//!
//! so that at g = 1 a shell that is held gets what a knee that gives T at its
//! axis gives at the lever r. The motor gets T as ever: a crossover in its path
//! would be a delay inside the loop of the stick, and makes it hum.
//!
//! **The filters.** A voltage V at a coil with force constant Bl and resistance R
//! moves a mass on a flexure, and the shell gets its reaction
//!
//! ```text
//! F/V = (Bl/R)·s²/(s² + 2ζω₀·s + ω₀²)
//! ```
//!
//! ζ with the damping of the back-EMF. The command moves that resonance down to
//! the corner, and adds a high-pass: both together are a Butterworth filter of
//! fourth order,
//!
//! ```text
//!                    s²            s² + 2ζω₀·s + ω₀²
//! V = −g·T·R/(Bl·r)·────────────────·─────────────────    2ζ₁ = 1/1.307, 2ζ₂ = 1/0.541
//!              s² + 2ζ₁ωc·s + ωc²   s² + 2ζ₂ωc·s + ωc²
//! ```
//!
//! Each is an oscillator that a held input pulls ([`oscillator`](crate::joint::oscillator)):
//! its motion over a tick is exact. What is kept is the distance from the input,
//! which is small where the mean torque is large, so that f32 loses nothing.
//!
//! **Limits.** An observer of the mass knows its excursion x and the coil's current;
//! its own gravity and the motion of the leg it does not know, so a part of the
//! stroke is left for them. From 80 % of what may be on,
//! the command is reduced: where it drives the mass further out, for the
//! excursion; at all, for the mean square of the current. The voltage is cut at the
//! supply's. So for any torque
//!
//! ```text
//! |V| ≤ supply,   √(x² + (ẋ/ω₀)²) ≤ limit,   mean square of the current ≤ limit²
//! ```
//!
//! up to what one tick adds. The command fades in, and out before a filter is exchanged.
//!
//! Sources: the moving coil is a Moticont LVCM-016-010-01 (1.1 N/A, 1.8 Ω,
//! ±1.6 mm, 1.45 A); mass, flexure, lever and time constants are engineering
//! estimates; corner and gain from simulations of the coupled leg, see the book.

mod exchanged;
mod settings;

pub use exchanged::Exchanged;
pub use settings::VibrationActuatorSettings;

use crate::joint::oscillator::{Oscillator, Transition};
use crate::joint::{LONGEST_STEP_S, Parameters, SettingsError};
use crate::parameters::Tabled;
use crate::real::Real;
use crate::render::Shown;
use crate::render::effects::{
    DeviceEffect, EffectSpec, Need, Observe, Owner, PhaseSpec, Target, Tick, Timing,
};

/// 2ζ of the two halves of a Butterworth filter of fourth order: 2·sin(π/8), and
/// 2·sin(3π/8).
const BUTTERWORTH: [f64; 2] = [0.765_366_864_730_179_5, 1.847_759_065_022_573_5];

/// Share of a limit at which reductions begin.
const BEGINS_AT: f64 = 0.8;

/// Time constant of the mean square of the current, s: estimate for a coil of a few
/// grams of copper.
pub const HEATING_S: f64 = 10.0;

/// Rate at which the gain rises and falls, 1/s: a fade of 50 ms.
const FADE_PER_S: f64 = 20.0;

/// The phases, by number: what holds the command back.
const ACTING: u16 = 1;
const VOLTAGE: u16 = 2;
const EXCURSION: u16 = 3;
const HEAT: u16 = 4;

/// An oscillator that follows its input, as a filter: the low-pass is where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Follower<F> {
    /// The motion over a tick.
    swing: Transition<F>,
    /// 2ζ/ω, s.
    damping_s: F,
}

/// State of a follower.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Following<F> {
    input: F,
    /// Distance from the input.
    behind: F,
    rate: F,
}

/// Output of a follower: each times a power of s/ω.
struct Parts<F> {
    high: F,
    rate: F,
    low: F,
}

impl<F: Real> Follower<F> {
    /// Follower with this frequency, rad/s, and 2ζ.
    fn new(omega: f64, two_zeta: f64, step_s: f64) -> Self {
        let oscillator = Oscillator::<F>::of(&Parameters {
            inertia_kg_m2: 1.0,
            stiffness_nm_per_rad: omega * omega,
            damping_nms_per_rad: two_zeta * omega,
            kinetic_torque_nm: 0.0,
            static_torque_nm: 0.0,
        });
        Self {
            swing: oscillator.transition(F::from_f64(step_s)),
            damping_s: F::from_f64(two_zeta / omega),
        }
    }

    /// The output now, for an input that is held over the tick that begins.
    #[inline]
    fn tick(&self, state: &mut Following<F>, input: F) -> Parts<F> {
        let behind = state.behind - (input - state.input);
        let parts = Parts {
            high: -behind - self.damping_s * state.rate,
            rate: state.rate,
            low: input + behind,
        };
        let (behind, rate) = self.swing.apply(behind, state.rate);
        *state = Following {
            input,
            behind: behind.settled(),
            rate: rate.settled(),
        };
        parts
    }
}

impl<F: Real> Following<F> {
    /// State as if this had been the input for ever.
    #[inline]
    fn at(input: F) -> Self {
        Self {
            input,
            behind: F::ZERO,
            rate: F::ZERO,
        }
    }
}

/// Coefficients that a commit replaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<F> {
    gain: F,
    /// The rest, for which the command fades out.
    design: Design<F>,
}

/// The filters, the observer, and the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Design<F> {
    high_pass: Follower<F>,
    equaliser: Follower<F>,
    /// Factors of its rate, and of its low-pass, that the equaliser adds.
    of_rate: F,
    of_low: F,
    volts_per_nm: F,
    most_v: F,
    /// The mass over a tick; its place is a share of the excursion that may be.
    mass: Transition<F>,
    share_per_v: F,
    /// 1/ω₀², s².
    per_omega_squared: F,
    /// Current, as a share of what may last: of the voltage, and of the mass.
    per_v: F,
    per_rate: F,
    /// Share of the way to its mean that the heat goes in a tick.
    heating: F,
    /// Change of the gain in a tick.
    fade: F,
}

/// The command for an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VibrationActuator<F> {
    /// The gain that is faded to.
    goal: F,
    gain: F,
    high_pass: Following<F>,
    equaliser: Following<F>,
    /// Observed excursion and its rate, as a share of what may be.
    excursion: F,
    excursion_rate: F,
    /// Mean square of the current, as a share of what may last.
    heat: F,
    phase: u16,
    has_begun: bool,
    design: Design<F>,
}

impl<F: Real> DeviceEffect<F> for VibrationActuator<F> {
    type Settings = VibrationActuatorSettings;
    type Coefficients = Coefficients<F>;
    type Switched = Exchanged<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "vibration-actuator",
        adds: "a reaction-mass actuator on the shell that the hand holds, driven by the same model",
        states: &[
            "high-pass",
            "its rate",
            "equaliser",
            "its rate",
            "excursion",
            "its rate",
            "heat",
        ],
        column: "coil_command_v",
        unit: "V",
        title: "Vibration actuator, voltage commanded",
        phases: Some(PhaseSpec {
            column: "vibration_actuator_phase",
            names: &["silent", "acting", "voltage", "excursion", "heat"],
        }),
        needs: &[Need {
            effect: "reaction-mass",
            why: "it is the actuator that is commanded",
        }],
        parameters: VibrationActuatorSettings::TABLE,
        choices: VibrationActuatorSettings::CHOICES,
        of: Owner::Brace,
        sides: &[],
    };

    fn coefficients(
        settings: &VibrationActuatorSettings,
        timing: &Timing,
    ) -> Result<Coefficients<F>, SettingsError> {
        settings.check()?;
        let step_s = timing.step_s;
        if !(step_s > 0.0 && step_s <= LONGEST_STEP_S) {
            return Err(SettingsError::Step { step_s });
        }
        let f = F::from_f64;
        let corner = core::f64::consts::TAU * settings.corner_hz;
        let omega = settings.resonance_rad_s();
        let two_zeta = 2.0 * settings.damping_ratio;
        let [first, second] = BUTTERWORTH;
        let force_per_v = settings.force_constant_n_per_a / settings.resistance_ohm;
        let most_m = settings.usable_stroke_m();
        let emf_a_per_m_s = force_per_v;
        Ok(Coefficients {
            gain: f(settings.gain),
            design: Design {
                high_pass: Follower::new(corner, first, step_s),
                equaliser: Follower::new(corner, second, step_s),
                of_rate: f(two_zeta * omega / (corner * corner)),
                of_low: f(omega * omega / (corner * corner)),
                volts_per_nm: f(settings.volts_per_nm()),
                most_v: f(settings.supply_v),
                mass: Follower::new(omega, two_zeta, step_s).swing,
                share_per_v: f(force_per_v / (settings.stiffness_n_per_m() * most_m)),
                per_omega_squared: f(1.0 / (omega * omega)),
                per_v: f(1.0 / (settings.resistance_ohm * settings.continuous_current_a)),
                per_rate: f(emf_a_per_m_s * most_m / settings.continuous_current_a),
                heating: f(step_s / HEATING_S),
                fade: f(FADE_PER_S * step_s),
            },
        })
    }

    /// Silent, with a cold coil.
    fn new(coefficients: Coefficients<F>) -> Self {
        Self {
            goal: coefficients.gain,
            gain: F::ZERO,
            high_pass: Following::at(F::ZERO),
            equaliser: Following::at(F::ZERO),
            excursion: F::ZERO,
            excursion_rate: F::ZERO,
            heat: F::ZERO,
            phase: 0,
            has_begun: false,
            design: coefficients.design,
        }
    }

    fn target_of(_: &VibrationActuatorSettings) -> Target {
        Target::Coil
    }

    #[inline]
    fn target(&self) -> Target {
        Target::Coil
    }

    #[inline]
    fn added(&mut self, tick: &Tick<'_, F>, shown: &mut Shown<F>, _: &mut impl Observe<F>) -> F {
        // What compensates the gear's friction is no part of the joint.
        let torque_nm = shown.torque_nm - shown.added.friction_compensation + shown.shell_nm;
        self.tick(torque_nm, tick.is_driven)
    }

    fn phase(&self) -> u16 {
        self.phase
    }
}

impl<F: Real> VibrationActuator<F> {
    /// One tick: the voltage at the coil from now to the next, V, for a knee that
    /// shows this torque, N·m. Zero while nothing is driven, and where the torque is
    /// no finite number.
    // By name in a profile: a test looks for it where it should not be.
    #[inline(never)]
    pub fn tick(&mut self, torque_nm: F, is_driven: bool) -> F {
        if !(is_driven && self.has_begun && torque_nm.is_finite()) {
            self.rest(torque_nm);
            self.has_begun = is_driven;
            return F::ZERO;
        }
        let design = &self.design;
        self.gain += (self.goal - self.gain).within(design.fade);
        let high = design.high_pass.tick(&mut self.high_pass, torque_nm).high;
        let parts = design.equaliser.tick(&mut self.equaliser, high);
        let shaped_nm = parts.high + (design.of_rate * parts.rate + design.of_low * parts.low);
        let volts = self.limited(self.gain * design.volts_per_nm * shaped_nm);
        self.observe(volts);
        volts
    }

    /// Resets the state as if the knee had shown this torque for ever; the coil stays warm.
    #[cold]
    #[inline(never)]
    fn rest(&mut self, torque_nm: F) {
        let torque_nm = if torque_nm.is_finite() {
            torque_nm
        } else {
            F::ZERO
        };
        let cooled = self.heat - self.design.heating * self.heat;
        *self = Self {
            goal: self.goal,
            high_pass: Following::at(torque_nm),
            heat: cooled,
            ..Self::new(Coefficients {
                gain: self.goal,
                design: self.design,
            })
        };
    }

    /// Command as the limits leave it, V.
    #[inline]
    fn limited(&mut self, wanted_v: F) -> F {
        let steep = F::from_f64(1.0 / (1.0 - BEGINS_AT));
        let steep_squared = F::from_f64(1.0 / (1.0 - BEGINS_AT * BEGINS_AT));
        let mut volts = wanted_v;
        self.phase = ACTING;
        let cool = steep * (F::ONE - self.heat);
        if cool < F::ONE {
            volts = cool.at_least(F::ZERO) * volts;
            self.phase = HEAT;
        }
        let rate = self.excursion_rate;
        let swing = self.excursion * self.excursion + rate * rate * self.design.per_omega_squared;
        let room = steep_squared * (F::ONE - swing);
        if room < F::ONE && volts * rate > F::ZERO {
            volts = room.at_least(F::ZERO) * volts;
            self.phase = EXCURSION;
        }
        if volts.abs() > self.design.most_v {
            volts = volts.within(self.design.most_v);
            self.phase = VOLTAGE;
        }
        volts
    }

    /// The mass and the coil over the tick that begins.
    #[inline]
    fn observe(&mut self, volts: F) {
        let design = &self.design;
        let current = design.per_v * volts - design.per_rate * self.excursion_rate;
        self.heat += design.heating * (current * current - self.heat);
        let middle = design.share_per_v * volts;
        let (from, rate) = design
            .mass
            .apply(self.excursion - middle, self.excursion_rate);
        self.excursion = (middle + from).settled();
        self.excursion_rate = rate.settled();
    }

    /// Observed amplitude √(x² + (ẋ/ω₀)²), as a share of what may be.
    pub fn amplitude(&self) -> F {
        let rate = self.excursion_rate;
        (self.excursion * self.excursion + rate * rate * self.design.per_omega_squared).sqrt()
    }

    /// Observed mean square of the current, as a share of what may last.
    pub fn heat(&self) -> F {
        self.heat
    }
}

#[cfg(test)]
mod tests;
