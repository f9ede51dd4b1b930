//! The stages that a scene's device has around its joint: those of a bare
//! solver, or all that the drive has.

use super::recorder::Heard;
use crate::any_joint::AnyJoint;
use crate::scene::Scene;
use crepitus_model::control::device_limits::LimitSettings;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::effects::{
    EffectSettings, EffectSpec, Effects, SwitchedEffects, Timing,
};
use crepitus_model::render::input_check::{Checked, InputCheck, InputLimits};
use crepitus_model::render::limits::TorqueLimits;
use crepitus_model::render::position::Position;
use crepitus_model::render::{
    Addition, Bare, Check, Limits, Pipeline, ShaftEstimate, Shown, Symptom,
};
use crepitus_model::solver::locate::Locate;
use crepitus_model::{
    Crepitus, Frozen, Real, Settings, SettingsError, StepCoefficients, StickSlip, Validated,
};
use crepitus_plant::effect::Part;

/// Ticks between a sample and the torque that answers it, of a bare solver.
const BARE_DELAY_TICKS: usize = 1;

/// Stages behind the symptoms of a bare solver.
pub(super) type BareStages<F, S> = Pipeline<F, (), S, Effects<F>>;

/// Stages of the drive; its symptoms are always those of the firmware.
pub(super) type DriveStages<F, S> =
    Pipeline<F, InputCheck<F>, S, SwitchedEffects<F>, Remembering<F>>;

/// Returns the stages around a bare solver, or around nothing.
pub(super) fn bare<F: Real, S: Symptom<F>>(
    scene: &Scene,
    step_s: f64,
    symptoms: S,
) -> Result<BareStages<F, S>, SettingsError> {
    Ok(Pipeline::new(
        (),
        symptoms,
        scene.laws(step_s, BARE_DELAY_TICKS)?,
        (),
    ))
}

/// Stages as the drive renders with them, armed long ago on a shaft at rest.
pub(super) fn drive<F: Real, S: Symptom<F>>(
    scene: &Scene,
    step_s: f64,
    symptoms: S,
) -> Result<DriveStages<F, S>, SettingsError> {
    let limits = LimitSettings::default();
    let slew_nm = F::from_f64(limits.slew_nm_per_s * step_s);
    let timing = scene.timing(step_s, MOST_DELAY_TICKS);
    let mut effects = SwitchedEffects::new(slew_nm, &timing);
    let changes = scene.effect_settings().changes_from_none(&timing)?;
    effects.change(&changes, slew_nm);
    Ok(Pipeline::new(
        InputCheck::new(&InputLimits::device(step_s), F::from_f64(step_s), F::ZERO),
        symptoms,
        effects,
        Remembering {
            limits: TorqueLimits::armed(F::from_f64(limits.torque_nm), slew_nm),
            asked_nm: F::ZERO,
        },
    ))
}

/// The joint that the drive renders for these settings.
pub(super) fn crepitus<F: Real, L: Locate<F, Shape = Linear>>(
    scene: &Scene,
    settings: &Validated<Settings>,
    step_s: f64,
) -> Result<Crepitus<F, L>, SettingsError> {
    let encoder = scene.encoder.unwrap_or_default();
    Ok(Crepitus::new(
        StepCoefficients::new(settings, step_s)?,
        InputLimits::device(step_s),
        F::from_f64(encoder.rad_per_count()),
        F::ZERO,
    ))
}

/// The effects of the device that a scene lists, in the order in which they
/// act.
pub(super) fn listed(scene: &Scene) -> impl Iterator<Item = &'static EffectSpec> {
    scene
        .listed
        .iter()
        .filter_map(|listed| match listed.effect.part {
            Part::Stage(spec) => Some(spec),
            _ => None,
        })
}

/// Numbers for ticks of another length.
#[derive(Clone)]
pub(super) struct Retiming {
    joint: Option<Validated<Settings>>,
    effects: EffectSettings,
    timing: Timing,
    /// Number of these ticks in one of those before.
    ratio: f64,
}

impl Retiming {
    pub(super) fn new(scene: &Scene, step_s: f64) -> Self {
        Self {
            joint: scene.crepitus.map(|crepitus| crepitus.settings),
            effects: scene.effect_settings(),
            timing: scene.timing(step_s, BARE_DELAY_TICKS),
            ratio: 1.0,
        }
    }

    /// Makes it that from the ticks so far to ticks of this length.
    pub(super) fn ticks_of(&mut self, step_s: f64) {
        self.ratio = self.timing.step_s / step_s;
        self.timing.step_s = step_s;
    }
}

/// A stage of a bare solver, whose ticks can be of any length, and which is there from the first row on. The
/// drive's ticks never change, and it shows nothing before the first of them.
pub(super) trait InParts<F>: Clone + Send + 'static {
    /// Adds its torque on a joint that rests at a place.
    fn add_resting(&self, _place: &Position<F>, _shown: &mut Shown<F>) {}

    /// Goes on in ticks of another length.
    fn retime(&mut self, _to: &Retiming) {}

    /// Ends a part of a tick that began as `before`.
    fn forget_part(&mut self, _before: &Self) {}
}

impl<F> InParts<F> for () {}

impl<F: Real, L: Locate<F, Shape = Linear>> InParts<F> for Crepitus<F, L> {}

impl<F: Real> InParts<F> for SwitchedEffects<F> {}

impl<F: Real> InParts<F> for Bare<AnyJoint<F>> {
    fn retime(&mut self, to: &Retiming) {
        let made = to
            .joint
            .as_ref()
            .map(|j| StepCoefficients::new(j, to.timing.step_s));
        if let Some(Ok(coefficients)) = made {
            self.0.change_step(coefficients);
        }
    }
}

impl<F: Real> InParts<F> for Effects<F> {
    fn add_resting(&self, place: &Position<F>, shown: &mut Shown<F>) {
        Self::add_resting(self, place, shown);
    }

    fn retime(&mut self, to: &Retiming) {
        Self::retime(self, &to.effects, &to.timing, to.ratio);
    }

    fn forget_part(&mut self, before: &Self) {
        Self::forget_part(self, before);
    }
}

/// Limits of a device that remember the torque before them.
#[derive(Clone)]
pub(super) struct Remembering<F> {
    limits: TorqueLimits<F>,
    asked_nm: F,
}

impl<F: Real> Limits<F> for Remembering<F> {
    #[inline]
    fn tick(&mut self, shown: &mut Shown<F>) {
        self.asked_nm = shown.torque_nm;
        self.limits.tick(shown);
    }
}

/// Torque before the limits of a device.
pub(super) trait Asked<F>: Limits<F> + Clone + Send + 'static {
    /// The torque that came in, N·m; none where there are no limits.
    fn asked_nm(&self) -> Option<F>;
}

impl<F> Asked<F> for () {
    fn asked_nm(&self) -> Option<F> {
        None
    }
}

impl<F: Real> Asked<F> for Remembering<F> {
    #[inline]
    fn asked_nm(&self) -> Option<F> {
        Some(self.asked_nm)
    }
}

/// A pipeline of any stages.
pub(super) trait Rendering<F>: Clone + Send + 'static {
    /// One tick, as [`Pipeline::tick_observed`] makes it, in the place of what was shown before.
    fn tick(&mut self, seen: &ShaftEstimate<F>, shown: &mut Shown<F>, heard: &mut Heard<F>);

    /// Torque before the limits of a device, N·m; none without a device.
    fn asked_nm(&self) -> Option<F>;

    /// One part of a tick: at the end of it, if it is not the last, stages that know whole ticks
    /// only are as before. `jump_nm` is what the parts before it had of jumps.
    fn tick_part(
        &mut self,
        seen: &ShaftEstimate<F>,
        part: (&Retiming, bool, F),
        heard: &mut Heard<F>,
    ) -> Shown<F>;

    /// Goes on in ticks of another length.
    fn retime(&mut self, to: &Retiming);

    /// See [`Addition::rest`].
    fn rest(&mut self, place: &Position<F>);

    /// Output of a joint that is seen for the first time, which is no tick.
    fn begin(&mut self, seen: &ShaftEstimate<F>, shown: Shown<F>) -> Shown<F>;
}

/// Renders a tick, or a part of one, into what is `shown` of it so far.
#[inline(always)]
#[expect(
    clippy::inline_always,
    reason = "a call of the loop, whose arguments and results would pass through memory"
)]
fn render<F: Real, I: Check<F>, S: Symptom<F>, E: Addition<F>, L: Limits<F>>(
    stages: &mut Pipeline<F, I, S, E, L>,
    seen: &ShaftEstimate<F>,
    shown: &mut Shown<F>,
    heard: &mut Heard<F>,
) {
    let input = stages.check.check(&seen.sample);
    let torque = stages
        .symptoms
        .tick(&input, shown, |event| heard.events.push(event));
    shown.torque_nm = torque.shown_nm;
    shown.model_torque_nm = torque.model_nm;
    stages.effects.tick(seen, &input, shown, heard);
    stages.limits.tick(shown);
}

impl<F: Real, I, S, E, L> Rendering<F> for Pipeline<F, I, S, E, L>
where
    I: Check<F> + Clone + Send + 'static,
    S: Symptom<F> + InParts<F>,
    E: Addition<F> + InParts<F>,
    L: Asked<F>,
{
    fn tick_part(
        &mut self,
        seen: &ShaftEstimate<F>,
        (to, is_last, jump_nm): (&Retiming, bool, F),
        heard: &mut Heard<F>,
    ) -> Shown<F> {
        self.retime(to);
        let before = (!is_last).then(|| self.effects.clone());
        let mut shown = Shown {
            jump_nm,
            ..Shown::nothing()
        };
        render(self, seen, &mut shown, heard);
        if let Some(before) = before {
            self.effects.forget_part(&before);
        }
        shown
    }

    fn retime(&mut self, to: &Retiming) {
        self.symptoms.retime(to);
        self.effects.retime(to);
    }

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
    fn tick(&mut self, seen: &ShaftEstimate<F>, shown: &mut Shown<F>, heard: &mut Heard<F>) {
        *shown = Shown::nothing();
        render(self, seen, shown, heard);
    }

    #[inline]
    fn asked_nm(&self) -> Option<F> {
        self.limits.asked_nm()
    }

    fn rest(&mut self, place: &Position<F>) {
        self.effects.rest(place);
    }

    fn begin(&mut self, seen: &ShaftEstimate<F>, shown: Shown<F>) -> Shown<F> {
        let mut shown = self.add(seen, &Checked::Missing(1), shown);
        self.effects.add_resting(&seen.place, &mut shown);
        shown
    }
}

/// A pipeline whose symptom is a stick-slip object.
pub(super) trait HasJoint<F: Real>: Rendering<F> {
    /// The object's type.
    type Joint: StickSlip<F>;

    /// Whether samples can be refused.
    const REFUSES: bool;

    /// The object.
    fn joint(&self) -> &Self::Joint;

    /// While samples are refused, what is held in the place of the object's torque, N·m.
    fn held_nm(&self) -> Option<F>;

    /// Number of gaps after which the object began again.
    fn restarts(&self) -> u32;

    /// The object and the symptoms on it, where there is nothing else and none of them gives
    /// energy: a tick is then that of each in turn.
    fn in_turn(&mut self) -> Option<(&mut AnyJoint<F>, &mut Effects<F>)> {
        None
    }
}

impl<F: Real> HasJoint<F> for BareStages<F, Bare<AnyJoint<F>>> {
    type Joint = AnyJoint<F>;
    const REFUSES: bool = false;

    #[inline]
    fn joint(&self) -> &AnyJoint<F> {
        &self.symptoms.0
    }

    fn held_nm(&self) -> Option<F> {
        None
    }

    fn restarts(&self) -> u32 {
        0
    }

    fn in_turn(&mut self) -> Option<(&mut AnyJoint<F>, &mut Effects<F>)> {
        self.effects
            .is_passive()
            .then_some((&mut self.symptoms.0, &mut self.effects))
    }
}

impl<F: Real, L: Locate<F, Shape = Linear>> HasJoint<F> for DriveStages<F, Crepitus<F, L>> {
    type Joint = Frozen<F, L>;
    const REFUSES: bool = true;

    #[inline]
    fn joint(&self) -> &Self::Joint {
        self.symptoms.joint()
    }

    #[inline]
    fn held_nm(&self) -> Option<F> {
        self.symptoms.held_nm()
    }

    #[inline]
    fn restarts(&self) -> u32 {
        self.symptoms.counters().restarts
    }
}
