//! `render_torque`: the shaft's motion, the [pipeline](crepitus_model::render) with the
//! firmware's stages, and the application of a commit.
//!
//! The joint runs in every tick, also while torque is off.

use crate::drive::exchange::{Exchange, Rendered, Turn};
use crate::drive::prepare::{JointPlan, Reader, RenderingPlan, TIMING};
use crate::drive::sampler::{Sampled, Sampler};
use crepitus_model::render::effects::SwitchedEffects;
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::limits::TorqueLimits;
use crepitus_model::render::position::Position;
use crepitus_model::render::{Limit, Pipeline, ShaftEstimate, Shown};
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{Crepitus, EventKind, Frozen, Real};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{LimitReason, TICK_S};

/// The symptoms of the device.
pub type Symptoms = Option<Crepitus<f32, ExactEvents>>;

/// The stages of the device.
pub type Stages = Pipeline<f32, InputCheck<f32>, Symptoms, SwitchedEffects<f32>, TorqueLimits<f32>>;

/// Renders the torque, once a tick. In the order of its fields, the stages last: what is
/// within the first kilobyte a load reaches directly.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Rendering {
    sampler: Sampler,
    /// The joint is removed once it has settled.
    is_removing: bool,
    is_settling: bool,
    /// Speed of the last tick.
    omega_rad_s: f32,
    /// The tick that the last result was of.
    of_tick: u32,
    stages: Stages,
}

impl Rendering {
    /// Starts with these coefficients on a shaft at rest at this count.
    pub fn new(reader: &Reader, counter: u32, plan: &RenderingPlan) -> Self {
        let limits = InputLimits::device(TICK_S);
        let slew_nm = plan.slew_nm;
        let mut rendering = Self {
            sampler: Sampler::new(reader, counter),
            stages: Stages::new(
                InputCheck::new(&limits, f32::from_f64(TICK_S), 0.0),
                None,
                SwitchedEffects::new(slew_nm, &TIMING),
                TorqueLimits::new(plan.torque_limit_nm, slew_nm),
            ),
            is_removing: false,
            is_settling: false,
            omega_rad_s: 0.0,
            of_tick: 0,
        };
        rendering.apply(plan, 0.0);
        rendering
    }

    fn apply(&mut self, plan: &RenderingPlan, omega_rad_s: f32) {
        let stages = &mut self.stages;
        self.is_removing = false;
        match plan.joint {
            JointPlan::Absent => {}
            JointPlan::Start(silent, ramp) => {
                let limits = InputLimits::device(TICK_S);
                let mut joint = Crepitus::new(silent, limits, plan.rad_per_count, omega_rad_s);
                joint.follow(ramp);
                stages.symptoms = Some(joint);
            }
            JointPlan::Follow(ramp) | JointPlan::Remove(ramp) => {
                self.is_removing = matches!(plan.joint, JointPlan::Remove(_));
                if let Some(joint) = &mut stages.symptoms {
                    joint.follow(ramp);
                }
            }
        }
        stages.effects.change(&plan.effects, plan.slew_nm);
        stages.limits.change(plan.torque_limit_nm, plan.slew_nm);
    }

    /// Runs one tick with the counter that was sampled as it began. True if a plan
    /// is due: then [`Self::take_over`] follows.
    pub fn tick(&mut self, exchange: &Exchange) -> bool {
        let turn = exchange.turn();
        let sampled = self.sampler.sample(exchange.counter());
        self.omega_rad_s = sampled.omega_rad_s;
        let rendered = self.render(&turn, &sampled);
        exchange.set_settling(self.is_settling);
        exchange.show(&rendered);
        exchange.render_takes_plan()
    }

    /// Applies the plan that is stored, from the next tick on: in one tick with the
    /// first step of a ramp, that would take longer than all else.
    pub fn take_over(&mut self, plan: Option<&RenderingPlan>, exchange: &Exchange) {
        let Some(plan) = plan else { return };
        if let Some(reader) = &plan.reader {
            self.sampler.replace(reader);
        }
        self.apply(plan, self.omega_rad_s);
        exchange.set_settling(true);
        exchange.render_took_plan();
    }

    /// The stick-slip joint, if there is one.
    pub fn joint(&self) -> Option<&Frozen<f32, ExactEvents>> {
        self.stages.symptoms.as_ref().map(Crepitus::joint)
    }

    /// The tick that the next result is of. With more results than ticks it is one that is not due
    /// yet, which `command_motor` takes for a late one until there is no torque: the timer
    /// runs too fast, and with it the model's time.
    #[inline]
    fn next(&mut self, turn: &Turn) -> u32 {
        let next = self.of_tick.wrapping_add(1);
        let is_behind = next.wrapping_sub(turn.tick).cast_signed() < 0;
        self.of_tick = if turn.is_armed && !is_behind {
            next
        } else {
            turn.tick
        };
        self.of_tick
    }

    fn render(&mut self, turn: &Turn, sampled: &Sampled) -> Rendered {
        let seen = ShaftEstimate {
            sample: sampled.shaft,
            omega_rad_s: sampled.omega_rad_s,
            place: Position::at(sampled.count.wrapping_sub(turn.zero)),
            is_driven: turn.is_armed,
        };
        let mut flags = SampleFlags::default();
        self.stages.limits.set_energised(turn.is_armed);
        let shown = self.stages.tick(&seen, |event| {
            flags = flags.with(
                match event.kind {
                    EventKind::Break => SampleFlags::BREAK,
                    EventKind::Stick | EventKind::Reverse => SampleFlags::STICK,
                },
                true,
            );
        });
        if self.is_removing && !shown.settling {
            self.stages.symptoms = None;
            self.is_removing = false;
        }
        self.is_settling = shown.settling;
        Rendered {
            tick: self.next(turn),
            count: sampled.count,
            omega_rad_s: sampled.omega_rad_s,
            lost_ticks: sampled.lost_ticks,
            torque_nm: shown.torque_nm,
            model_torque_nm: shown.model_torque_nm,
            coil_v: shown.coil_v,
            flags: with(flags, &shown).with(SampleFlags::LOST, sampled.lost_ticks > 0),
            phases: shown.phases,
        }
    }
}

/// Adds phase, ramp, limit and the share held back to the flags.
#[inline]
fn with(flags: SampleFlags, shown: &Shown<f32>) -> SampleFlags {
    flags
        .with_phase(shown.phase.sign())
        .with(SampleFlags::SETTLING, shown.settling)
        .with_limit(match shown.limit {
            Limit::None => LimitReason::None,
            Limit::Torque => LimitReason::Torque,
            Limit::Slew => LimitReason::Slew,
            Limit::TurnedBack => LimitReason::TurnedBack,
            Limit::Holding => LimitReason::Holding,
            Limit::NotArmed => LimitReason::NotArmed,
            Limit::Tank => LimitReason::Tank,
        })
        .with_held_back(shown.held_back)
}
