//! The program: reads a plan, runs its steps, waits for the next command.

use crate::exchange::{BEGIN, ENTRY, Exchange, Input, Kind, Output, READY, REFUSED, RUN, STATE};
use crate::laws;
use crate::measured::{Effect, Joint, Law, Measured, Rendered, step};
use crate::plan::Plan;
use crate::subject::{Subject, in_form};
use core::hint::black_box;
use crepitus_model::control::current_loop::CurrentLoopSettings;
use crepitus_model::control::device_limits::LimitSettings;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::parameters::Tabled;
use crepitus_model::real::Real;
use crepitus_model::render::effects::{DeviceEffect, LawVisitor, SPECS, Timing};
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::render::position::Scale;
use crepitus_model::render::position::Sensing;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{CurrentLoop, Guarded, Renderer, SettingsError, StepCoefficients, StickSlip};

/// Executes one command after the other. `wait` is called while there is none,
/// and returns whether there will be another.
pub fn serve(exchange: &Exchange<'_>, wait: &mut dyn FnMut() -> bool) {
    let mut here = Here { exchange, wait };
    let mut goes_on = here.next();
    while goes_on {
        let plan = Plan::decode(exchange);
        let served = plan.map(|plan| here.serve(&plan));
        goes_on = if let Some(Ok(goes_on)) = served {
            goes_on
        } else {
            exchange.set(STATE, REFUSED);
            exchange.done();
            here.next()
        };
    }
}

struct Here<'a> {
    exchange: &'a Exchange<'a>,
    wait: &'a mut dyn FnMut() -> bool,
}

impl Here<'_> {
    /// Waits for a command; returns whether there is one.
    fn next(&mut self) -> bool {
        while self.exchange.command() == 0 {
            if !(self.wait)() {
                return false;
            }
        }
        true
    }

    /// Executes a plan until a command brings another one; returns whether one
    /// does.
    fn serve(&mut self, plan: &Plan) -> Result<bool, SettingsError> {
        let step_s = plan.step_s;
        Ok(match plan.subject {
            Subject::Rung(_, solver) => self.joint::<false>(plan, solver)?,
            Subject::Checked(_) => self.joint::<true>(plan, Solver::ExactEvents)?,
            Subject::Renderer => {
                let coefficients =
                    |which| StepCoefficients::<f32>::new(&plan.settings(which)?, step_s);
                let coefficients = [coefficients(0)?, coefficients(1)?];
                let rendered = Rendered {
                    renderer: Renderer::of(
                        coefficients[0],
                        InputLimits::device(step_s),
                        f32::from_f64(EncoderSettings::default().rad_per_count()),
                        plan.omega_rad_s,
                    ),
                    slew_nm_per_s: LimitSettings::defaults().slew_nm_per_s,
                };
                self.run(rendered, Some(coefficients))
            }
            Subject::Encoder => {
                let settings = EncoderSettings::default();
                self.run(
                    EncoderReader::new(&settings, step_s, 0, plan.omega_rad_s)?,
                    None,
                )
            }
            Subject::Effect(place, form) => {
                let timing = Timing {
                    step_s,
                    delay_ticks: MOST_DELAY_TICKS,
                    sensing: Sensing::of_encoder(&EncoderSettings::default()),
                };
                // There is a subject for each place of the table only.
                let settings = SPECS
                    .get(place)
                    .map_or_else(Default::default, |spec| in_form(spec, form));
                let visitor = EffectVisitor {
                    scale: timing.scale()?,
                    here: self,
                    plan,
                };
                settings.with_law(place, &timing, visitor)?.unwrap_or(false)
            }
            Subject::CurrentLoop => {
                let settings = CurrentLoopSettings::defaults();
                self.run(CurrentLoop::new(&settings, step_s)?, None)
            }
            // There is a subject for each law but ours only.
            Subject::Law(_) => match plan.subject.law() {
                Some(entry) => {
                    let [joint, _] = plan.parameters;
                    let visitor = FrictionVisitor { here: self };
                    entry.with(&joint, step_s, plan.omega_rad_s, visitor)?
                }
                None => false,
            },
        })
    }

    fn joint<const CHECKED: bool>(
        &mut self,
        plan: &Plan,
        solver: Solver,
    ) -> Result<bool, SettingsError> {
        let visitor = Visitor::<CHECKED> { here: self, plan };
        with_joint(
            &plan.settings(0)?,
            solver,
            plan.step_s,
            plan.omega_rad_s,
            visitor,
        )
    }

    /// Runs steps of a subject, command after command; returns whether another
    /// plan comes.
    fn run<M: Measured>(
        &mut self,
        mut subject: M,
        coefficients: Option<[StepCoefficients<f32>; 2]>,
    ) -> bool {
        // The callee is opaque here, so it is not inlined.
        let step: fn(&mut M, &Input) -> Output = black_box(step::<M>);
        self.exchange.set(ENTRY, address(step as usize));
        self.exchange.set(STATE, READY);
        let mut committed = 0;
        let mut command = self.exchange.command();
        loop {
            if command & RUN != 0 {
                let steps = Plan::decode(self.exchange).map_or(0, |plan| plan.steps);
                for n in (0..usize::MAX).take(steps as usize) {
                    let input = self.exchange.input(n);
                    if let (Kind::Commit, Some(coefficients)) = (input.kind, &coefficients) {
                        committed = 1 - committed;
                        if let Some(next) = coefficients.get(committed) {
                            subject.commit(*next);
                        }
                    }
                    self.exchange.set_output(n, &step(&mut subject, &input));
                }
            }
            self.exchange.done();
            if !self.next() {
                return false;
            }
            command = self.exchange.command();
            if command & BEGIN != 0 {
                return true;
            }
        }
    }
}

/// Address of code on the target.
#[expect(clippy::cast_possible_truncation, reason = "32 bits on the target")]
fn address(of: usize) -> u32 {
    of as u32 & !1
}

/// Runs an effect.
struct EffectVisitor<'a, 'b> {
    scale: Scale<f32>,
    here: &'a mut Here<'b>,
    plan: &'a Plan,
}

impl LawVisitor<f32> for EffectVisitor<'_, '_> {
    type Output = bool;

    fn visit<E: DeviceEffect<f32>>(self, law: E) -> bool {
        let place = self.plan.place;
        self.here.run(Effect::new(law, place, self.scale), None)
    }
}

/// Runs a friction law.
struct FrictionVisitor<'a, 'b> {
    here: &'a mut Here<'b>,
}

impl laws::LawVisitor<f32> for FrictionVisitor<'_, '_> {
    type Output = bool;

    fn visit<M: laws::Mounted<f32>>(self, law: M) -> bool {
        self.here.run(Law(law), None)
    }
}

/// Runs a joint.
struct Visitor<'a, 'b, const CHECKED: bool> {
    here: &'a mut Here<'b>,
    plan: &'a Plan,
}

impl<const CHECKED: bool> JointVisitor<f32> for Visitor<'_, '_, CHECKED> {
    type Output = bool;

    fn visit<J: StickSlip<f32>>(self, joint: J) -> bool {
        if CHECKED {
            let limits = InputLimits::device(self.plan.step_s);
            let checked = Guarded::new(joint, limits, self.plan.omega_rad_s);
            self.here.run(checked, None)
        } else {
            self.here.run(Joint(joint), None)
        }
    }
}
