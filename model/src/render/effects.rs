//! The effects of a device besides its joint: a file, and a line here, each.
//!
//! An effect's file has its parameters (`settings!`), its law ([`DeviceEffect`])
//! and its description ([`EffectSpec`]). From the line here follow the device's
//! parameters and commits, scene files, traces, studies, and the count of its
//! cycles on the target.

#[macro_use]
mod table;
pub mod bone_shaping;
mod faded;
pub mod friction_compensation;
mod phases;
mod slewed;

pub use faded::Faded;
pub use phases::{PhaseSpec, Phases};
pub use slewed::Slewed;

use super::input_check::Checked;
use super::{Addition, Seen, Shown};
use crate::joint::SettingsError;
use crate::parameters::{Parameter, ParameterSpec, Source, Tabled, filled, switch};
use crate::real::Real;

effects! {
    friction_compensation: FrictionCompensation, FrictionCompensationSettings;
    bone_shaping: BoneShaping, BoneShapingSettings;
}

/// Description of an effect.
#[derive(Clone, Copy, Debug)]
pub struct EffectSpec {
    /// Name in scene files; the group of its parameters.
    pub name: &'static str,
    /// What it adds.
    pub adds: &'static str,
    /// Its state variables.
    pub states: &'static [&'static str],
    /// Column of a trace: the torque that it adds, N·m.
    pub column: &'static str,
    /// Title of the chart of that torque.
    pub title: &'static str,
    /// Its phases, if it has several.
    pub phases: Option<PhaseSpec>,
    /// Effects without which it has no meaning.
    pub needs: &'static [Need],
    /// Its parameters.
    pub parameters: &'static [ParameterSpec],
}

/// An effect that another one needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Its name.
    pub effect: &'static str,
    /// Why.
    pub why: &'static str,
}

/// Time on the device, as a law needs to know it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Length of a tick, s.
    pub step_s: f64,
    /// The most ticks between a sample and the torque that answers it.
    pub delay_ticks: usize,
}

/// The law of an effect, with its state.
pub trait DeviceEffect<F: Real>: Sized {
    /// Its parameters.
    type Settings;

    /// How it is switched and changed while the device runs: [`Slewed`] or
    /// [`Faded`].
    type Switched: Switched<F, Self>;

    /// Its description.
    const SPEC: EffectSpec;

    /// Whether it renders a disorder: its torque is then part of the model's.
    const IS_SYMPTOM: bool = false;

    /// At rest, from settings; computed in f64 and rounded once.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting or the tick is out of range.
    fn new(settings: &Self::Settings, timing: &Timing) -> Result<Self, SettingsError>;

    /// The torque to add in this tick, N·m.
    fn added_nm(&mut self, seen: &Seen<F>, input: &Checked<F>, shown: &Shown<F>) -> F;

    /// The number of its phase.
    fn phase(&self) -> u16 {
        0
    }
}

/// An effect on a device that runs.
pub trait Switched<F, E> {
    /// Absent.
    fn new(slew_nm: F) -> Self;

    /// Adds its torque to what is shown, and returns it, N·m.
    fn tick(&mut self, seen: &Seen<F>, input: &Checked<F>, shown: &mut Shown<F>) -> F;

    /// From the next tick on: another law, or none, where `law` is given; and
    /// torque that changes for it by at most `slew_nm` a tick.
    fn change(&mut self, law: Option<Option<E>>, slew_nm: F);

    /// The law in force.
    fn law(&self) -> Option<&E>;
}

/// What else is shown of an effect that has acted.
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
    /// What it returns.
    type Output;

    /// The law that was asked for.
    fn visit<E: DeviceEffect<F>>(self, law: E) -> Self::Output;
}

#[cfg(test)]
pub(crate) mod tests {
    use super::friction_compensation::{FrictionCompensation, FrictionCompensationSettings};
    use super::*;
    use crate::ShaftStep;

    pub(crate) const TIMING: Timing = Timing {
        step_s: 5e-5,
        delay_ticks: 1,
    };

    pub(crate) fn seen(omega_rad_s: f32) -> Seen<f32> {
        Seen::taken(&ShaftStep {
            delta_phi_rad: 0.0,
            omega_start_rad_s: omega_rad_s,
            omega_end_rad_s: omega_rad_s,
        })
    }

    /// What an effect adds to 1 N·m in a tick, and what is shown then.
    pub(crate) fn after<E>(
        stage: &mut impl Switched<f32, E>,
        omega_rad_s: f32,
        jump_nm: f32,
    ) -> (f32, Shown<f32>) {
        let mut shown = Shown {
            torque_nm: 1.0,
            jump_nm,
            ..Shown::nothing()
        };
        let added_nm = stage.tick(&seen(omega_rad_s), &Checked::Missing(1), &mut shown);
        (added_nm, shown)
    }

    /// A symptom of 0.5 N·m that is always in its third phase.
    struct Constant;

    impl DeviceEffect<f32> for Constant {
        type Settings = FrictionCompensationSettings;
        type Switched = Faded<f32, Self>;

        const SPEC: EffectSpec = EffectSpec {
            name: "constant",
            phases: Some(PhaseSpec {
                column: "constant_phase",
                names: &["rest", "contact", "cap"],
            }),
            ..SPECS[0]
        };
        const IS_SYMPTOM: bool = true;

        fn new(_: &Self::Settings, _: &Timing) -> Result<Self, SettingsError> {
            Ok(Self)
        }

        fn added_nm(&mut self, _: &Seen<f32>, _: &Checked<f32>, _: &Shown<f32>) -> f32 {
            0.5
        }

        fn phase(&self) -> u16 {
            2
        }
    }

    #[test]
    fn a_symptom_is_in_the_models_torque_and_its_phase_is_shown() {
        let mut stage = Faded::<f32, Constant>::new(0.1);
        assert!(stage.law().is_none());
        stage.change(Some(Some(Constant)), 0.1);
        let (added_nm, mut shown) = after(&mut stage, 0.0, 0.0);
        assert_eq!((shown.torque_nm, shown.model_torque_nm), (1.5, 0.0));
        note(stage.law(), added_nm, &mut shown);
        assert_eq!(shown.model_torque_nm, 0.5);
        let place = Constant::SPEC.place();
        assert_eq!(shown.phases, Phases::default().with(place, 2));
        assert_ne!(shown.phases, Phases::default());
        // One that is off has no phase, and what is no symptom is not the model's.
        let mut shown = Shown::nothing();
        note::<f32, Constant>(None, 0.0, &mut shown);
        assert_eq!(shown, Shown::nothing());
        let law = FrictionCompensation::new(&FrictionCompensationSettings::defaults(), &TIMING);
        note(law.as_ref().ok(), 0.3, &mut shown);
        assert_eq!(shown, Shown::nothing());
    }

    #[test]
    fn a_line_of_the_table_is_in_everything_that_follows_from_it() {
        let numbers: std::vec::Vec<f64> = FrictionCompensationSettings::defaults().values().into();
        let settings = EffectSettings::given(|name| {
            (name == "friction-compensation").then_some(numbers.as_slice())
        });
        assert_eq!(settings.friction_compensation, Some(Tabled::defaults()));
        assert_eq!(settings.bone_shaping, None);
        assert_eq!(SPECS.len(), DEVICE.len());
        for (spec, device) in SPECS.iter().zip(DEVICE) {
            assert!(device.iter().all(|parameter| parameter.group == spec.name));
        }
        let mut laws = settings.laws::<f32>(&TIMING).unwrap();
        let mut shown = Shown::nothing();
        laws.tick(&seen(1.0), &Checked::Missing(1), &mut shown);
        assert_eq!(shown.torque_nm, -0.4);
        assert_eq!(shown.model_torque_nm, 0.0);
        let place = |column| SPECS.iter().position(|spec| spec.column == column);
        for (column, nm) in [("compensation_nm", -0.4), ("shaping_nm", 0.0)] {
            assert_eq!(shown.added.get(place(column).unwrap()), Some(nm));
        }
        assert_eq!(shown.added.get(SPECS.len()), None);
        // Nothing changes, or only what is another.
        let unchanged = settings.changes::<f32>(&settings, &TIMING).unwrap();
        let mut stages = SwitchedEffects::new(1.0);
        stages.change(laws.clone().into(), 1.0);
        stages.change(unchanged, 1.0);
        let mut switched = Shown::nothing();
        stages.tick(&seen(1.0), &Checked::Missing(1), &mut switched);
        assert_eq!(switched, shown);
    }
}
