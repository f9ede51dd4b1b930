//! # The comms controller
//!
//! `device::comms` on silicon: bytes and lines in, a millisecond, bytes and
//! lines out.
//!
//! | priority | task | interrupt | when | what it has to itself |
//! |---|---|---|---|---|
//! | 3 | `tick` | TIM2 | every quarter of a millisecond; the tick of comms with each fourth | line |
//! | 2 | `usb` | OTG_FS | what the bus does; room and something to send; every millisecond | the USB port |
//! | 1 | `link` | DMA2_STREAM6, pended | with `tick`, and as a frame has gone | the link, watchdog |
//! | 0 | `idle` | | always | parameters in flash, log |
//!
//! | shared | between | locked for |
//! |---|---|---|
//! | `comms` | 3, 2, 1, 0 | a tick, an event of the bus, a byte, a frame |
//! | `save` | 3, 0 | parameters on their way to flash |
//!
//! Nothing above `idle` logs, and nothing waits: a host that does not read
//! loses telemetry, which is counted.
#![no_std]
#![no_main]

use defmt_rtt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use board::comms_board::CommsBoard;
    use board::enable_line::EnableLine;
    use board::flash::ParameterSectors;
    use board::link::{Link, PLACE, PLACES};
    use board::parameter_log::ParameterLog;
    use board::ticks::Quarters;
    use board::usb::{DIGITS, PACKET_WORDS, UsbBusAllocator, UsbBusType, identity};
    use board::watchdog::{Roll, Watchdog};
    use core::mem::MaybeUninit;
    use crepitus_device::comms::{Boot, Comms, Inputs};
    use crepitus_device::usb_port::{HostBytes, UsbPort};
    use crepitus_protocol::frame::Place;
    use crepitus_protocol::{Fault, Revision, Values};
    use stm32f4xx_hal::pac::Interrupt;

    /// What starts `usb`, beside the bus.
    const USB: Interrupt = Interrupt::OTG_FS;

    /// What starts `link`, beside the end of a frame.
    const LINK: Interrupt = Interrupt::DMA2_STREAM6;

    /// Between the order to start anew and doing it, ms: the answer is sent,
    /// and the drive is told.
    const FAREWELL_MS: u8 = 20;

    /// Who has run, for the watchdog.
    const TICKED: usize = 0;
    const USED: usize = 1;
    const LINKED: usize = 2;
    const TASKS: usize = 3;

    /// Runs of `link` that `idle` may take for a round: at most 250 ms.
    const PATIENCE: u32 = 1_000;

    #[shared]
    struct Shared {
        comms: &'static mut Comms,
        save: Option<(Revision, Values)>,
        roll: Roll<TASKS>,
    }

    #[local]
    struct Local {
        quarters: Quarters,
        line: EnableLine,
        port: UsbPort<'static, UsbBusType>,
        link: Link,
        log: ParameterLog<ParameterSectors>,
        watchdog: Watchdog,
    }

    #[init(local = [
        places: [Place; PLACES] = [PLACE; PLACES],
        // In their places from the beginning: large, or referred to for ever.
        comms: MaybeUninit<Comms> = MaybeUninit::uninit(),
        bus: MaybeUninit<UsbBusAllocator<UsbBusType>> = MaybeUninit::uninit(),
        packets: [u32; PACKET_WORDS] = [0; PACKET_WORDS],
        digits: [u8; DIGITS] = [0; DIGITS]
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = CommsBoard::new(cx.device, cx.local.packets, cx.local.places.each_mut());
        let start = board.start;
        defmt::info!(
            "comms: start {=u16} after {=str}; before: {=str} {=u32:#x}",
            start.number,
            start.cause.name(),
            start.before.reason.name(),
            start.before.detail,
        );
        let comms = cx.local.comms.write(Comms::new(&Boot {
            identity: board.identity,
            start: start.number,
            saved: board.log.newest(),
            counters: 0,
        }));
        let told = identity(&board.identity.serial, cx.local.digits);
        let Ok(port) = UsbPort::new(cx.local.bus.write(board.bus), &told) else {
            panic!("the description of the USB device is not allowed");
        };
        (
            Shared {
                comms,
                save: None,
                roll: Roll::new(),
            },
            Local {
                quarters: board.quarters,
                line: board.line,
                port,
                link: board.link,
                log: board.log,
                watchdog: Watchdog::start(board.watchdog, PATIENCE),
            },
        )
    }

    #[task(
        binds = TIM2, priority = 3,
        local = [quarters, line, quarter: u8 = 0, farewell: Option<u8> = None],
        shared = [comms, save, &roll],
    )]
    fn tick(mut cx: tick::Context) {
        cx.local.quarters.acknowledge();
        cx.shared.roll.here(TICKED);
        rtic::pend(LINK);
        *cx.local.quarter = (*cx.local.quarter + 1) % 4;
        if *cx.local.quarter != 0 {
            return;
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
            *cx.local.farewell = Some(FAREWELL_MS);
        }
        match cx.local.farewell {
            Some(0) => board::stop::reboot(),
            Some(left) => *left -= 1,
            None => {}
        }
        rtic::pend(USB);
    }

    #[task(binds = OTG_FS, priority = 2, local = [port], shared = [comms, &roll])]
    fn usb(mut cx: usb::Context) {
        cx.shared.roll.here(USED);
        let port = cx.local.port;
        cx.shared.comms.lock(|comms| port.poll(*comms));
    }

    #[task(binds = DMA2_STREAM6, priority = 1, local = [link, watchdog], shared = [comms, &roll])]
    fn link(mut cx: link::Context) {
        let link = cx.local.link;
        link.acknowledge();
        cx.shared.roll.here(LINKED);
        cx.local.watchdog.feed(cx.shared.roll);
        for _ in 0..link.received() {
            if let Some(byte) = link.take_byte() {
                cx.shared.comms.lock(|comms| comms.link_received(byte));
            }
        }
        if link.can_send()
            && let Some(frame) = cx.shared.comms.lock(|comms| comms.link_to_send())
        {
            link.send_copy(&frame);
        }
        if cx.shared.comms.lock(|comms| !comms.to_send().is_empty()) {
            rtic::pend(USB);
        }
    }

    #[idle(local = [log], shared = [comms, save, &roll])]
    fn idle(mut cx: idle::Context) -> ! {
        let mut told = None;
        loop {
            if let Some((revision, values)) = cx.shared.save.lock(Option::take) {
                let done = cx.local.log.keep(revision, &values);
                cx.shared.comms.lock(|comms| comms.saved(done));
            }
            let now = cx.shared.comms.lock(|comms| {
                let fault = comms.fault().map_or(0, Fault::code);
                (comms.state(), fault, comms.revision())
            });
            if told != Some(now) {
                told = Some(now);
                let (state, fault, revision) = now;
                defmt::info!(
                    "{=str}, fault {=u8}, revision {=u32}",
                    state.name(),
                    fault,
                    revision.0
                );
            }
            cx.shared.roll.idle_here();
            cortex_m::asm::wfi();
        }
    }
}
