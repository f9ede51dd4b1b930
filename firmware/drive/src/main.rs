//! # The drive controller
//!
//! `device::drive` on silicon: read peripherals, tick, write peripherals.
//!
//! | priority | task | interrupt | when | resources of its own |
//! |---|---|---|---|---|
//! | 4 | `command_motor` | TIM3 | in the middle of the tick, when the current is converted | bridge, line, converter |
//! | 3 | `sample_encoder` | TIM4 | every 50 µs | encoder |
//! | 2 | `render_torque` | SDIO, pended | after it | the model |
//! | 1 | `link` | DMA2_STREAM6, pended | after each tick, and after each sent frame | the link, watchdog |
//! | 0 | `idle` | | always | preparation, log |
//!
//! | shared | between | locked for |
//! |---|---|---|
//! | `command`: safety, motor, blocks | 4, 1, 0 | a status, two samples |
//! | `sampled` | 4, 3, 2 | a copy |
//! | `rendered` | 4, 2 | a copy |
//! | `sampler` | 3, 1 | the clock, the zero |
//! | `prepared`, `rendering_plan`, `command_plan` | 3, 2, 4, 0 | handing over a plan |
//! | `commits` | 1, 0 | handing over a commit |
//!
//! Parameters go from `link` by `commits` to `idle`, which computes step
//! coefficients from them; at the start of a block `sample_encoder` passes
//! those to the others. Only `idle` logs, and nothing blocks.
#![no_std]
#![no_main]

mod shared;

use defmt_rtt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use crate::shared::Parts;
    use board::bridge::Bridge;
    use board::converter::Converter;
    use board::drive_board::DriveBoard;
    use board::enable_line::EnableLine;
    use board::encoder::Encoder;
    use board::link::{BUFFERS, DmaBuffer, EMPTY_BUFFER, Link};
    use board::ticks::{self, BeginOfTick, MiddleOfTick};
    use board::watchdog::{TaskCheckins, Watchdog};
    use core::sync::atomic::{AtomicBool, Ordering};
    use crepitus_device::counters::Counters;
    use crepitus_device::drive::Boot;
    use crepitus_device::drive::command::{Command, Inputs, Outputs};
    use crepitus_device::drive::commits::Commits;
    use crepitus_device::drive::link_task::LinkTask;
    use crepitus_device::drive::motor;
    use crepitus_device::drive::prepare::{CommandPlan, Preparation, Prepared, RenderingPlan};
    use crepitus_device::drive::rendering::{Rendered, Rendering};
    use crepitus_device::drive::sampler::{Sampled, Sampler};
    use crepitus_protocol::Fault;
    use crepitus_protocol::frame::FrameBuffer;
    use stm32f4xx_hal::pac::Interrupt;

    /// Starts `render_torque`; otherwise unused.
    const RENDER: Interrupt = Interrupt::SDIO;

    /// Starts `link`, as the end of a sent frame does.
    const LINK: Interrupt = Interrupt::DMA2_STREAM6;

    /// Tasks that check in with the watchdog.
    const COMMAND: usize = 0;
    const SAMPLE: usize = 1;
    const RENDERED: usize = 2;
    const LINKED: usize = 3;
    const TASKS: usize = 4;

    /// The most bytes that a run of `link` receives, every other tick. The link
    /// could bring 42 in that time; comms sends 25 in a millisecond, and 300 with
    /// a commit.
    const RUN_BYTES: usize = 16;

    /// Timeout of `idle` in runs of `link`: at most 250 ms.
    const IDLE_TIMEOUT_RUNS: u32 = 5_000;

    #[shared]
    struct Shared {
        command: Command,
        sampler: Sampler,
        commits: Commits,
        prepared: Option<Prepared>,
        rendering_plan: Option<RenderingPlan>,
        command_plan: Option<CommandPlan>,
        sampled: Option<Sampled>,
        rendered: Option<Rendered>,
        is_settling: AtomicBool,
        is_running: AtomicBool,
        is_link_due: AtomicBool,
        was_armed: AtomicBool,
        has_plan: AtomicBool,
        counters: Counters,
        checkins: TaskCheckins<TASKS>,
    }

    #[local]
    struct Local {
        middle: MiddleOfTick,
        converter: Converter,
        line: EnableLine,
        bridge: Bridge,
        begin: BeginOfTick,
        encoder: Encoder,
        rendering: Rendering,
        link: Link,
        link_task: LinkTask<DmaBuffer>,
        preparation: Preparation,
        watchdog: Watchdog,
    }

    #[init(local = [buffers: [FrameBuffer; BUFFERS] = [EMPTY_BUFFER; BUFFERS]])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = DriveBoard::new(cx.device, cx.local.buffers.each_mut());
        let start = board.start;
        defmt::info!(
            "drive: start {=u16} after {=str}; before: {=str} {=u32:#x}",
            start.number,
            start.cause.name(),
            start.before.reason.name(),
            start.before.detail,
        );
        let boot = Boot {
            identity: board.identity,
            counter: board.encoder.count(),
            start: start.number,
            ..Boot::default()
        };
        let Ok((preparation, first)) = Preparation::new() else {
            panic!("the default parameters are invalid");
        };
        let shared = Shared {
            command: Command::new(&first.motor, &first.prepared.command, &boot),
            sampler: Sampler::new(&first.reader, boot.counter, boot.tick),
            commits: Commits::default(),
            prepared: None,
            rendering_plan: None,
            command_plan: None,
            sampled: None,
            rendered: None,
            is_settling: AtomicBool::new(false),
            is_running: AtomicBool::new(false),
            is_link_due: AtomicBool::new(false),
            was_armed: AtomicBool::new(false),
            has_plan: AtomicBool::new(false),
            counters: Counters::new(),
            checkins: TaskCheckins::new(),
        };
        let local = Local {
            middle: board.middle,
            converter: board.converter,
            line: board.line,
            bridge: board.bridge,
            begin: board.begin,
            encoder: board.encoder,
            rendering: Rendering::new(&first.prepared.rendering),
            link: board.link,
            link_task: LinkTask::new(boot.identity, boot.start),
            preparation,
            watchdog: Watchdog::start(board.watchdog, IDLE_TIMEOUT_RUNS),
        };
        // Last, so that the first tick is like the others.
        ticks::start(&local.bridge, &local.middle, &local.begin);
        (shared, local)
    }

    #[task(
        binds = TIM3, priority = 4,
        local = [middle, converter, line, bridge, middles: u8 = 0],
        shared = [
            command, command_plan, sampled, rendered, &is_running, &is_link_due, &was_armed,
            &counters, &checkins,
        ]
    )]
    fn command_motor(cx: command_motor::Context) {
        let part = cx.local;
        part.middle.acknowledge();
        cx.shared.checkins.check_in(COMMAND);
        // The timers start before the tasks can run: the first interrupt is
        // left over from then, the second is synchronous.
        *part.middles = part.middles.saturating_add(1);
        if *part.middles >= 2 {
            cx.shared.is_running.store(true, Ordering::Relaxed);
        }
        let inputs = Inputs {
            current_a: part.converter.take_a(),
            enable_is_on: part.line.is_on(),
            has_tripped: part.bridge.break_has_fired(),
        };
        let (counters, was_armed) = (cx.shared.counters, cx.shared.was_armed);
        let mut shared = (
            cx.shared.command,
            cx.shared.command_plan,
            cx.shared.sampled,
            cx.shared.rendered,
        );
        let outputs = shared.lock(|command, plan, sampled, rendered| {
            let Some(sampled) = sampled else {
                return Outputs::default();
            };
            // By reference: a copy takes microseconds.
            if let Some(new) = plan {
                command.apply(new, counters);
                *plan = None;
            }
            let outputs = command.tick(&inputs, sampled, rendered.as_ref(), counters);
            was_armed.store(command.was_armed(), Ordering::Relaxed);
            outputs
        });
        part.line.set(outputs.enable);
        match outputs.bridge {
            motor::Bridge::Float => part.bridge.float(),
            motor::Bridge::Driven(volts) => part.bridge.drive(volts),
        }
        cx.shared.is_link_due.store(true, Ordering::Relaxed);
        rtic::pend(LINK);
    }

    #[task(
        binds = TIM4, priority = 3,
        local = [begin, encoder],
        shared = [
            sampler, sampled, prepared, rendering_plan, command_plan, &has_plan, &is_running, &checkins,
        ]
    )]
    fn sample_encoder(mut cx: sample_encoder::Context) {
        cx.local.begin.acknowledge();
        cx.shared.checkins.check_in(SAMPLE);
        if !cx.shared.is_running.load(Ordering::Relaxed) {
            return;
        }
        let counter = cx.local.encoder.count();
        let begins_block = cx.shared.sampler.lock(|sampler| sampler.begins_block());
        if begins_block {
            let mut slots = (
                cx.shared.prepared,
                cx.shared.rendering_plan,
                cx.shared.command_plan,
            );
            let (sampler, has_plan) = (&mut cx.shared.sampler, cx.shared.has_plan);
            slots.lock(|prepared, rendering_plan, command_plan| {
                if let Some(ready) = prepared {
                    if let Some(reader) = &ready.reader {
                        sampler.lock(|sampler| sampler.replace(reader));
                    }
                    *rendering_plan = Some(ready.rendering);
                    has_plan.store(true, Ordering::Relaxed);
                    *command_plan = Some(ready.command);
                    *prepared = None;
                }
            });
        }
        let now = cx.shared.sampler.lock(|sampler| sampler.sample(counter));
        cx.shared.sampled.lock(|sampled| *sampled = Some(now));
        rtic::pend(RENDER);
    }

    #[task(
        binds = SDIO, priority = 2,
        local = [rendering],
        shared = [
            sampled, rendered, rendering_plan, &has_plan, &is_settling, &was_armed, &checkins,
        ]
    )]
    fn render_torque(mut cx: render_torque::Context) {
        cx.shared.checkins.check_in(RENDERED);
        let rendering = cx.local.rendering;
        let sampled = cx.shared.sampled.lock(|sampled| *sampled);
        // By reference, again.
        let Some(sampled) = &sampled else {
            return;
        };
        if cx.shared.has_plan.load(Ordering::Relaxed) {
            cx.shared.has_plan.store(false, Ordering::Relaxed);
            cx.shared.rendering_plan.lock(|slot| {
                // By reference: a copy takes microseconds.
                if let Some(plan) = slot {
                    rendering.apply(plan, sampled.omega_rad_s);
                    *slot = None;
                }
            });
        }
        let was_armed = cx.shared.was_armed.load(Ordering::Relaxed);
        let now = rendering.tick(sampled, was_armed);
        let is_settling = rendering.is_settling();
        cx.shared.is_settling.store(is_settling, Ordering::Relaxed);
        cx.shared.rendered.lock(|rendered| *rendered = Some(now));
    }

    #[task(
        binds = DMA2_STREAM6, priority = 1,
        local = [link, link_task, watchdog, has_received: bool = false],
        shared = [command, sampler, commits, &is_link_due, &counters, &checkins]
    )]
    fn link(cx: link::Context) {
        let (link, task) = (cx.local.link, cx.local.link_task);
        link.acknowledge();
        cx.shared.checkins.check_in(LINKED);
        cx.local.watchdog.feed(cx.shared.checkins);
        let counters = cx.shared.counters;
        let mut parts = Parts {
            command: cx.shared.command,
            sampler: cx.shared.sampler,
            commits: cx.shared.commits,
        };
        // Once a tick, and either received bytes or a piece of a frame to send,
        // so that no tick has much to do. If both are pending they alternate.
        if !cx.shared.is_link_due.swap(false, Ordering::Relaxed) {
            return;
        }
        let received = link.received().min(RUN_BYTES);
        let receives = received > 0 && !*cx.local.has_received;
        *cx.local.has_received = receives;
        if receives {
            for _ in 0..received {
                if let Some(byte) = link.take_byte() {
                    task.received(byte, &mut parts, counters);
                }
            }
        } else if let Some(frame) = task.next_frame(|| link.spare(), &mut parts, counters) {
            link.send(frame);
        }
        if task.take_reboot() {
            board::stop::reboot();
        }
    }

    #[idle(
        local = [preparation],
        shared = [
            command, commits, prepared, rendering_plan, command_plan,
            &is_settling, &counters, &checkins,
        ]
    )]
    fn idle(mut cx: idle::Context) -> ! {
        let mut reported = None;
        loop {
            // A commit passes through these in turn.
            let is_busy = cx.shared.prepared.lock(|slot| slot.is_some())
                || cx.shared.rendering_plan.lock(|slot| slot.is_some())
                || cx.shared.command_plan.lock(|slot| slot.is_some())
                || cx.shared.is_settling.load(Ordering::Relaxed);
            if !is_busy
                && let Some((revision, gathered)) = cx.shared.commits.lock(Commits::take)
                && let Some(values) = Commits::verified(&gathered, cx.shared.counters)
            {
                let is_live = cx.shared.command.lock(|command| command.safety().is_live());
                let result = cx.local.preparation.prepare(revision, &values, is_live);
                let done = result.as_ref().map(|_| ()).map_err(|error| *error);
                let counters = cx.shared.counters;
                cx.shared
                    .commits
                    .lock(|commits| commits.done(revision, done, counters));
                let prepared = result.ok();
                cx.shared.prepared.lock(|slot| *slot = prepared);
            }
            let now = cx.shared.command.lock(|command| {
                let safety = command.safety();
                let fault = safety.fault().map_or(0, Fault::code);
                (safety.state(), fault, command.revision())
            });
            if reported != Some(now) {
                reported = Some(now);
                let (state, fault, revision) = now;
                defmt::info!(
                    "{=str}, fault {=u8}, revision {=u32}",
                    state.name(),
                    fault,
                    revision.0
                );
            }
            cx.shared.checkins.idle_checks_in();
            cortex_m::asm::wfi();
        }
    }
}
