//! What the drive controller does.
//!
//! ```text
//! priority   task               when                      parts
//! 4          command_motor      half a tick later, at the  Safety, Motor, Plausibility, Batch
//!                               converter's end
//! 3          sample_encoder     every 50 µs                Sampler
//! 2          render_torque      after it                   Rendering
//! 1          link               bytes, room to send        Link
//! idle                                                     Preparation
//! ```
//!
//! The firmware gives each part to its task. [`Drive`] is all of them in one,
//! in the order in which they run when none is late: it is what the simulator
//! runs, and the measure of the firmware.

pub mod arming;
pub mod batch;
pub mod command;
pub mod link;
pub mod motor;
pub mod plausibility;
pub mod prepare;
pub mod rendering;
pub mod safety;
pub mod sampler;
pub mod vigil;

use crate::counters::Counters;
use batch::Batch;
use command::{Command, Inputs, Outputs};
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::frame::Frame;
use crepitus_protocol::link::{DriveRefusal, DriveStatus, Order, ToDrive};
use crepitus_protocol::management::{Identity, Question, What};
use crepitus_protocol::telemetry::BlockFlags;
use crepitus_protocol::{Fault, Revision, State, ValueError, Values};
use link::{Inbound, Link};
use prepare::{Preparation, Prepared, Start};
use rendering::{Rendered, Rendering};
use sampler::{Sampled, Sampler};
use vigil::Heard;

/// How a drive starts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boot {
    /// Who it is.
    pub identity: Identity,
    /// What the encoder's counter says.
    pub counter: u32,
    /// Which start this is.
    pub start: u16,
    /// The first tick: 0, but in a test of the wrap.
    pub tick: u64,
    /// Number of the first block: 0, but in a test of the wrap.
    pub sequence: u16,
}

/// The drive controller, all of it.
#[derive(Debug)]
pub struct Drive {
    identity: Identity,
    start: u16,
    counters: Counters,
    preparation: Preparation,
    sampler: Sampler,
    rendering: Rendering,
    command: Command,
    batch: Batch,
    link: Link,
    /// A commit that waits for its preparation, the latest one.
    wanted: Option<(Revision, Values)>,
    /// A commit that waits for the end of a block.
    prepared: Option<Prepared>,
    refused: Option<(Revision, ValueError)>,
    revision: Revision,
    sampled: Option<Sampled>,
    rendered: Option<Rendered>,
    zeroed: bool,
    line_is_on: bool,
    wants_reboot: bool,
    shown: (State, Option<Fault>, Revision),
}

impl Drive {
    /// As it starts.
    ///
    /// # Errors
    /// [`ValueError`] if the defaults are not allowed: a mistake in their
    /// table, which a test would have found.
    pub fn new(boot: &Boot) -> Result<Self, ValueError> {
        let (
            preparation,
            Start {
                reader,
                motor,
                prepared,
            },
        ) = Preparation::new()?;
        Ok(Self {
            identity: boot.identity,
            start: boot.start,
            counters: Counters::new(),
            preparation,
            sampler: Sampler::new(&reader, boot.counter, boot.tick),
            rendering: Rendering::new(&prepared),
            command: Command::new(&motor, &prepared, boot.identity.reset),
            batch: Batch::new(boot.tick, boot.sequence),
            link: Link::default(),
            wanted: None,
            prepared: None,
            refused: None,
            revision: Revision::NONE,
            sampled: None,
            rendered: None,
            zeroed: false,
            line_is_on: false,
            wants_reboot: false,
            shown: (State::Disarmed, None, Revision::NONE),
        })
    }

    /// `sample_encoder`, priority 3: what the counter says as the tick begins.
    pub fn sample_encoder(&mut self, counter: u32) {
        if self.batch.is_between_blocks()
            && let Some(prepared) = self.prepared.take()
        {
            self.take_over(&prepared);
        }
        self.sampled = Some(self.sampler.sample(counter));
    }

    /// `render_torque`, priority 2.
    pub fn render_torque(&mut self) {
        if let Some(sampled) = &self.sampled {
            let is_energised = self.command.safety().state() == State::Armed;
            self.rendered = Some(self.rendering.tick(sampled, is_energised));
        }
    }

    /// `command_motor`, priority 4: half a tick later.
    pub fn command_motor(&mut self, inputs: &Inputs) -> Outputs {
        self.line_is_on = inputs.enable_is_on;
        let Some(sampled) = &self.sampled else {
            return Outputs::default();
        };
        let (outputs, sample) =
            self.command
                .tick(inputs, sampled, self.rendered.as_ref(), &self.counters);
        let flags = BlockFlags::new(self.command.safety().state(), self.zeroed, self.start);
        self.batch
            .push(sample, self.revision, flags, &self.counters);
        if let Some(result) = self.command.safety_mut().take_outcome() {
            self.link.finish(result);
        }
        let safety = self.command.safety();
        let shown = (safety.state(), safety.fault(), self.revision);
        if self.shown != shown {
            self.shown = shown;
            self.link.changed();
        }
        outputs
    }

    /// `idle`: prepares a commit, if one waits and the one before has settled.
    pub fn prepare(&mut self) {
        if self.prepared.is_some() || self.rendering.is_settling() {
            return;
        }
        let Some((revision, values)) = self.wanted.take() else {
            return;
        };
        let is_live = self.command.safety().is_live();
        match self.preparation.prepare(revision, &values, is_live) {
            Ok(prepared) => self.prepared = Some(prepared),
            Err(error) => {
                self.counters.count(DriveCounter::RefusedCommits);
                self.refused = Some((revision, error));
                self.link.changed();
            }
        }
    }

    /// `link`, priority 1: a byte from comms.
    pub fn link_received(&mut self, byte: u8) {
        match self.link.receive(byte, &self.counters) {
            None => {}
            Some(Inbound::Management(question)) => self.manage(question),
            Some(Inbound::Message(ToDrive::Heartbeat(heartbeat))) => {
                let now = self.sampler.next_tick();
                let safety = self.command.safety_mut();
                if safety.hear(now, &heartbeat, &self.counters) == Heard::Restarted {
                    self.link.forget();
                    self.refused = None;
                }
            }
            Some(Inbound::Message(ToDrive::Commit { revision, values })) => {
                self.commit(revision, &values);
            }
            Some(Inbound::Message(ToDrive::Command {
                seen_tick,
                number,
                order,
            })) => {
                let now = self.sampler.next_tick();
                if self.link.accepts(now, seen_tick, number, &self.counters)
                    && let Some(result) = self.obey(now, order)
                {
                    self.link.finish(result);
                }
            }
        }
    }

    /// The next frame for comms, if there is one.
    pub fn link_to_send(&mut self) -> Option<Frame> {
        let now = self.sampler.next_tick();
        let safety = self.command.safety();
        let (counters, batch) = (&self.counters, &mut self.batch);
        let status = |last| DriveStatus {
            tick: now,
            start: self.start,
            heard: safety.heard_start(),
            state: safety.state(),
            fault: safety.fault().map_or(0, Fault::code),
            revision: self.revision,
            refused: self.refused,
            last,
            zeroed: self.zeroed,
            polarity_proven: safety.polarity_proven(),
            counters: counters.all(),
        };
        self.link.next_frame(now, status, || batch.pop())
    }

    /// Whether it was asked to start anew; once. The board does it.
    pub fn take_reboot(&mut self) -> bool {
        core::mem::take(&mut self.wants_reboot)
    }

    /// Ticks since the start: the next one.
    pub fn next_tick(&self) -> u64 {
        self.sampler.next_tick()
    }

    /// Whether there may be torque.
    pub fn state(&self) -> State {
        self.command.safety().state()
    }

    /// The parameters in force.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// What it has counted.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    fn take_over(&mut self, prepared: &Prepared) {
        if let Some(reader) = &prepared.reader {
            self.sampler.replace(reader);
        }
        let omega_rad_s = self.sampled.map_or(0.0, |sampled| sampled.omega_rad_s);
        self.rendering.take_over(prepared, omega_rad_s);
        self.command.take_over(prepared);
        (self.revision, self.refused) = (prepared.revision, None);
        self.counters.count(DriveCounter::Commits);
    }

    fn commit(&mut self, revision: Revision, values: &Values) {
        let is_known = self.revision == revision
            || self.prepared.is_some_and(|p| p.revision == revision)
            || self.refused.is_some_and(|(refused, _)| refused == revision);
        if is_known {
            // Repeated, because the status that says so was lost.
            self.link.changed();
        } else if self.wanted.is_none_or(|(wanted, _)| wanted != revision) {
            self.wanted = Some((revision, *values));
        }
    }

    /// Carries out an order; none if its end is still to come.
    fn obey(&mut self, now: u64, order: Order) -> Option<Result<(), DriveRefusal>> {
        let safety = self.command.safety_mut();
        match order {
            Order::Arm if self.revision == Revision::NONE => Some(Err(DriveRefusal::NoParameters)),
            Order::Arm => {
                let lost_ticks = self.sampled.map_or(1, |sampled| sampled.lost_ticks);
                match safety.arm(now, lost_ticks) {
                    Ok(()) => None,
                    Err(refusal) => Some(Err(refusal)),
                }
            }
            Order::Zero if safety.is_live() => Some(Err(DriveRefusal::Armed)),
            Order::Zero => {
                self.sampler.zero();
                self.zeroed = true;
                Some(Ok(()))
            }
            Order::ClearFault => Some(safety.clear(self.line_is_on)),
        }
    }

    fn manage(&mut self, question: Question) {
        let safety = self.command.safety_mut();
        let done = match question.what {
            What::Hello => true,
            What::Stop => {
                safety.disarm();
                true
            }
            What::Reboot => {
                self.wants_reboot = !safety.is_live();
                self.wants_reboot
            }
        };
        self.link.answer(question, &self.identity, done);
    }
}
