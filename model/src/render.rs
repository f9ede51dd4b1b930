//! Rendering on a device: one pipeline from a sample of the shaft to a torque.
//!
//! ```text
//!            Check          Symptom                     Addition             Limits
//! sample ─> InputCheck ─> Crepitus ─ turn-back guard ─> effects ──────────> TorqueLimits ─> torque
//!                            ↑                          (a table of them)
//!                  commit ─ Ramp
//! ```
//!
//! Each place takes any type of its trait. `()` is an absent stage: it has no
//! state and costs no instruction. The drive and every run of a scene with a device use the
//! same stages; a bare solver on its own stands in [`Bare`].
//!
//! Every reason why less than what the model asks for is shown has a name, a
//! [`Limit`]; the last one that acts is reported.

pub mod crepitus;
pub mod effects;
pub mod guarded;
pub mod held;
pub mod input_check;
pub mod limits;
pub mod position;
pub mod ramp;
pub mod turn_back;

use crate::joint::{Event, Phase, ShaftStep, StickSlip};
use crate::real::Real;
use core::marker::PhantomData;
use effects::{Added, Observe, Phases};
use input_check::{Checked, Sample};
use position::Position;

/// Reason why the torque shown is not the one that the model asks for. The numbers
/// are those of the wire, where the motor has 3, 4 and 8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Limit {
    /// No limit: the torque shown is the one that the model asks for.
    #[default]
    None = 0,
    /// The joint's largest torque.
    Torque = 1,
    /// Torque grows at most as fast as this: after arming, or of what
    /// compensates friction.
    Slew = 2,
    /// The hand has turned back inside a slip: nothing is shown until it ends.
    TurnedBack = 5,
    /// The shaft is out of sensing: the last torque is held, then released.
    Holding = 6,
    /// There is no torque: the device is not armed.
    NotArmed = 7,
    /// The [tank](effects::tank) holds back torque of symptoms that give energy.
    Tank = 9,
}

/// Output of a tick; each stage changes it in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown<F> {
    /// The torque to show, N·m: T > 0 opposes growing angle.
    pub torque_nm: F,
    /// Torque of the symptoms before any guard or limit, N·m.
    pub model_torque_nm: F,
    /// Sum of the jumps of the symptoms' torque in this tick, N·m.
    pub jump_nm: F,
    /// Torque of the symptoms that give energy, which a tank pays, N·m.
    pub active_nm: F,
    /// Share of the torque asked for by symptoms that give energy that their tank holds
    /// back, 0 to 1; 0 while they ask for none.
    pub held_back: F,
    /// Torque of the symptoms that the actuator on the shell alone gets, N·m.
    pub shell_nm: F,
    /// Voltage at the coil of that actuator, V: V > 0 pushes the shell towards growing
    /// angle.
    pub coil_v: F,
    /// Contribution of each effect besides the joint, N·m or V.
    pub added: Added<F>,
    /// The phase of each.
    pub phases: Phases,
    /// Phase of the stick-slip object; stick without one.
    pub phase: Phase,
    /// Parameters are on their way.
    pub settling: bool,
    /// Reason why the torque shown is not more.
    pub limit: Limit,
}

impl<F: Real> Shown<F> {
    /// Converts to f64.
    pub fn to_f64(&self) -> Shown<f64> {
        Shown {
            torque_nm: self.torque_nm.to_f64(),
            model_torque_nm: self.model_torque_nm.to_f64(),
            jump_nm: self.jump_nm.to_f64(),
            active_nm: self.active_nm.to_f64(),
            held_back: self.held_back.to_f64(),
            shell_nm: self.shell_nm.to_f64(),
            coil_v: self.coil_v.to_f64(),
            added: self.added.to_f64(),
            phases: self.phases,
            phase: self.phase,
            settling: self.settling,
            limit: self.limit,
        }
    }

    /// Output that shows nothing.
    #[inline]
    pub fn nothing() -> Self {
        Self {
            torque_nm: F::ZERO,
            model_torque_nm: F::ZERO,
            jump_nm: F::ZERO,
            active_nm: F::ZERO,
            held_back: F::ZERO,
            shell_nm: F::ZERO,
            coil_v: F::ZERO,
            added: Added::NONE,
            phases: Phases(0),
            phase: Phase::Stick,
            settling: false,
            limit: Limit::None,
        }
    }
}

/// Knowledge of the shaft in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftEstimate<F> {
    /// Motion of the shaft since the last sample that was taken.
    pub sample: Sample<F>,
    /// Velocity of the shaft as far as known, rad/s; also where this sample is lost.
    pub omega_rad_s: F,
    /// Place of the joint, or the place where it was seen last.
    pub place: Position<F>,
    /// The motor is driven: symptoms act.
    pub is_driven: bool,
}

/// Decides what symptoms may believe of a sample.
pub trait Check<F> {
    /// Takes in a sample.
    fn check(&mut self, sample: &Sample<F>) -> Checked<F>;
}

/// Renders a disorder.
pub trait Symptom<F> {
    /// One tick: its torque, and in `shown` what else there is to say. Events
    /// come in the order of time; an event's fraction is that of the time since
    /// the last good sample.
    fn tick(
        &mut self,
        input: &Checked<F>,
        shown: &mut Shown<F>,
        on_event: impl FnMut(Event<F>),
    ) -> Torque<F>;
}

/// The torque of symptoms, N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque<F> {
    /// Torque to be shown.
    pub shown_nm: F,
    /// Torque that would be shown without a guard.
    pub model_nm: F,
}

/// Adds to the torque of the joint.
pub trait Addition<F> {
    /// Puts it at rest as at arming, at this place of the joint.
    fn rest(&mut self, place: &Position<F>);

    /// One tick.
    fn tick(
        &mut self,
        seen: &ShaftEstimate<F>,
        input: &Checked<F>,
        shown: &mut Shown<F>,
        observe: &mut impl Observe<F>,
    );
}

/// Holds the torque within what is allowed.
pub trait Limits<F> {
    /// One tick.
    fn tick(&mut self, shown: &mut Shown<F>);
}

/// The stages of a device. In the order of its fields, the effects last: their memory
/// would push others out of a load's reach.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Pipeline<F, I, S, E = (), L = ()> {
    /// The check of its input.
    pub check: I,
    /// Limits of its torque.
    pub limits: L,
    /// The symptoms.
    pub symptoms: S,
    /// The effects besides the joint.
    pub effects: E,
    precision: PhantomData<F>,
}

impl<F: Real, I: Check<F>, S: Symptom<F>, E: Addition<F>, L: Limits<F>> Pipeline<F, I, S, E, L> {
    /// Pipeline of these stages.
    pub fn new(check: I, symptoms: S, effects: E, limits: L) -> Self {
        Self {
            check,
            symptoms,
            effects,
            limits,
            precision: PhantomData,
        }
    }

    /// One tick.
    #[inline]
    pub fn tick(&mut self, seen: &ShaftEstimate<F>, on_event: impl FnMut(Event<F>)) -> Shown<F> {
        self.tick_observed(seen, on_event, &mut ())
    }

    /// One tick, with what happens to the effects.
    #[inline]
    pub fn tick_observed(
        &mut self,
        seen: &ShaftEstimate<F>,
        on_event: impl FnMut(Event<F>),
        observe: &mut impl Observe<F>,
    ) -> Shown<F> {
        let mut shown = Shown::nothing();
        let input = self.check.check(&seen.sample);
        let torque = self.symptoms.tick(&input, &mut shown, on_event);
        shown.torque_nm = torque.shown_nm;
        shown.model_torque_nm = torque.model_nm;
        self.add_observed(seen, &input, shown, observe)
    }

    /// The stages after the symptoms; on their own, what is shown before the
    /// first tick.
    #[inline]
    pub fn add(
        &mut self,
        seen: &ShaftEstimate<F>,
        input: &Checked<F>,
        shown: Shown<F>,
    ) -> Shown<F> {
        self.add_observed(seen, input, shown, &mut ())
    }

    #[inline]
    fn add_observed(
        &mut self,
        seen: &ShaftEstimate<F>,
        input: &Checked<F>,
        mut shown: Shown<F>,
        observe: &mut impl Observe<F>,
    ) -> Shown<F> {
        self.effects.tick(seen, input, &mut shown, observe);
        self.limits.tick(&mut shown);
        shown
    }
}

/// A solver of the ladder on its own: every sample is a step, and none is made
/// up for.
#[derive(Clone, Debug)]
pub struct Bare<J>(pub J);

impl<F: Real, J: StickSlip<F>> Symptom<F> for Bare<J> {
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    fn tick(
        &mut self,
        input: &Checked<F>,
        shown: &mut Shown<F>,
        mut on_event: impl FnMut(Event<F>),
    ) -> Torque<F> {
        if let Checked::Step(shaft) = input {
            self.0.step(shaft, |event| {
                shown.jump_nm += event.torque_after_nm - event.torque_before_nm;
                on_event(event);
            });
        }
        shown.phase = self.0.phase();
        let torque_nm = self.0.torque_nm();
        Torque {
            shown_nm: torque_nm,
            model_nm: torque_nm,
        }
    }
}

impl<F: Real> Check<F> for () {
    #[inline]
    fn check(&mut self, sample: &Sample<F>) -> Checked<F> {
        match sample {
            Sample::Taken(shaft) => Checked::Step(*shaft),
            Sample::Lost => Checked::Missing(1),
        }
    }
}

impl<F: Real> Symptom<F> for () {
    #[inline]
    fn tick(&mut self, _: &Checked<F>, _: &mut Shown<F>, _: impl FnMut(Event<F>)) -> Torque<F> {
        Torque {
            shown_nm: F::ZERO,
            model_nm: F::ZERO,
        }
    }
}

impl<F: Real, S: Symptom<F>> Symptom<F> for Option<S> {
    #[inline]
    fn tick(
        &mut self,
        input: &Checked<F>,
        shown: &mut Shown<F>,
        on_event: impl FnMut(Event<F>),
    ) -> Torque<F> {
        match self {
            Some(symptom) => symptom.tick(input, shown, on_event),
            None => Symptom::tick(&mut (), input, shown, on_event),
        }
    }
}

impl<F> Addition<F> for () {
    fn rest(&mut self, _: &Position<F>) {}

    #[inline]
    fn tick(
        &mut self,
        _: &ShaftEstimate<F>,
        _: &Checked<F>,
        _: &mut Shown<F>,
        _: &mut impl Observe<F>,
    ) {
    }
}

impl<F> Limits<F> for () {
    #[inline]
    fn tick(&mut self, _: &mut Shown<F>) {}
}

impl<F: Real> ShaftEstimate<F> {
    /// A sample that was taken of a joint that is driven, at this place.
    #[inline]
    pub fn taken(shaft: &ShaftStep<F>, place: Position<F>) -> Self {
        Self {
            sample: Sample::Taken(*shaft),
            omega_rad_s: shaft.omega_end_rad_s,
            place,
            is_driven: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::effects::EffectSettings;
    use crate::render::effects::friction_compensation::FrictionCompensationSettings;
    use crate::render::effects::tests::TIMING;
    use crate::solver::locate::ExactEvents;
    use crate::{Frozen, Settings, StepCoefficients};

    type Joint = Bare<Frozen<f64, ExactEvents>>;

    fn joint() -> Joint {
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), 5e-5).unwrap();
        Bare(Frozen::new(coefficients, 1.0))
    }

    fn steady() -> ShaftEstimate<f64> {
        let shaft = ShaftStep {
            delta_phi_rad: 5e-5,
            omega_start_rad_s: 1.0,
            omega_end_rad_s: 1.0,
        };
        ShaftEstimate::taken(&shaft, Position::at(0))
    }

    #[test]
    fn an_absent_stage_has_no_state_and_changes_no_bit() {
        assert_eq!(
            size_of::<Pipeline<f64, (), Joint>>(),
            size_of::<Frozen<f64, ExactEvents>>()
        );
        let mut pipeline = Pipeline::new((), joint(), (), ());
        let mut alone = joint().0;
        let (mut ours, mut theirs, mut jumps) = (0, 0, 0);
        for _ in 0..2_000 {
            let shown = pipeline.tick(&steady(), |_| ours += 1);
            let Sample::Taken(step) = steady().sample else {
                unreachable!()
            };
            let mut jump_nm = 0.0;
            alone.step(&step, |event| {
                theirs += 1;
                jump_nm += event.torque_after_nm - event.torque_before_nm;
            });
            assert_eq!(shown.jump_nm, jump_nm);
            jumps += u32::from(jump_nm != 0.0);
            assert_eq!(shown.torque_nm.to_bits(), alone.torque_nm().to_bits());
            assert_eq!(shown.model_torque_nm, shown.torque_nm);
            assert_eq!((shown.phase, shown.limit), (alone.phase(), Limit::None));
        }
        assert!(ours > 4 && ours == theirs && jumps > 2);
    }

    #[test]
    fn an_effect_acts_where_it_is() {
        let given = EffectSettings {
            friction_compensation: Some(FrictionCompensationSettings::default()),
            ..EffectSettings::default()
        };
        let effects = given.laws(&TIMING).unwrap();
        let mut pipeline = Pipeline::new((), Some(joint()), effects, ());
        let shown = pipeline.tick(&steady(), |_| {});
        assert_eq!(shown.added.friction_compensation, -0.4);
        assert_eq!(shown.torque_nm, shown.model_torque_nm - 0.4);
        pipeline.effects.friction_compensation = None;
        let shown = pipeline.tick(&steady(), |_| {});
        assert_eq!(shown.torque_nm, shown.model_torque_nm);
        pipeline.symptoms = None;
        let shown = pipeline.tick(&steady(), |_| panic!("nothing there"));
        assert_eq!(shown, Shown::nothing());
    }

    #[test]
    fn a_bare_solver_waits_for_its_next_sample() {
        let mut pipeline = Pipeline::new((), joint(), (), ());
        let before = pipeline.tick(&steady(), |_| {}).torque_nm;
        let lost = ShaftEstimate {
            sample: Sample::Lost,
            ..steady()
        };
        assert_eq!(pipeline.tick(&lost, |_| {}).torque_nm, before);
        assert!(pipeline.tick(&steady(), |_| {}).torque_nm > before);
    }
}
