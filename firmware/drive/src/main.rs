//! # The drive controller
//!
//! `device::drive` on silicon: read peripherals, tick, write peripherals.
//!
//! | priority | task | interrupt | when | resources of its own |
//! |---|---|---|---|---|
//! | 5 | `sample_encoder` | TIM4 | every 50 µs | encoder |
//! | 4 | `command_motor` | TIM3 | in the middle of the tick, when the current is converted | bridge, coil, lines, write access to them, converters, clock |
//! | 3 | `render_torque` | TIM7, pended | after each sample | the model |
//! | 1 | `link` | DMA2_STREAM6, pended | after each tick, and after each sent frame | the link, watchdog |
//! | 0 | `idle` | | always | preparation, log |
//!
//! | shared | between | locked for |
//! |---|---|---|
//! | `command`: safety, motor, blocks, its plan | 4, 1, 0 | a status, two samples; storing the plan |
//! | `exchange`, `task_clock` | 5, 4, 3, 0; all | never: atomic |
//! | `rendering_plan` | 3, 0 | storing it; applying it |
//! | `commits` | 1, 0 | handing over a commit |
//!
//! Parameters go from `link` by `commits` to `idle`, which computes step
//! coefficients from them; between two blocks the two tasks apply their halves.
//! `sample_encoder` shares nothing that is locked: no task delays the sample. Only
//! `idle` logs, and nothing blocks.
#![no_std]
#![no_main]

mod shared;

use defmt_rtt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use crate::shared::{Commanding, IdleParts, Parts};
    use board::bridge::Bridge;
    use board::coil::Coil;
    use board::converter::Converters;
    use board::crash::BlackBox;
    use board::crc_unit::CrcUnit;
    use board::drive_board::DriveBoard;
    use board::enable_line::{EnableLine, OtherLine};
    use board::encoder::Encoder;
    use board::link::{BUFFERS, DmaBuffer, EMPTY_BUFFER, Link};
    use board::mpu::OutputAccess;
    use board::stack_mark::{self, StackMark};
    use board::task_clock::{Run, TaskClock};
    use board::ticks::{self, BeginOfTick, FreeClock, MiddleOfTick};
    use board::watchdog::{TaskCheckins, Watchdog};
    use core::sync::atomic::{AtomicBool, Ordering};
    use crepitus_device::counters::Counters;
    use crepitus_device::drive::Boot;
    use crepitus_device::drive::coil::CoilOutput;
    use crepitus_device::drive::command::{Command, Inputs};
    use crepitus_device::drive::commits::Commits;
    use crepitus_device::drive::exchange::Exchange;
    use crepitus_device::drive::idle::prepare_pending;
    use crepitus_device::drive::link_task::{LinkTask, Shared as _};
    use crepitus_device::drive::motor;
    use crepitus_device::drive::prepare::{Preparation, RenderingPlan};
    use crepitus_device::drive::rendering::Rendering;
    use crepitus_device::self_test::SelfTest;
    use crepitus_device::task_times::{Reports, Sampling};
    use crepitus_protocol::counters::DriveCounter;
    use crepitus_protocol::crash::Tick;
    use crepitus_protocol::frame::{DELIMITER, FrameBuffer};
    use crepitus_protocol::pieces::Reassembly;
    use crepitus_protocol::task_times::TaskTimes;
    use crepitus_protocol::{Fault, TICKS_PER_S};
    use stm32f4xx_hal::pac::Interrupt;

    /// Starts `link`, as the end of a sent frame does.
    const LINK: Interrupt = Interrupt::DMA2_STREAM6;

    /// Starts `render_torque`: the vector of a timer that stays off.
    const RENDER: Interrupt = Interrupt::TIM7;

    /// Tasks that check in with the watchdog, and whose cycles are counted: in the order of the protocol's
    /// `DRIVE_TASKS`.
    const SAMPLED: usize = 0;
    const COMMANDED: usize = 1;
    const RENDERED: usize = 2;
    const LINKED: usize = 3;
    const TASKS: usize = 4;

    /// The most bytes that a run of `link` receives, every other tick: 240 in a
    /// millisecond. Comms sends 25, and while a commit is sent 145.
    const RUN_BYTES: usize = 24;

    /// Timeout of `idle` in runs of `link`: at most 250 ms.
    const IDLE_TIMEOUT_RUNS: u32 = 5_000;

    #[shared]
    struct Shared {
        command: Commanding,
        commits: Commits,
        rendering_plan: Option<RenderingPlan>,
        exchange: Exchange,
        is_running: AtomicBool,
        is_link_due: AtomicBool,
        counters: Counters,
        checkins: TaskCheckins<TASKS>,
        task_clock: TaskClock<TASKS>,
        sampling: Sampling,
    }

    #[local]
    struct Local {
        middle: MiddleOfTick,
        converters: Converters,
        clock: FreeClock,
        line: EnableLine,
        comms_line: OtherLine,
        bridge: Bridge,
        coil: Coil,
        black_box: BlackBox,
        output_access: OutputAccess,
        begin: BeginOfTick,
        encoder: Encoder,
        rendering: Rendering,
        link: Link,
        crc_unit: CrcUnit,
        link_task: LinkTask<DmaBuffer>,
        preparation: Preparation,
        watchdog: Watchdog,
        stack: StackMark,
    }

    #[init(local = [buffers: [FrameBuffer; BUFFERS] = [EMPTY_BUFFER; BUFFERS]])]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        let stack = StackMark::paint();
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
            self_test: board.self_test,
            counter: board.encoder.count(),
            start: start.number,
            ..Boot::default()
        };
        if board.self_test == SelfTest::CrystalWrong {
            defmt::error!("drive: a crystal of {=u32} Hz", board.crystal_hz);
        }
        let Ok((preparation, first)) = Preparation::new() else {
            panic!("the default parameters are invalid");
        };
        let shared = Shared {
            command: Commanding {
                command: Command::new(&first.motor, &first.prepared.command, &boot),
                plan: None,
            },
            commits: Commits::default(),
            rendering_plan: None,
            exchange: Exchange::new(boot.tick),
            is_running: AtomicBool::new(false),
            is_link_due: AtomicBool::new(false),
            counters: Counters::new(),
            checkins: TaskCheckins::new(),
            task_clock: TaskClock::start(&mut cx.core.DCB, &mut cx.core.DWT),
            sampling: Sampling::new(),
        };
        let mut local = Local {
            middle: board.middle,
            converters: board.converters,
            clock: board.clock,
            line: board.line,
            comms_line: board.comms_line,
            bridge: board.bridge,
            coil: board.coil,
            black_box: board.black_box,
            output_access: OutputAccess::protect(cx.core.MPU),
            begin: board.begin,
            encoder: board.encoder,
            rendering: Rendering::new(&first.reader, boot.counter, &first.prepared.rendering),
            link: board.link,
            crc_unit: board.crc_unit,
            link_task: LinkTask::new(boot.identity, boot.start),
            preparation,
            watchdog: Watchdog::start(board.watchdog, IDLE_TIMEOUT_RUNS),
            stack,
        };
        // Last, so that the first tick is like the others.
        local
            .output_access
            .write(|| ticks::start(&local.bridge, &local.middle, &local.begin, &local.coil));
        (shared, local)
    }

    #[task(
        binds = TIM4, priority = 5,
        local = [begin, encoder],
        shared = [&exchange, &is_running, &checkins, &task_clock, &sampling]
    )]
    fn sample_encoder(cx: sample_encoder::Context) {
        let run = Run::begin();
        cx.local.begin.acknowledge();
        cx.shared.checkins.check_in(SAMPLED);
        if cx.shared.is_running.load(Ordering::Relaxed) {
            cx.shared.exchange.sample(cx.local.encoder.count());
            let instant = cx.local.begin.clocks();
            rtic::pend(RENDER);
            cx.shared.sampling.store(run.end(), instant);
        } else {
            cx.shared.task_clock.end(SAMPLED, run);
        }
    }

    #[task(
        binds = TIM3, priority = 4,
        local = [
            middle, converters, clock, line, comms_line, bridge, coil, output_access, black_box,
            middles: u8 = 0,
        ],
        shared = [
            command, &exchange, &is_running, &is_link_due, &counters, &checkins, &task_clock,
            &sampling,
        ]
    )]
    fn command_motor(mut cx: command_motor::Context) {
        let run = Run::begin();
        let part = cx.local;
        part.middle.acknowledge();
        cx.shared.checkins.check_in(COMMANDED);
        // The timers start before the tasks can run: the first interrupt is
        // left over from then, the second is synchronous.
        *part.middles = part.middles.saturating_add(1);
        if *part.middles >= 2 {
            cx.shared.is_running.store(true, Ordering::Relaxed);
        }
        let coil_is_driven = part.coil.is_driven();
        let inputs = Inputs {
            current_a: part.converters.take_sensor_a(),
            monitor_a: part.converters.take_monitor_a(),
            slow: part.converters.take_slow(),
            coil_a: coil_is_driven
                .then(|| part.converters.take_coil_a())
                .flatten(),
            coil_has_tripped: part.coil.has_tripped(),
            interval_us: part.clock.interval_us(),
            enable_is_on: part.line.is_on(),
            comms_enable_is_on: part.comms_line.is_on(),
            has_tripped: part.bridge.break_has_fired(),
        };
        let (exchange, counters) = (cx.shared.exchange, cx.shared.counters);
        let keep = |tick: &Tick| part.black_box.record(tick);
        let outputs = cx.shared.command.lock(|part| {
            let plan = part.plan.as_ref();
            part.command.tick(&inputs, plan, exchange, counters, keep)
        });
        part.output_access.write(|| {
            part.line.set(outputs.enable);
            match outputs.bridge {
                motor::Bridge::Float => part.bridge.float(),
                motor::Bridge::Driven(_) => part.bridge.drive(outputs.duty),
            }
            match outputs.coil {
                CoilOutput::Asleep => part.coil.sleep(),
                CoilOutput::Driven(duty) => part.coil.drive(duty),
            }
        });
        cx.shared.is_link_due.store(true, Ordering::Relaxed);
        rtic::pend(LINK);
        let clock = cx.shared.task_clock;
        if let Some(cycles) = cx.shared.sampling.take() {
            clock.add(SAMPLED, cycles);
        }
        clock.end(COMMANDED, run);
    }

    #[task(
        binds = TIM7, priority = 3,
        local = [rendering],
        shared = [rendering_plan, &exchange, &checkins, &task_clock]
    )]
    fn render_torque(mut cx: render_torque::Context) {
        let run = Run::begin();
        cx.shared.checkins.check_in(RENDERED);
        let (rendering, exchange) = (cx.local.rendering, cx.shared.exchange);
        if rendering.tick(exchange) {
            cx.shared
                .rendering_plan
                .lock(|plan| rendering.take_over(plan.as_ref(), exchange));
        }
        cx.shared.task_clock.end(RENDERED, run);
    }

    #[task(
        binds = DMA2_STREAM6, priority = 1,
        local = [
            link, crc_unit, link_task, watchdog,
            has_received: bool = false,
            has_ended: bool = false,
        ],
        shared = [command, commits, &is_link_due, &counters, &checkins, &task_clock]
    )]
    fn link(cx: link::Context) {
        let run = Run::begin();
        let (link, task) = (cx.local.link, cx.local.link_task);
        link.acknowledge();
        // The end of a sent frame is no tick.
        if !cx.shared.is_link_due.swap(false, Ordering::Relaxed) {
            return cx.shared.task_clock.end(LINKED, run);
        }
        link.look();
        cx.shared.checkins.check_in(LINKED);
        cx.local.watchdog.feed(cx.shared.checkins);
        let (counters, unit) = (cx.shared.counters, cx.local.crc_unit);
        let mut parts = Parts {
            command: cx.shared.command,
            commits: cx.shared.commits,
        };
        // Once a tick, and either received bytes or a piece of a frame to send,
        // so that no tick has much to do. If both are pending they alternate. The end
        // of a frame, whose message is handled at once, has a run of its own, which
        // may follow the one before.
        let received = link.received();
        let is_end = received > 0 && link.next_byte() == Some(DELIMITER);
        let may_receive = !*cx.local.has_received || is_end && !*cx.local.has_ended;
        let receives = received > 0 && may_receive;
        (*cx.local.has_received, *cx.local.has_ended) = (receives, receives && is_end);
        if receives {
            let mut bytes = [0; RUN_BYTES];
            let part = link.take_part(received, &mut bytes);
            task.received(unit, part, &mut parts, counters);
        } else {
            let spare = || link.spare();
            let made = task.next_frame(unit, board::crash::part, spare, &mut parts, counters);
            if let Some(frame) = made {
                link.send(frame);
            }
        }
        if task.take_reboot() {
            board::stop::reboot();
        }
        cx.shared.task_clock.end(LINKED, run);
    }

    #[idle(
        local = [preparation, stack, reports: Reports = Reports::new(TICKS_PER_S)],
        shared = [
            command, commits, rendering_plan, &exchange, &counters, &checkins, &task_clock,
            &sampling,
        ]
    )]
    fn idle(cx: idle::Context) -> ! {
        let mut reported = None;
        let mut gathered = Reassembly::default();
        let (exchange, counters) = (cx.shared.exchange, cx.shared.counters);
        let mut parts = IdleParts {
            parts: Parts {
                command: cx.shared.command,
                commits: cx.shared.commits,
            },
            rendering_plan: cx.shared.rendering_plan,
        };
        loop {
            let preparation = &mut *cx.local.preparation;
            prepare_pending(preparation, &mut gathered, &mut parts, exchange, counters);
            let now = parts.parts.command(|command| {
                let safety = command.safety();
                (safety.state(), safety.fault().map_or(0, Fault::code))
            });
            // Not the revision: the log disables interrupts for some 5 µs, and the ticks after a
            // commit have the least time to spare.
            if reported != Some(now) {
                reported = Some(now);
                let (state, fault) = now;
                defmt::info!("{=str}, fault {=u8}", state.name(), fault);
            }
            cx.local.stack.advance();
            let tasks = cx.shared.task_clock.tasks();
            if let Some(tasks) = cx.local.reports.poll(tasks, COMMANDED) {
                let (earliest_sample, latest_sample) = cx.shared.sampling.span();
                counters.times().offer(&TaskTimes {
                    tasks,
                    earliest_sample,
                    latest_sample,
                    late_ticks: counters.get(DriveCounter::LateTicks),
                    stack_used: cx.local.stack.used(),
                    stack_bytes: stack_mark::BYTES,
                });
            }
            cx.shared.checkins.idle_checks_in();
            board::sleep();
        }
    }
}
