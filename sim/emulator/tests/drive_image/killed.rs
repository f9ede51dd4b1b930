//! Each task killed in turn ends in a watchdog reset: its handler is replaced
//! by one that returns at once, acknowledging its interrupt or not.

use crate::code::{FOREVER, RETURN, bytes, store};
use crate::host::{Host, examination, image};
use crate::tasks::{COMMAND, LINK, RENDER, SAMPLE};
use crepitus_emulator::Reset;

/// TIM3_SR, TIM4_SR: flags are cleared by zeros. DMA2_HIFCR: by a one.
const TIM3: Acknowledge = (0x4000_0410, 0);
const TIM4: Acknowledge = (0x4000_0810, 0);
const STREAM_6: Acknowledge = (0x4002_640c, 1 << 21);

/// A register, and what is written to it to acknowledge an interrupt.
type Acknowledge = (u32, u32);

/// Name, exception, and how its interrupt is acknowledged, unless another task pends it.
const TASKS: [(&str, u16, Option<Acknowledge>); 4] = [
    ("sample_encoder", SAMPLE, Some(TIM4)),
    ("command_motor", COMMAND, Some(TIM3)),
    ("render_torque", RENDER, None),
    ("link", LINK, Some(STREAM_6)),
];

/// 4 × (160 + 1) clocks of 17 kHz, 37.9 ms, in half ticks.
const SLOWEST_WATCHDOG: u64 = 1_516;

/// Most runs of `link` that the idle loop may miss, in half ticks: it runs once
/// a tick at least.
const IDLE_TIMEOUT: u64 = 2 * 5_000;

/// A handler that only writes `value` to `register`.
fn acknowledging((register, value): Acknowledge) -> Vec<u8> {
    bytes(&[&store(register, value)[..], &[RETURN]].concat())
}

fn armed() -> Option<Host> {
    let mut host = Host::new(&image()?, &examination());
    host.arm();
    host.run(100);
    host.board.mcu_mut().set_watchdog_hz(17_000);
    Some(host)
}

/// Half ticks until the first reset, which has to be the watchdog's.
fn halves_until_reset(host: &mut Host, at_most: u64) -> u64 {
    for halves in 0..=at_most {
        if let Some((_, cause)) = host.board.resets().first() {
            assert_eq!(*cause, Reset::Watchdog);
            assert!(!host.board.drive_is_on());
            return halves;
        }
        host.board.half(None);
    }
    panic!("no reset after {at_most} half ticks");
}

#[test]
fn each_task_that_returns_at_once_is_reset_by_the_watchdog() {
    for (name, exception, acknowledge) in TASKS {
        let returns = [("unacknowledged", bytes(&[RETURN]))];
        let acknowledges = acknowledge.map(|register| ("acknowledged", acknowledging(register)));
        for (kind, handler) in returns.into_iter().chain(acknowledges) {
            let Some(mut host) = armed() else { return };
            let image = image().expect("it was there");
            let at = image.vector(exception).expect("a handler");
            host.board.mcu_mut().patch_flash(at, &handler);
            let halves = halves_until_reset(&mut host, SLOWEST_WATCHDOG + 2);
            println!("{name}, {kind}: reset after {halves} half ticks");
        }
    }
}

#[test]
fn an_idle_loop_that_hangs_is_reset_by_the_watchdog() {
    let Some(mut host) = armed() else { return };
    let idle = host.idle_pc();
    host.board.mcu_mut().patch_flash(idle, &bytes(&[FOREVER]));
    let halves = halves_until_reset(&mut host, IDLE_TIMEOUT + SLOWEST_WATCHDOG + 2);
    println!("idle: reset after {halves} half ticks");
}
