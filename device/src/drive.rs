//! The drive controller.
//!
//! ```text
//! priority   task               when                      parts
//! 5          sample_encoder     every 50 µs                Exchange
//! 4          command_motor      half a tick later, at the  Safety, Motor, Plausibility, Batch
//!                               converters' end
//! 3          render_torque      after each sample          Sampler, Rendering
//! 1          link               bytes, room to send        Link
//! idle                                                     Preparation
//! ```
//!
//! **The clock is that of `command_motor`**, whose ticks every timeout counts. A
//! tick without a new result of `render_torque` is late, whatever kept it:
//! [`exchange`] numbers the results.
//!
//! In the firmware each task owns its part. [`Drive`] combines them, in the
//! order in which they run when none is late: the simulator runs it, and the
//! firmware is compared with it.

pub mod arming;
pub mod batch;
pub mod coil;
pub mod command;
pub mod commits;
pub mod emf_check;
pub mod exchange;
pub mod heartbeat_monitor;
pub mod idle;
pub mod link;
pub mod link_task;
mod milliamperes;
pub mod motor;
pub mod outgoing;
pub mod overload;
pub mod plausibility;
pub mod prepare;
pub mod range;
pub mod rendering;
pub mod safety;
pub mod sampler;
pub mod slow_checks;

use crate::counters::Counters;
use crate::self_test::SelfTest;
use command::{Command, Inputs, Outputs};
use commits::Commits;
use crepitus_protocol::crash::{Head, NO_TICK_WORDS, Part, Ring, TICKS, Tick};
use crepitus_protocol::frame::{FRAME_BYTES, Frame, FrameBuffer, SoftwareCrc};
use crepitus_protocol::management::Identity;
use crepitus_protocol::pieces::Reassembly;
use crepitus_protocol::{CoilFault, Fault, Revision, State, ValueError, Values};
use exchange::{Exchange, Rendered};
use idle::{Plans, prepare_pending};
use link_task::{LinkTask, Shared};
use prepare::{Preparation, Prepared, Start};
use rendering::Rendering;

/// Boot-time inputs of the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boot {
    /// Identity of this controller.
    pub identity: Identity,
    /// Result of the self-test.
    pub self_test: SelfTest,
    /// The encoder's counter.
    pub counter: u32,
    /// Boot counter.
    pub start: u16,
    /// The first tick: 0, except in a test of the wrap.
    pub tick: u64,
    /// Sequence number of the first block: 0, except in a test of the wrap.
    pub sequence: u16,
    /// The post-mortem record.
    pub crash: Option<Crash>,
}

/// The whole drive controller.
#[derive(Debug)]
pub struct Drive {
    counters: Counters,
    /// Owned by the idle loop.
    preparation: Preparation,
    /// Owned by the tasks.
    rendering: Rendering,
    command: Command,
    link: LinkTask<FrameBuffer>,
    /// Passed between the tasks.
    commits: Commits,
    prepared: Option<Prepared>,
    exchange: Exchange,
    /// The last ticks.
    last_ticks: Ring,
    /// The post-mortem record.
    crash: Option<Crash>,
}

/// A post-mortem record.
#[derive(Clone, Copy, Debug)]
pub struct Crash {
    /// Cause, registers and stack.
    pub head: Head,
    /// Last ticks before the crash.
    pub ticks: Ring,
}

impl Crash {
    /// The word at a place of the record.
    fn word(&self, place: usize) -> Option<u32> {
        let words = self.head.words();
        let ticks = self.ticks.as_flattened();
        let word = words.get(place);
        word.or_else(|| ticks.get(place.checked_sub(words.len())?))
            .copied()
    }
}

/// The link task's shared resources; here the tasks never run concurrently.
struct Parts<'a> {
    command: &'a mut Command,
    commits: &'a mut Commits,
}

impl Shared for Parts<'_> {
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        work(self.command)
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        work(self.commits)
    }
}

/// Parts that `idle` uses.
struct IdleParts<'a> {
    parts: Parts<'a>,
    prepared: &'a mut Option<Prepared>,
}

impl Plans for IdleParts<'_> {
    fn parts(&mut self) -> &mut impl Shared {
        &mut self.parts
    }

    fn store(&mut self, plan: Prepared) {
        *self.prepared = Some(plan);
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
            rendering: Rendering::new(&reader, boot.counter, &prepared.rendering),
            command: Command::new(&motor, &prepared.command, boot),
            link: LinkTask::new(boot.identity, boot.start),
            commits: Commits::default(),
            prepared: None,
            exchange: Exchange::new(boot.tick),
            last_ticks: [NO_TICK_WORDS; TICKS],
            crash: boot.crash,
        })
    }

    /// `sample_encoder`, priority 5: with the counter as the tick begins.
    pub fn sample_encoder(&mut self, counter: u32) {
        self.exchange.sample(counter);
    }

    /// `render_torque`, priority 3: after the sample.
    pub fn render_torque(&mut self) {
        if self.rendering.tick(&self.exchange) {
            let plan = self.prepared.as_ref().map(|prepared| &prepared.rendering);
            self.rendering.take_over(plan, &self.exchange);
        }
    }

    /// `command_motor`, priority 4: half a tick later.
    pub fn command_motor(&mut self, inputs: &Inputs) -> Outputs {
        let plan = self.prepared.as_ref().map(|prepared| &prepared.command);
        let ring = &mut self.last_ticks;
        let keep = |tick: &Tick| {
            if let Some(slot) = ring.get_mut(tick.slot()) {
                *slot = tick.words();
            }
        };
        self.command
            .tick(inputs, plan, &self.exchange, &self.counters, keep)
    }

    /// The post-mortem record of a program that ends like this now.
    pub fn ends(&self, head: Head) -> Crash {
        let ticks = self.last_ticks;
        Crash { head, ticks }
    }

    /// `idle`: prepares a pending commit once the previous one has settled.
    pub fn prepare(&mut self) {
        let mut gathered = Reassembly::default();
        let mut parts = IdleParts {
            parts: Parts {
                command: &mut self.command,
                commits: &mut self.commits,
            },
            prepared: &mut self.prepared,
        };
        let (exchange, counters) = (&self.exchange, &self.counters);
        let preparation = &mut self.preparation;
        prepare_pending(preparation, &mut gathered, &mut parts, exchange, counters);
    }

    /// `link`, priority 1: a byte from comms.
    pub fn link_received(&mut self, byte: u8) {
        let (link, mut parts, counters) = self.link();
        link.received(&mut SoftwareCrc, &[byte], &mut parts, counters);
    }

    /// The transmit half of `link`: encodes one piece of the current frame for
    /// comms, or starts the next one if it `has_buffer`. Returns a finished
    /// frame.
    pub fn link_to_send(&mut self, has_buffer: bool) -> Option<Frame> {
        let crash = self.crash;
        let (link, mut parts, counters) = self.link();
        let buffer = || has_buffer.then_some([0; FRAME_BYTES]);
        let part = |number| Part::of(number, |place| crash.as_ref()?.word(place));
        let made = link.next_frame(&mut SoftwareCrc, part, buffer, &mut parts, counters)?;
        Some(made.frame())
    }

    fn link(&mut self) -> (&mut LinkTask<FrameBuffer>, Parts<'_>, &Counters) {
        let parts = Parts {
            command: &mut self.command,
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
        self.command.next_tick()
    }

    /// The safety state.
    pub fn state(&self) -> State {
        self.command.safety().state()
    }

    /// The latched fault.
    pub fn fault(&self) -> Option<Fault> {
        self.command.safety().fault()
    }

    /// The latched fault of the vibration actuator's coil.
    pub fn coil_fault(&self) -> Option<CoilFault> {
        self.command.coil().fault()
    }

    /// Returns whether arming waits for the enable line of comms, or has it.
    pub fn awaits_comms(&self) -> bool {
        self.command.safety().awaits_comms()
    }

    /// Revision of the active parameters.
    pub fn revision(&self) -> Revision {
        self.command.revision()
    }

    /// Values of the active parameters; `None` while a commit is pending.
    pub fn values(&self) -> Option<&Values> {
        (!self.exchange.has_plan()).then(|| self.preparation.values())
    }

    /// Output of the last `render_torque`.
    pub fn rendered(&self) -> Option<Rendered> {
        self.exchange.rendered()
    }

    /// The counters of the drive.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}
