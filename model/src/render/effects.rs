//! The effects of a device besides its joint: a file, and a line here, each.
//!
//! An effect's file has its parameters (`settings!`), its law ([`DeviceEffect`])
//! and its description ([`EffectSpec`]). From the line here follow the device's
//! parameters and commits, scene files, traces, studies, and the count of its
//! cycles on the target. A symptom implements [`Law`].

#[macro_use]
mod table;
pub mod bone_shaping;
pub mod clasp_knife;
pub mod clonus;
pub mod cogwheel;
mod faded;
pub mod friction_compensation;
pub mod lead_pipe;
mod outliving;
mod phases;
pub mod play;
pub mod range_limit;
mod slewed;
pub mod spasticity;
mod states;
pub mod symptom;
pub mod tank;
pub mod texture;
mod together;
pub mod vibration_actuator;

pub use faded::Faded;
pub use outliving::Outliving;
pub use phases::{PhaseSpec, Phases};
pub use slewed::Slewed;
pub use states::{STATES, StateName};
pub use together::MOST_SHARE_AT_A_WALL;

use super::input_check::Checked;
use super::position::{Position, Scale, Sensing, Travel};
use super::{Addition, ShaftEstimate, Shown};
use crate::joint::{LONGEST_STEP_S, SettingsError};
use crate::parameters::{
    Choice, Chosen, Parameter, ParameterSpec, Source, Tabled, filled, same, switch,
};
use crate::real::Real;
use symptom::{Besides, Bounds, Change, ClinicWords, Law, law_nm};
use tank::Tank;

effects! {
    symptoms {
        range_limit: RangeLimit, RangeLimitSettings;
        lead_pipe: LeadPipe, LeadPipeSettings;
        cogwheel: Cogwheel, CogwheelSettings;
        spasticity: Spasticity, SpasticitySettings;
        clasp_knife: ClaspKnife, ClaspKnifeSettings;
        clonus: Clonus, ClonusSettings;
        texture: Texture, TextureSettings;
    }
    additions {
        friction_compensation: FrictionCompensation, FrictionCompensationSettings;
        bone_shaping: BoneShaping, BoneShapingSettings;
        vibration_actuator: VibrationActuator, VibrationActuatorSettings;
    }
}

/// Description of an effect.
#[derive(Clone, Copy, Debug)]
pub struct EffectSpec {
    /// Name in scene files; the group of its parameters.
    pub name: &'static str,
    /// Description of its contribution.
    pub adds: &'static str,
    /// State variables of the effect.
    pub states: &'static [&'static str],
    /// Column of a trace: what it adds.
    pub column: &'static str,
    /// The unit of that: N·m, or V of a coil of its own.
    pub unit: &'static str,
    /// Title of the chart of it.
    pub title: &'static str,
    /// Phases of the effect, if it has several.
    pub phases: Option<PhaseSpec>,
    /// Effects without which it has no meaning.
    pub needs: &'static [Need],
    /// Parameters of the effect.
    pub parameters: &'static [ParameterSpec],
    /// Choices of the effect.
    pub choices: &'static [Choice],
    /// Owner of the effect.
    pub of: Owner,
    /// Prefixes of the names of parameters that belong to a side. In a scene a
    /// name without a prefix stands for all sides.
    pub sides: &'static [&'static str],
}

/// Owner of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The knee's: presets set it.
    Knee,
    /// The brace's: its numbers were identified once, and no preset changes them unless it
    /// names the effect.
    Brace,
}

/// An effect that another one needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Name of the effect that is needed.
    pub effect: &'static str,
    /// Reason why it is needed.
    pub why: &'static str,
}

/// Time on the device, as a law needs to know it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Length of a tick, s.
    pub step_s: f64,
    /// The most ticks between a sample and the torque that answers it.
    pub delay_ticks: usize,
    /// Sensing that the device has of the joint.
    pub sensing: Sensing,
}

impl Timing {
    /// Scale of angles and times for a symptom.
    ///
    /// # Errors
    /// [`SettingsError::Step`] if the tick is no time that a device has.
    pub fn scale<F: Real>(&self) -> Result<Scale<F>, SettingsError> {
        let step_s = self.step_s;
        if step_s > 0.0 && step_s <= LONGEST_STEP_S {
            Ok(Scale::new(&self.sensing, step_s))
        } else {
            Err(SettingsError::Step { step_s })
        }
    }
}

/// Input of an effect in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a, F> {
    /// The joint's velocity as far as known, rad/s.
    pub omega_rad_s: F,
    /// The joint's travel since the last sample that was taken, rad; without a good one none.
    pub travel_rad: F,
    /// Motion of the joint that symptoms may believe; `None` without a good sample.
    pub travel: Option<&'a Travel<F>>,
    /// Consecutive ticks without a good sample.
    pub missing_ticks: u32,
    /// Place of the joint, or the place where it was seen last.
    pub place: Position<F>,
    /// The motor is driven: symptoms act.
    pub is_driven: bool,
    /// The share of torque that is paid from the tank.
    pub paid_share: F,
}

impl<'a, F: Real> Tick<'a, F> {
    /// Input from this sample.
    #[inline]
    pub fn of(
        seen: &ShaftEstimate<F>,
        input: &Checked<F>,
        travel: Option<&'a Travel<F>>,
        paid_share: F,
    ) -> Self {
        Self {
            omega_rad_s: seen.omega_rad_s,
            travel_rad: input.travel_rad().unwrap_or(F::ZERO),
            travel,
            missing_ticks: match input {
                Checked::Missing(ticks) => *ticks,
                _ => 0,
            },
            place: seen.place,
            is_driven: seen.is_driven,
            paid_share,
        }
    }
}

/// Sees what happens to the symptoms of the table.
pub trait Observe<F> {
    /// Whether anybody does.
    const LISTENS: bool;

    /// Something has happened to this effect.
    fn change(&mut self, effect: &'static EffectSpec, change: Change<F>);

    /// In this tick a symptom that gives energy asks for a torque, and the tank pays so much
    /// of it, N·m.
    fn paid(&mut self, _: &'static EffectSpec, _asked_nm: F, _paid_nm: F) {}
}

impl<F> Observe<F> for () {
    const LISTENS: bool = false;

    #[inline]
    fn change(&mut self, _: &'static EffectSpec, _: Change<F>) {}
}

impl<F, O: FnMut(&'static EffectSpec, Change<F>)> Observe<F> for O {
    const LISTENS: bool = true;

    #[inline]
    fn change(&mut self, effect: &'static EffectSpec, change: Change<F>) {
        self(effect, change);
    }
}

/// Energy that all symptoms that are no springs may return at once, J.
pub const TANK_J: f64 = 0.2;

/// Power that all symptoms that are no springs may return continuously, W: in any 2 s at most 0.28 J, with
/// a bone's ringing less than the half joule that a device may give a leg.
pub const TANK_REFILL_W: f64 = 0.04;

/// Share of the height of a beat, or of a reflex, that has to reach the motor for it to count as
/// felt: below half of it, what is felt is another knee's.
pub const FELT_SHARE: f64 = 0.5;

/// Destination of an effect's contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// N·m of the motor.
    Joint,
    /// N·m that the [actuator on the shell](vibration_actuator) alone gets.
    Shell,
    /// V at the coil of that actuator.
    Coil,
}

/// The law of an effect, with its state.
pub trait DeviceEffect<F: Real>: Sized {
    /// Parameters of the effect.
    type Settings;

    /// Part of the law that a commit replaces.
    type Coefficients: Copy + core::fmt::Debug + PartialEq;

    /// Method by which it is switched and changed while the device runs: [`Slewed`],
    /// [`Faded`] or [`Outliving`].
    type Switched: Switched<F, Self>;

    /// Description of the effect.
    const SPEC: EffectSpec;

    /// Whether it renders a disorder: its torque is then part of the model's.
    const IS_SYMPTOM: bool = false;

    /// Coefficients for settings; computed in f64 and rounded once.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting or the tick is out of range.
    fn coefficients(
        settings: &Self::Settings,
        timing: &Timing,
    ) -> Result<Self::Coefficients, SettingsError>;

    /// Returns the effect at rest, with these coefficients.
    fn new(coefficients: Self::Coefficients) -> Self;

    /// Puts it at rest as at arming: at this place of the joint. Only symptoms have one.
    fn rest(&mut self, _: &Position<F>) {}

    /// Destination of the contribution of an effect with these settings.
    fn target_of(_: &Self::Settings) -> Target {
        Target::Joint
    }

    /// Destination of this effect's contribution.
    #[inline]
    fn target(&self) -> Target {
        Target::Joint
    }

    /// Contribution in this tick, N·m or V.
    fn added(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F;

    /// The number of its phase.
    fn phase(&self) -> u16 {
        0
    }
}

/// Every symptom is an effect.
impl<F: Real, L: Law<Real = F>> DeviceEffect<F> for L {
    type Settings = L::Settings;
    type Coefficients = L::Coefficients;
    type Switched = Outliving<F, L>;

    const SPEC: EffectSpec = L::SPEC;
    const IS_SYMPTOM: bool = true;

    fn coefficients(
        settings: &L::Settings,
        timing: &Timing,
    ) -> Result<L::Coefficients, SettingsError> {
        <L as Law>::coefficients(settings, timing)
    }

    fn new(coefficients: L::Coefficients) -> Self {
        <L as Law>::new(coefficients)
    }

    fn rest(&mut self, place: &Position<F>) {
        Law::rest(self, place);
    }

    #[inline]
    fn added(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F {
        let mut besides = Besides::NOTHING;
        let mut nm = law_nm(self, tick.travel, &mut besides, observe);
        if self.is_active() {
            let asked_nm = nm;
            nm = besides.pay(asked_nm, tick.paid_share);
            besides.active_nm = nm;
            observe.paid(const { &<L as Law>::SPEC }, asked_nm, nm);
        }
        besides.add_to(tick.paid_share, shown);
        nm
    }

    fn phase(&self) -> u16 {
        Law::phase(self)
    }
}

/// An effect on a device that runs.
pub trait Switched<F: Real, E: DeviceEffect<F>> {
    /// Absent.
    fn new(slew_nm: F) -> Self;

    /// Applies another law, or none, from the next tick on, where coefficients are given;
    /// the torque changes for it by at most `slew_nm` a tick.
    fn change(&mut self, coefficients: &Option<Option<E::Coefficients>>, slew_nm: F);

    /// Puts it at rest as at arming, at this place of the joint.
    fn rest(&mut self, _: &Position<F>) {}

    /// The law in force.
    fn law(&self) -> Option<&E>;
}

/// One that is no symptom: it adds by itself. (Symptoms are followed together.)
pub trait Adds<F: Real, E: DeviceEffect<F>>: Switched<F, E> {
    /// Adds its torque to what is shown, and returns it, N·m.
    fn tick(
        &mut self,
        tick: &Tick<'_, F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> F;
}

/// The tank of a device's symptoms.
fn tank<F: Real>(timing: &Timing) -> Tank<F> {
    Tank::new(TANK_J, TANK_REFILL_W, timing.step_s, timing.delay_ticks)
}

/// Adds to where it goes.
#[inline]
fn give<F: Real>(target: Target, added: F, shown: &mut Shown<F>) {
    // Each by its value: a choice of the place to add to would keep all of `shown` in
    // memory, which is over a hundred cycles on the target.
    let with = |to, was: F| if target == to { was + added } else { was };
    shown.torque_nm = with(Target::Joint, shown.torque_nm);
    shown.shell_nm = with(Target::Shell, shown.shell_nm);
    shown.coil_v = with(Target::Coil, shown.coil_v);
}

/// A bit for an effect, at its place in the table.
const fn bit<E: DeviceEffect<f64>>() -> u32 {
    let (mut bit, mut specs) = (1, SPECS);
    while let [spec, rest @ ..] = specs {
        if same(spec.name, E::SPEC.name) {
            break;
        }
        bit <<= 1;
        specs = rest;
    }
    bit
}

/// Enters the phase of an effect that has acted, and the model's torque if it is a symptom.
#[inline]
fn note<F: Real, E: DeviceEffect<F>>(law: Option<&E>, added_nm: F, shown: &mut Shown<F>) {
    if E::IS_SYMPTOM {
        shown.model_torque_nm += added_nm;
    }
    if const { E::SPEC.phase_bits() > 0 }
        && let Some(law) = law
    {
        shown.phases = shown.phases.with(const { E::SPEC.place() }, law.phase());
    }
}

/// Runs code with the law of an effect.
pub trait LawVisitor<F: Real> {
    /// Result of `visit`.
    type Output;

    /// The law that was asked for.
    fn visit<E: DeviceEffect<F>>(self, law: E) -> Self::Output;
}

#[cfg(test)]
pub(crate) mod tests;
