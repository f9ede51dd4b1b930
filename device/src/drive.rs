//! The drive controller.
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
//! In the firmware each task owns its part. [`Drive`] combines them, in the
//! order in which they run when none is late: the simulator runs it, and the
//! firmware is compared with it.

pub mod arming;
pub mod batch;
pub mod command;
pub mod commits;
pub mod heartbeat_monitor;
pub mod link;
pub mod link_task;
pub mod motor;
pub mod outgoing;
pub mod plausibility;
pub mod prepare;
pub mod rendering;
pub mod safety;
pub mod sampler;

use crate::counters::Counters;
use command::{Command, Inputs, Outputs};
use commits::Commits;
use crepitus_protocol::frame::{FRAME_BYTES, Frame, FrameBuffer};
use crepitus_protocol::management::Identity;
use crepitus_protocol::{Fault, Revision, State, ValueError, Values};
use link_task::{LinkTask, Shared};
use prepare::{CommandPlan, Preparation, Prepared, RenderingPlan, Start};
use rendering::{Rendered, Rendering};
use sampler::{Sampled, Sampler};

/// Boot-time inputs of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boot {
    /// Identity of this controller.
    pub identity: Identity,
    /// The encoder's counter.
    pub counter: u32,
    /// Boot counter.
    pub start: u16,
    /// The first tick: 0, except in a test of the wrap.
    pub tick: u64,
    /// Sequence number of the first block: 0, except in a test of the wrap.
    pub sequence: u16,
}

/// The whole drive controller.
#[derive(Debug)]
pub struct Drive {
    counters: Counters,
    /// Owned by the idle loop.
    preparation: Preparation,
    /// Owned by the tasks.
    sampler: Sampler,
    rendering: Rendering,
    command: Command,
    link: LinkTask<FrameBuffer>,
    /// Passed between the tasks.
    commits: Commits,
    prepared: Option<Prepared>,
    rendering_plan: Option<RenderingPlan>,
    command_plan: Option<CommandPlan>,
    sampled: Option<Sampled>,
    rendered: Option<Rendered>,
}

/// The link task's shared resources; here the tasks never run concurrently.
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
    /// The state after boot.
    ///
    /// # Errors
    /// [`ValueError`] if the default values are invalid: a bug in their table,
    /// which a test excludes.
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

    /// `sample_encoder`, priority 3: reads the counter as the tick begins. At
    /// the first tick of a block it passes new parameters to the other tasks.
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
            self.rendering.apply(&plan, sampled.omega_rad_s);
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
            self.command.apply(&plan, &self.counters);
        }
        self.command
            .tick(inputs, sampled, self.rendered.as_ref(), &self.counters)
    }

    /// `idle`: prepares a pending commit once the previous one has settled.
    pub fn prepare(&mut self) {
        let is_busy = self.prepared.is_some()
            || self.rendering_plan.is_some()
            || self.command_plan.is_some()
            || self.rendering.is_settling();
        if is_busy {
            return;
        }
        let Some((revision, reassembly)) = self.commits.take() else {
            return;
        };
        let Some(values) = Commits::verified(&reassembly, &self.counters) else {
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

    /// The transmit half of `link`: encodes one piece of the current frame for
    /// comms, or starts the next one if it `has_buffer`. Returns a finished
    /// frame.
    pub fn link_to_send(&mut self, has_buffer: bool) -> Option<Frame> {
        let (link, mut parts, counters) = self.link();
        let buffer = || has_buffer.then_some([0; FRAME_BYTES]);
        let made = link.next_frame(buffer, &mut parts, counters)?;
        Some(made.frame())
    }

    fn link(&mut self) -> (&mut LinkTask<FrameBuffer>, Parts<'_>, &Counters) {
        let parts = Parts {
            command: &mut self.command,
            sampler: &mut self.sampler,
            commits: &mut self.commits,
        };
        (&mut self.link, parts, &self.counters)
    }

    /// Returns a pending reboot request, once. The board executes it.
    pub fn take_reboot(&mut self) -> bool {
        self.link.take_reboot()
    }

    /// Number of the next tick, counted from boot.
    pub fn next_tick(&self) -> u64 {
        self.sampler.next_tick()
    }

    /// The safety state.
    pub fn state(&self) -> State {
        self.command.safety().state()
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        self.command.safety().fault()
    }

    /// Revision of the active parameters.
    pub fn revision(&self) -> Revision {
        self.command.revision()
    }

    /// Values of the active parameters; `None` while a commit is pending.
    pub fn values(&self) -> Option<&Values> {
        let is_pending = self.prepared.is_some() || self.command_plan.is_some();
        (!is_pending).then(|| self.preparation.values())
    }

    /// Output of the last `render_torque`.
    pub fn rendered(&self) -> Option<&Rendered> {
        self.rendered.as_ref()
    }

    /// The counters of the drive.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}
