//! Loops whose time is measured on the host: a rung or a law, stepped from memory.
//!
//! They are compiled here, in one codegen unit with the steps: a step in another codegen unit than
//! its loop costs up to twice as much. Whoever measures holds the clock: each loop is given to a
//! closure, which calls it with chunks of steps.

use core::hint::black_box;
use crepitus_model::render::effects::symptom::Change;
use crepitus_model::render::effects::vibration_actuator::VibrationActuator;
use crepitus_model::render::effects::{
    DeviceEffect, EffectSettings, EffectSpec, LawVisitor, Tick, Timing,
};
use crepitus_model::render::input_check::Checked;
use crepitus_model::render::position::{Position, Scale, Travel};
use crepitus_model::render::{ShaftEstimate, Shown};
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Real, Settings, SettingsError, ShaftStep, StickSlip, Validated};

/// Compiler and options that the loops are built with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Build {
    /// Compiler and its version.
    pub compiler: &'static str,
    /// Optimisation level of the loops.
    pub opt_level: &'static str,
    /// Target triple.
    pub target: &'static str,
    /// Enabled features of the target, with commas.
    pub target_features: &'static str,
    /// Whether debug assertions are compiled in.
    pub has_debug_assertions: bool,
}

/// The build of the loops.
pub const BUILD: Build = Build {
    compiler: env!("CREPITUS_COMPILER"),
    opt_level: env!("CREPITUS_OPT_LEVEL"),
    target: env!("CREPITUS_TARGET"),
    target_features: env!("CREPITUS_TARGET_FEATURES"),
    has_debug_assertions: cfg!(debug_assertions),
};

/// A step of the shaft, and the place where it ends.
pub type PlacedStep<F> = (ShaftStep<F>, Position<F>);

/// Goes through a chunk of steps.
pub type Stepper<'a, S> = &'a mut dyn FnMut(&[S]);

/// A precision whose loops are compiled here.
pub trait Loops: Real {
    /// Calls `clock` with the loop of a joint on this rung: the step, its events and its torque,
    /// as in a tick of the device.
    ///
    /// # Errors
    /// [`SettingsError`] if settings, rung and step do not go together.
    fn joint(
        settings: &Validated<Settings>,
        solver: Solver,
        step_s: f64,
        omega_rad_s: Self,
        clock: &mut dyn FnMut(Stepper<'_, ShaftStep<Self>>),
    ) -> Result<(), SettingsError>;

    /// Calls `clock` with the loop of the law at this place of the model's table of effects, which
    /// rests at `from`; never if there is none.
    ///
    /// # Errors
    /// [`SettingsError`] if settings or step are out of range.
    fn law(
        settings: &EffectSettings,
        place: usize,
        timing: &Timing,
        from: &Position<Self>,
        clock: &mut dyn FnMut(Stepper<'_, PlacedStep<Self>>),
    ) -> Result<(), SettingsError>;

    /// The loop of the vibration actuator's stage over torques of the joint, N·m.
    fn actuator(law: &mut VibrationActuator<Self>, torques_nm: &[Self]);
}

macro_rules! loops {
    ($($real:ty),*) => {$(
        impl Loops for $real {
            fn joint(
                settings: &Validated<Settings>,
                solver: Solver,
                step_s: f64,
                omega_rad_s: Self,
                clock: &mut dyn FnMut(Stepper<'_, ShaftStep<Self>>),
            ) -> Result<(), SettingsError> {
                with_joint(settings, solver, step_s, omega_rad_s, OfJoint(clock))
            }

            fn law(
                settings: &EffectSettings,
                place: usize,
                timing: &Timing,
                from: &Position<Self>,
                clock: &mut dyn FnMut(Stepper<'_, PlacedStep<Self>>),
            ) -> Result<(), SettingsError> {
                let scale = timing.scale()?;
                let visitor = OfLaw { from, scale, clock };
                settings.with_law(place, timing, visitor)?;
                Ok(())
            }

            fn actuator(law: &mut VibrationActuator<Self>, torques_nm: &[Self]) {
                for torque_nm in torques_nm {
                    black_box(law.tick(black_box(*torque_nm), true));
                }
            }
        }
    )*};
}

loops!(f32, f64);

struct OfJoint<'a, F>(&'a mut dyn FnMut(Stepper<'_, ShaftStep<F>>));

impl<F: Real> JointVisitor<F> for OfJoint<'_, F> {
    type Output = ();

    fn visit<J: StickSlip<F>>(self, mut joint: J) {
        (self.0)(&mut |steps| {
            for shaft in steps {
                joint.step(shaft, |event| {
                    black_box(event);
                });
                black_box(joint.torque_nm());
            }
        });
    }
}

struct OfLaw<'a, F> {
    from: &'a Position<F>,
    scale: Scale<F>,
    clock: &'a mut dyn FnMut(Stepper<'_, PlacedStep<F>>),
}

impl<F: Real> LawVisitor<F> for OfLaw<'_, F> {
    type Output = ();

    fn visit<E: DeviceEffect<F>>(self, mut law: E) {
        law.rest(self.from);
        (self.clock)(&mut |steps| {
            for (shaft, place) in steps {
                black_box(tick(&mut law, shaft, *place, &self.scale, |change| {
                    black_box(change);
                }));
            }
        });
    }
}

/// One tick of a law that is paid in full: its torque, N·m.
#[inline]
pub fn tick<F: Real, E: DeviceEffect<F>>(
    law: &mut E,
    shaft: &ShaftStep<F>,
    place: Position<F>,
    scale: &Scale<F>,
    mut on_change: impl FnMut(Change<F>),
) -> F {
    let input = Checked::Step(*shaft);
    let travel = Travel::plausible(&input, &place, scale);
    let tick = Tick::of(
        &ShaftEstimate::taken(shaft, place),
        &input,
        travel.as_ref(),
        F::ONE,
    );
    law.added(
        &tick,
        &mut Shown::nothing(),
        &mut |_: &'static EffectSpec, change: Change<F>| on_change(change),
    )
}
