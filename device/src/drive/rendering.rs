//! `render_torque`: the torque to show.
//!
//! ```text
//! joint ─> guard ──────────(+)──(+)──> limits ─> torque
//!                           │    │
//! friction compensation ─ slew   bone
//! ```
//!
//! The joint runs in every tick, torque or not. While the bridge floats
//! nothing is asked of the motor; from arming on, what may be asked for grows
//! with the slew limit, so a stick that is full of torque does not jolt.

use crate::drive::prepare::{JointPlan, RenderingPlan};
use crate::drive::sampler::Sampled;
use crepitus_model::guarded::InputLimits;
use crepitus_model::locate::ExactEvents;
use crepitus_model::{
    BoneShaping, EventKind, FrictionCompensation, Real, Renderer, Sample, StickSlip,
};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{LimitReason, TICK_S};

/// The joint that the firmware renders.
pub type Joint = Renderer<f32, ExactEvents>;

/// The torque of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Ticks since the start.
    pub tick: u64,
    /// What is asked of the motor, N·m.
    pub torque_nm: f32,
    /// What the model asks for, N·m.
    pub model_torque_nm: f32,
    /// What else is to be said; without what the motor adds.
    pub flags: SampleFlags,
}

/// Renders, once a tick.
#[derive(Clone, Debug)]
pub struct Rendering {
    joint: Option<Joint>,
    /// It goes once it has settled.
    is_leaving: bool,
    is_settling: bool,
    compensation: Option<FrictionCompensation<f32>>,
    /// What compensation adds now, N·m.
    compensating_nm: f32,
    bone: Option<BoneShaping<f32>>,
    /// What is left of the ringing of a bone that was exchanged, N·m.
    fading_nm: f32,
    rung_nm: f32,
    torque_limit_nm: f32,
    slew_nm: f32,
    /// What may be asked for as yet, N·m.
    allowance_nm: f32,
}

impl Rendering {
    /// From the first numbers.
    pub fn new(plan: &RenderingPlan) -> Self {
        let mut rendering = Self {
            joint: None,
            is_leaving: false,
            is_settling: false,
            compensation: None,
            compensating_nm: 0.0,
            bone: None,
            fading_nm: 0.0,
            rung_nm: 0.0,
            torque_limit_nm: 0.0,
            slew_nm: 0.0,
            allowance_nm: 0.0,
        };
        rendering.take_over(plan, 0.0);
        rendering
    }

    /// From the next tick on, these numbers.
    pub fn take_over(&mut self, plan: &RenderingPlan, omega_rad_s: f32) {
        self.is_leaving = false;
        match plan.joint {
            JointPlan::Absent => {}
            JointPlan::Begin(silent, ramp) => {
                let limits = InputLimits::device(TICK_S);
                let mut joint = Joint::new(silent, limits, plan.rad_per_count, omega_rad_s);
                joint.follow(ramp);
                self.joint = Some(joint);
            }
            JointPlan::Follow(ramp) | JointPlan::Leave(ramp) => {
                self.is_leaving = matches!(plan.joint, JointPlan::Leave(_));
                if let Some(joint) = &mut self.joint {
                    joint.follow(ramp);
                }
            }
        }
        self.compensation = plan.compensation;
        if let Some(bone) = plan.bone {
            self.fading_nm += self.rung_nm;
            self.rung_nm = 0.0;
            self.bone = bone;
        }
        self.torque_limit_nm = plan.torque_limit_nm;
        self.slew_nm = plan.slew_nm;
    }

    /// Whether numbers still move, after a tick: the next commit waits.
    pub fn is_settling(&self) -> bool {
        self.is_settling
    }

    /// One tick.
    pub fn tick(&mut self, sampled: &Sampled, is_energised: bool) -> Rendered {
        let mut flags = SampleFlags::default();
        let (mut model_nm, mut shown_nm, mut reason) = (0.0, 0.0, LimitReason::None);
        let mut jump_nm = 0.0;
        if let Some(joint) = &mut self.joint {
            let shown = joint.tick(&sampled.shaft, |event| {
                jump_nm += event.torque_after_nm - event.torque_before_nm;
                flags = flags.with(
                    match event.kind {
                        EventKind::Break => SampleFlags::BREAK,
                        EventKind::Stick | EventKind::Reverse => SampleFlags::STICK,
                    },
                    true,
                );
            });
            (model_nm, shown_nm) = (shown.model_torque_nm, shown.torque_nm);
            if shown.turned_back {
                reason = LimitReason::TurnedBack;
            } else if shown.holding {
                reason = LimitReason::Holding;
            }
            flags = flags
                .with_phase(joint.joint().phase().sign())
                .with(SampleFlags::SETTLING, shown.settling);
            if self.is_leaving && !shown.settling {
                self.joint = None;
                self.is_leaving = false;
            }
            self.is_settling = shown.settling;
        }
        let (wanted_nm, slewed) = self.with_what_is_added(shown_nm, jump_nm, sampled);
        if slewed && reason == LimitReason::None {
            reason = LimitReason::Slew;
        }
        let (torque_nm, reason) = self.limited(wanted_nm, is_energised, reason);
        Rendered {
            tick: sampled.tick,
            torque_nm,
            model_torque_nm: model_nm,
            flags: flags
                .with(SampleFlags::LOST, sampled.lost_ticks > 0)
                .with_limit(reason),
        }
    }

    /// Compensation and bone; and whether the slew limit was felt.
    fn with_what_is_added(
        &mut self,
        shown_nm: f32,
        jump_nm: f32,
        sampled: &Sampled,
    ) -> (f32, bool) {
        let mut slewed = false;
        let mut total_nm = shown_nm;
        if self.compensation.is_some() || self.compensating_nm != 0.0 {
            let target_nm = self
                .compensation
                .as_ref()
                .map_or(0.0, |c| c.torque_nm(sampled.omega_rad_s));
            let step_nm = target_nm - self.compensating_nm;
            slewed = step_nm.abs() > self.slew_nm;
            self.compensating_nm = if slewed {
                self.compensating_nm + self.slew_nm.copysign(step_nm)
            } else {
                target_nm
            };
            total_nm += self.compensating_nm;
        }
        if let Some(bone) = &mut self.bone {
            let travel_rad = match sampled.shaft {
                Sample::Taken(step) => step.delta_phi_rad,
                Sample::Lost => 0.0,
            };
            bone.ring(jump_nm);
            self.rung_nm = bone.tick(travel_rad);
            total_nm += self.rung_nm;
        }
        if self.fading_nm != 0.0 {
            let left_nm = (self.fading_nm.abs() - self.slew_nm).at_least(0.0);
            self.fading_nm = left_nm.copysign(self.fading_nm);
            total_nm += self.fading_nm;
        }
        (total_nm, slewed)
    }

    /// Within what may be asked for, and why it may not be more.
    fn limited(
        &mut self,
        wanted_nm: f32,
        is_energised: bool,
        reason: LimitReason,
    ) -> (f32, LimitReason) {
        if !is_energised {
            self.allowance_nm = 0.0;
            return (0.0, LimitReason::NotArmed);
        }
        let most_nm = if self.allowance_nm > self.torque_limit_nm {
            // It was lowered, and is followed as torque is: no jolt.
            (self.allowance_nm - self.slew_nm).at_least(self.torque_limit_nm)
        } else {
            (self.allowance_nm + self.slew_nm).at_most(self.torque_limit_nm)
        };
        self.allowance_nm = most_nm;
        // A torque that is no number passes, and is noticed by what follows.
        if wanted_nm.abs() <= most_nm || wanted_nm.is_nan() {
            return (wanted_nm, reason);
        }
        let limit = if most_nm == self.torque_limit_nm {
            LimitReason::Torque
        } else {
            LimitReason::Slew
        };
        (most_nm.copysign(wanted_nm), limit)
    }
}
