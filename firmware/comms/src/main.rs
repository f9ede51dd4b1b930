//! # The comms controller
//!
//! `device::comms` on silicon: read bytes and lines, tick, write bytes and
//! lines.
//!
//! | priority | task | interrupt | when | resources of its own |
//! |---|---|---|---|---|
//! | 3 | `tick` | TIM2 | every quarter of a millisecond; the tick of comms with each fourth | line |
//! | 2 | `usb` | OTG_FS | events of the bus; data to send; every millisecond | the USB port |
//! | 1 | `link` | DMA2_STREAM6, pended | with `tick`, and after each sent frame | the link, watchdog |
//! | 0 | `idle` | | always | parameters in flash, log |
//!
//! | shared | between | locked for |
//! |---|---|---|
//! | `comms` | 3, 2, 1, 0 | a tick, an event of the bus, some bytes of the link, a frame |
//! | `save` | 3, 0 | handing over parameters to store |
//!
//! Only `idle` logs, and nothing blocks: a host that does not read loses
//! telemetry, which is counted.
#![no_std]
#![no_main]

use defmt_rtt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use board::comms_board::CommsBoard;
    use board::crc_unit::CrcUnit;
    use board::enable_line::EnableLine;
    use board::flash::ParameterSectors;
    use board::link::{BUFFERS, EMPTY_BUFFER, Link};
    use board::stack_mark::{self, StackMark};
    use board::task_clock::{Run, TaskClock};
    use board::ticks::Quarters;
    use board::usb::{DIGITS, PACKET_WORDS, UsbBusAllocator, UsbBusType, identity};
    use board::watchdog::{TaskCheckins, Watchdog};
    use core::mem::MaybeUninit;
    use crepitus_device::comms::{Boot, Comms, Inputs};
    use crepitus_device::parameter_log::ParameterLog;
    use crepitus_device::self_test::SelfTest;
    use crepitus_device::task_times::Reports;
    use crepitus_device::usb_port::{HostBytes, UsbPort};
    use crepitus_protocol::frame::FrameBuffer;
    use crepitus_protocol::task_times::TaskTimes;
    use crepitus_protocol::{Fault, Revision, Values};
    use stm32f4xx_hal::pac::Interrupt;

    /// Starts `usb`, as the bus does.
    const USB: Interrupt = Interrupt::OTG_FS;

    /// Starts `link`, as the end of a sent frame does.
    const LINK: Interrupt = Interrupt::DMA2_STREAM6;

    /// Bytes of the link that are taken in at a time.
    const RUN_BYTES: usize = 32;

    /// Tasks that check in with the watchdog, and whose cycles are counted: in the order of the protocol's
    /// `COMMS_TASKS`.
    const TICKED: usize = 0;
    const USB_POLLED: usize = 1;
    const LINKED: usize = 2;
    const TASKS: usize = 3;

    /// Runs of `tick` between two reports of the cycles: a second.
    const REPORT_RUNS: u32 = 4_000;

    /// Timeout of `idle` in runs of `link`: at most 250 ms.
    const IDLE_TIMEOUT_RUNS: u32 = 1_000;

    #[shared]
    struct Shared {
        comms: &'static mut Comms,
        save: Option<(Revision, Values)>,
        checkins: TaskCheckins<TASKS>,
        task_clock: TaskClock<TASKS>,
    }

    #[local]
    struct Local {
        quarters: Quarters,
        line: EnableLine,
        port: UsbPort<'static, UsbBusType>,
        link: Link,
        crc_unit: CrcUnit,
        log: ParameterLog<ParameterSectors>,
        watchdog: Watchdog,
        stack: StackMark,
    }

    #[init(local = [
        buffers: [FrameBuffer; BUFFERS] = [EMPTY_BUFFER; BUFFERS],
        // Static: large, or borrowed for ever.
        comms: MaybeUninit<Comms> = MaybeUninit::uninit(),
        bus: MaybeUninit<UsbBusAllocator<UsbBusType>> = MaybeUninit::uninit(),
        packets: [u32; PACKET_WORDS] = [0; PACKET_WORDS],
        digits: [u8; DIGITS] = [0; DIGITS]
    ])]
    fn init(mut cx: init::Context) -> (Shared, Local) {
        let stack = StackMark::paint();
        board::mpu::protect_comms(&cx.core.MPU);
        let board = CommsBoard::new(cx.device, cx.local.packets, cx.local.buffers.each_mut());
        let start = board.start;
        defmt::info!(
            "comms: start {=u16} after {=str}; before: {=str} {=u32:#x}",
            start.number,
            start.cause.name(),
            start.before.reason.name(),
            start.before.detail,
        );
        if board.self_test == SelfTest::CrystalWrong {
            defmt::error!("comms: a crystal of {=u32} Hz", board.crystal_hz);
        }
        let comms = cx.local.comms.write(Comms::new(&Boot {
            identity: board.identity,
            self_test: board.self_test,
            start: start.number,
            entropy: start.entropy,
            saved: board.log.newest(),
            counters: 0,
            crash: board::crash::head(),
        }));
        let usb_identity = identity(&board.identity.serial, cx.local.digits);
        let Ok(port) = UsbPort::new(cx.local.bus.write(board.bus), &usb_identity) else {
            panic!("the USB descriptors are invalid");
        };
        (
            Shared {
                comms,
                save: None,
                checkins: TaskCheckins::new(),
                task_clock: TaskClock::start(&mut cx.core.DCB, &mut cx.core.DWT),
            },
            Local {
                quarters: board.quarters,
                line: board.line,
                port,
                link: board.link,
                crc_unit: board.crc_unit,
                log: board.log,
                watchdog: Watchdog::start(board.watchdog, IDLE_TIMEOUT_RUNS),
                stack,
            },
        )
    }

    #[task(
        binds = TIM2, priority = 3,
        local = [quarters, line, quarter: u8 = 0],
        shared = [comms, save, &checkins, &task_clock],
    )]
    fn tick(mut cx: tick::Context) {
        let run = Run::begin();
        cx.local.quarters.acknowledge();
        cx.shared.checkins.check_in(TICKED);
        rtic::pend(LINK);
        *cx.local.quarter = (*cx.local.quarter + 1) % 4;
        if *cx.local.quarter != 0 {
            return cx.shared.task_clock.end(TICKED, run);
        }
        let inputs = Inputs {
            enable_is_on: cx.local.line.is_on(),
        };
        let outputs = cx.shared.comms.lock(|comms| comms.tick(&inputs));
        cx.local.line.set(outputs.enable);
        if outputs.save.is_some() {
            cx.shared.save.lock(|save| *save = outputs.save);
        }
        if outputs.reboot {
            board::stop::reboot();
        }
        rtic::pend(USB);
        cx.shared.task_clock.end(TICKED, run);
    }

    #[task(binds = OTG_FS, priority = 2, local = [port], shared = [comms, &checkins, &task_clock])]
    fn usb(mut cx: usb::Context) {
        let run = Run::begin();
        cx.shared.checkins.check_in(USB_POLLED);
        let port = cx.local.port;
        cx.shared.comms.lock(|comms| port.poll(*comms));
        port.drop_control_leftover();
        cx.shared.task_clock.end(USB_POLLED, run);
    }

    #[task(
        binds = DMA2_STREAM6, priority = 1,
        local = [link, crc_unit, watchdog],
        shared = [comms, &checkins, &task_clock]
    )]
    fn link(mut cx: link::Context) {
        let begun = Run::begin();
        let (link, unit) = (cx.local.link, cx.local.crc_unit);
        link.acknowledge();
        link.look();
        cx.shared.checkins.check_in(LINKED);
        cx.local.watchdog.feed(cx.shared.checkins);
        let mut run = [0; RUN_BYTES];
        for _ in 0..=link.received() / RUN_BYTES {
            let bytes = link.take(&mut run);
            cx.shared
                .comms
                .lock(|comms| comms.link_received_all(unit, bytes));
        }
        if link.can_send()
            && let Some(frame) = cx.shared.comms.lock(|comms| comms.link_to_send())
        {
            link.send_copy(&frame);
        }
        if cx.shared.comms.lock(|comms| !comms.to_send().is_empty()) {
            rtic::pend(USB);
        }
        cx.shared.task_clock.end(LINKED, begun);
    }

    #[idle(
        local = [log, stack, reports: Reports = Reports::new(REPORT_RUNS)],
        shared = [comms, save, &checkins, &task_clock]
    )]
    fn idle(mut cx: idle::Context) -> ! {
        let mut reported = None;
        loop {
            if let Some((revision, values)) = cx.shared.save.lock(Option::take) {
                let done = cx.local.log.store(revision, &values);
                cx.shared.comms.lock(|comms| comms.saved(done));
            }
            let now = cx.shared.comms.lock(|comms| {
                let fault = comms.fault().map_or(0, Fault::code);
                (comms.state(), fault, comms.revision())
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
            cx.local.stack.advance();
            let tasks = cx.shared.task_clock.tasks();
            if let Some(tasks) = cx.local.reports.poll(tasks, TICKED) {
                let times = TaskTimes {
                    tasks,
                    stack_used: cx.local.stack.used(),
                    stack_bytes: stack_mark::BYTES,
                    ..TaskTimes::default()
                };
                cx.shared.comms.lock(|comms| comms.set_times(&times));
            }
            cx.shared.checkins.idle_checks_in();
            cortex_m::asm::wfi();
        }
    }
}
