//! `command_motor`: the bridge's output for the next tick, and the telemetry
//! sample of this one.

use crate::counters::Counters;
use crate::drive::Boot;
use crate::drive::batch::Batch;
use crate::drive::motor::{Bridge, Motor};
use crate::drive::plausibility::{Observation, Plausibility};
use crate::drive::prepare::{CommandPlan, MotorPlan};
use crate::drive::rendering::Rendered;
use crate::drive::safety::{Permit, Safety};
use crate::drive::sampler::Sampled;
use crepitus_model::Real;
use crepitus_model::control::current_loop::Limit;

use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::telemetry::{Block, BlockFlags, NO_CURRENT, Sample, SampleFlags};
use crepitus_protocol::{LimitReason, Revision, State};

/// Inputs from the peripherals in the middle of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// The current, A, positive towards growing angle; `None` if the converter
    /// has no result.
    pub current_a: Option<f32>,
    /// The drive's enable line, as read back.
    pub enable_is_on: bool,
    /// The hardware's break input has tripped.
    pub has_tripped: bool,
}

/// Outputs to the peripherals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// The drive's enable line.
    pub enable: bool,
    /// The bridge: floating at once, or driven from the next PWM period on.
    pub bridge: Bridge,
}

/// Commands the motor, once a tick.
#[derive(Clone, Debug)]
pub struct Command {
    safety: Safety,
    motor: Motor,
    plausibility: Plausibility,
    speed_limit_rad_s: f32,
    /// The bridge was driven in the previous tick.
    was_driven: bool,
    /// The state after that tick.
    last_state: State,
    /// Revision of the active parameters.
    revision: Revision,
    /// The line, as read back.
    line_is_on: bool,
    batch: Batch,
    zeroed: bool,
    /// Boot counter of the drive.
    start: u16,
}

impl Command {
    /// The state after boot.
    pub fn new(motor: &MotorPlan, plan: &CommandPlan, boot: &Boot) -> Self {
        Self {
            safety: Safety::new(boot.identity.reset),
            motor: Motor::new(motor),
            plausibility: Plausibility::default(),
            speed_limit_rad_s: plan.speed_limit_rad_s,
            was_driven: false,
            last_state: State::Disarmed,
            revision: plan.revision,
            line_is_on: false,
            batch: Batch::new(boot.tick, boot.sequence),
            zeroed: false,
            start: boot.start,
        }
    }

    /// Applies new parameters from the next tick on.
    pub fn apply(&mut self, plan: &CommandPlan, counters: &Counters) {
        if let Some(motor) = &plan.motor {
            self.motor = Motor::new(motor);
        }
        self.speed_limit_rad_s = plan.speed_limit_rad_s;
        self.revision = plan.revision;
        counters.count(DriveCounter::Commits);
    }

    /// Revision of the active parameters.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// The last read-back of the enable line.
    pub fn line_is_on(&self) -> bool {
        self.line_is_on
    }

    /// Records that the angle's zero was set.
    pub fn set_zeroed(&mut self) {
        self.zeroed = true;
    }

    /// Whether the angle's zero was set.
    pub fn is_zeroed(&self) -> bool {
        self.zeroed
    }

    /// The oldest block queued for the link.
    pub fn block(&self) -> Option<&Block> {
        self.batch.front()
    }

    /// Number of blocks queued for the link.
    pub fn queued_blocks(&self) -> usize {
        self.batch.queued()
    }

    /// Removes the oldest block: the link has sent it.
    pub fn pop_block(&mut self) {
        self.batch.pop();
    }

    /// Whether the drive was armed after the last tick; then torque is applied.
    pub fn was_armed(&self) -> bool {
        self.last_state == State::Armed
    }

    /// The safety state machine.
    pub fn safety(&self) -> &Safety {
        &self.safety
    }

    /// The safety state machine, to execute orders.
    pub fn safety_mut(&mut self) -> &mut Safety {
        &mut self.safety
    }

    /// Runs one tick.
    pub fn tick(
        &mut self,
        inputs: &Inputs,
        sampled: &Sampled,
        rendered: Option<&Rendered>,
        counters: &Counters,
    ) -> Outputs {
        self.line_is_on = inputs.enable_is_on;
        let is_late = rendered.is_none_or(|rendered| rendered.tick != sampled.tick);
        let rendered = rendered.copied().unwrap_or_default();
        let mut permit = self.safety.tick(
            sampled.tick,
            inputs.current_a,
            inputs.enable_is_on,
            sampled.count,
            counters,
        );
        if let Some(offset_a) = self.safety.offset_a() {
            self.motor.set_offset(offset_a);
        }
        let current_a = inputs.current_a.map(|raw_a| self.motor.current_a(raw_a));
        if matches!(permit, Permit::Torque | Permit::Push(_)) {
            permit = self.checked(
                permit,
                &Observation {
                    lost_ticks: sampled.lost_ticks,
                    omega_rad_s: sampled.omega_rad_s,
                    is_late,
                    torque_is_finite: rendered.torque_nm.is_finite(),
                    current_a,
                    enable_is_on: inputs.enable_is_on,
                    has_tripped: inputs.has_tripped,
                },
                counters,
            );
        }
        let outputs = self.drive(permit, sampled, &rendered, current_a);
        let sample = self.sample(permit, sampled, &rendered, current_a, is_late, counters);
        let state = self.safety.state();
        self.last_state = state;
        let flags = BlockFlags::new(state, self.zeroed, self.start);
        self.batch.push(sample, self.revision, flags, counters);
        outputs
    }

    /// Withdraws the permit if a plausibility check fails.
    fn checked(
        &mut self,
        permit: Permit,
        observation: &Observation,
        counters: &Counters,
    ) -> Permit {
        if !self.was_driven {
            self.plausibility = Plausibility::default();
        }
        let fault = self
            .plausibility
            .check(observation, &self.motor, self.speed_limit_rad_s);
        match fault {
            None => permit,
            Some(fault) => {
                self.safety.fail(fault, counters);
                Permit::Nothing
            }
        }
    }

    fn drive(
        &mut self,
        permit: Permit,
        sampled: &Sampled,
        rendered: &Rendered,
        current_a: Option<f32>,
    ) -> Outputs {
        let torque_nm = match permit {
            Permit::Nothing | Permit::Line => None,
            Permit::Push(amperes) => Some(-amperes * self.motor.joint_constant()),
            Permit::Torque => Some(rendered.torque_nm),
        };
        let bridge = match torque_nm {
            None => self.motor.float(),
            Some(torque_nm) => {
                if !self.was_driven {
                    self.motor.start(sampled.omega_rad_s);
                }
                self.motor.drive(torque_nm, current_a)
            }
        };
        self.was_driven = torque_nm.is_some();
        Outputs {
            enable: permit != Permit::Nothing,
            bridge,
        }
    }

    fn sample(
        &self,
        permit: Permit,
        sampled: &Sampled,
        rendered: &Rendered,
        current_a: Option<f32>,
        is_late: bool,
        counters: &Counters,
    ) -> Sample {
        let is_armed = permit == Permit::Torque;
        let by_motor = match self.motor.limited_by() {
            Some(Limit::Current) => LimitReason::Current,
            Some(Limit::Voltage) => LimitReason::Voltage,
            None => LimitReason::None,
        };
        let limit = match (is_armed, rendered.flags.limit()) {
            (false, _) => LimitReason::NotArmed,
            (true, LimitReason::None | LimitReason::NotArmed) => by_motor,
            (true, reason) => reason,
        };
        for (counter, is_active) in [
            (DriveCounter::LostSamples, sampled.lost_ticks > 0),
            (DriveCounter::LateTicks, is_late),
            (DriveCounter::MissedCurrents, current_a.is_none()),
            (
                DriveCounter::LimitedTicks,
                is_armed && limit != LimitReason::None,
            ),
        ] {
            if is_active {
                counters.count(counter);
            }
        }
        Sample {
            count: sampled.count,
            model_torque_nm: rendered.model_torque_nm,
            torque_nm: if is_armed { rendered.torque_nm } else { 0.0 },
            current_ma: current_a.map_or(NO_CURRENT, milliamperes),
            flags: rendered
                .flags
                .with_limit(limit)
                .with(SampleFlags::ENERGISED, is_armed)
                .with(SampleFlags::LATE, is_late),
        }
    }
}

/// Rounds and clamps to the range of i16, never [`NO_CURRENT`].
fn milliamperes(current_a: f32) -> i16 {
    let most = f32::from(i16::MAX);
    let scaled = current_a * 1e3;
    let rounded = (scaled + 0.5_f32.copysign(scaled)).within(most);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast from float saturates"
    )]
    let milliamperes = rounded as i16;
    milliamperes
}
