//! `command_motor`: the bridge's output for the next tick, and the telemetry
//! sample of this one.

mod guards;
mod samples;

use crate::counters::Counters;
use crate::drive::Boot;
use crate::drive::arming::ArmingInputs;
use crate::drive::batch::Batch;
use crate::drive::coil::{Coil, CoilOutput};
use crate::drive::emf_check::EmfCheck;
use crate::drive::exchange::{Exchange, Rendered, Turn};
use crate::drive::motor::{Bridge, Motor};
use crate::drive::overload::Overload;
use crate::drive::plausibility::{Observation, Plausibility};
use crate::drive::prepare::{CommandPlan, MotorPlan};
use crate::drive::range::{self, Range};
use crate::drive::safety::{Permit, Safety};
use crate::drive::slow_checks::{SlowChecks, SlowInput, SlowReadings};
use crepitus_model::control::chirp::Chirp;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::crash::Tick;
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::telemetry::{Block, BlockFlags};
use crepitus_protocol::{Revision, State};

/// Inputs from the peripherals in the middle of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a line by itself")]
pub struct Inputs {
    /// The current, A, positive towards growing angle, by the amplifier at half A. `None`
    /// if its converter has no result.
    pub current_a: Option<f32>,
    /// The current, A, by a shunt, an amplifier and a converter of its own at half B. The loop takes
    /// that of the half that switched earlier; checks take both.
    pub monitor_a: Option<f32>,
    /// Time since the last call, by another timer than the one that calls, µs.
    pub interval_us: u32,
    /// The drive's enable line, as read back.
    pub enable_is_on: bool,
    /// The enable line of comms, at its gate.
    pub comms_enable_is_on: bool,
    /// The hardware's break input has tripped.
    pub has_tripped: bool,
    /// One of the inputs that change slowly.
    pub slow: SlowInput,
    /// Current of the vibration actuator's coil, A, positive as its command. `None` if
    /// its converter has no result, or if the coil is asleep.
    pub coil_a: Option<f32>,
    /// The break input of the coil's timer has tripped: its driver's nFAULT. Only read
    /// while the coil is driven.
    pub coil_has_tripped: bool,
}

/// Outputs to the peripherals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// The drive's enable line.
    pub enable: bool,
    /// The bridge: floating at once, or driven from the next PWM period on.
    pub bridge: Bridge,
    /// Voltage of the bridge as a share of the supply's, −1 to 1, rounded.
    pub duty: f32,
    /// The bridge of the vibration actuator's coil.
    pub coil: CoilOutput,
}

/// Commands the motor, once a tick. In the order of its fields, the blocks last: what is
/// within the first kilobyte a load reaches directly.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Command {
    /// Number of the next tick: the clock of every timeout.
    next_tick: u64,
    safety: Safety,
    motor: Motor,
    /// Offset of the monitor, A.
    monitor_offset_a: f32,
    plausibility: Plausibility,
    emf_check: EmfCheck,
    /// Angle of one count, rad.
    rad_per_count: f32,
    speed_limit_rad_s: f32,
    range: Range,
    slow_checks: SlowChecks,
    overload: Overload,
    /// The coil has something to do.
    has_coil: bool,
    /// The coil played a chirp in this tick.
    has_chirped: bool,
    /// The bridge was driven in the previous tick.
    was_driven: bool,
    /// Consecutive ticks with a current while the bridge floats.
    conducting_ticks: u32,
    /// Time for which the enable line of comms was off, in quarters of a tick.
    without_comms: u32,
    /// Revision of the active parameters.
    revision: Revision,
    /// The boot of comms that has sent it.
    sent_by: u16,
    /// The line, as read back.
    line_is_on: bool,
    /// The encoder's last count, and that of the angle's zero.
    count: i32,
    zero: i32,
    lost_ticks: u32,
    zeroed: bool,
    /// Boot counter of the drive.
    start: u16,
    batch: Batch,
    /// Coil of the vibration actuator, if there is one.
    coil: Coil,
    /// Chirp that the coil plays instead of its command.
    chirp: Option<Chirp>,
}

impl Command {
    /// The state after boot.
    pub fn new(motor: &MotorPlan, plan: &CommandPlan, boot: &Boot) -> Self {
        Self {
            next_tick: boot.tick,
            safety: Safety::new(boot.identity.reset, boot.self_test),
            motor: Motor::new(motor),
            monitor_offset_a: 0.0,
            plausibility: Plausibility::default(),
            emf_check: EmfCheck::default(),
            rad_per_count: plan.rad_per_count,
            speed_limit_rad_s: plan.speed_limit_rad_s,
            range: Range::new(&plan.range),
            slow_checks: SlowChecks::new(&plan.slow),
            overload: Overload::new(&plan.overload),
            has_coil: plan.coil.is_some(),
            coil: Coil::new(plan.coil),
            chirp: None,
            has_chirped: false,
            was_driven: false,
            conducting_ticks: 0,
            without_comms: 0,
            revision: plan.revision,
            sent_by: plan.comms_start,
            line_is_on: false,
            batch: Batch::new(boot.tick, boot.sequence),
            count: boot.counter.cast_signed(),
            zero: boot.counter.cast_signed(),
            lost_ticks: 0,
            zeroed: false,
            start: boot.start,
        }
    }

    fn apply(&mut self, plan: &CommandPlan, counters: &Counters) {
        // No window ends in a tick that has a plan to apply.
        self.emf_check.restart();
        if let Some(motor) = &plan.motor {
            self.motor = Motor::new(motor);
            self.emf_check = EmfCheck::default();
        }
        // Counts from the zero would be another angle.
        self.zeroed &= plan.rad_per_count == self.rad_per_count;
        self.rad_per_count = plan.rad_per_count;
        self.speed_limit_rad_s = plan.speed_limit_rad_s;
        self.range = Range::new(&plan.range);
        self.slow_checks.change(&plan.slow);
        self.overload.change(&plan.overload);
        self.coil.change(plan.coil);
        if plan.coil.is_none() {
            // A chirp would go on with the next actuator.
            (self.chirp, self.has_chirped) = (None, false);
        }
        self.has_coil = self.coil.is_in_use();
        (self.revision, self.sent_by) = (plan.revision, plan.comms_start);
        counters.count(DriveCounter::Commits);
    }

    /// Revision of the active parameters.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// Active revision for comms: none if another boot of comms sent it, which may have had the
    /// same number for something else.
    pub fn known_revision(&self) -> Revision {
        if self.safety.comms_start() == Some(self.sent_by) {
            self.revision
        } else {
            Revision::NONE
        }
    }

    /// Number of the next tick.
    pub fn next_tick(&self) -> u64 {
        self.next_tick
    }

    /// Sets the angle's zero here.
    ///
    /// # Errors
    /// [`DriveRefusal::Armed`] while it is armed or arming.
    pub fn zero(&mut self) -> Result<(), DriveRefusal> {
        if self.safety.is_live() {
            return Err(DriveRefusal::Armed);
        }
        self.zero = self.count;
        self.zeroed = true;
        self.slow_checks.zero();
        Ok(())
    }

    /// Starts arming.
    ///
    /// # Errors
    /// [`DriveRefusal`] if it cannot start.
    pub fn arm(&mut self) -> Result<(), DriveRefusal> {
        if self.revision == Revision::NONE {
            return Err(DriveRefusal::NoParameters);
        }
        let place = if !self.zeroed {
            Err(DriveRefusal::NotZeroed)
        } else if self.range.fades_left(self.count_from_zero()) >= 0.0 {
            Ok(())
        } else {
            Err(DriveRefusal::OutsideRange)
        };
        self.safety.arm(self.next_tick, self.lost_ticks, place)?;
        self.plausibility = Plausibility::default();
        self.without_comms = 0;
        Ok(())
    }

    /// The encoder's count from the angle's zero.
    fn count_from_zero(&self) -> i32 {
        self.count.wrapping_sub(self.zero)
    }

    /// Returns whether the angle's zero was set.
    pub fn is_zeroed(&self) -> bool {
        self.zeroed
    }

    /// Last readings of supply, motor temperature and joint sensor.
    pub fn slow_readings(&self) -> SlowReadings {
        self.slow_checks.readings()
    }

    /// The coil of the vibration actuator.
    pub fn coil(&self) -> &Coil {
        &self.coil
    }

    /// Clears the fault, and that of the coil.
    ///
    /// # Errors
    /// [`DriveRefusal::Faulted`] if its cause persists, [`DriveRefusal::Armed`].
    pub fn clear_fault(&mut self) -> Result<(), DriveRefusal> {
        self.safety.clear(self.line_is_on)?;
        self.coil.clear();
        Ok(())
    }

    /// Plays a chirp on the coil from the next tick on, until it is over or there is no torque.
    ///
    /// # Errors
    /// [`DriveRefusal`] says why not.
    pub fn play_chirp(&mut self, chirp: &PlayedChirp) -> Result<(), DriveRefusal> {
        if self.safety.state() != State::Armed {
            return Err(DriveRefusal::NotArmed);
        }
        if self.chirp.is_some() {
            return Err(DriveRefusal::ChirpPlaying);
        }
        let settings = chirp.settings();
        self.coil.check_chirp(settings.amplitude_v)?;
        let chirp = Chirp::new(&settings).map_err(|_| DriveRefusal::ChirpOutOfRange)?;
        self.chirp = Some(chirp);
        Ok(())
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

    /// The safety state machine.
    pub fn safety(&self) -> &Safety {
        &self.safety
    }

    /// The safety state machine, to execute orders.
    pub fn safety_mut(&mut self) -> &mut Safety {
        &mut self.safety
    }

    /// Runs one tick with the newest result of `render_torque`, and with the plan
    /// that is stored, which it applies when it is due. `keep` stores the tick for the
    /// post-mortem record. Before the first result there is no tick.
    pub fn tick(
        &mut self,
        inputs: &Inputs,
        plan: Option<&CommandPlan>,
        exchange: &Exchange,
        counters: &Counters,
        keep: impl FnOnce(&Tick),
    ) -> Outputs {
        let Some(rendered) = exchange.rendered() else {
            return Outputs::default();
        };
        let begins_block = self.batch.begins_block();
        if let Some(plan) = plan.filter(|_| exchange.command_takes_plan(begins_block)) {
            self.apply(plan, counters);
            exchange.command_took_plan();
        }
        let outputs = self.command(inputs, &rendered, counters, keep);
        exchange.announce(Turn {
            tick: low(self.next_tick),
            ends_block: self.batch.ends_block(),
            // After the bridge has floated the slew limit starts from zero, as after arming.
            is_armed: self.safety.state() == State::Armed && self.was_driven,
            zero: self.zero,
        });
        outputs
    }

    fn command(
        &mut self,
        inputs: &Inputs,
        rendered: &Rendered,
        counters: &Counters,
        keep: impl FnOnce(&Tick),
    ) -> Outputs {
        let now = self.next_tick;
        self.next_tick = now.wrapping_add(1);
        self.line_is_on = inputs.enable_is_on;
        (self.count, self.lost_ticks) = (rendered.count, rendered.lost_ticks);
        let is_late = rendered.tick != low(now);
        let fault_before = self.safety.fault();
        let mut permit = self.safety.tick(
            now,
            &ArmingInputs {
                raw_a: inputs.current_a.zip(inputs.monitor_a),
                line_is_on: inputs.enable_is_on,
                comms_line_is_on: inputs.comms_enable_is_on,
                count: rendered.count,
            },
            counters,
        );
        if let Some((sensor_a, monitor_a)) = self.safety.offsets_a() {
            self.motor.set_offset(sensor_a);
            self.monitor_offset_a = monitor_a;
        }
        permit = self.with_comms(permit, inputs.comms_enable_is_on, counters);
        let sensor_a = inputs.current_a.map(|raw_a| self.motor.sensor_a(raw_a));
        let monitor_a = inputs.monitor_a.map(|raw_a| raw_a - self.monitor_offset_a);
        let current_a = sensor_a.map(|sensor_a| self.motor.current_a(sensor_a, monitor_a));
        let currents_a = sensor_a.zip(monitor_a);
        permit = self.floating(permit, currents_a, rendered.omega_rad_s, counters);
        if matches!(permit, Permit::Torque | Permit::Push(_)) {
            let emf_contradicts = self.check_emf(rendered, current_a, is_late);
            permit = self.checked(
                permit,
                &Observation {
                    lost_ticks: rendered.lost_ticks,
                    omega_rad_s: rendered.omega_rad_s,
                    is_late,
                    torque_is_finite: rendered.torque_nm.is_finite(),
                    current_a,
                    sensor_a,
                    monitor_a,
                    emf_contradicts,
                    interval_us: inputs.interval_us,
                    enable_is_on: inputs.enable_is_on,
                    has_tripped: inputs.has_tripped,
                },
                counters,
            );
        }
        let count = self.count_from_zero();
        let fades_left = self.range.fades_left(count);
        let is_live = self.safety.is_live();
        let slow = self.slow_checks.tick(inputs.slow, count, is_live);
        permit = self.guarded(permit, slow, fades_left, current_a, counters);
        let share = range::share(fades_left);
        let torque_nm = rendered.torque_nm * share;
        let mut outputs = self.drive(permit, torque_nm, rendered.omega_rad_s, current_a);
        if self.has_coil {
            outputs.coil = self.drive_coil(
                permit == Permit::Torque,
                rendered.coil_v * share,
                inputs.coil_a,
                inputs.coil_has_tripped,
                counters,
            );
        }
        let applied_nm =
            (permit == Permit::Torque && outputs.bridge != Bridge::Float).then_some(torque_nm);
        let sample = self.sample(
            applied_nm,
            share < 1.0,
            rendered,
            current_a,
            is_late,
            counters,
        );
        self.doubt_zero(fault_before);
        let flags = BlockFlags::new(self.safety.state(), self.zeroed, self.start);
        let phases = rendered.phases.into();
        self.batch
            .push(sample, phases, self.revision, flags, counters);
        keep(&Tick {
            number: low(now),
            sample,
        });
        outputs
    }

    fn drive(
        &mut self,
        permit: Permit,
        torque_nm: f32,
        omega_rad_s: f32,
        current_a: Option<f32>,
    ) -> Outputs {
        if let Permit::Proof(volts, enable) = permit {
            self.was_driven = true;
            let bridge = self.motor.prove(volts, omega_rad_s);
            return Outputs {
                enable,
                bridge,
                duty: self.motor.duty(bridge),
                coil: CoilOutput::Asleep,
            };
        }
        let torque_nm = match permit {
            Permit::Nothing | Permit::Line | Permit::Proof(..) => None,
            Permit::Push(amperes) => Some(-amperes * self.motor.joint_constant()),
            Permit::Torque => Some(torque_nm),
        };
        let bridge = match torque_nm {
            None => self.motor.float(),
            Some(torque_nm) => {
                if !self.was_driven {
                    self.motor.start(omega_rad_s);
                    self.emf_check = EmfCheck::default();
                }
                self.motor.drive(torque_nm, current_a)
            }
        };
        self.was_driven = torque_nm.is_some();
        Outputs {
            enable: permit != Permit::Nothing,
            bridge,
            duty: self.motor.duty(bridge),
            coil: CoilOutput::Asleep,
        }
    }
}

/// The lowest 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "the lowest bits")]
fn low(tick: u64) -> u32 {
    tick as u32
}
