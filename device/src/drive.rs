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
pub mod commits;
pub mod link;
pub mod link_task;
pub mod motor;
pub mod outgoing;
pub mod plausibility;
pub mod prepare;
pub mod rendering;
pub mod safety;
pub mod sampler;
pub mod vigil;

use crate::counters::Counters;
use command::{Command, Inputs, Outputs};
use commits::Commits;
use crepitus_protocol::frame::{FRAME_BYTES, Frame, Place};
use crepitus_protocol::management::Identity;
use crepitus_protocol::{Fault, Revision, State, ValueError, Values};
use link_task::{LinkTask, Shared};
use prepare::{CommandPlan, Preparation, Prepared, RenderingPlan, Start};
use rendering::{Rendered, Rendering};
use sampler::{Sampled, Sampler};

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
    counters: Counters,
    /// Of the idle loop.
    preparation: Preparation,
    /// Of the tasks.
    sampler: Sampler,
    rendering: Rendering,
    command: Command,
    link: LinkTask<Place>,
    /// Between the tasks.
    commits: Commits,
    prepared: Option<Prepared>,
    rendering_plan: Option<RenderingPlan>,
    command_plan: Option<CommandPlan>,
    sampled: Option<Sampled>,
    rendered: Option<Rendered>,
}

/// What the link's task shares, of a drive whose tasks never run at once.
struct Parts<'a> {
    command: &'a mut Command,
    sampler: &'a mut Sampler,
    commits: &'a mut Commits,
}

impl Shared for Parts<'_> {
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        work(self.command)
    }

    fn sampler<R>(&mut self, work: impl FnOnce(&mut Sampler) -> R) -> R {
        work(self.sampler)
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        work(self.commits)
    }
}

impl Drive {
    /// As it starts.
    ///
    /// # Errors
    /// [`ValueError`] if the defaults are not allowed: a mistake in their
    /// table, which a test would have found.
    pub fn new(boot: &Boot) -> Result<Self, ValueError> {
        let (preparation, start) = Preparation::new()?;
        let Start {
            reader,
            motor,
            prepared,
        } = start;
        Ok(Self {
            counters: Counters::new(),
            preparation,
            sampler: Sampler::new(&reader, boot.counter, boot.tick),
            rendering: Rendering::new(&prepared.rendering),
            command: Command::new(&motor, &prepared.command, boot),
            link: LinkTask::new(boot.identity, boot.start),
            commits: Commits::default(),
            prepared: None,
            rendering_plan: None,
            command_plan: None,
            sampled: None,
            rendered: None,
        })
    }

    /// `sample_encoder`, priority 3: what the counter says as the tick begins.
    /// With a block, new parameters are handed to the other tasks.
    pub fn sample_encoder(&mut self, counter: u32) {
        if self.sampler.begins_block()
            && let Some(prepared) = self.prepared.take()
        {
            if let Some(reader) = &prepared.reader {
                self.sampler.replace(reader);
            }
            self.rendering_plan = Some(prepared.rendering);
            self.command_plan = Some(prepared.command);
        }
        self.sampled = Some(self.sampler.sample(counter));
    }

    /// `render_torque`, priority 2.
    pub fn render_torque(&mut self) {
        let Some(sampled) = &self.sampled else {
            return;
        };
        if let Some(plan) = self.rendering_plan.take() {
            self.rendering.take_over(&plan, sampled.omega_rad_s);
        }
        let was_armed = self.command.was_armed();
        self.rendered = Some(self.rendering.tick(sampled, was_armed));
    }

    /// `command_motor`, priority 4: half a tick later.
    pub fn command_motor(&mut self, inputs: &Inputs) -> Outputs {
        let Some(sampled) = &self.sampled else {
            return Outputs::default();
        };
        if let Some(plan) = self.command_plan.take() {
            self.command.take_over(&plan, &self.counters);
        }
        self.command
            .tick(inputs, sampled, self.rendered.as_ref(), &self.counters)
    }

    /// `idle`: prepares a commit, if one waits and the one before has settled.
    pub fn prepare(&mut self) {
        let is_busy = self.prepared.is_some()
            || self.rendering_plan.is_some()
            || self.command_plan.is_some()
            || self.rendering.is_settling();
        if is_busy {
            return;
        }
        let Some((revision, gathered)) = self.commits.take() else {
            return;
        };
        let Some(values) = Commits::verified(&gathered, &self.counters) else {
            return;
        };
        let is_live = self.command.safety().is_live();
        let result = self.preparation.prepare(revision, &values, is_live);
        let done = result.as_ref().map(|_| ()).map_err(|error| *error);
        self.commits.done(revision, done, &self.counters);
        self.prepared = result.ok();
    }

    /// `link`, priority 1: a byte from comms.
    pub fn link_received(&mut self, byte: u8) {
        let (link, mut parts, counters) = self.link();
        link.received(byte, &mut parts, counters);
    }

    /// A run of the rest of `link`: goes on with the next frame for comms, a
    /// piece, or begins it if it `has_place`. The frame, once it is whole.
    pub fn link_to_send(&mut self, has_place: bool) -> Option<Frame> {
        let (link, mut parts, counters) = self.link();
        let place = || has_place.then_some([0; FRAME_BYTES]);
        let made = link.next_frame(place, &mut parts, counters)?;
        Some(made.frame())
    }

    fn link(&mut self) -> (&mut LinkTask<Place>, Parts<'_>, &Counters) {
        let parts = Parts {
            command: &mut self.command,
            sampler: &mut self.sampler,
            commits: &mut self.commits,
        };
        (&mut self.link, parts, &self.counters)
    }

    /// Whether it was asked to start anew; once. The board does it.
    pub fn take_reboot(&mut self) -> bool {
        self.link.take_reboot()
    }

    /// Ticks since the start: the next one.
    pub fn next_tick(&self) -> u64 {
        self.sampler.next_tick()
    }

    /// Whether there may be torque.
    pub fn state(&self) -> State {
        self.command.safety().state()
    }

    /// The fault that it is in.
    pub fn fault(&self) -> Option<Fault> {
        self.command.safety().fault()
    }

    /// The parameters in force.
    pub fn revision(&self) -> Revision {
        self.command.revision()
    }

    /// Their values; none while the next ones are prepared already.
    pub fn values(&self) -> Option<&Values> {
        let is_other = self.prepared.is_some() || self.command_plan.is_some();
        (!is_other).then(|| self.preparation.values())
    }

    /// Output of the last `render_torque`.
    pub fn rendered(&self) -> Option<&Rendered> {
        self.rendered.as_ref()
    }

    /// What it has counted.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}
